"""Compares what a peer received with what it should have, field by field and bit by bit.

    compare.py EXPECTED.json RECEIVED.json [--ignore FIELD]...

Both hold a list of messages for every topic. Contact networks, bonds and the like are expected
whole and come in chunks, which are put together here. Prints the first difference and exits with 1.
"""

import argparse
import json
import sys

# By topic: the most entries that a chunk may have of these columns, and all columns.
CHUNKED = {
    "contact_network": (
        {"first": 700},
        ("first", "second", "normal", "normal_force", "tangential_force", "overlap", "state"),
    ),
    "grain_motion": (
        {"carries": 450},
        ("displacement", "non_affine", "rotation", "total_rotation", "d2min", "shear_strain",
         "volumetric_strain", "carries"),
    ),
    "bonds": (
        {"first": 440},
        ("first", "second", "condition", "share", "radius", "position", "normal", "normal_force",
         "tangential_force", "torsion", "strength_use"),
    ),
    "cracks": (
        {"first": 440},
        ("first", "second", "mode", "substep", "position", "normal", "normal_force",
         "tangential_force", "torsion", "overload", "stress_before", "stress_after",
         "energy_released"),
    ),
    "rearrangements": (
        {"grains": 400, "lost_first": 1500, "made_first": 1500},
        ("grains", "displacement", "rotation", "lost_first", "lost_second", "made_first",
         "made_second"),
    ),
}


def whole(topic, chunks):
    """One message per increment, or per event of one, from its chunks."""
    messages = {}
    for chunk in chunks:
        messages.setdefault((chunk["increment"], chunk.get("event")), []).append(chunk)
    return [joined(topic, increment, parts) for (increment, _), parts in messages.items()]


def joined(topic, increment, parts):
    largest, columns = CHUNKED[topic]
    numbers = [part["chunk"] for part in parts]
    count = parts[0]["chunk_count"]
    if numbers != list(range(count)):
        sys.exit(f"{topic} of increment {increment}: chunks {numbers} of {count}")
    for part in parts:
        if part["chunk_count"] != count or part["header"] != parts[0]["header"]:
            sys.exit(f"{topic} of increment {increment}: chunks that disagree")
        for column, most in largest.items():
            if len(part[column]) > most:
                sys.exit(f"{topic} of increment {increment}: {len(part[column])} {column} in a chunk")
    message = {**parts[0], "chunk": 0, "chunk_count": 1}
    for column in columns:
        message[column] = [value for part in parts for value in part[column]]
    return message


def compare(path, expected, received, ignored):
    if isinstance(expected, dict):
        if set(expected) != set(received):
            sys.exit(f"{path}: fields {sorted(received)}, not {sorted(expected)}")
        for name in expected:
            if name not in ignored:
                compare(f"{path}.{name}", expected[name], received[name], ignored)
    elif isinstance(expected, list):
        if len(expected) != len(received):
            sys.exit(f"{path}: {len(received)} received, {len(expected)} expected")
        for index, pair in enumerate(zip(expected, received)):
            compare(f"{path}[{index}]", *pair, ignored)
    elif repr(expected) != repr(received):
        sys.exit(f"{path}: {received!r} received, {expected!r} expected")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("expected")
    parser.add_argument("received")
    parser.add_argument("--ignore", action="append", default=[])
    arguments = parser.parse_args()
    with open(arguments.expected, encoding="utf-8") as file:
        expected = json.load(file)
    with open(arguments.received, encoding="utf-8") as file:
        received = json.load(file)
    for topic in CHUNKED:
        received[topic] = whole(topic, received[topic])
    for topic in expected:
        compare(topic, expected[topic], received[topic], arguments.ignore)


if __name__ == "__main__":
    main()
