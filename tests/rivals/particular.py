#!/usr/bin/env python3
"""Compares Stripmine with the Rust crate `particular` on softened gravity of every pair, in alternating runs on one core. Optional: no
test needs it.

    python3 tests/rivals/particular.py [--out FOLDER] [--rounds 3] [--stripmine PROGRAM]

Builds `tests/rivals/particular` for this processor (`-C target-cpu=native`, link-time optimisation) in a folder among this
machine's temporary files; if the crate is not available the script reports it and ends without an error. Rates are directed
interactions a second, N² counted, of one thread: for the crate by sweeps over bodies at rest, for ours by whole leapfrog steps of
moving bodies. Both use Plummer spheres with softening 0.01.
"""

import argparse
import json
import os
import pathlib
import subprocess
import tempfile

from environment import said
from provenance import refusal
from report import contest, result, shown, write

CRATE = pathlib.Path(__file__).with_name("particular")
# Our precision for each of theirs.
OURS = {"f32": "mixed", "f64": "f64"}


def built():
    """Builds the rival's program and returns its path."""
    folder = pathlib.Path(tempfile.gettempdir()) / "stripmine-particular"
    variables = dict(os.environ, RUSTFLAGS="-C target-cpu=native", CARGO_TARGET_DIR=str(folder))
    call = ["cargo", "build", "--release", "--quiet", "--locked"]
    done = subprocess.run(call, cwd=CRATE, env=variables, capture_output=True, text=True)
    if done.returncode != 0:
        raise OSError(said(done.stderr))
    return folder / "release" / "in-particular"


def answer(call):
    done = subprocess.run(list(map(str, call)), capture_output=True, text=True, timeout=300)
    if done.returncode != 0:
        raise SystemExit(said(done.stderr))
    return json.loads(done.stdout)


def held(rival, stripmine, bodies, precision, rounds):
    """Runs both in turns; rates in 10⁹ a second."""
    ours, theirs, error = [], [], 0.0
    for _ in range(rounds):
        found = answer([rival, bodies, precision, 2])
        theirs.append(found["rate"] / 1e9)
        error = found["error"]
        call = [stripmine, "bench", "nbody", "--json", "--quiet", "--threads", 1, "--repeats", 3, "--particles", bodies]
        found = answer([*call, "--precision", OURS[precision]])
        ours.append(found["interactions_per_second_median"] / 1e9)
    configuration = f"forces in {precision}, {found['arithmetic']} (the rival's error {error:.1e})"
    return contest("all-pairs gravity", bodies, configuration, ours, theirs), found["instruction_set"]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bodies", type=int, nargs="+", default=[4096, 16384])
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--stripmine", default="target/release/stripmine")
    parser.add_argument("--out", type=pathlib.Path, help="folder for contests.json")
    asked = parser.parse_args()
    refused = refusal(asked.out, asked.stripmine)
    if refused is not None:
        raise SystemExit(refused)
    try:
        rival = built()
    except OSError as why:
        print(f"skipped: the crate is not available: {why}")
        return
    contests = [held(rival, asked.stripmine, bodies, precision, asked.rounds) for bodies in asked.bodies for precision in OURS]
    unit = "10⁹ directed interactions a second, one thread"
    build = "crate particular, target-cpu=native, link-time optimisation"
    found = result("particular", "0.7.0", build, contests[-1][1], unit, [it for it, _ in contests], [])
    print(shown(found))
    if asked.out:
        write(asked.out, found)


main()
