"""Writes a bag of boundary commands with rosbags, as another recorder would.

Usage: write_bag.py BAG_FOLDER BOUNDARY_COMMAND_TEXT < [{"topic": ..., "command": {...}}]

BOUNDARY_COMMAND_TEXT is a .msg file; fields that it has beyond those of the input become 0.
"""

import json
import sys
from pathlib import Path

import numpy
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

NAME = "graintwin_msgs/msg/BoundaryCommand"


def main():
    folder, text = Path(sys.argv[1]), Path(sys.argv[2]).read_text()
    store = get_typestore(Stores.ROS2_JAZZY)
    store.register(get_types_from_msg(text, NAME))
    time, header = store.types["builtin_interfaces/msg/Time"], store.types["std_msgs/msg/Header"]
    connections = {}
    with Writer(folder, version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        for number, sent in enumerate(json.load(sys.stdin)):
            topic, command = sent["topic"], sent["command"]
            if topic not in connections:
                connections[topic] = writer.add_connection(topic, NAME, typestore=store)
            fields = dict.fromkeys((name for name, _ in store.fielddefs[NAME][1]), 0)
            fields |= command
            stamp = command["header"]["stamp"]
            fields["header"] = header(time(stamp["sec"], stamp["nanosec"]), "")
            fields["displacement"] = numpy.array(command["displacement"])
            raw = store.serialize_cdr(store.types[NAME](**fields), NAME)
            writer.write(connections[topic], 1_000 + number, raw)


main()
