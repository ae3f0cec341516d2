"""Short scenes of each method, and the command, if available."""

import os
import shutil

# Presets, with overrides for a short run of a few rows.
SHORT = {
    "pipe-small": {"run.steps": 60, "run.thermo_every": 20, "run.snapshot_every": 30},
    "dense-gas": {"particles.count": 200, "run.steps": 60, "run.thermo_every": 20, "run.snapshot_every": 30},
    "langevin-dense": {"particles.count": 200, "run.steps": 60, "run.thermo_every": 20, "run.snapshot_every": 30},
    "cold-collapse": {"particles.count": 64, "run.steps": 60, "run.thermo_every": 20, "run.snapshot_every": 30},
    "hard-disks": {"particles.count": 200, "run": {"time": 6.0, "thermo_every": 2.0, "snapshot_every": 3.0}},
}


def command():
    """Path of the command `stripmine`, from the environment variable STRIPMINE or the path; None if there is none."""
    return os.environ.get("STRIPMINE") or shutil.which("stripmine")


def flat(overrides):
    """Overrides as command-line arguments."""
    arguments = []
    for name, value in overrides.items():
        keys = {f"{name}.{key}": inner for key, inner in value.items()} if isinstance(value, dict) else {name: value}
        for key, value in keys.items():
            arguments += ["--set", f"{key}={value}"]
    return arguments
