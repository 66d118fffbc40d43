"""Computes the motion of the grains in a bag with numpy, from the pack, the walls and the displacements
alone, every pair of grains looked at, and compares it with what the bag says of it.

Usage: motion.py BAG_FOLDER

Exits with a traceback at the first thing that is wrong; prints what was compared otherwise.
"""

import csv
import io
import json
import sys
from pathlib import Path

import numpy as np
from mcap.reader import make_reader
from rosbags.rosbag2 import Reader
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

FOLDER = Path(sys.argv[1])


def messages(topics):
    """Messages of the topics by increment."""
    store = get_typestore(Stores.EMPTY)
    told = {topic: {} for topic in topics}
    with Reader(FOLDER) as reader:
        for connection in reader.connections:
            store.register(get_types_from_msg(connection.msgdef.data, connection.msgtype))
        wanted = [one for one in reader.connections if one.topic in told]
        for connection, _, raw in reader.messages(connections=wanted):
            message = store.deserialize_cdr(raw, connection.msgtype)
            told[connection.topic][message.increment] = message
    return told


def pack():
    """Positions, radii and the box at the start."""
    with open(next(FOLDER.glob("*.mcap")), "rb") as file:
        found = {one.name: one.data for one in make_reader(file).iter_attachments()}
    rows = list(csv.DictReader(io.StringIO(found["pack.csv"].decode())))
    position = np.array([[float(row[axis]) for axis in "xyz"] for row in rows])
    radius = np.array([float(row["radius"]) for row in rows])
    box = json.loads(found["pack.json"])["box"]
    return position, radius, np.array(box["min"]), np.array(box["max"])


def local(position, moved, radius, carries, i):
    """D2min, shear strain and loss of volume about grain i; nothing with too few neighbours."""
    branch = position - position[i]
    near = carries & (np.linalg.norm(branch, axis=1) < radius + radius[i] + radius.mean())
    near[i] = False
    if near.sum() < 4:
        return None
    solved, *_ = np.linalg.lstsq(branch[near], (moved - moved[i])[near], rcond=None)
    left = (moved - moved[i])[near] - branch[near] @ solved
    gradient = np.eye(3) + solved.T
    # E = (F'F - 1)/2, with small strains kept apart from 1.
    strain = (solved + solved.T + solved @ solved.T) / 2
    deviator = strain - np.eye(3) * np.trace(strain) / 3
    return (left**2).sum() / near.sum(), np.sqrt((deviator**2).sum() / 2), 1 - np.linalg.det(gradient)


def band(position, shear, carries):
    known = carries & np.isfinite(shear)
    place, shear = position[known], shear[known]
    most = place[np.argsort(-shear, kind="stable")[: int(np.ceil(0.1 * len(shear)))]]
    sheared, everyone = (np.cov(points.T, bias=True) for points in (most, place))
    ratio, vectors = np.linalg.eig(np.linalg.solve(everyone, sheared))
    order = np.argsort(ratio.real)
    normal = vectors[:, order[0]].real
    normal /= np.linalg.norm(normal)
    normal *= np.sign(normal[np.argmax(abs(normal))])
    thickness = np.sqrt(12 * normal @ sheared @ normal)
    return most.mean(axis=0), normal, np.sqrt(ratio.real[order]), thickness


def participation(vectors):
    square = (vectors**2).sum(axis=1)
    return square.sum() ** 2 / (len(square) * (square**2).sum())


def rms(vectors):
    return np.sqrt((vectors**2).sum(axis=1).mean())


def close(name, found, wanted, tolerance, scale=None):
    found, wanted = np.asarray(found), np.asarray(wanted)
    scale = np.abs(wanted).max() if scale is None else scale
    off = np.abs(found - wanted).max() / scale
    assert off <= tolerance, f"{name}: {found} against {wanted}, off by {off:e}"


def main():
    told = messages(["/graintwin/grain_motion", "/graintwin/wall_forces"])
    motions, walls = told["/graintwin/grain_motion"], told["/graintwin/wall_forces"]
    position, radius, low, high = pack()
    size = (high - low).max()
    before = low, high
    turned = np.zeros_like(position)
    compared = 0
    for increment, motion in sorted(motions.items()):
        inward = np.asarray(walls[increment].displacement)
        after = low + inward[0::2], high - inward[1::2]
        moved = np.asarray(motion.displacement).reshape(-1, 3)
        carries = np.asarray(motion.carries, dtype=bool)
        stretch = (after[1] - after[0]) / (before[1] - before[0])
        carried = after[0] + stretch * (position - before[0]) - position
        non_affine = np.asarray(motion.non_affine).reshape(-1, 3)
        close("non_affine", non_affine, moved - carried, 1e-15, size)
        if increment > 0:
            found = [local(position, moved, radius, carries, i) for i in range(len(radius))]
            known = np.array([one is not None for one in found])
            assert (known == np.isfinite(motion.d2min)).all(), "who has neighbours"
            d2min, shear, loss = np.array([one or (np.nan,) * 3 for one in found]).T
            assert (np.abs(motion.d2min / d2min - 1)[known] < 1e-7).all()
            close("shear", np.asarray(motion.shear_strain)[known], shear[known], 1e-9)
            close("volume", np.asarray(motion.volumetric_strain)[known], loss[known], 1e-9)
            middle = (before[0] + before[1]) / 2
            stretched = (stretch - 1) * (position - middle)
            close("affine_rms", motion.affine_rms, rms(stretched[carries]), 1e-9)
            close("non_affine_rms", motion.non_affine_rms, rms(non_affine[carries]), 1e-9)
            ratio = rms(non_affine[carries]) / rms(stretched[carries])
            close("non_affine_ratio", motion.non_affine_ratio, ratio, 1e-9)
            close("participation", motion.participation, participation(non_affine[carries]), 1e-9)
            ranked = np.sort(d2min[carries & known])[::-1]
            for share, top in ((0.01, motion.d2min_top_1), (0.1, motion.d2min_top_10)):
                most = ranked[: int(np.ceil(share * len(ranked)))]
                close("top", top, most.sum() / ranked.sum(), 1e-7)
            center, normal, spread, thickness = band(position, shear, carries)
            close("center", motion.band_center, center, 1e-9, size)
            close("normal", motion.band_normal, normal, 1e-6)
            close("spread", motion.band_spread, spread, 1e-9)
            close("thickness", motion.band_thickness, thickness, 1e-6)
            compared += 1
        if len(motion.rotation):
            rotation = np.asarray(motion.rotation).reshape(-1, 3)
            turned += rotation
            total = np.asarray(motion.total_rotation).reshape(-1, 3)
            close("rotation", turned, total, 1e-12, max(np.abs(total).max(), 1e-12))
            if increment > 0:
                close("rotation_rms", motion.rotation_rms, rms(rotation[carries]), 1e-9)
                wanted = participation(rotation[carries])
                close("of rotations", motion.rotation_participation, wanted, 1e-9)
        position, before = position + moved, after
    json.dump({"increments": compared, "grains": len(radius), "floating": int((~carries).sum())},
              sys.stdout)


main()
