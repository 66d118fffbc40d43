"""A viewer of the Foxglove WebSocket protocol, written after its specification.

Usage: live.py ADDRESS LAST_SEQUENCE TOPIC...

Prints `waits`, connects as soon as somebody listens at ADDRESS (host:port) and subscribes to the topics,
among them `/graintwin/report`. Prints `looks` when it knows how the twin is, and `seen` when the report of
command LAST_SEQUENCE and the measures of its increment are there. Then reads the folder of the recording
of the same run from standard input, compares every message that came with it, bit by bit, has a second
viewer come late, and prints what was seen as JSON. Without a folder it ends there.
"""

import json
import struct
import sys
import time
from contextlib import ExitStack
from pathlib import Path

from mcap.reader import make_reader
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect
from websockets.typing import Subprotocol

ADDRESS, LAST = sys.argv[1], int(sys.argv[2])
TOPICS = sys.argv[3:]
REPORT = "/graintwin/report"
PROTOCOL = Subprotocol("foxglove.sdk.v1")
# Say how the twin is: whoever comes gets the last.
STATE = ["/tf_static", "/graintwin/state", "/graintwin/wall_forces", "/graintwin/moduli"]
# Only a viewer that hangs takes that long.
PATIENCE = 120.0
# Connections; they are closed at the end.
OPEN = ExitStack()


class Viewer:
    """One connection: what was offered, and what came by topic."""

    def __init__(self, topics):
        until = time.monotonic() + PATIENCE
        while True:
            try:
                asked = connect(f"ws://{ADDRESS}", subprotocols=[PROTOCOL], max_size=None)
                self.socket = OPEN.enter_context(asked)
                break
            except OSError:
                assert time.monotonic() < until, f"nobody listens at {ADDRESS}"
                time.sleep(0.05)
        assert self.socket.subprotocol == PROTOCOL
        self.info = json.loads(self.socket.recv(PATIENCE))
        assert self.info["op"] == "serverInfo", self.info
        self.offered = {}
        while not set(topics) <= set(self.offered):
            told = json.loads(self.socket.recv(PATIENCE))
            assert told["op"] == "advertise", told
            self.offered |= {channel["topic"]: channel for channel in told["channels"]}
        self.names = dict(enumerate(topics, 1))
        wanted = [
            {"id": key, "channelId": self.offered[name]["id"]} for key, name in self.names.items()
        ]
        self.socket.send(json.dumps({"op": "subscribe", "subscriptions": wanted}))
        self.store = get_typestore(Stores.EMPTY)
        for name in topics:
            channel = self.offered[name]
            assert (channel["encoding"], channel["schemaEncoding"]) == ("cdr", "ros2msg"), channel
            self.store.register(get_types_from_msg(channel["schema"], channel["schemaName"]))
        self.came = {name: [] for name in topics}
        self.times = []

    def take(self):
        """Waits for one message; returns its topic and what it says."""
        said = self.socket.recv(PATIENCE)
        assert isinstance(said, bytes), said
        kind, subscription, log_time = struct.unpack_from("<BIQ", said)
        assert kind == 1, kind
        name, payload = self.names[subscription], said[13:]
        self.came[name].append(payload)
        self.times.append(log_time)
        return name, self.read(name, payload)

    def read(self, name, payload):
        return self.store.deserialize_cdr(payload, self.offered[name]["schemaName"])

    def until(self, done):
        while not done():
            self.take()

    def last(self, name):
        return self.came[name][-1] if self.came[name] else None


def recorded(folder):
    """The messages of a recording by topic, and the texts of their types."""
    messages, texts = {}, {}
    for file in sorted(Path(folder).glob("*.mcap")):
        with file.open("rb") as stream:
            for schema, channel, message in make_reader(stream).iter_messages():
                messages.setdefault(channel.topic, []).append(bytes(message.data))
                texts[channel.topic] = schema.data.decode()
    return messages, texts


def increments(viewer, name):
    return [viewer.read(name, payload).increment for payload in viewer.came[name]]


def seen_all(viewer):
    """Whether everything up to the last command has come."""
    reports = [viewer.read(REPORT, payload) for payload in viewer.came[REPORT]]
    last = [report for report in reports if report.sequence == LAST]
    if not last:
        return False
    measured = [name for name in TOPICS if name.startswith("/graintwin/") and name != REPORT]
    return all(viewer.came[name] for name in measured)


print("waits", flush=True)
viewer = Viewer(TOPICS)
viewer.until(lambda: all(viewer.came[name] for name in TOPICS if name in STATE))
print("looks", flush=True)
viewer.until(lambda: seen_all(viewer))
print("seen", flush=True)
folder = sys.stdin.readline().strip()

told = {"name": viewer.info["name"], "capabilities": viewer.info["capabilities"]}
told["increments"] = {
    name: increments(viewer, name)
    for name in TOPICS
    if name.startswith("/graintwin/") and "markers" not in name and "grains" not in name
}
told["counts"] = {name: len(came) for name, came in viewer.came.items()}
told["offered"] = sorted(viewer.offered)
assert viewer.times == sorted(viewer.times)
state = viewer.read("/graintwin/state", viewer.last("/graintwin/state"))
told["strain"] = [float(one) for one in state.strain]
frames = viewer.read("/tf_static", viewer.last("/tf_static")).transforms
told["frames"] = sorted((one.header.frame_id, one.child_frame_id) for one in frames)

late = Viewer([name for name in TOPICS if name in STATE]) if folder else None
if late:
    late.until(lambda: all(late.came.values()))
    told["late"] = all(late.last(name) == viewer.last(name) for name in late.came)
    late.socket.close()
    # The recording is whole when the run has ended.
    print("done", flush=True)
    sys.stdin.readline()
    messages, texts = recorded(folder)
    for name, came in viewer.came.items():
        assert viewer.offered[name]["schema"] == texts[name], name
        for payload in came:
            assert payload in messages[name], f"{name}: not what is recorded"
        if name != REPORT:
            assert came[-1] == messages[name][-1], f"{name}: not the last"
    told["compared"] = sum(told["counts"].values())
try:
    while True:
        viewer.take()
except ConnectionClosed:
    told["closed"] = True
print(json.dumps(told), flush=True)
OPEN.close()
