"""Reads a bag of several files with two independent readers.

Usage: split.py BAG_FOLDER

Prints {"messages": [[topic, log_time, sha256 of the bytes], ...], "files": [what each holds, ...]}
as rosbags finds them by metadata.yaml, after checking that mcap finds the same in the files alone.
"""

import hashlib
import json
import sys
from pathlib import Path

from mcap.reader import make_reader
from rosbags.rosbag2 import Reader
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from ruamel.yaml import YAML

FOLDER = Path(sys.argv[1])


def digest(data):
    return hashlib.sha256(bytes(data)).hexdigest()


def with_rosbags():
    store = get_typestore(Stores.EMPTY)
    with Reader(FOLDER) as reader:
        for connection in reader.connections:
            store.register(get_types_from_msg(connection.msgdef.data, connection.msgtype))
        messages = []
        for connection, time, raw in reader.messages():
            store.deserialize_cdr(raw, connection.msgtype)
            messages.append([connection.topic, time, digest(raw)])
        assert reader.message_count == len(messages), (reader.message_count, len(messages))
        if messages:
            assert reader.start_time == messages[0][1]
            assert reader.duration == messages[-1][1] - messages[0][1] + 1
        counts = {}
        for connection in reader.connections:
            counts[connection.topic] = counts.get(connection.topic, 0) + connection.msgcount
        for topic, count in counts.items():
            assert count == sum(one[0] == topic for one in messages), topic
    return messages


def with_mcap(path):
    with path.open("rb") as stream:
        reader = make_reader(stream)
        messages, channels = [], {}
        for schema, channel, message in reader.iter_messages(log_time_order=False):
            assert schema.encoding == "ros2msg" and schema.data
            assert "offered_qos_profiles" in channel.metadata
            messages.append([channel.topic, message.log_time, digest(message.data)])
            channels[channel.topic] = channel.metadata
        metadata = {one.name: one.metadata for one in reader.iter_metadata()}
        summary = reader.get_summary()
        assert summary.statistics.message_count == len(messages)
        for index in summary.chunk_indexes:
            assert index.message_index_length > 0, "a chunk without a message"
        inside = YAML(typ="safe").load(metadata["rosbag2"]["serialized_metadata"])
        assert inside["relative_file_paths"] == [path.name], inside
        assert inside["message_count"] == len(messages)
        return {
            "name": path.name,
            "messages": messages,
            "attachments": sorted(one.name for one in reader.iter_attachments()),
            "metadata": {name: texts for name, texts in metadata.items() if name != "rosbag2"},
        }


def main():
    messages = with_rosbags()
    outside = YAML(typ="safe").load((FOLDER / "metadata.yaml").read_text())
    told = outside["rosbag2_bagfile_information"]
    files = [with_mcap(FOLDER / name) for name in told["relative_file_paths"]]
    assert sum((file["messages"] for file in files), []) == messages
    assert len(list(FOLDER.glob("*.mcap"))) == len(files)
    for file, about in zip(files, told["files"], strict=True):
        assert about["path"] == file["name"]
        assert about["message_count"] == len(file["messages"])
        times = [time for _, time, _ in file["messages"]]
        assert about["starting_time"]["nanoseconds_since_epoch"] == times[0]
        assert about["duration"]["nanoseconds"] == times[-1] - times[0]
        file["messages"] = len(times)
    json.dump({"messages": messages, "files": files}, sys.stdout)


main()
