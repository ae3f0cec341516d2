#!/usr/bin/env python3
"""Compares Stripmine with EDMD (Smallenburg 2022) on elastic hard discs in a periodic box, in alternating runs on one core. Optional: no
test needs it.

    python3 tests/rivals/edmd.py --edmd CHECKOUT [--out FOLDER] [--rounds 3]
    python3 tests/rivals/edmd.py --edmd CHECKOUT --quick            the smaller size, about a minute

Without a checkout EDMD is cloned; if that is not possible, or there is no C compiler, the script reports it and ends without an error.

The rival is EDMD's program `Single`: one event a particle, a list of neighbours with its own shell for each, a calendar. It is written for
spheres: `edmd_planar.py` removes the third coordinate from its source, `in_edmd.c` starts and measures it. It is compiled for this
processor with its own flags. At each density and size a scan finds the best shell of its lists, then the best block and the best horizon of
its calendar; shells have the shortest arrays of neighbours that suffice.

Both start with Maxwell's velocities on a hexagonal lattice, in its order in memory, and are measured after the same number of
collisions. Rates are million collisions a second of processor time, one thread. Z = pV/NkT, from the virial of all collisions,
shows that both are the same fluid. Memory is the peak resident memory, at the largest size.
"""

import argparse
import collections
import itertools
import json
import os
import pathlib
import shutil
import statistics
import subprocess
import sys
import tempfile

from edmd_planar import Changed, planar
from environment import Unavailable, said
from provenance import git, refusal
from report import contest, result, same, shown, write

SOURCE = "https://github.com/FSmallenburg/EDMD"
# Flags of its Makefile.
FLAGS = ["-Ofast", "-funroll-loops", "-march=native"]
UNIT = "million collisions a second of processor time, one thread"
PACKING_FRACTIONS = [0.1, 0.3, 0.5, 0.65, 0.7]
PARTICLES = [2500, 250_000]
# Memory is compared at the size of the paper, at one density.
LARGEST, LARGEST_FRACTION = 2_500_000, 0.5
SHELLS = [1.2, 1.3, 1.4, 1.5, 1.7, 1.85, 2.0, 2.25, 2.5, 3.0, 4.0, 6.0]
BLOCKS = [0.3, 1, 3, 10, 30]
HORIZONS = [1, 4, 16]
# Larger shells are skipped after one that reaches less than this part of the best rate.
MUCH_SLOWER = 0.8
# Lengths of a disc's array of neighbours.
NEIGHBOURS = [8, 12, 16, 24, 32, 48, 64, 96, 128, 192]
# Largest difference of Z between the rivals, relative to its excess over 1.
WITHIN = 0.02
# Time limit in seconds, which no call reaches.
LONGEST = 1200

Setting = collections.namedtuple("Setting", "shell block horizon")


def checkout(folder, asked):
    """The given checkout, or a clone."""
    if asked is None:
        call = ["git", "clone", "--quiet", "--depth", "1", SOURCE, str(folder / "edmd")]
        try:
            done = subprocess.run(call, env=dict(os.environ, GIT_TERMINAL_PROMPT="0"), capture_output=True, text=True, timeout=120)
        except (OSError, subprocess.TimeoutExpired) as why:
            raise Unavailable(why) from why
        if done.returncode != 0:
            raise Unavailable(said(done.stderr))
        return folder / "edmd"
    if not (asked / "Single" / "mdSingle.c").exists():
        raise Unavailable(f"{asked} has no Single/mdSingle.c")
    return asked


def run(call):
    done = subprocess.run(list(map(str, call)), capture_output=True, text=True, timeout=LONGEST)
    if done.returncode != 0:
        raise SystemExit(f"error: {call[0]}: {said(done.stderr + done.stdout)}")
    return done.stdout


class Edmd:
    """EDMD in two dimensions; one program for every shell and length of the arrays of neighbours."""

    def __init__(self, source, folder):
        self.folder, self.single = folder, source / "Single"
        self.version = git(source, "describe", "--always", "--dirty", "--abbrev=12") or "of no commit"
        self.compiler = next(filter(None, map(shutil.which, ("gcc", "clang"))), None)
        if self.compiler is None:
            raise Unavailable("neither gcc nor clang is installed")
        (folder / "planar.c").write_text(planar(self.single))

    def build(self):
        """Compiler and flags."""
        return f"Single in two dimensions, {run([self.compiler, '--version']).splitlines()[0]} {' '.join(FLAGS)}"

    def program(self, shell, neighbours):
        made = self.folder / f"shell-{shell}-{neighbours}"
        if not made.exists():
            defined = [f"-DSHELL={shell}", f"-DMAXNEIGH={neighbours}", f"-I{self.single}"]
            run([self.compiler, *FLAGS, *defined, self.folder / "planar.c", "-o", made, "-lm"])
        return made

    def measured(self, system, setting, seed, collisions):
        """Measures with the shortest arrays of neighbours that suffice."""
        particles, fraction = system
        for neighbours in NEIGHBOURS:
            call = [self.program(setting.shell, neighbours), particles, fraction, seed, setting.block, setting.horizon]
            call += [equilibration(collisions), collisions]
            done = subprocess.run(list(map(str, call)), capture_output=True, text=True, timeout=LONGEST)
            if done.returncode == 0:
                return json.loads(done.stdout.splitlines()[-1])
            if "Too many neighbors" not in done.stdout:
                break
        raise SystemExit(f"error: EDMD with {particles} discs at {fraction}, {setting}: {said(done.stderr + done.stdout)}")

    def tuned(self, system, shells, collisions):
        """Finds the fastest setting: first the shell, then the block, then the horizon."""
        rates = {}

        def tried(setting):
            if setting not in rates:
                rates[setting] = rate(self.measured(system, setting, 1, collisions))
            return rates[setting]

        first = len(shells) // 2
        for some in shells[first:], shells[first - 1 :: -1]:
            for shell in some:
                if tried(Setting(shell, 3, 4)) < MUCH_SLOWER * max(rates.values()):
                    break
        found = max(rates, key=rates.get)
        found = max((found._replace(block=block) for block in BLOCKS), key=tried)
        return max((found._replace(horizon=horizon) for horizon in HORIZONS), key=tried)


