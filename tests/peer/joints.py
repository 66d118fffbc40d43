"""A rig that knows nothing of graintwin's messages: publishes joint states and trajectories.

    joints.py MESSAGES.json

MESSAGES.json holds a list of JointState under `states` and one of JointTrajectory under
`trajectories`, numbers as text. They are written in this order and kept until the node has taken
them. The domain is that of ROS_DOMAIN_ID. Exit code 1 when the node is not found or does not take
them.
"""

import json
import os
import sys
import time
from dataclasses import dataclass

from cyclonedds.domain import DomainParticipant
from cyclonedds.idl import IdlStruct
from cyclonedds.idl.types import float64, int32, sequence, uint32
from cyclonedds.pub import DataWriter
from cyclonedds.topic import Topic
from cyclonedds.util import duration

from messages import Header, JointState, Time, dds_name, qos

MATCH_SECONDS = 30
SETTLE_SECONDS = 0.8


@dataclass
class Duration(IdlStruct, typename="builtin_interfaces.msg.dds_.Duration_"):
    sec: int32
    nanosec: uint32


@dataclass
class Point(IdlStruct, typename="trajectory_msgs.msg.dds_.JointTrajectoryPoint_"):
    positions: sequence[float64]
    velocities: sequence[float64]
    accelerations: sequence[float64]
    effort: sequence[float64]
    time_from_start: Duration


@dataclass
class JointTrajectory(IdlStruct, typename="trajectory_msgs.msg.dds_.JointTrajectory_"):
    header: Header
    joint_names: sequence[str]
    points: sequence[Point]


def floats(texts):
    return [float(text) for text in texts]


def state(fields):
    header = Header(Time(*fields["stamp"]), "rig")
    return JointState(header, fields["name"], floats(fields["position"]), [0.5], [])


def trajectory(fields):
    points = [
        Point(floats(positions), [], [], [1.0], Duration(sec, nanosec))
        for sec, nanosec, positions in fields["points"]
    ]
    return JointTrajectory(Header(Time(*fields["stamp"]), ""), fields["name"], points)


def wait_for_node(writers):
    end = time.monotonic() + MATCH_SECONDS
    while any(len(writer.get_matched_subscriptions()) == 0 for writer in writers):
        if time.monotonic() > end:
            sys.exit(f"not matched within {MATCH_SECONDS} s")
        time.sleep(0.02)
    time.sleep(SETTLE_SECONDS)


def main():
    with open(sys.argv[1], encoding="utf-8") as file:
        messages = json.load(file)
    participant = DomainParticipant(int(os.environ.get("ROS_DOMAIN_ID", "0")))
    kinds = {"states": ("joint_states", JointState), "trajectories": ("joint_trajectory", JointTrajectory)}
    writers = {
        key: DataWriter(participant, Topic(participant, dds_name(name), kind), qos=qos(1000))
        for key, (name, kind) in kinds.items()
    }
    wait_for_node(writers.values())
    for key, read in (("states", state), ("trajectories", trajectory)):
        for fields in messages[key]:
            writers[key].write(read(fields))
        if not writers[key].wait_for_acks(duration(seconds=60)):
            sys.exit(f"{key} are not acknowledged")


if __name__ == "__main__":
    main()
