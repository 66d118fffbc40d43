"""Computes the statistics of force networks anew from the networks themselves.

Usage: fabric.py BAG_FOLDER FRICTION

Reads `/graintwin/contact_network`, `/graintwin/state` and the pack of a recording, and compares what they
give with `/graintwin/fabric`, increment by increment: chains by a search of the graph, directions and
forces against angle by sums over the contacts. Prints a summary; exits with a traceback at the first
difference. Grains further than the walls are not looked at: `interior_coordination` needs positions.
"""

import json
import math
import sys
from pathlib import Path

from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory

FOLDER, FRICTION = Path(sys.argv[1]), float(sys.argv[2])
FIRST_WALL = 2**32 - 6


def near(name, found, expected, scale=None):
    """Equal but for rounding, numbers or sequences of them; NaN is equal to NaN."""
    if hasattr(found, "__len__"):
        assert len(found) == len(expected), (name, found, expected)
        scale = scale or max((abs(x) for x in expected if not math.isnan(x)), default=1.0)
        for pair in zip(found, expected):
            near(name, *pair, scale)
    elif math.isnan(expected):
        assert math.isnan(found), (name, found)
    else:
        assert abs(found - expected) <= 1e-11 * (scale or abs(expected)), (name, found, expected)


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


class Contact:
    def __init__(self, network, k, radii):
        wall = 2**32 - 1 - network.second[k]
        self.wall = wall if wall < 6 else None
        self.ends = [network.first[k]] + ([] if wall < 6 else [network.second[k]])
        self.normal = list(network.normal[3 * k : 3 * k + 3])
        self.force = network.normal_force[k]
        self.shear = list(network.tangential_force[3 * k : 3 * k + 3])
        self.size = math.sqrt(dot(self.shear, self.shear))
        self.length = sum(radii[grain] for grain in self.ends) - network.overlap[k]


def parts(contacts):
    """The connected parts of the grains, each with the walls it touches, by a depth-first search."""
    neighbours, walls = {}, {}
    for contact in contacts:
        for end in contact.ends:
            neighbours.setdefault(end, set()).update(contact.ends)
        if contact.wall is not None:
            walls.setdefault(contact.ends[0], set()).add(contact.wall)
    left = set(neighbours)
    while left:
        part, stack = set(), [left.pop()]
        while stack:
            grain = stack.pop()
            part.add(grain)
            stack.extend(neighbours[grain] - part)
        left -= part
        yield part, set().union(*(walls.get(grain, set()) for grain in part))


def spans(contacts):
    found = [walls for _, walls in parts(contacts)]
    return [any({2 * axis, 2 * axis + 1} <= walls for walls in found) for axis in range(3)]


def strongest(contacts, axis):
    """The largest force that leaves the walls connected, by bisection."""
    forces = sorted({contact.force for contact in contacts})
    if not spans(contacts)[axis]:
        return 0.0
    low, high = 0, len(forces)
    while high - low > 1:
        middle = (low + high) // 2
        if spans([one for one in contacts if one.force >= forces[middle]])[axis]:
            low = middle
        else:
            high = middle
    return forces[low]


def histogram(values, width, bins):
    counts = [0] * bins
    for value in values:
        counts[min(int(value / width), bins - 1)] += 1
    return counts


def check_chains(told, contacts):
    total = sum(contact.force for contact in contacts)
    forces = sorted((contact.force for contact in contacts), reverse=True)
    threshold = forces[max(1, round(told.chain_share * len(forces))) - 1]
    assert told.chain_threshold == threshold
    members = [contact for contact in contacts if contact.force >= threshold]
    sizes = [len(part) for part, _ in parts(members)]
    expected = [len(members), sum(sizes), len(sizes), max(sizes)]
    assert [told.chain_contacts, told.chain_grains, told.chains, told.largest_chain] == expected
    near("load", told.chain_load, sum(contact.force for contact in members) / total)
    assert list(told.chain_spans) == spans(members), told.chain_spans
    assert list(told.strongest_path) == [strongest(contacts, axis) for axis in range(3)]
    return threshold


def check_directions(told, inner, threshold):
    load = sum(contact.force for contact in inner)
    pairs = [(i, j) for i in range(3) for j in range(3)]
    fabric = [sum(one.normal[i] * one.normal[j] for one in inner) / len(inner) for i, j in pairs]
    forces = [sum(one.force * one.normal[i] * one.normal[j] for one in inner) / load for i, j in pairs]
    shears = [sum(one.shear[i] * one.normal[j] for one in inner) / load for i, j in pairs]
    near("fabric", told.fabric, fabric)
    near("force_fabric", told.force_fabric, forces)
    near("shear_fabric", told.shear_fabric, shears, 1.0)
    for found, of in (
        (told.contact_anisotropy, [7.5 * x for x in fabric]),
        (told.normal_anisotropy, [7.5 * (x - y) for x, y in zip(forces, fabric)]),
        (told.tangential_anisotropy, [5.0 * x for x in shears]),
    ):
        near("anisotropy", found, of[8] - 0.5 * (of[0] + of[4]), 1.0)
    largest = [one for one in inner if one.force >= threshold]
    for found, of in ((told.cone_all, inner), (told.cone_largest, largest)):
        for axis in range(3):
            inside = sum(math.degrees(math.acos(min(1.0, abs(one.normal[axis])))) <= 45 for one in of)
            near("cone", found[axis], inside / len(of))


