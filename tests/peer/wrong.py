"""Publishes what is no command on the topic of the commands.

    wrong.py KIND COUNT

KIND is `string`, which says what type it has, or a type that says it is a BoundaryCommand and is
not: `short` ends after the session, `empty` ends before its header, `lying` gives its session more
bytes than there are. Of a type that matches the node's, it ends when the node has acknowledged all.
"""

import os
import sys
import time
from dataclasses import dataclass

from cyclonedds.domain import DomainParticipant
from cyclonedds.idl import IdlStruct
from cyclonedds.idl.types import uint8, uint32
from cyclonedds.pub import DataWriter
from cyclonedds.topic import Topic
from cyclonedds.util import duration

from messages import Header, Time, dds_name, qos
from play import MATCH_SECONDS, SETTLE_SECONDS

COMMAND = "graintwin_msgs.msg.dds_.BoundaryCommand_"


@dataclass
class String(IdlStruct, typename="std_msgs.msg.dds_.String_"):
    data: str


@dataclass
class Short(IdlStruct, typename=COMMAND):
    header: Header
    session: str


@dataclass
class Empty(IdlStruct, typename=COMMAND):
    structure_needs_at_least_one_member: uint8


@dataclass
class Lying(IdlStruct, typename=COMMAND):
    header: Header
    session_bytes: uint32


MESSAGES = {
    "string": String("not a command"),
    "short": Short(Header(Time(0, 0), ""), "rig"),
    "empty": Empty(0),
    "lying": Lying(Header(Time(0, 0), ""), 0xFFFFFFFF),
}


def main():
    kind, count = sys.argv[1], int(sys.argv[2])
    message = MESSAGES[kind]
    participant = DomainParticipant(int(os.environ.get("ROS_DOMAIN_ID", "0")))
    topic = Topic(participant, dds_name("boundary_command"), type(message))
    writer = DataWriter(participant, topic, qos=qos(1000))
    end = time.monotonic() + MATCH_SECONDS
    while kind != "string" and not writer.get_matched_subscriptions():
        if time.monotonic() > end:
            sys.exit(f"not matched within {MATCH_SECONDS} s")
        time.sleep(0.02)
    time.sleep(SETTLE_SECONDS)
    for _ in range(count):
        writer.write(message)
    if not writer.wait_for_acks(duration(seconds=MATCH_SECONDS)):
        sys.exit("the node does not acknowledge them")
    time.sleep(SETTLE_SECONDS)


if __name__ == "__main__":
    main()
