"""Where results come from, and whether they may be written over committed ones."""

import pathlib
import platform
import shlex
import subprocess
import sys

# What the results depend on, from the top of the checkout.
SOURCES = [f":/{name}" for name in ("src", "kernels", "build.rs", "Cargo.toml", "Cargo.lock", "tests/rivals")]


def git(folder, *arguments):
    """What git says in a folder; nothing where there is no git, or no checkout."""
    try:
        done = subprocess.run(["git", "-C", str(folder), *arguments], capture_output=True, text=True)
    except OSError:
        return ""
    return done.stdout.strip() if done.returncode == 0 else ""


def is_traceable(out):
    """Whether results may go there: over committed ones only those of a committed source."""
    changed = git(pathlib.Path(__file__).parent, "status", "--porcelain", "--", *SOURCES)
    return not (changed and git(out, "ls-files", "--", "."))


def provenance():
    """Where results come from: the commit of this checkout, the whole command line, the processor."""
    commit = git(pathlib.Path(__file__).parent, "describe", "--always", "--dirty", "--abbrev=12") or None
    listed = pathlib.Path("/proc/cpuinfo")
    lines = listed.read_text().splitlines() if listed.exists() else []
    names = [line.split(":")[1].strip() for line in lines if line.startswith("model name")]
    host = names[0] if names else platform.processor()
    return {"commit": commit, "command": shlex.join(["python3", *sys.argv]), "host": host}
