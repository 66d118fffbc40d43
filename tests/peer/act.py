"""A peer that does what a script says, and writes down what it gets.

    act.py SCRIPT.json RECEIVED.json

SCRIPT.json is {"listen": {TOPIC: TYPE}, "steps": [STEP]}, where a step is one of

    {"publish": TOPIC, "type": TYPE, "fields": {...}}
    {"wait": TOPIC, "count": N}         until N messages have come on a topic that is listened to
    {"call": SERVICE, "fields": {...}}  and wait for the response

Types are those of messages.py, topics have their full names. It starts when everything is matched.
RECEIVED.json holds a list of messages for every topic, and those of the services under "calls".
Exit code 1 when something does not come in time.
"""

import json
import os
import sys
import time
from dataclasses import fields, is_dataclass

import messages
from cyclonedds.core import Policy, Qos
from cyclonedds.domain import DomainParticipant
from cyclonedds.internal import InvalidSample
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from play import MATCH_SECONDS, SETTLE_SECONDS, plain
from services import SERVICES

WAIT_SECONDS = 60
GUID = 0x0123456789ABCDEF
LATCHED = {"/tf_static"}
# Publishers of the time are allowed to be.
BEST_EFFORT = {"/clock"}


def build(kind, values):
    """A message of the type `kind` from plain data."""
    built = {}
    for field in fields(kind):
        value = values[field.name]
        inner = field.type if isinstance(field.type, type) else None
        built[field.name] = build(inner, value) if is_dataclass(inner) else value
    return kind(**built)


def qos_of(topic):
    if topic in BEST_EFFORT:
        return Qos(Policy.Reliability.BestEffort, Policy.History.KeepLast(10))
    return messages.qos(2000, topic in LATCHED)


class Call:
    """A client of one service."""

    def __init__(self, participant, name):
        service = SERVICES[name]
        request = Topic(participant, f"rq/graintwin/{name}Request", service.request)
        response = Topic(participant, f"rr/graintwin/{name}Reply", service.response)
        self.kind = service.request
        self.writer = DataWriter(participant, request, qos=messages.qos(10))
        self.reader = DataReader(participant, response, qos=messages.qos(10))

    def ask(self, number, values):
        self.writer.write(self.kind(guid=GUID, seq=number, **values))

    def answer(self, number):
        """The response to call `number`, when it is there; another one is a mistake."""
        for response in taken(self.reader):
            assert (response.guid, response.seq) == (GUID, number), response
            return response
        return None


def taken(reader):
    return [sample for sample in reader.take(N=200) if not isinstance(sample, InvalidSample)]


class Actor:
    def __init__(self, script):
        participant = DomainParticipant(int(os.environ.get("ROS_DOMAIN_ID", "0")))
        self.steps = script["steps"]
        self.readers = {}
        for topic, kind in script["listen"].items():
            made = Topic(participant, f"rt{topic}", getattr(messages, kind))
            self.readers[topic] = DataReader(participant, made, qos=qos_of(topic))
        self.received = {topic: [] for topic in self.readers}
        self.received["calls"] = []
        self.writers, self.calls = {}, {}
        for step in self.steps:
            topic, name = step.get("publish"), step.get("call")
            if topic and topic not in self.writers:
                made = Topic(participant, f"rt{topic}", getattr(messages, step["type"]))
                self.writers[topic] = DataWriter(participant, made, qos=qos_of(topic))
            if name and name not in self.calls:
                self.calls[name] = Call(participant, name)

    def until(self, what, ready, seconds=WAIT_SECONDS):
        end = time.monotonic() + seconds
        while not ready():
            if time.monotonic() > end:
                sys.exit(f"waited in vain until {what}")
            time.sleep(0.005)

    def matched(self):
        readers = [*self.readers.values(), *(call.reader for call in self.calls.values())]
        writers = [*self.writers.values(), *(call.writer for call in self.calls.values())]
        return all(one.get_matched_publications() for one in readers) and all(
            one.get_matched_subscriptions() for one in writers
        )

    def take(self):
        for topic, reader in self.readers.items():
            self.received[topic] += taken(reader)

    def has(self, topic, count):
        self.take()
        return len(self.received[topic]) >= count

    def act(self):
        self.until("everything is matched", self.matched, MATCH_SECONDS)
        time.sleep(SETTLE_SECONDS)
        for number, step in enumerate(self.steps):
            if topic := step.get("publish"):
                message = build(getattr(messages, step["type"]), step["fields"])
                self.writers[topic].write(message)
            elif topic := step.get("wait"):
                self.until(f"{topic} has come", lambda: self.has(topic, step["count"]))
            else:
                self.call(number, step)

    def call(self, number, step):
        call = self.calls[step["call"]]
        call.ask(number, step["fields"])
        answers = []

        def answered():
            answers.extend(filter(None, [call.answer(number)]))
            return answers

        self.until(f"{step['call']} answers", answered)
        self.received["calls"] += answers


def main():
    with open(sys.argv[1], encoding="utf-8") as file:
        actor = Actor(json.load(file))
    actor.act()
    with open(sys.argv[2], "w", encoding="utf-8") as file:
        json.dump({name: plain(got) for name, got in actor.received.items()}, file)


if __name__ == "__main__":
    main()
