"""Reads the interface package as ROS 2's own tools do.

Usage: package.py PACKAGE_FOLDER LOG_FOLDER

Prints what catkin_pkg, which defines REP-149 in code, has read of package.xml and what it warns of,
and what colcon finds with and without --base-paths, its plug-in for cargo being there.
"""

import json
import os
import subprocess
import sys
from pathlib import Path

from catkin_pkg.package import parse_package

package_folder, log_folder = Path(sys.argv[1]), sys.argv[2]


def colcon(base):
    environment = {**os.environ, "COLCON_LOG_PATH": log_folder, "COLCON_HOME": log_folder}
    program = Path(sys.executable).with_name("colcon")
    said = subprocess.run(
        [program, "list", "--base-paths", base],
        cwd=package_folder.parent.parent, env=environment, capture_output=True, text=True, check=True,
    )
    return [line.split("\t") for line in said.stdout.splitlines()]


warnings = []
package = parse_package(str(package_folder / "package.xml"), warnings=warnings)
package.validate(warnings=warnings)
names = lambda dependencies: sorted(dependency.name for dependency in dependencies)
json.dump({
    "name": package.name,
    "version": package.version,
    "format": package.package_format,
    "licenses": [str(licence) for licence in package.licenses],
    "maintainers": [one.email for one in package.maintainers],
    "build_type": package.get_build_type(),
    "groups": [group.name for group in package.member_of_groups],
    "buildtool": names(package.buildtool_depends),
    "build": names(package.build_depends),
    "run": names(package.exec_depends),
    "test": names(package.test_depends),
    "warnings": warnings,
    "colcon_msgs": colcon("msgs"),
    "colcon_root": colcon("."),
}, sys.stdout)
