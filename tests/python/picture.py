"""Looks at the pictures in a bag with independent readers, and compares them with its data.

Usage: picture.py BAG_FOLDER [LIVE.json]

LIVE.json holds messages that a subscriber of `grains` and `markers` received during the run: each
must be in the bag, bit by bit. Exits with a traceback at the first thing that is wrong; prints what
was seen otherwise.
"""

import csv
import json
import sys
from pathlib import Path

import numpy
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from rosbags.rosbag2 import Reader
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

FOLDER = Path(sys.argv[1])
CUBE, LINE_LIST, SPHERE_LIST, TEXT = 1, 5, 7, 9
ADD, DELETE = 0, 2
WALLS = ["x_min", "x_max", "y_min", "y_max", "z_min", "z_max"]
# What single precision leaves of a number.
SINGLE = 3e-7


def plain(value):
    """A message as dicts and lists."""
    if fields := getattr(value, "__dataclass_fields__", None):
        names = [name for name in fields if name == name.lower() and not name.startswith("_")]
        return {name: plain(getattr(value, name)) for name in names}
    if isinstance(value, numpy.ndarray):
        return value.tolist()
    return [plain(one) for one in value] if isinstance(value, list) else value


def xyz(point):
    return [point["x"], point["y"], point["z"]]


def stamp_of(message):
    header = message["markers"][0]["header"] if "markers" in message else message["header"]
    return header["stamp"]["sec"], header["stamp"]["nanosec"]


def read():
    """Every message by topic, plain, as rosbags reads it; the types come from the bag alone."""
    store = get_typestore(Stores.EMPTY)
    told = {}
    with Reader(FOLDER) as reader:
        for connection in reader.connections:
            store.register(get_types_from_msg(connection.msgdef.data, connection.msgtype))
        for connection, _, raw in reader.messages():
            message = store.deserialize_cdr(raw, connection.msgtype)
            told.setdefault(connection.topic, []).append(plain(message))
    return told


def as_mcap_reads():
    """Sizes of the pictures as the other reader decodes them, and the pack."""
    sizes = {"/graintwin/grains": [], "/graintwin/markers": []}
    with next(FOLDER.glob("*.mcap")).open("rb") as stream:
        reader = make_reader(stream, decoder_factories=[DecoderFactory()])
        for _, channel, record, message in reader.iter_decoded_messages(topics=list(sizes)):
            size = len(message.markers) if hasattr(message, "markers") else message.width
            sizes[channel.topic].append((size, len(record.data)))
        (pack,) = [one.data for one in reader.iter_attachments() if one.name == "pack.csv"]
    return sizes, list(csv.DictReader(pack.decode().splitlines()))


def points(cloud):
    """The points of a cloud by the names of their fields."""
    kinds = {6: "<u4", 7: "<f4"}
    layout = numpy.dtype({
        "names": [field["name"] for field in cloud["fields"]],
        "formats": [kinds[field["datatype"]] for field in cloud["fields"]],
        "offsets": [field["offset"] for field in cloud["fields"]],
        "itemsize": cloud["point_step"],
    })
    assert not cloud["is_bigendian"] and cloud["height"] == 1
    data = numpy.array(cloud["data"], dtype=numpy.uint8).tobytes()
    assert len(data) == cloud["row_step"] == cloud["width"] * cloud["point_step"]
    return numpy.frombuffer(data, layout)


def check_cloud(cloud, pack, scale, state, bounds):
    assert list(cloud["id"]) == list(range(len(pack)))
    radii = numpy.array([float(row["radius"]) for row in pack])
    assert numpy.allclose(cloud["radius"], radii * scale, rtol=SINGLE)
    low, high = bounds[0::2] * scale, bounds[1::2] * scale
    for axis, name in enumerate("xyz"):
        assert (low[axis] < cloud[name]).all() and (cloud[name] < high[axis]).all(), name
    volume = numpy.prod(bounds[1::2] - bounds[0::2])
    stress = numpy.array(state["stress_contacts"]).reshape(3, 3)
    weighted = (4 / 3 * numpy.pi * radii**3 * cloud["pressure"]).sum()
    assert numpy.isclose(weighted, numpy.trace(stress) / 3 * volume, rtol=1e-5)


