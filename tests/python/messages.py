"""Serialises messages independently of graintwin.

Usage: messages.py MSG_FOLDER < [{"type": ..., "value": {...}, "definition": ...}]

The definitions of graintwin_msgs are read from MSG_FOLDER, the standard ones are those that come
with rosbags. Prints for each message its bytes in both byte orders and its type's hash, and
whether the definition in the input means the same fields.
"""

import json
import sys
from pathlib import Path

import numpy
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from rosbags.typesys.base import TypesysError

NUMPY = {
    "float64": numpy.float64,
    "uint32": numpy.uint32,
    "uint8": numpy.uint8,
    "bool": numpy.bool_,
}


def build(store, name, value):
    """A message of type `name` from plain data; every field must be there, and no other."""
    fields = store.fielddefs[name][1]
    assert {field for field, _ in fields} == set(value), (name, list(value))
    built = {}
    for field, (kind, detail) in fields:
        built[field] = element(store, kind.name, detail, value[field])
    return store.types[name](**built)


def element(store, kind, detail, value):
    if kind == "BASE":
        return value
    if kind == "NAME":
        return build(store, detail, value)
    (inner, inner_detail), _ = detail
    if inner.name == "BASE" and inner_detail[0] in NUMPY:
        return numpy.array(value, dtype=NUMPY[inner_detail[0]])
    return [element(store, inner.name, inner_detail, one) for one in value]


def same_fields(store, name, definition):
    """Whether `definition` alone, without any store, has the fields and hash of `name`."""
    try:
        alone = get_typestore(Stores.EMPTY)
        alone.register(get_types_from_msg(definition, name))
        return alone.hash_rihs01(name) == store.hash_rihs01(name)
    except (KeyError, TypesysError):
        return False


def main():
    store = get_typestore(Stores.ROS2_JAZZY)
    for path in sorted(Path(sys.argv[1]).glob("*.msg")):
        store.register(get_types_from_msg(path.read_text(), f"graintwin_msgs/msg/{path.stem}"))
    answers = []
    for asked in json.load(sys.stdin):
        name = asked["type"]
        message = build(store, name, asked["value"])
        answers.append({
            "type": name,
            "little": bytes(store.serialize_cdr(message, name, little_endian=True)).hex(),
            "big": bytes(store.serialize_cdr(message, name, little_endian=False)).hex(),
            "hash": store.hash_rihs01(name),
            "same_fields": same_fields(store, name, asked["definition"]),
        })
    json.dump(answers, sys.stdout)


main()
