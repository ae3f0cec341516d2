#!/usr/bin/env python3
"""Error of Z = pV/NkT of 870 hard discs over processor seconds: Stripmine, EDMD (Smallenburg 2022) and straight event-chain Monte Carlo,
on one core. Optional: no test needs it.

    python3 tests/rivals/error_of_z.py --edmd CHECKOUT [--out FOLDER] [--seeds 8]

Each program runs with several seeds for each number of processor seconds, after an eighth (EDMD: a tenth) of that for equilibration. The error is the
standard deviation over the seeds. The discs start on a stretched
hexagonal lattice in a periodic square (EDMD: in a nearly square box, which in_edmd.c chooses). EDMD has the shell that
edmd.py found for the smaller systems; the length of a chain is tuned. The means of all programs must agree.
"""

import argparse
import itertools
import json
import math
import os
import pathlib
import random
import statistics
import sys
import tempfile

from edmd import Edmd, Setting, checkout, run
from environment import Unavailable
from provenance import refusal, write

COLUMNS, ROWS = 29, 30
PACKING_FRACTIONS = [0.5, 0.7, 0.72]
SECONDS = [0.25, 0.5, 1, 2, 4]
CHAINS = [2, 4, 8, 16, 32]
SETTINGS = {0.5: Setting(2.25, 3, 16), 0.7: Setting(1.5, 3, 4), 0.72: Setting(1.5, 3, 4)}
# Events of the first run, which measures the rate.
FIRST = 300_000
SCENE = """format = 2
units = "reduced"
[method]
kind = "hard-disks"
[domain]
sides = [{side!r}, {side!r}]
periodic = [true, true]
[particles]
generate = "list"
radius = 0.5
mass = 1.0
positions = {positions}
velocities = {velocities}
[run]
time = {time!r}
thermo_every = {rows!r}
snapshot_every = 0
[output]
trajectory = false
"""


class Chain:
    """Event-chain Monte Carlo; an event is a contact."""

    name = "event chain"

    def __init__(self, folder, compiler):
        self.program, self.lengths = folder / "event-chain", {}
        source = pathlib.Path(__file__).with_name("event_chain.c")
        run([compiler, "-O3", "-march=native", source, "-o", self.program, "-lm"])

    def tune(self, fraction):
        """The length of the chains with the smallest scatter in a second."""
        def scatter(length):
            self.lengths[fraction] = length
            return statistics.stdev(self.measured(fraction, seed, 3_000_000)[1] for seed in range(6))

        self.lengths[fraction] = min(CHAINS, key=scatter)

    def measured(self, fraction, seed, events):
        """Seconds and Z."""
        if fraction not in self.lengths:
            self.tune(fraction)
        call = [self.program, COLUMNS, ROWS, fraction, seed, self.lengths[fraction], events // 8, events]
        found = json.loads(run(call))
        return found["seconds"], found["compressibility"]


class Rival:
    """EDMD."""

    name = "EDMD"

    def __init__(self, edmd):
        self.edmd = edmd

    def measured(self, fraction, seed, events):
        number = COLUMNS * ROWS
        found = self.edmd.measured((number, fraction), SETTINGS[fraction], seed, events)
        # Its temperature counts the momentum, which is conserved, among the degrees of freedom.
        return found["seconds"], 1 + (found["measured_compressibility"] - 1) * (number - 1) / number


class Ours:
    """Stripmine; the rate of collisions sets the time of a run."""

    name = "Stripmine"

    def __init__(self, program, folder):
        self.program, self.folder, self.rates = program, folder, {}

    def measured(self, fraction, seed, events):
        rate = self.rates.get(fraction, 10_000.0)
        time = events / rate
        side = math.sqrt(COLUMNS * ROWS * math.pi / (4 * fraction))
        scene, folder = self.folder / "ours.toml", self.folder / "ours"
        places = [((at % COLUMNS + 0.25 + 0.5 * (at // COLUMNS % 2)) * side / COLUMNS, (at // COLUMNS + 0.5) * side / ROWS)
                  for at in range(COLUMNS * ROWS)]
        drawn = random.Random(seed)
        velocities = [[drawn.gauss(0, 1), drawn.gauss(0, 1)] for _ in places]
        lists = {"positions": [list(place) for place in places], "velocities": velocities}
        scene.write_text(SCENE.format(side=side, time=1.125 * time, rows=0.125 * time, **lists))
        run([self.program, "run", scene, "--quiet", "--threads", 1, "--overwrite", "--out", folder])
        lines = [line.split(",") for line in (folder / "thermo.csv").read_text().splitlines()]
        column = {name: [float(line[at]) for line in lines[1:]] for at, name in enumerate(lines[0])}
        z = statistics.fmean(column["compressibility"][2:])
        self.rates[fraction] = (column["collisions"][-1] - column["collisions"][1]) / time
        seconds = json.loads((folder / "summary.json").read_text())["phases"]["events"]
        return seconds * 8 / 9, z


def errors(program, fraction, seeds):
    """Seconds, and the mean and the standard deviation of Z over the seeds, for each amount."""
    # The first run of ours finds the rate of collisions.
    seconds, _ = [program.measured(fraction, 0, FIRST) for _ in range(2)][-1]
    rows = []
    for wanted in SECONDS:
        found = [program.measured(fraction, seed, int(FIRST * wanted / seconds)) for seed in range(1, seeds + 1)]
        z = [z for _, z in found]
        rows.append({
            "program": program.name, "packing_fraction": fraction, "seconds": statistics.fmean(taken for taken, _ in found),
            "seeds": seeds, "mean": statistics.fmean(z), "error": statistics.stdev(z),
        })
        print(rows[-1], file=sys.stderr, flush=True)
    return rows


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--edmd", type=pathlib.Path, help="a checkout of EDMD")
    parser.add_argument("--packing-fraction", type=float, nargs="+", default=PACKING_FRACTIONS, choices=PACKING_FRACTIONS)
    parser.add_argument("--seeds", type=int, default=8)
    parser.add_argument("--stripmine", type=pathlib.Path, default=pathlib.Path("target/release/stripmine"))
    parser.add_argument("--out", type=pathlib.Path, help="folder for errors.json")
    asked = parser.parse_args()
    refused = refusal(asked.out, asked.stripmine)
    if refused is not None:
        return refused
    if hasattr(os, "sched_setaffinity"):
        # Child processes inherit the core.
        os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
    with tempfile.TemporaryDirectory(prefix="stripmine-errors-") as folder:
        folder = pathlib.Path(folder)
        try:
            edmd = Edmd(checkout(folder, asked.edmd), folder)
        except Unavailable as why:
            print(f"skipped: EDMD is not available: {why}")
            return 0
        programs = [Ours(asked.stripmine.resolve(), folder), Rival(edmd), Chain(folder, edmd.compiler)]
        found = [errors(program, fraction, asked.seeds) for fraction, program in itertools.product(asked.packing_fraction, programs)]
        rows = list(itertools.chain.from_iterable(found))
        chains = {str(fraction): length for fraction, length in programs[2].lengths.items()}
    if asked.out:
        write(asked.out, {"errors.json": json.dumps({"edmd": edmd.version, "chains": chains, "rows": rows}, indent=1) + "\n"})
    return 0


if __name__ == "__main__":
    sys.exit(main())
