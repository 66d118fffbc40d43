"""Writes the bag of a rig that knows nothing of this package, with rosbags, as another recorder would.

Usage: write_rig.py BAG_FOLDER < {"storage": "mcap", "compression": "STORAGE", "messages": [...]}

A message has topic, time (ns) and big (its byte order), and one of
  states: {"names": [...], "positions": [...]}
  trajectory: {"names": [...], "points": [[seconds, [...]], ...]}
  text: "..."
  raw: bytes of a JointState, as hexadecimal digits.
Its stamp is its time.
"""

import json
import sys
from pathlib import Path

import numpy
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

STORE = get_typestore(Stores.ROS2_JAZZY)
STATES = "sensor_msgs/msg/JointState"
TRAJECTORY = "trajectory_msgs/msg/JointTrajectory"
TEXT = "std_msgs/msg/String"


def header(time):
    stamp = STORE.types["builtin_interfaces/msg/Time"](time // 10**9, time % 10**9)
    return STORE.types["std_msgs/msg/Header"](stamp, "rig")


def floats(values):
    return numpy.array(values, dtype=numpy.float64)


def states(time, names, positions):
    rest = floats([0.5] * len(positions))
    return STORE.types[STATES](header(time), names, floats(positions), rest, floats([]))


def trajectory(time, names, points):
    point = STORE.types["trajectory_msgs/msg/JointTrajectoryPoint"]
    duration = STORE.types["builtin_interfaces/msg/Duration"]
    none = floats([])
    points = [point(floats(at), none, none, none, duration(sec, 0)) for sec, at in points]
    return STORE.types[TRAJECTORY](header(time), names, points)


def message(sent):
    time = sent["time"]
    if "states" in sent:
        return STATES, states(time, **sent["states"])
    if "trajectory" in sent:
        return TRAJECTORY, trajectory(time, **sent["trajectory"])
    if "text" in sent:
        return TEXT, STORE.types[TEXT](sent["text"])
    return STATES, None


def main():
    asked = json.load(sys.stdin)
    plugin = StoragePlugin[asked.get("storage", "mcap").upper()]
    mode = CompressionMode[asked.get("compression", "NONE")]
    connections = {}
    writer = Writer(Path(sys.argv[1]), version=9, storage_plugin=plugin)
    if mode != CompressionMode.NONE:
        writer.set_compression(mode, CompressionFormat.ZSTD)
    with writer:
        for sent in asked["messages"]:
            topic = sent["topic"]
            kind, content = message(sent)
            if topic not in connections:
                connections[topic] = writer.add_connection(topic, kind, typestore=STORE)
            if content is None:
                raw = bytes.fromhex(sent["raw"])
            else:
                big = sent.get("big", False)
                raw = STORE.serialize_cdr(content, kind, little_endian=not big)
            writer.write(connections[topic], sent["time"], raw)


main()
