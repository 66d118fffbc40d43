"""A picture of a recording in the viewer rerun: grains, force chains, walls and curves.

    python -m venv ENV && ENV/bin/pip install rerun-sdk==0.41.0 mcap==1.6.0 rosbags==0.11.9
    ENV/bin/python docs/images/viewer.py BAG OUT.png [--increment N]

Rerun draws point clouds and curves of a bag by itself (`rerun BAG/BAG_0.mcap`), but no markers; so
this reads the bag with rosbags, knows nothing of graintwin but its topics, and hands the markers
on. Without a screen it needs xvfb-run, and without a graphics card a software rasteriser (on
Debian: xvfb, mesa-vulkan-drivers).
"""

import argparse
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy
import rerun
import rerun.blueprint as layout
from PIL import Image
from rosbags.rosbag2 import Reader
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

LINE_LIST, SPHERE_LIST, TRIANGLE_LIST = 5, 7, 11
WALLS = ("x_min", "x_max", "y_min", "y_max", "z_min", "z_max")
STRAIN = "axial strain [µm/m]"
SIZE = (1600, 720)
PATIENCE_SECONDS = 300


def read(folder):
    """Messages by topic in the order of the bag; the types come from the bag alone."""
    store = get_typestore(Stores.EMPTY)
    told = {"state": [], "wall_forces": [], "markers": []}
    with Reader(folder) as reader:
        wanted = [one for one in reader.connections if one.topic.rsplit("/", 1)[1] in told]
        for connection in wanted:
            store.register(get_types_from_msg(connection.msgdef.data, connection.msgtype))
        for connection, _, raw in reader.messages(connections=wanted):
            message = store.deserialize_cdr(raw, connection.msgtype)
            told[connection.topic.rsplit("/", 1)[1]].append(message)
    return told


def points(marker):
    return numpy.array([[point.x, point.y, point.z] for point in marker.points])


def rgb(color):
    return [int(255 * part) for part in (color.r, color.g, color.b)]


def draw(array):
    """The markers of one increment, in a view each for spheres and chains; returns the text."""
    text = ""
    for marker in array.markers:
        name = f"{marker.ns}/{marker.id}"
        centre = marker.pose.position
        if marker.ns == "text":
            text = marker.text
        elif marker.ns == "walls" and marker.type != TRIANGLE_LIST:
            box = rerun.Boxes3D(
                centers=[[centre.x, centre.y, centre.z]],
                sizes=[[marker.scale.x, marker.scale.y, marker.scale.z]],
                colors=[[150, 170, 190]],
                radii=[rerun.components.Radius.ui_points(0.75)],
                fill_mode=rerun.components.FillMode.MajorWireframe,
            )
            rerun.log(name, box, static=True)
        elif not marker.points:
            continue
        elif marker.type == SPHERE_LIST:
            spheres = rerun.Points3D(
                points(marker),
                radii=marker.scale.x / 2,
                colors=[rgb(color) for color in marker.colors],
            )
            rerun.log(name, spheres, static=True)
        elif marker.type == TRIANGLE_LIST:
            triangles = points(marker).reshape(-1, 3, 3)
            rerun.log(name, rerun.LineStrips3D(triangles, colors=[rgb(marker.color)]), static=True)
        elif marker.type == LINE_LIST:
            lines = rerun.LineStrips3D(
                points(marker).reshape(-1, 2, 3),
                radii=marker.scale.x / 2,
                colors=[rgb(marker.color)],
            )
            rerun.log(name, lines, static=True)
    return text


def micro(state):
    """The axial strain in whole µm/m, which rerun counts as time."""
    return round(1e6 * state.strain[2])


def plot(states, forces):
    """Curves over the axial strain."""
    for name in WALLS:
        rerun.log(f"forces/{name}", rerun.SeriesLines(names=name), static=True)
    for name in ("confining", "deviatoric"):
        rerun.log(f"stresses/{name}", rerun.SeriesLines(names=f"{name} stress"), static=True)
    for state, force in zip(states, forces, strict=True):
        rerun.set_time(STRAIN, sequence=micro(state))
        for name, value in zip(WALLS, force.normal_force, strict=True):
            rerun.log(f"forces/{name}", rerun.Scalars(value))
        rerun.log("stresses/confining", rerun.Scalars(state.confining_stress / 1e6))
        rerun.log("stresses/deviatoric", rerun.Scalars(state.deviatoric_stress / 1e6))