def check_spheres(markers, cloud, by):
    centres = {tuple(map(float, place)): k for k, place in enumerate(zip(*map(cloud.__getitem__, "xyz")))}
    assert len(centres) == len(cloud)
    spread = float(cloud["radius"].max() - cloud["radius"].min())
    bins = len(markers)
    assert bins == 1 if spread == 0 else 6 <= bins <= 16, bins
    seen, colors = [], []
    for marker in markers:
        assert marker["type"] == SPHERE_LIST and len(marker["colors"]) == len(marker["points"])
        assert len(set(xyz(marker["scale"]))) == 1
        for point, color in zip(marker["points"], marker["colors"]):
            grain = centres[tuple(xyz(point))]
            off = abs(float(cloud["radius"][grain]) - marker["scale"]["x"] / 2)
            assert off <= 0.5 * spread / bins * 1.0001 + 1e-6, (grain, off)
            seen.append(grain)
            colors.append((float(cloud[by][grain]), color["g"]))
    assert sorted(seen) == list(range(len(cloud))), "each grain once"
    # The green of viridis rises from one end to the other.
    green = [green for _, green in sorted(colors)]
    assert all(one <= other + 1e-6 for one, other in zip(green, green[1:]))
    assert green[0] < green[-1] or not cloud[by].any()


