"""A rig that does what it is told, line by line, for as long as it is asked.

    rig.py TOPIC...

It listens to these topics of the node, and says {} when everything is matched. Then every line of
its input is one request in JSON, answered by one line:

    {"send": [[SESSION, SEQUENCE, MODE, [DISPLACEMENT, ... 6]], ...], "period": SECONDS}
        publishes the commands, stamped with the present time, one a period: {}
    {"wait": TOPIC, "count": N}
        until N messages in all have come on the topic: {"come": COUNT}, after a minute in any case
    {"told": TOPIC}
        the messages since the last time: {"messages": [...]}
    {"call": SERVICE, "fields": {...}}
        {"answer": {...}}

It ends with its input. The domain is that of ROS_DOMAIN_ID.
"""

import json
import os
import sys
import time

from cyclonedds.domain import DomainParticipant
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic

from act import Call, taken
from messages import OUT, PICTURES, BoundaryCommand, Header, Time, dds_name, qos
from play import MATCH_SECONDS, SETTLE_SECONDS, plain

WAIT_SECONDS = 60


def now():
    nanoseconds = time.time_ns()
    return Time(nanoseconds // 10**9, nanoseconds % 10**9)


class Rig:
    def __init__(self, topics):
        self.participant = DomainParticipant(int(os.environ.get("ROS_DOMAIN_ID", "0")))
        topic = Topic(self.participant, dds_name("boundary_command"), BoundaryCommand)
        self.writer = DataWriter(self.participant, topic, qos=qos(20000))
        self.readers = {}
        for name in topics:
            out = {**OUT, **PICTURES}[name]
            made = Topic(self.participant, dds_name(name), out.kind)
            reader = DataReader(self.participant, made, qos=qos(out.depth, out.latched))
            self.readers[name] = reader
        self.calls = {}
        self.new = {name: [] for name in topics}
        self.come = {name: 0 for name in topics}

    def match(self):
        end = time.monotonic() + MATCH_SECONDS
        while not (
            self.writer.get_matched_subscriptions()
            and all(reader.get_matched_publications() for reader in self.readers.values())
        ):
            if time.monotonic() > end:
                sys.exit(f"not matched within {MATCH_SECONDS} s")
            time.sleep(0.02)
        time.sleep(SETTLE_SECONDS)

    def take(self):
        for name, reader in self.readers.items():
            while samples := taken(reader):
                self.new[name] += samples
                self.come[name] += len(samples)

    def send(self, commands, period):
        due = time.monotonic()
        for session, sequence, mode, displacement in commands:
            header = Header(now(), "")
            self.writer.write(BoundaryCommand(header, session, sequence, mode, displacement))
            if period == 0:
                continue
            due += period
            while (left := due - time.monotonic()) > 0:
                self.take()
                time.sleep(min(left, period / 4))
        return {}

    def wait(self, topic, count):
        end = time.monotonic() + WAIT_SECONDS
        while self.come[topic] < count and time.monotonic() < end:
            self.take()
            time.sleep(0.002)
        return {"come": self.come[topic]}

    def told(self, topic):
        self.take()
        messages, self.new[topic] = self.new[topic], []
        return {"messages": [plain(message) for message in messages]}

    def call(self, name, fields):
        if name not in self.calls:
            self.calls[name] = Call(self.participant, name)
        call = self.calls[name]
        end = time.monotonic() + WAIT_SECONDS
        while not (
            call.writer.get_matched_subscriptions() and call.reader.get_matched_publications()
        ):
            if time.monotonic() > end:
                sys.exit(f"no service {name} within {WAIT_SECONDS} s")
            time.sleep(0.02)
        time.sleep(SETTLE_SECONDS)
        number = time.monotonic_ns()
        call.ask(number, fields)
        while (answer := call.answer(number)) is None:
            if time.monotonic() > end:
                sys.exit(f"no answer of {name} within {WAIT_SECONDS} s")
            time.sleep(0.01)
        return {"answer": plain(answer)}

    def do(self, asked):
        if "send" in asked:
            return self.send(asked["send"], asked["period"])
        if "wait" in asked:
            return self.wait(asked["wait"], asked["count"])
        if "told" in asked:
            return self.told(asked["told"])
        return self.call(asked["call"], asked["fields"])


def say(answer):
    print(json.dumps(answer), flush=True)


def main():
    rig = Rig(sys.argv[1:])
    rig.match()
    say({})
    for line in sys.stdin:
        say(rig.do(json.loads(line)))


if __name__ == "__main__":
    main()
