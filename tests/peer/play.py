"""A rig that knows the twin from DDS only: plays commands, writes down everything it gets.

    play.py COMMANDS.json RECEIVED.json [--in-flight N]

COMMANDS.json is a list of objects with the fields of BoundaryCommand, floats as text where JSON
has no word for them. RECEIVED.json holds a list of messages for every topic of the node, in the
order of arrival, NaN as null. The domain is that of ROS_DOMAIN_ID. Exit code 1 when the node is
not found or a command stays without a report.
"""

import argparse
import json
import math
import os
import sys
import time
from dataclasses import fields, is_dataclass

from cyclonedds.domain import DomainParticipant
from cyclonedds.internal import InvalidSample
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic

from messages import OUT, BoundaryCommand, Header, Time, dds_name, qos

MATCH_SECONDS = 30
SETTLE_SECONDS = 0.8
QUIET_SECONDS = 3
ANSWER_SECONDS = 120


def command_from(fields_):
    stamp = fields_["header"]["stamp"]
    return BoundaryCommand(
        header=Header(Time(stamp["sec"], stamp["nanosec"]), fields_["header"]["frame_id"]),
        session=fields_["session"],
        sequence=fields_["sequence"],
        mode=fields_["mode"],
        displacement=[float(value) for value in fields_["displacement"]],
    )


def plain(value):
    """A message as JSON can hold it."""
    if is_dataclass(value):
        return {field.name: plain(getattr(value, field.name)) for field in fields(value)}
    if isinstance(value, (list, tuple, bytes)):
        return [plain(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value


class Peer:
    def __init__(self):
        participant = DomainParticipant(int(os.environ.get("ROS_DOMAIN_ID", "0")))
        topic = Topic(participant, dds_name("boundary_command"), BoundaryCommand)
        self.writer = DataWriter(participant, topic, qos=qos(20000))
        self.readers = {
            name: DataReader(
                participant,
                Topic(participant, dds_name(name), out.kind),
                qos=qos(out.depth, out.latched),
            )
            for name, out in OUT.items()
        }
        self.received = {name: [] for name in OUT}
        self.answered = set()
        self.last_arrival = time.monotonic()

    def wait_for_node(self):
        """Until every endpoint is matched."""
        end = time.monotonic() + MATCH_SECONDS
        while True:
            missing = [
                name
                for name, reader in self.readers.items()
                if len(reader.get_matched_publications()) == 0
            ]
            if len(self.writer.get_matched_subscriptions()) == 0:
                missing.append("boundary_command")
            if not missing:
                return
            if time.monotonic() > end:
                sys.exit(f"not matched within {MATCH_SECONDS} s: {', '.join(missing)}")
            time.sleep(0.02)

    def take(self):
        """Everything that has arrived."""
        for name, reader in self.readers.items():
            while samples := reader.take(N=200):
                self.last_arrival = time.monotonic()
                got = [sample for sample in samples if not isinstance(sample, InvalidSample)]
                self.received[name] += got
                if name == "report":
                    self.answered.update((report.session, report.sequence) for report in got)

    def take_for(self, seconds):
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            self.take()
            time.sleep(0.002)

    def take_until_quiet(self):
        while time.monotonic() - self.last_arrival < QUIET_SECONDS:
            self.take()
            time.sleep(0.01)

    def play(self, commands, in_flight):
        """Writes the commands, at most `in_flight` of them without a report; returns what stays
        without one."""
        waiting = set()
        end = time.monotonic() + ANSWER_SECONDS
        for command in commands:
            self.writer.write(command)
            waiting.add((command.session, command.sequence))
            while len(waiting) >= in_flight and time.monotonic() < end:
                self.take()
                waiting -= self.answered
        while waiting and time.monotonic() < end:
            self.take()
            waiting -= self.answered
            time.sleep(0.002)
        return waiting


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("commands")
    parser.add_argument("received")
    parser.add_argument("--in-flight", type=int, default=1 << 30)
    arguments = parser.parse_args()

    with open(arguments.commands, encoding="utf-8") as file:
        commands = [command_from(fields_) for fields_ in json.load(file)]
    peer = Peer()
    peer.wait_for_node()
    peer.take_for(SETTLE_SECONDS)
    unanswered = peer.play(commands, arguments.in_flight)
    peer.take_until_quiet()
    with open(arguments.received, "w", encoding="utf-8") as file:
        json.dump({name: plain(got) for name, got in peer.received.items()}, file)
    if unanswered:
        sys.exit(f"{len(unanswered)} of {len(commands)} commands without a report")


if __name__ == "__main__":
    main()
