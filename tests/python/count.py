"""Counts the messages that rosbags reads from a bag: count.py BAG_FOLDER"""

import sys
from pathlib import Path

from rosbags.rosbag2 import Reader
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

store = get_typestore(Stores.EMPTY)
with Reader(Path(sys.argv[1])) as reader:
    for connection in reader.connections:
        store.register(get_types_from_msg(connection.msgdef.data, connection.msgtype))
    count = 0
    for connection, _, raw in reader.messages():
        store.deserialize_cdr(raw, connection.msgtype)
        count += 1
    assert count == reader.message_count, (count, reader.message_count)
print(count)
