"""Compares the means and statistical inefficiencies of runs with those that `pymbar` finds in the same rows.

    python averages.py STRIPMINE

Needs the packages `pymbar` and `numpy`; if one is not installed, the check prints SKIPPED and exits with 0.

For rows after the end of our transient, the means must agree to nine digits, and our inefficiency, from 16 waves, must be 0.4 to 2.5 times pymbar's, which
is three standard errors of ours. Exits with 1 if one does not. Theirs is at least 1, ours may be smaller. Also prints the end of the transient of both.
"""

import csv
import json
import subprocess
import sys
import tempfile
from pathlib import Path

SCENES = {
    "langevin-dense": {"run.time": 50, "run.thermo_every": 20},
    "dense-gas": {"run.steps": 20000, "run.thermo_every": 20},
    "hard-disks": {"run.events": 500000, "run.thermo_every": 0.1},
}


def main(stripmine):
    try:
        import numpy
        from pymbar import timeseries
    except ImportError as error:
        print(f"SKIPPED: {error}")
        return 0
    wrong = 0
    for scene, settings in SCENES.items():
        with tempfile.TemporaryDirectory() as folder:
            sets = [part for key, value in settings.items() for part in ("--set", f"{key}={value}")]
            subprocess.run([stripmine, "run", scene, "--quiet", "--overwrite", "--out", folder, *sets], check=True)
            rows = list(csv.DictReader((Path(folder) / "thermo.csv").open()))
            averages = json.loads((Path(folder) / "summary.json").read_text())["averages"]["quantities"]
        times = numpy.array([float(row["time"]) for row in rows])
        for ours in averages:
            name = ours["quantity"]
            if ours["says"] != "mean" or ours["of"] != "values":
                continue
            # The first row is the start and does not count.
            series = numpy.array([float(row[name]) for row in rows])[1:]
            # Ours are means over blocks of rows in long runs.
            kept = series[times[1:] > ours["equilibrated_at"] * (1 + 1e-9)]
            theirs = timeseries.statistical_inefficiency(kept, mintime=3)
            start, *_ = timeseries.detect_equilibration(series, nskip=max(1, len(series) // 100))
            mean = abs(kept.mean() / ours["mean"] - 1)
            ratio = max(ours["inefficiency"], 1) / theirs
            is_wrong = mean > 1e-9 and abs(kept.mean()) > 1e-9 * abs(kept).max() or not 0.4 < ratio < 2.5
            wrong += is_wrong
            print(
                f"{scene} {name}: g {ours['inefficiency']:.2f}, pymbar {theirs:.2f}; transient {ours['equilibrated_at']:.3g}, "
                f"pymbar {times[1:][start]:.3g}{'  WRONG' if is_wrong else ''}"
            )
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
