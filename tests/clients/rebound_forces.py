"""Compares the accelerations of bodies with those of REBOUND.

    python rebound_forces.py STRIPMINE

Needs the package `rebound`; if it is not installed, the check prints SKIPPED and exits with 0.

The program moves a softened Plummer sphere by one step of explicit Euler with dt = 1, from rest, without changing positions. The
new velocities are then the accelerations, to the last bit of a trajectory. REBOUND computes those of the same positions with the same
softening. Python computes them with sums rounded once (`math.fsum`), which shows where a difference comes from. Exits with 1 if one of
ours differs from these sums by more than 4 units of the last place of the largest, in double precision, or from REBOUND by over 4 units more
than REBOUND differs from the sums.
"""

import math
import subprocess
import sys
import tempfile
from pathlib import Path

# In units of the last place of the largest acceleration.
ALLOWED = 4.0
BODIES = 512
SOFTENING = 0.05


def frames(path):
    """Yields the rows of each frame: id, position, velocity and mass."""
    lines = path.read_text().splitlines()
    at = 0
    while at < len(lines):
        count = int(lines[at])
        rows = [line.split() for line in lines[at + 2 : at + 2 + count]]
        # species x y z id u v w radius mass ...
        yield [
            (int(row[4]), tuple(map(float, row[1:4])), tuple(map(float, row[5:8])), float(row[9]))
            for row in rows
        ]
        at += 2 + count


def summed_once(places, masses):
    """Accelerations with exact sums, rounded once."""
    found = []
    for here in places:
        terms = [[], [], []]
        for there, mass in zip(places, masses):
            way = [b - a for a, b in zip(here, there)]
            square = math.fsum([part * part for part in way] + [SOFTENING * SOFTENING])
            for sums, part in zip(terms, way):
                sums.append(mass * part / (square * math.sqrt(square)))
        found.append(tuple(map(math.fsum, terms)))
    return found


def main(stripmine):
    try:
        import rebound
    except ImportError as error:
        print(f"SKIPPED: {error}")
        return 0
    worst, expected = {}, None
    for engine in ("fast", "programs", "reference"):
        with tempfile.TemporaryDirectory() as folder:
            at_rest = Path(folder) / "rest"
            scene = {
                "particles.count": BODIES,
                "particles.generate": "sphere",
                "law.softening": SOFTENING,
                "integrator.kind": "euler",
                "integrator.dt": 1.0,
                "machine.engine": engine,
                "run.steps": 1,
                "run.snapshot_every": 1,
            }
            settings = [part for key, value in scene.items() for part in ("--set", f"{key}={value}")]
            call = [stripmine, "run", "cold-collapse", "--quiet", "--out", str(at_rest), *settings]
            subprocess.run(call, check=True)
            first, last = list(frames(at_rest / "trajectory.xyz"))[:2]
        simulation = rebound.Simulation()
        simulation.gravity = "basic"
        simulation.softening = SOFTENING
        for _, place, _, mass in first:
            simulation.add(m=mass, x=place[0], y=place[1], z=place[2])
        # Evaluates the forces once, without a step.
        simulation.integrator = "leapfrog"
        simulation.dt = 1e-300
        simulation.steps(1)
        theirs = [(body.ax, body.ay, body.az) for body in simulation.particles]
        ours = [
            tuple(now - before for now, before in zip(after[2], begun[2])) for begun, after in zip(first, last)
        ]
        expected = expected or summed_once([row[1] for row in first], [row[3] for row in first])
        largest = max(abs(part) for row in expected for part in row)

        def off(rows, others):
            most = max(abs(a - b) for row, other in zip(rows, others) for a, b in zip(row, other))
            return most / (largest * sys.float_info.epsilon)

        worst[engine] = off(ours, expected), off(ours, theirs), off(theirs, expected)
    for engine, (own, apart, rival) in worst.items():
        print(
            f"{engine}: differs from the sum rounded once by {own:.2f} units of the last place of the largest, from REBOUND {rebound.__version__} "
            f"by {apart:.2f}; REBOUND differs from that sum by {rival:.2f}"
        )
    held = all(own <= ALLOWED and apart <= ALLOWED + rival for own, apart, rival in worst.values())
    return 0 if held else 1


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    sys.exit(main(sys.argv[1]))
