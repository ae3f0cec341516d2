"""Where results come from, whether they may be written over committed ones, and the folder they are written to."""

import datetime
import functools
import json
import pathlib
import platform
import shlex
import subprocess
import sys

# What the results depend on, from the top of the checkout: the source without these results, which it ships.
SOURCES = [f":/{name}" for name in ("src", "kernels", "build.rs", "Cargo.toml", "Cargo.lock", "tests/rivals")]
SOURCES.append(":(exclude,top)src/study/rivals/measured")


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


@functools.cache
def provenance():
    """Where results come from: the commit of this checkout, before any result is written there, the whole command line, the processor."""
    commit = git(pathlib.Path(__file__).parent, "describe", "--always", "--dirty", "--abbrev=12") or None
    listed = pathlib.Path("/proc/cpuinfo")
    lines = listed.read_text().splitlines() if listed.exists() else []
    names = [line.split(":")[1].strip() for line in lines if line.startswith("model name")]
    host = names[0] if names else platform.processor()
    return {"date": datetime.date.today().isoformat(), "commit": commit, "command": shlex.join(["python3", *sys.argv]), "host": host}


def write(folder, files):
    """Writes files into a folder of their own, beside the list of them and where they come from."""
    source = provenance()
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in files.items():
        (folder / name).write_text(text, encoding="utf-8")
    listed = {**source, "files": sorted(["provenance.json", *files])}
    (folder / "provenance.json").write_text(json.dumps(listed, indent=2) + "\n")