def views(array, strains):
    """Where everything stands on the screen."""
    walls = [marker for marker in array.markers if marker.ns == "walls"]
    places = numpy.array([[m.pose.position.x, m.pose.position.y, m.pose.position.z] for m in walls])
    middle, largest = places.mean(axis=0), (places.max(axis=0) - places.min(axis=0)).max()
    eye = layout.EyeControls3D(
        position=middle + largest * numpy.array([1.25, -1.75, 0.95]),
        look_target=middle,
        eye_up=[0.0, 0.0, 1.0],
    )

    def scene(contents, name):
        return layout.Spatial3DView(
            origin="/",
            contents=contents,
            name=name,
            background=[255, 255, 255],
            line_grid=layout.LineGrid3D(visible=False),
            eye_controls=eye,
        )

    whole = layout.TimeAxis(
        view_range=rerun.TimeRange(
            rerun.TimeRangeBoundary.absolute(seq=min(strains)),
            # With a little room for the last number of the axis.
            rerun.TimeRangeBoundary.absolute(seq=max(strains) + max(strains) // 12),
        )
    )
    curves = [
        layout.TimeSeriesView(
            origin=origin,
            name=f"{what} over {STRAIN}",
            axis_x=whole,
            plot_legend=rerun.blueprint.Corner2D.LeftTop,
        )
        for origin, what in (("forces", "wall forces [N]"), ("stresses", "stresses [MPa]"))
    ]
    return layout.Blueprint(
        layout.Horizontal(
            scene(["spheres/**", "walls/**"], "grains, coloured by pressure"),
            scene(["chains/**", "walls/**"], "forces above the mean"),
            layout.Vertical(
                *curves,
                layout.TextDocumentView(origin="about", name="increment"),
                row_shares=[3, 3, 2],
            ),
            column_shares=[4, 4, 3],
        ),
        layout.TimePanel(state="hidden", timeline=STRAIN),
        layout.BlueprintPanel(state="hidden"),
        layout.SelectionPanel(state="hidden"),
        layout.TopPanel(state="hidden"),
    )


def photograph(recording, out):
    viewer = Path(sys.executable).parent / "rerun"
    size = "x".join(map(str, SIZE))
    command = [viewer, recording, "--screenshot-to", out, "--window-size", size]
    if "DISPLAY" not in os.environ:
        if not shutil.which("xvfb-run"):
            sys.exit("no screen, and no xvfb-run to stand in for one")
        screen = f"-screen 0 {SIZE[0]}x{SIZE[1]}x24"
        command = ["xvfb-run", "-a", "-s", screen, *command]
    # What it has to say of the machine would stand in the picture.
    quiet = {**os.environ, "RUST_LOG": "off"}
    done = subprocess.run(
        command, timeout=PATIENCE_SECONDS, capture_output=True, text=True, env=quiet
    )
    if not Path(out).exists():
        sys.exit(f"the viewer drew nothing: {done.stderr}")
    # It draws two dots a pixel; a page needs one.
    with Image.open(out) as drawn:
        small = drawn.convert("RGB").resize(SIZE, Image.Resampling.LANCZOS)
    small.save(out, optimize=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("bag", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--increment", type=int, help="the last with a picture by default")
    arguments = parser.parse_args()
    told = read(arguments.bag)
    if not told["markers"]:
        sys.exit(f"{arguments.bag} holds no markers: outputs.markers of its scene is never")
    pictures = {}
    numbers = {(s.header.stamp.sec, s.header.stamp.nanosec): s.increment for s in told["state"]}
    for array in told["markers"]:
        stamp = array.markers[0].header.stamp
        pictures[numbers[stamp.sec, stamp.nanosec]] = array
    number = max(pictures) if arguments.increment is None else arguments.increment
    if number not in pictures:
        sys.exit(f"increment {number} has no picture; there are those of {sorted(pictures)}")
    rerun.init("graintwin")
    text = draw(pictures[number])
    plot(told["state"], told["wall_forces"])
    rerun.log("about", rerun.TextDocument(text.replace(", ", "\n")), static=True)
    with tempfile.TemporaryDirectory() as folder:
        recording = Path(folder) / "recording.rrd"
        strains = [micro(state) for state in told["state"]]
        rerun.save(recording, default_blueprint=views(pictures[number], strains))
        rerun.disconnect()
        photograph(recording, arguments.out)
    print(f"{arguments.out}: increment {number}, {text}")


main()