def solve(rows, values):
    """Two equations with two unknowns."""
    (a, b), (c, d) = rows
    return [(values[0] * d - b * values[1]) / (a * d - b * c), (a * values[1] - values[0] * c) / (a * d - b * c)]


def check_angle(told, contacts, inner, stress):
    bins = len(told.angle_count)
    members = [[] for _ in range(bins)]
    for one in inner:
        cosine = abs(one.normal[2])
        sine = math.sqrt(1 - cosine**2)
        # The axis' projection on the contact plane, on the side of the normal.
        towards = [-one.normal[i] * one.normal[2] for i in range(3)]
        towards[2] += 1
        sign = math.copysign(1.0, one.normal[2])
        along = sign * dot(one.shear, towards) / math.sqrt(dot(towards, towards))
        one.form = (sine**2, cosine**2, sine * cosine, along)
        members[min(int(cosine * bins), bins - 1)].append(one)
    assert list(told.angle_count) == [len(of) for of in members]
    mean = lambda of, value: sum(map(value, of)) / len(of) if of else math.nan
    near("P", told.angle_normal, [mean(of, lambda one: one.force) for of in members])
    near("|Q|", told.angle_tangential, [mean(of, lambda one: one.size) for of in members])
    scale = max(one.size for one in inner) or 1.0
    near("Q", told.angle_shear, [mean(of, lambda one: one.form[3]) for of in members], scale)
    sums = lambda a, b: sum(one.form[a] * one.form[b] for one in inner)
    lateral, axial = solve(
        [[sums(0, 0), sums(0, 1)], [sums(0, 1), sums(1, 1)]],
        [sum(one.force * one.form[k] for one in inner) for k in (0, 1)],
    )
    near("fitted", told.angle_fitted, [lateral, axial, sums(2, 3) / sums(2, 2)], axial)
    mean_force = sum(one.force * one.length for one in contacts) / sum(one.length for one in contacts)
    pressure = (stress[0] + stress[4] + stress[8]) / 3
    lateral, axial = (mean_force * of / pressure for of in (0.5 * (stress[0] + stress[4]), stress[8]))
    near("predicted", told.angle_predicted, [lateral, axial, axial - lateral], axial)


def check(told, network, state, radii):
    contacts = [Contact(network, k, radii) for k in range(len(network.first))]
    inner = [contact for contact in contacts if contact.wall is None]
    assert [told.contacts, told.grain_contacts] == [len(contacts), len(inner)]
    mean = sum(contact.force for contact in contacts) / len(contacts)
    near("mean P", told.mean_normal_force, mean)
    near("mean Q", told.mean_tangential_force, sum(one.size for one in contacts) / len(contacts))
    forces = [contact.force / mean for contact in contacts]
    assert list(told.force_histogram) == histogram(forces, 0.25, 50)
    used = [one.size / (FRICTION * one.force) for one in contacts] if FRICTION else []
    assert list(told.mobilised_histogram) == (histogram(used, 0.05, 20) if FRICTION else [])
    numbers = [0] * len(radii)
    for contact in contacts:
        for end in contact.ends:
            numbers[end] += 1
    assert list(told.coordination) == histogram(numbers, 1, max(numbers) + 1)
    check_directions(told, inner, check_chains(told, contacts))
    check_angle(told, contacts, inner, state.stress_contacts)
    return len(contacts)


def main():
    messages, pack = {}, None
    for file in sorted(FOLDER.glob("*.mcap")):
        with file.open("rb") as stream:
            reader = make_reader(stream, decoder_factories=[DecoderFactory()])
            for _, channel, _, message in reader.iter_decoded_messages():
                name = channel.topic.removeprefix("/graintwin/")
                if name in ("fabric", "contact_network", "state"):
                    messages.setdefault(name, {})[message.increment] = message
            pack = pack or next((a.data for a in reader.iter_attachments() if a.name == "pack.csv"), None)
    lines = pack.decode().splitlines()
    column = lines[0].split(",").index("radius")
    radii = [float(line.split(",")[column]) for line in lines[1:]]
    assert set(messages["fabric"]) == set(messages["contact_network"])
    contacts = [
        check(told, messages["contact_network"][at], messages["state"][at], radii)
        for at, told in sorted(messages["fabric"].items())
    ]
    print(json.dumps({"increments": len(contacts), "contacts": contacts[-1]}))


main()
