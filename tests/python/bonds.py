"""Computes the use of the strength of bonds anew, and holds cracks against bonds.

Usage: bonds.py BAG_FOLDER

Reads `/graintwin/bonds` and `/graintwin/cracks` of a recording. The stresses on the section of a bond, a disc
of radius a, are -P/A and |Q|/A + 2 |M|/(A a) with A = pi a2; each over its strength, and over the
share of the cement that is left. Prints a summary; exits with a traceback at the first difference.
"""

import json
import math
import sys
from pathlib import Path

from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory

FOLDER = Path(sys.argv[1])


def use(bonds, k):
    area = math.pi * bonds.radius[k] ** 2
    shear = math.sqrt(sum(x * x for x in bonds.tangential_force[3 * k : 3 * k + 3]))
    tension = -bonds.normal_force[k] / area
    twist = 2 * abs(bonds.torsion[k]) / (area * bonds.radius[k])
    larger = max(tension / bonds.tensile_strength, (shear / area + twist) / bonds.shear_strength)
    return larger / bonds.share[k]


def pairs(message):
    return list(zip(message.first, message.second))


def main():
    increments, most, cracks, before = 0, 0.0, 0, {}
    with open(next(FOLDER.glob("*.mcap")), "rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        latest = None
        for _, channel, _, message in reader.iter_decoded_messages():
            if channel.topic == "/graintwin/bonds":
                latest = message
                keys = pairs(message)
                assert keys == sorted(set(keys)), "each pair once, sorted"
                for k, condition in enumerate(message.condition):
                    n = message.normal[3 * k : 3 * k + 3]
                    q = message.tangential_force[3 * k : 3 * k + 3]
                    assert abs(sum(x * x for x in n) - 1) < 1e-12
                    if condition != 0:
                        assert message.strength_use[k] == 0 and message.normal_force[k] == 0
                        continue
                    size = math.sqrt(sum(x * x for x in q))
                    assert abs(sum(x * y for x, y in zip(n, q))) <= 1e-9 * size
                    expected = use(message, k)
                    assert abs(message.strength_use[k] - expected) <= 1e-12 * max(1, abs(expected))
                    most = max(most, expected)
                increments += 1
            elif channel.topic == "/graintwin/cracks":
                # What was whole before and is broken now is what broke.
                now = dict(zip(pairs(latest), latest.condition))
                new = {pair: mode for pair, mode in now.items() if before.get(pair, 0) != mode}
                if message.increment > 0:
                    assert new == dict(zip(pairs(message), message.mode)), message.increment
                counts = [list(latest.condition).count(condition) for condition in (0, 1, 2)]
                told = [message.intact, message.broken_by_tension, message.broken_by_shear]
                assert counts == told, (counts, told)
                cracks += len(message.first)
                before = now
    print(json.dumps({"increments": increments, "most": most, "cracks": cracks}))


main()
