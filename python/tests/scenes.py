"""One short scene of each method, and the command where there is one."""

import os
import shutil

# Preset, overrides for a short run, and rows of it.
SHORT = {
    "pipe-small": {"run.steps": 60, "run.thermo_every": 20, "run.snapshot_every": 30},
    "dense-gas": {"particles.count": 200, "run.steps": 60, "run.thermo_every": 20, "run.snapshot_every": 30},
    "langevin-dense": {"particles.count": 200, "run.steps": 60, "run.thermo_every": 20, "run.snapshot_every": 30},
    "cold-collapse": {"particles.count": 64, "run.steps": 60, "run.thermo_every": 20, "run.snapshot_every": 30},
    "hard-disks": {"particles.count": 200, "run": {"time": 6.0, "thermo_every": 2.0, "snapshot_every": 3.0}},
}


def command():
    """The command `stripmine`: that of the environment variable STRIPMINE, or the one on the path; None without."""
    return os.environ.get("STRIPMINE") or shutil.which("stripmine")


def flat(overrides):
    """Overrides as the command takes them."""
    arguments = []
    for name, value in overrides.items():
        keys = {f"{name}.{key}": inner for key, inner in value.items()} if isinstance(value, dict) else {name: value}
        for key, value in keys.items():
            arguments += ["--set", f"{key}={value}"]
    return arguments
