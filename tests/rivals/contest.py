"""Contest at one density and size: LAMMPS and ours over the same steps of the same gas, in turns."""

import itertools
import json
import pathlib
import statistics
import subprocess
import sys

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


def skins_of(settings, style):
    """Settings of a pair style."""
    return [setting for setting in settings if setting[0] == style]


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

    def lammps(self, what, start, style, skin, *rest):
        call = [self.python, "-I", str(IN_LAMMPS), what, str(start), style, str(skin), *map(str, rest)]
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
            compared = self.lammps("compare", start, self.asked.style[0], self.asked.skin[0], COMPARED, self.state(COMPARED))
        settings = list(itertools.product(self.asked.style, self.asked.skin))
        theirs, mine, refused = {setting: [] for setting in settings}, {configuration: [] for configuration in configurations}, {}
        for _ in range(self.asked.rounds):
            for style, skin in theirs:
                theirs[style, skin].append(self.lammps("measure", start, style, skin, self.equilibration, self.steps))
            for configuration in configurations:
                try:
                    if configuration not in refused:
                        mine[configuration].append(self.ours(*configuration))
                except Refused as why:
                    refused[configuration] = str(why)
        rates = {setting: [self.rate(r["seconds"], r["particles"]) for r in runs] for setting, runs in theirs.items()}
        medians = {setting: statistics.median(of_setting) for setting, of_setting in rates.items()}
        best = {style: max(skins_of(medians, style), key=medians.get) for style in self.asked.style}
        for style, setting in best.items():
            print(f"  {style}: {medians[setting]:.1f} million particle-steps a second with a skin of {setting[1]}", file=sys.stderr)
        fastest = max(best.values(), key=medians.get)
        (style, skin), last = fastest, theirs[fastest][-1]
        own = [self.refusal(configuration, refused[configuration]) if configuration in refused else self.entry(configuration, mine[configuration], rates[fastest]) for configuration in configurations]
        return compared | {
            "packing_fraction": self.fraction,
            "particles": last["particles"],
            "steps": self.steps,
            "equilibration": self.equilibration,
            "rounds": self.asked.rounds,
            "lammps": last | {"style": style, "skin": skin, "rates": rates[fastest]},
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