def check_chains(markers, cloud, network, scale, bounds):
    """Each line is a contact above the mean force, and each such contact a line."""
    force = numpy.array(network["normal_force"])
    mean = force.mean()
    centres = numpy.stack([cloud[name] for name in "xyz"], axis=1).astype(float)
    normals = numpy.array(network["normal"]).reshape(-1, 3)
    expected = {}
    for contact in numpy.flatnonzero(force > mean):
        first, second = network["first"][contact], network["second"][contact]
        if second < len(cloud):
            end = centres[second]
        else:
            wall = 4294967295 - second
            reach = cloud["radius"][first] - network["overlap"][contact] * scale
            end = centres[first] - reach * normals[contact]
            assert abs(end[wall // 2] - bounds[wall] * scale) < 1e-6, "on the wall"
        key = tuple(numpy.round([*centres[first], *end], 5))
        assert key not in expected
        expected[key] = force[contact]
    lines, before, widths = 0, mean, []
    for marker in markers:
        assert marker["type"] == LINE_LIST and len(marker["points"]) % 2 == 0
        widths.append(marker["scale"]["x"])
        carried = []
        for one, other in zip(marker["points"][0::2], marker["points"][1::2]):
            carried.append(expected.pop(tuple(numpy.round([*xyz(one), *xyz(other)], 5))))
        lines += len(carried)
        assert not carried or before <= min(carried), "thicker lines carry more"
        before = max([before, *carried])
    assert not expected, f"{len(expected)} contacts without a line"
    assert widths == sorted(set(widths)) and len(widths) == 4
    return lines


def check_walls(markers, bounds, scale):
    for wall, marker in enumerate(markers):
        assert marker["type"] == CUBE
        centre, sides = xyz(marker["pose"]["position"]), xyz(marker["scale"])
        inward = 1 if wall % 2 == 0 else -1
        for axis in range(3):
            low, high = bounds[2 * axis] * scale, bounds[2 * axis + 1] * scale
            faces = [centre[axis] - sides[axis] / 2, centre[axis] + sides[axis] / 2]
            if axis == wall // 2:
                inner = faces[1] if inward == 1 else faces[0]
                assert numpy.isclose(inner, bounds[wall] * scale, atol=1e-9)
            else:
                assert numpy.allclose(faces, [low, high], atol=1e-9)


def check_text(marker, name, increment, state, scale):
    assert marker["type"] == TEXT
    text = marker["text"]
    assert text.startswith(f"{name}, increment {increment},") and "\n" not in text, text
    # "confining stress 1.234 MPa": what, number, unit.
    found = {what: rest for what, *rest in (part.strip().rsplit(" ", 2) for part in text.split(","))}
    number, unit = found["confining stress"]
    factor = {"Pa": 1, "kPa": 1e3, "MPa": 1e6, "GPa": 1e9}[unit]
    assert numpy.isclose(float(number) * factor, state["confining_stress"], rtol=1e-3), text
    assert text.endswith(f"drawn {scale:g} : 1"), text


def check_frames(told):
    """Every frame that a message speaks of hangs on the root."""
    (frames,) = told["/tf_static"]
    parents = {one["child_frame_id"]: one["header"]["frame_id"] for one in frames["transforms"]}

    def root(frame):
        return root(parents[frame]) if frame in parents else frame

    used = set(parents)
    for messages in told.values():
        for message in messages:
            parts = message.get("markers") or message.get("transforms") or [message]
            used |= {part["header"]["frame_id"] for part in parts if "header" in part}
    # What is about no place, as diagnostics are, names no frame.
    used.discard("")
    assert {root(frame) for frame in used} == {"world"}, used
    assert parents["pack_view"] == "world" and parents["wall_x_min"] == "pack"
    for one in frames["transforms"]:
        if one["header"]["frame_id"] == "world":
            assert xyz(one["transform"]["translation"]) == [0, 0, 0]
    places = {one["child_frame_id"]: xyz(one["transform"]["translation"]) for one in frames["transforms"]}
    return numpy.array([places[f"wall_{wall}"][k // 2] for k, wall in enumerate(WALLS)])


def main():
    told = read()
    sizes, pack = as_mcap_reads()
    start = check_frames(told)
    about = json.load(sys.stdin)
    scale, by = about["scale"], about["color"]
    by_stamp = {
        topic: {stamp_of(message): message for message in told[f"/graintwin/{topic}"]}
        for topic in ("state", "wall_states", "contact_network", "grains", "markers")
    }
    assert set(by_stamp["grains"]) == set(by_stamp["markers"])
    inward = numpy.array([1, -1] * 3)
    names, seen = set(), []
    for stamp, array in by_stamp["markers"].items():
        state, network = by_stamp["state"][stamp], by_stamp["contact_network"][stamp]
        bounds = start + inward * numpy.array(by_stamp["wall_states"][stamp]["position"])
        cloud = points(by_stamp["grains"][stamp])
        assert by_stamp["grains"][stamp]["header"]["frame_id"] == "pack_view"
        check_cloud(cloud, pack, scale, state, bounds)
        spaces = {}
        for marker in array["markers"]:
            assert marker["header"]["frame_id"] == "pack_view"
            assert marker["pose"]["orientation"] == {"x": 0, "y": 0, "z": 0, "w": 1}
            spaces.setdefault(marker["ns"], []).append(marker)
            listed = marker["type"] in (SPHERE_LIST, LINE_LIST)
            empty = listed and not marker["points"]
            assert marker["action"] == (DELETE if empty else ADD)
        names.add(tuple((marker["ns"], marker["id"]) for marker in array["markers"]))
        for markers in spaces.values():
            assert [marker["id"] for marker in markers] == list(range(len(markers)))
        assert set(spaces) == {"spheres", "chains", "walls", "text"}
        check_spheres(spaces["spheres"], cloud, by)
        lines = check_chains(spaces["chains"], cloud, network, scale, bounds)
        check_walls(spaces["walls"], bounds, scale)
        check_text(spaces["text"][0], about["name"], state["increment"], state, scale)
        seen.append(dict(increment=state["increment"], bins=len(spaces["spheres"]), lines=lines))
    assert len(names) == 1, "each array has the same markers"
    for (topic, of_mcap) in sizes.items():
        assert len(of_mcap) == len(by_stamp[topic.rsplit("/", 1)[1]])
    live = 0
    if len(sys.argv) > 2:
        for topic, messages in json.loads(Path(sys.argv[2]).read_text()).items():
            for message in messages:
                assert message == by_stamp[topic][stamp_of(message)], (topic, stamp_of(message))
                live += 1
    bytes_ = {topic: max(size for _, size in of) for topic, of in sizes.items()}
    json.dump({"increments": seen, "live": live, "bytes": bytes_}, sys.stdout)


main()
