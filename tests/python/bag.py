"""Reads a bag with two independent readers and compares every field with what was to be recorded.

Usage: bag.py BAG_FOLDER MSG_FOLDER < [[{"topic": ..., "fields": {...}}, ...] per answer]

Floats that JSON has no number for come as the strings "NaN" and "Infinity". Exits with a traceback
at the first difference; prints a summary otherwise.
"""

import json
import math
import sys
from pathlib import Path

from mcap.reader import make_reader
from mcap.stream_reader import StreamReader
from mcap_ros2.decoder import DecoderFactory
from rosbags.rosbag2 import Reader
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from ruamel.yaml import YAML

FOLDER, MSG_FOLDER = Path(sys.argv[1]), Path(sys.argv[2])
EXPECTED = [message for answer in json.load(sys.stdin) for message in answer]
FILE = FOLDER / f"{FOLDER.name}_0.mcap"


def same(found, expected):
    """Equality, NaN being equal to itself, vectors to lists, and times to lists."""
    if isinstance(expected, str) and expected in ("NaN", "Infinity"):
        expected = float(expected)
    if isinstance(expected, list):
        if hasattr(found, "x"):
            found = [found.x, found.y, found.z]
        return len(found) == len(expected) and all(map(same, found, expected))
    if isinstance(expected, dict):
        return all(same(getattr(found, name), value) for name, value in expected.items())
    if isinstance(expected, float) and math.isnan(expected):
        return math.isnan(found)
    return found == expected


def fields_of(message):
    """Names of the fields; constants, which are upper case, are none."""
    names = getattr(message, "__dataclass_fields__", None) or message.__slots__
    return {name for name in names if name == name.lower() and not name.startswith("_")}


def stamp_of(message):
    """When the message is of: its own stamp, or that of the first of its frames."""
    if hasattr(message, "stamp"):
        return message.stamp
    return (message if hasattr(message, "header") else message.transforms[0]).header.stamp


def compare(where, topic, message, expected):
    assert topic == expected["topic"], (where, topic, expected["topic"])
    fields = fields_of(message)
    assert fields and fields <= set(expected["fields"]), (where, topic, fields)
    for name in fields:
        value = getattr(message, name)
        assert same(value, expected["fields"][name]), (where, topic, name, value)


def with_mcap():
    """mcap and mcap-ros2-support: order, times, fields; and the layout rosbag2 needs."""
    with FILE.open("rb") as stream:
        reader = make_reader(stream, decoder_factories=[DecoderFactory()])
        last = 0
        messages = list(reader.iter_decoded_messages(log_time_order=False))
        assert len(messages) == len(EXPECTED), (len(messages), len(EXPECTED))
        for number, (expected, (schema, channel, record, message)) in enumerate(
            zip(EXPECTED, messages)
        ):
            assert schema.encoding == "ros2msg" and channel.message_encoding == "cdr"
            compare(f"mcap message {number}", channel.topic, message, expected)
            assert record.log_time > last, (number, record.log_time, last)
            last = record.log_time
            assert record.sequence == 0
            stamp = stamp_of(message)
            assert record.publish_time == max(0, stamp.sec * 10**9 + stamp.nanosec)
        assert reader.get_header().profile == "ros2"
        summary = reader.get_summary()
        for index in summary.chunk_indexes:
            assert index.message_index_length > 0, "a chunk without a message"
        attachments = {one.name: one.data for one in reader.iter_attachments()}
        metadata = {one.name: one.metadata for one in reader.iter_metadata()}
        return attachments, metadata, summary


def record_kinds():
    """The file's records in order: attachments, metadata, chunks, what is in the first chunk."""
    with FILE.open("rb") as stream:
        kinds = [type(one).__name__ for one in StreamReader(stream, emit_chunks=True).records]
    return kinds


def with_rosbags():
    """rosbags: types from the bag alone, bytes again, hashes, counts; types from MSG_FOLDER."""
    texts = get_typestore(Stores.ROS2_JAZZY)
    for path in sorted(MSG_FOLDER.glob("*.msg")):
        texts.register(get_types_from_msg(path.read_text(), f"graintwin_msgs/msg/{path.stem}"))
    alone = get_typestore(Stores.EMPTY)
    with Reader(FOLDER) as reader:
        for connection in reader.connections:
            alone.register(get_types_from_msg(connection.msgdef.data, connection.msgtype))
        for connection in reader.connections:
            assert connection.digest == texts.hash_rihs01(connection.msgtype), connection.topic
            assert alone.hash_rihs01(connection.msgtype) == connection.digest, connection.topic
            assert connection.ext.serialization_format == "cdr"
            (qos,) = connection.ext.offered_qos_profiles
            latched = connection.topic in (
                "/graintwin/moduli", "/graintwin/tangent", "/rosout", "/tf_static")
            assert qos.durability.name == ("TRANSIENT_LOCAL" if latched else "VOLATILE"), qos
            assert qos.reliability.name == "RELIABLE" and qos.history.name == "KEEP_LAST", qos
            assert qos.depth > 0, qos
        times = []
        for number, (connection, time, raw) in enumerate(reader.messages()):
            message = alone.deserialize_cdr(raw, connection.msgtype)
            compare(f"rosbags message {number}", connection.topic, message, EXPECTED[number])
            again = alone.serialize_cdr(message, connection.msgtype)
            assert bytes(again) == bytes(raw), (number, connection.topic)
            times.append(time)
        assert len(times) == len(EXPECTED) == reader.message_count
        if times:
            assert reader.start_time == times[0], (reader.start_time, times[0])
            assert reader.duration == times[-1] - times[0] + 1, (reader.duration, times)
        counts = {one.topic: one.msgcount for one in reader.connections}
        for topic, count in counts.items():
            assert count == sum(one["topic"] == topic for one in EXPECTED), topic


def main():
    with_rosbags()
    attachments, metadata, summary = with_mcap()
    outside = YAML(typ="safe").load((FOLDER / "metadata.yaml").read_text())
    inside = YAML(typ="safe").load(metadata["rosbag2"]["serialized_metadata"])
    assert outside == {"rosbag2_bagfile_information": inside}, (outside, inside)
    assert inside["version"] == 9 and inside["storage_identifier"] == "mcap"
    json.dump(
        {
            "kinds": record_kinds(),
            "compressions": sorted({one.compression for one in summary.chunk_indexes}),
            "attachments": {name: data.decode() for name, data in attachments.items()},
            "program": metadata["graintwin"],
            "topics": sorted(one.topic for one in summary.channels.values()),
        },
        sys.stdout,
    )


main()