def equilibration(collisions):
    """Equilibration as in `stripmine bench`."""
    return max(200, collisions // 10)


def rate(found):
    return 1e-6 * found["collisions"] / found["seconds"]


def amount(particles):
    """Collisions of a measurement: enough for a precise Z with few discs, and several for every disc with many."""
    return min(max(2_000_000, 40 * particles), 10_000_000)


def ours(stripmine, particles, fraction, collisions):
    call = [stripmine, "bench", "hard-disks", "--json", "--quiet", "--threads", 1, "--repeats", 1, "--particles", particles]
    found = json.loads(run([*call, "--packing-fraction", fraction, "--collisions", collisions]))
    return found | {"rate": 1e-6 * found["steps"] / found["cpu_seconds"]}


def held(edmd, asked, particles, fraction):
    """Measures a density and size: the contest, the checks of agreement, the memory of both, our instruction set."""
    collisions = amount(particles)
    # Our lattice of the start rounds the number of discs; the rival gets the same number.
    system = (ours(asked.stripmine, particles, fraction, 1000)["particles"], fraction)
    setting = edmd.tuned(system, SHELLS[::2] if asked.quick else SHELLS, collisions // 4)
    theirs, own = [], []
    for seed in range(1, asked.rounds + 1):
        theirs.append(edmd.measured(system, setting, seed, collisions))
        own.append(ours(asked.stripmine, particles, fraction, collisions))
    name = f"hard discs, ν = {fraction:.2f}"
    configuration = f"f64, {own[0]['engine']}; the rival's shell {setting.shell}, block {setting.block}/N, horizon {setting.horizon}"
    z, their_z = (statistics.median(found["compressibility"] for found in runs) for runs in (own, theirs))
    memory = {"system": name, "particles": system[0]}
    memory |= {who: runs[-1]["peak_memory_bytes"] for who, runs in (("ours", own), ("theirs", theirs))}
    return (
        contest(name, system[0], configuration, [found["rate"] for found in own], [rate(found) for found in theirs]),
        same(f"{name}, {system[0]}: Z", z, their_z, WITHIN * (z - 1)),
        memory,
        own[0]["instruction_set"],
    )


def of_the_report(edmd, parts):
    """The contests in the format of the report, with the memory at the largest size."""
    contests, agreement, memory, sets = zip(*parts)
    largest = max(it["particles"] for it in memory)
    found = result("EDMD", edmd.version, edmd.build(), sets[0], UNIT, list(contests), list(agreement))
    return found | {"memory": [it for it in memory if it["particles"] == largest]}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--edmd", type=pathlib.Path, help=f"a checkout of {SOURCE}")
    parser.add_argument("--packing-fraction", type=float, nargs="+", default=PACKING_FRACTIONS)
    parser.add_argument("--particles", type=int, nargs="+", help="lower bounds; by default also the number of the paper, at one density")
    parser.add_argument("--rounds", type=int, help="3 by default, 2 if quick")
    parser.add_argument("--quick", action="store_true", help="the smaller size, two rounds, fewer shells")
    parser.add_argument("--core", type=int, help="core for both; by default the last one")
    parser.add_argument("--stripmine", default="target/release/stripmine")
    parser.add_argument("--out", type=pathlib.Path, help="folder for contests.json")
    asked = parser.parse_args()
    asked.rounds = asked.rounds or (2 if asked.quick else 3)
    refused = refusal(asked.out, asked.stripmine)
    if refused is not None:
        return refused
    if hasattr(os, "sched_setaffinity"):
        # Child processes inherit the core.
        os.sched_setaffinity(0, {max(os.sched_getaffinity(0)) if asked.core is None else asked.core})
    sizes = asked.particles or (PARTICLES[:1] if asked.quick else PARTICLES)
    systems = list(itertools.product(sizes, asked.packing_fraction))
    if not (asked.particles or asked.quick):
        systems.append((LARGEST, LARGEST_FRACTION))
    with tempfile.TemporaryDirectory(prefix="stripmine-edmd-") as folder:
        try:
            folder = pathlib.Path(folder)
            edmd = Edmd(checkout(folder, asked.edmd), folder)
        except Unavailable as why:
            print(f"skipped: EDMD is not available: {why}")
            return 0
        except Changed as why:
            raise SystemExit(f"error: {why}") from why
        parts = []
        for particles, fraction in systems:
            print(f"packing fraction {fraction}, {particles} discs", file=sys.stderr, flush=True)
            parts.append(held(edmd, asked, particles, fraction))
            # Intermediate results are written, in case a later measurement fails.
            found = of_the_report(edmd, parts)
            if asked.out:
                write(asked.out, found)
    print(shown(found))
    for it in found["memory"]:
        print(f"memory, {it['system']}, {it['particles']}: {it['ours'] / 1e6:.0f} and {it['theirs'] / 1e6:.0f} MB")
    return 0


if __name__ == "__main__":
    sys.exit(main())
