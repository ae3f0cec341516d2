"""Holds our g(r) and hexatic order against those that `freud` finds in the frames of the same moments.

    python structure.py STRIPMINE

Needs the packages `freud-analysis` and `numpy`; where one is not installed, the check says SKIPPED and exits with 0.

A Lennard-Jones fluid in a bath and hard discs. Of twenty snapshots the second half counts: the last ten frames. Exits with 1 where a value of
g(r) differs by more than 0.5 % of the largest, or an order by more than 1e-4: `freud` works in single precision, in which a pair may be in the next bin.
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

LOOKS = 20
SCENES = {
    "langevin-dense": {"run.steps": 20000, "run.snapshot_every": 1000, "run.thermo_every": 0},
    "hard-disks": {"run.time": 20.0, "run.snapshot_every": 1.0, "run.thermo_every": 0},
}


def frames(path, numpy):
    """The box and the places of each frame."""
    lines = path.read_text().splitlines()
    at = 0
    while at < len(lines):
        count, comment = int(lines[at]), lines[at + 1]
        cell = [float(part) for part in comment.split('Lattice="')[1].split('"')[0].split()]
        properties = comment.split("Properties=")[1].split()[0].split(":")
        column, names = 0, {}
        for name, width in zip(properties[::3], properties[2::3]):
            names[name] = column
            column += int(width)
        first = names["pos"]
        rows = [line.split()[first : first + 2] for line in lines[at + 2 : at + 2 + count]]
        yield [cell[0], cell[4]], numpy.array(rows, dtype=float)
        at += 2 + count


def main(stripmine):
    try:
        import freud
        import numpy
    except ImportError as error:
        print(f"SKIPPED: {error}")
        return 0
    wrong = 0
    for scene, settings in SCENES.items():
        settings = settings | {"output.structure": '["g(r)", "psi6"]', "output.structure_share": 1000.0}
        with tempfile.TemporaryDirectory() as folder:
            sets = [part for key, value in settings.items() for part in ("--set", f"{key}={value}")]
            subprocess.run([stripmine, "run", scene, "--quiet", "--overwrite", "--out", folder, *sets], check=True)
            folder = Path(folder)
            ours = numpy.loadtxt(folder / "g.csv", delimiter=",", skiprows=1)
            summary = json.loads((folder / "summary.json").read_text())
            taken = list(frames(folder / "trajectory.xyz", numpy))
        assert len(taken) == LOOKS + 1, f"{scene}: {len(taken)} frames"
        width = ours[1, 0] - ours[0, 0]
        rdf = freud.density.RDF(len(ours), len(ours) * width, normalization_mode="finite_size")
        hexatic = freud.order.Hexatic(k=6)
        distances, orders = [], []
        for sides, places in taken[-LOOKS // 2 :]:
            box = freud.box.Box(*sides)
            points = numpy.zeros((len(places), 3))
            points[:, :2] = places - 0.5 * numpy.array(sides)
            points = box.wrap(points)
            rdf.compute((box, points), reset=True)
            distances.append(numpy.array(rdf.rdf))
            order = hexatic.compute((box, points), neighbors={"num_neighbors": 6}).particle_order
            orders.append([abs(order.mean()), abs(order).mean()])
        theirs = numpy.mean(distances, axis=0)
        off = abs(theirs - ours[:, 1]).max() / theirs.max()
        psi6 = next(it for it in summary["structure"] if it["name"] == "psi6")
        found = [it["mean"] for it in psi6["headlines"]]
        off_by = abs(numpy.mean(orders, axis=0) - found).max()
        print(f"freud {freud.__version__}, {scene}: g(r) differs by {off:.1e} of the largest value, psi6 by {off_by:.1e}")
        wrong += off > 5e-3 or off_by > 1e-4
    return 1 if wrong else 0


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    sys.exit(main(sys.argv[1]))
