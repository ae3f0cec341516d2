#!/usr/bin/env python3
"""Compares Stripmine with LAMMPS on the granular bench scene, in alternating runs on one core. Optional: no test needs it.

    python3 tests/rivals/lammps.py                                  every density and size: takes long
    python3 tests/rivals/lammps.py --packing-fraction 0.84 --particles 10000       one of them
    python3 tests/rivals/lammps.py --what lattice neighbor-list --precision f64 mixed --integrator velocity-verlet gear6

The first call makes a virtual environment among this machine's temporary files and installs `lammps` and `mpich` from the
Python package index (or give `--python`, one that has them); if that is not possible the script reports it and ends
without an error. A native build of LAMMPS (`-O3 -march=native`) is faster than the package: give its Python.

LAMMPS has two pair styles for this law: the general `granular`, and the specialised `gran/hertz/history` without a tangential spring. The
faster one is the rival at each density; the output says how fast both are.

The scene: discs of mass and diameter 1 on a jittered hexagonal lattice, kT = 0.01, Hertz contacts, damping that hardly
cools, friction, dt = 0.005. Stripmine writes the start, so both start with the same positions and velocities. Two checks
show that both compute the same physics: after 300 steps with velocity Verlet the positions agree, and both have the
same temperature at the end.

Every round runs LAMMPS and then each of our configurations, over the same steps of the same gas. Rates are per second of processor
time of one thread, which is fair on a machine with other load. The output shows medians over the rounds with their range;
a ratio is the median of the rounds' ratios.
"""

import argparse
import itertools
import json
import pathlib
import subprocess
import sys
import tempfile

from contest import IN_LAMMPS, Contest, Refused, run
from environment import Unavailable, environment
from provenance import refusal
from report import contest, result, same, shown, write

PACKING_FRACTIONS = [0.84, 0.80, 0.6, 0.3, 0.1, 0.03]
UNIT = "million particle-steps a second of processor time, one thread"
PARTICLES = [10_000, 100_000, 1_000_000]


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--packing-fraction", type=float, nargs="+", default=PACKING_FRACTIONS)
    parser.add_argument("--particles", type=int, nargs="+", default=PARTICLES)
    parser.add_argument("--what", nargs="+", default=["lattice"], help="lattice, neighbor-list, sectors")
    parser.add_argument("--precision", nargs="+", default=["f64"], help="f64, f32, mixed")
    parser.add_argument("--integrator", nargs="+", default=["velocity-verlet"], help="velocity-verlet, gear4, gear5, gear6")
    parser.add_argument("--execution", default="fast", help="execution of the lattice")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--steps", type=int, help="steps of a measurement; by default about a second, at least 200")
    parser.add_argument("--style", nargs="+", default=["granular", "gran/hertz/history"], help="pair styles of LAMMPS; the fastest is used")
    parser.add_argument("--skin", type=float, nargs="+", default=[0.3], help="skins of LAMMPS's lists; the fastest is used")
    parser.add_argument("--stripmine", default="target/release/stripmine")
    parser.add_argument("--python", help="a Python that has LAMMPS")
    parser.add_argument("--out", type=pathlib.Path, help="folder for contests.json")
    return parser.parse_args()


def of_the_report(held, build):
    """The contests in the format of the report."""
    contests, agreement, sets = [], [], set()
    for it in held:
        rival, system = it["lammps"], f"granular discs, packing fraction {it['packing_fraction']:.2f}"
        for own in (own for own in it["ours"] if "refused" not in own):
            sets.add(own["instruction_set"])
            configuration = f"{own['what']} {own['precision']} {own['integrator']}"
            contests.append(contest(system, it["particles"], configuration, own["rates"], rival["rates"]))
            # Trajectories soon diverge chaotically: temperatures and contacts agree as samples of one gas.
            agreement.append(same(f"{system}, {it['particles']}, {configuration}: kT", own["temperature"], rival["temperature"], 1e-4))
        if it["apart"] is not None:
            agreement.append(same(f"{system}, {it['particles']}: farthest apart after 300 steps", it["apart"], 0.0, 1e-6))
    return result("LAMMPS", held[0]["lammps"]["version"], build, ", ".join(sorted(sets)), UNIT, contests, agreement)


def main():
    asked = arguments()
    refused = refusal(asked.out, asked.stripmine)
    if refused is not None:
        return refused
    try:
        python, variables = environment(asked.python)
    except Unavailable as why:
        print(f"skipped: LAMMPS is not available: {why}")
        return 0
    build = json.loads(run([python, "-I", str(IN_LAMMPS), "build"], variables))
    configurations = list(itertools.product(asked.what, asked.precision, asked.integrator))
    results = []
    with tempfile.TemporaryDirectory(prefix="stripmine-rivals-") as folder:
        for fraction, particles in itertools.product(asked.packing_fraction, asked.particles):
            contest = Contest(asked, python, variables, pathlib.Path(folder), fraction, particles)
            print(f"packing fraction {fraction}, {particles} discs", file=sys.stderr, flush=True)
            try:
                results.append(contest.held(configurations))
            except (Refused, subprocess.TimeoutExpired) as why:
                print(f"  left out: {why}", file=sys.stderr)
            # Intermediate results are written, in case a later measurement fails.
            if results and asked.out:
                write(asked.out, of_the_report(results, build))
    if results:
        print(shown(of_the_report(results, build)))
    return 0


if __name__ == "__main__":
    sys.exit(main())
