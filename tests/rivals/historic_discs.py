#!/usr/bin/env python3
"""Pressure of hard discs beside published values: 870 discs at ten packing fractions (Li et al. 2022), three dilute gases (virial series), and
512 x 512 discs between fluid and crystal, from both sides. About two hours on two cores; no test needs it.

    python3 tests/rivals/historic_discs.py --work FOLDER [--out FOLDER] [--share 1]

An interrupted call resumes in the folder of its runs. Boxes are periodic squares. Error bars are half-widths of 95 % from the scatter of the runs.
"""

import argparse
import json
import math
import pathlib
import statistics
import subprocess
import sys

from provenance import provenance, refusal, write

# Packing fractions, discs, collisions of a run, runs, and start.
# So many discs that the share 1/N of pairs that a disc makes with itself is below the error.
DILUTE = [(nu, 40_000, 20_000_000, 8, "compressed") for nu in (0.1, 0.2, 0.3)]
FLUIDS, CRYSTALS = (0.67, 0.674, 0.68, 0.686, 0.69, 0.694, 0.698, 0.7), (0.71, 0.718)
# Crystals forget their start late.
DENSE = [(nu, 870, 400_000_000, 8, "compressed") for nu in FLUIDS] + [(nu, 870, 1_000_000_000, 8, "compressed") for nu in CRYSTALS]
# Single runs are too short to relax: the pressure in equilibrium lies between that of a fluid and of a crystal.
MELTING = [(nu, 512 * 512, 250_000_000, 1, start) for nu in (0.698, 0.7, 0.71, 0.716) for start in ("compressed", "hexagonal")]
SCENE = """format = 2
units = "reduced"
[method]
kind = "hard-disks"
{domain}
[particles]
generate = "{start}"
count = {count}
{fraction}
radius = 0.5
mass = 1.0
temperature = 1.0
seed = 1
[run]
events = {events}
thermo_every = {rows!r}
snapshot_every = 0
[output]
trajectory = false
"""


def scene(nu, count, events, start):
    """Scene of a run with about 2000 rows; its box is square, or nearly so for a crystal."""
    side = math.sqrt(count * math.pi / (4 * nu))
    square = f"[domain]\nsides = [{side!r}, {side!r}]\nperiodic = [true, true]"
    domain, fraction = (square, "") if start == "compressed" else ("", f"packing_fraction = {nu}")
    # Collisions of a disc per unit of time, by Henderson's pressure.
    rate = 4 / math.sqrt(math.pi) * ((1 + nu * nu / 8) / (1 - nu) ** 2 - 1)
    rows = round(events / (count * rate / 2) / 2000, 3)
    return SCENE.format(domain=domain, start=start, count=count, fraction=fraction, events=events, rows=rows)


def late(folder, blocks=10):
    """Mean of Z over the second half of a run that still relaxes, with the 95 % half-width from the scatter of blocks."""
    lines = [line.split(",") for line in (folder / "thermo.csv").read_text().splitlines()]
    z = [float(line[lines[0].index("compressibility")]) for line in lines[1:]]
    z = z[len(z) // 2 :]
    means = [statistics.fmean(z[at * len(z) // blocks : (at + 1) * len(z) // blocks]) for at in range(blocks)]
    error = statistics.stdev(means) / math.sqrt(blocks)
    # Student's t for nine degrees of freedom.
    return {"mean": statistics.fmean(means), "bar": 2.262 * error, "standard_error": error, "equilibrated_at": None}


def measured(program, work, nu, count, events, runs, start):
    """Mean of Z with its error, over all runs."""
    folder = work / f"{count}-{nu}-{start}"
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "scene.toml").write_text(scene(nu, count, events, start))
    seeds = ["--seeds", str(runs)] if runs > 1 else []
    made = folder / "runs"
    call = [program, "run", folder / "scene.toml", "--out", made, "--resume", "--quiet", *seeds]
    subprocess.run(list(map(str, call)), check=True)
    folders = sorted(made.glob("seed-*")) or [made]
    if runs == 1:
        z = late(made)
    else:
        found = subprocess.run([program, "average", *folders, "--json"], check=True, capture_output=True, text=True)
        z = {it["quantity"]: it for it in json.loads(found.stdout)["quantities"]}["compressibility"]
    row = {"packing_fraction": nu, "discs": count, "start": start, "runs": runs, "collisions": runs * events}
    row |= {"mean": z.get("mean"), "bar": z.get("bar"), "standard_error": z.get("standard_error"), "transient": z.get("equilibrated_at")}
    print(row, file=sys.stderr, flush=True)
    return row


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--work", type=pathlib.Path, required=True, help="folder of the runs; an interrupted call resumes there")
    parser.add_argument("--share", type=float, default=1.0, help="share of the collisions")
    parser.add_argument("--stripmine", type=pathlib.Path, default=pathlib.Path("target/release/stripmine"))
    parser.add_argument("--out", type=pathlib.Path, help="folder for pressures.json")
    asked = parser.parse_args()
    refused = refusal(asked.out, asked.stripmine)
    if refused is not None:
        return refused
    # The commit is that of the start.
    provenance()
    states = [(nu, count, int(events * asked.share), runs, start) for nu, count, events, runs, start in DILUTE + DENSE + MELTING]
    rows = [measured(asked.stripmine.resolve(), asked.work, *state) for state in states]
    if asked.out:
        write(asked.out, {"pressures.json": json.dumps({"rows": rows}, indent=1) + "\n"})
    return 0


if __name__ == "__main__":
    sys.exit(main())
