"""Contest at one density and size: LAMMPS and ours over the same steps of the same gas, in turns."""

import json
import pathlib
import statistics
import subprocess

from environment import said

IN_LAMMPS = pathlib.Path(__file__).with_name("in_lammps.py")
# Steps after which positions of both are compared: contacts have come and gone, and chaos has not yet taken over.
COMPARED = 300
# Larger systems are not compared disc by disc: agreement of smaller ones is enough.
COMPARED_DISCS = 100_000
# Rivals rebuild their lists now and then: fewer steps may contain no rebuild.
LEAST_STEPS = 200
# Time limit in seconds, which no call reaches.
LONGEST = 900


class Refused(Exception):
    """A program that gave no result, with its message."""


def run(call, variables=None):
    done = subprocess.run(call, env=variables, capture_output=True, text=True, timeout=LONGEST)
    if done.returncode != 0:
        raise Refused(said(done.stderr))
    return done.stdout


class Contest:
    """A density and size, with the start that stripmine wrote."""

    def __init__(self, asked, python, variables, folder, fraction, particles):
        self.asked, self.python, self.variables, self.folder = asked, python, variables, folder
        self.fraction, self.particles = fraction, particles
        self.steps = asked.steps or max(LEAST_STEPS, 10_000_000 // particles)
        # As in `stripmine bench`.
        self.equilibration = max(200, self.steps // 10)

    def state(self, steps):
        """Writes the bench scene after some steps as a data file."""
        scene = {
            "particles.count": self.particles,
            "particles.packing_fraction": self.fraction,
            "machine.engine": '"fast"',
            "integrator.kind": '"velocity-verlet"',
            "run.steps": steps,
            "output.trajectory": "false",
            "output.lammps_data": "true",
        }
        call = [self.asked.stripmine, "run", "bench", "--quiet", "--threads", "1", "--overwrite"]
        folder = self.folder / f"{steps}"
        run(call + ["--out", str(folder)] + [part for key, value in scene.items() for part in ("--set", f"{key}={value}")])
        return folder / "final.data"

    def lammps(self, what, start, skin, *rest):
        call = [self.python, "-I", str(IN_LAMMPS), what, str(start), str(skin), *map(str, rest)]
        return json.loads(run(call, self.variables).strip().splitlines()[-1])

    def ours(self, what, precision, integrator):
        execution = self.asked.execution
        engine = ["--engine", "fast"] if execution == "fast" else ["--execution", execution]
        call = [
            self.asked.stripmine, "bench", what, "--json", "--threads", "1", "--repeats", "1",
            "--packing-fraction", str(self.fraction), "--particles", str(self.particles), "--steps", str(self.steps),
            "--precision", precision, "--integrator", integrator, *engine,
        ]
        return json.loads(run(call))

    def rate(self, seconds, particles):
        """Rate in million particle-steps a second."""
        return 1e-6 * particles * self.steps / seconds

    def held(self, configurations):
        """Runs the contest and returns the figures of LAMMPS and of each of our configurations."""
        start = self.state(0)
        compared = {"apart": None, "moved": None}
        if self.particles <= COMPARED_DISCS:
            compared = self.lammps("compare", start, self.asked.skin[0], COMPARED, self.state(COMPARED))
        theirs, mine, refused = {skin: [] for skin in self.asked.skin}, {configuration: [] for configuration in configurations}, {}
        for _ in range(self.asked.rounds):
            for skin in theirs:
                theirs[skin].append(self.lammps("measure", start, skin, self.equilibration, self.steps))
            for configuration in configurations:
                try:
                    if configuration not in refused:
                        mine[configuration].append(self.ours(*configuration))
                except Refused as why:
                    refused[configuration] = str(why)
        rates = {skin: [self.rate(r["seconds"], r["particles"]) for r in runs] for skin, runs in theirs.items()}
        skin = max(rates, key=lambda skin: statistics.median(rates[skin]))
        last = theirs[skin][-1]
        own = [self.refusal(configuration, refused[configuration]) if configuration in refused else self.entry(configuration, mine[configuration], rates[skin]) for configuration in configurations]
        return compared | {
            "packing_fraction": self.fraction,
            "particles": last["particles"],
            "steps": self.steps,
            "equilibration": self.equilibration,
            "rounds": self.asked.rounds,
            "lammps": last | {"skin": skin, "rates": rates[skin]},
            "ours": own,
        }

    def refusal(self, configuration, why):
        return dict(zip(("what", "precision", "integrator"), configuration)) | {"refused": why}

    def entry(self, configuration, runs, rival_rates):
        """Entry of one of our configurations over the rounds, with the state after the last."""
        last = runs[-1]
        rates = [self.rate(r["cpu_seconds"], r["particles"]) for r in runs]
        # Phases are measured in wall time and scaled to processor time.
        each = 1e9 * last["cpu_seconds"] / last["seconds"] / (last["particles"] * self.steps)
        return dict(zip(("what", "precision", "integrator"), configuration)) | {
            "execution": last["execution"],
            "instruction_set": last["instruction_set"],
            "rates": rates,
            "ratios": [a / b for a, b in zip(rates, rival_rates)],
            "temperature": last["temperature"][1],
            "contacts": last["contacts"] / last["particles"],
            "nanoseconds": {phase: seconds * each for phase, seconds in last["phases"].items()},
            "peak_memory_bytes": last["peak_memory_bytes"],
        }
