"""Provenance of results, the check that they may replace committed ones, and the folder that they are written to."""

import datetime
import functools
import json
import pathlib
import platform
import shlex
import subprocess
import sys

# Sources of the results, from the top of the checkout: without these results, which the source ships.
SOURCES = [f":/{name}" for name in ("src", "kernels", "build.rs", "Cargo.toml", "Cargo.lock", "tests/rivals")]
SOURCES.append(":(exclude,top)src/study/rivals/measured")


def git(folder, *arguments):
    """Output of git in a folder; empty without git or a checkout."""
    try:
        done = subprocess.run(["git", "-C", str(folder), *arguments], capture_output=True, text=True)
    except OSError:
        return ""
    return done.stdout.strip() if done.returncode == 0 else ""


def is_traceable(out):
    """True if results may be written there: only a committed source may overwrite committed results."""
    changed = git(pathlib.Path(__file__).parent, "status", "--porcelain", "--", *SOURCES)
    return not (changed and git(out, "ls-files", "--", "."))


def refusal(out, program):
    """Exit code of a script that may not write its results to a folder, or lacks the program; else none. The reason is printed."""
    if out and not is_traceable(out):
        print(f"error: the results in {out} are committed, but this checkout has uncommitted changes", file=sys.stderr)
        print("  help: commit them and build again, or choose another --out", file=sys.stderr)
        return 2
    if not pathlib.Path(program).exists():
        print(f"skipped: {program} does not exist: cargo build --release")
        return 0
    return None


@functools.cache
def provenance():
    """Provenance of results: the commit of this checkout before any result is written, the whole command line, the processor."""
    commit = git(pathlib.Path(__file__).parent, "describe", "--always", "--dirty", "--abbrev=12") or None
    listed = pathlib.Path("/proc/cpuinfo")
    lines = listed.read_text().splitlines() if listed.exists() else []
    names = [line.split(":")[1].strip() for line in lines if line.startswith("model name")]
    host = names[0] if names else platform.processor()
    return {"date": datetime.date.today().isoformat(), "commit": commit, "command": shlex.join(["python3", *sys.argv]), "host": host}


def write(folder, files):
    """Writes files into their own folder, with a list of them and their provenance."""
    source = provenance()
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in files.items():
        (folder / name).write_text(text, encoding="utf-8")
    listed = {**source, "files": sorted(["provenance.json", *files])}
    (folder / "provenance.json").write_text(json.dumps(listed, indent=2) + "\n")
