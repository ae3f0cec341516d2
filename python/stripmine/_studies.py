"""Studies of a scene, carried out by the command `stripmine`: the package itself links the physics, and not the laboratory."""

import json
import os
import shutil
import signal
import subprocess
import tempfile
import warnings
from pathlib import Path

from . import _stripmine
from ._errors import Error

_IS_POSIX = os.name == "posix"
# The scene's file, in a folder of its own.
_SCENE = "scene.toml"
# A study of means, and where its folder has the tables.
_ACCURACY = "accuracy"
_TABLES = Path("host", _ACCURACY)


def explain(scene, of=None, error=None, *, time=None, limit=None, window=None, seconds=None, command=None):
    """The plan that the command prints."""
    options = {"of": of, "error": error, "time": time, "limit": limit, "seconds": seconds}
    with tempfile.TemporaryDirectory(prefix="stripmine-") as folder:
        return _printed(scene, ["explain"], options, window, Path(folder), command)


def accuracy(scene, of=None, error=None, *, window=None, budget=60, out=None, command=None):
    """The tables that the command writes, by name."""
    with tempfile.TemporaryDirectory(prefix="stripmine-") as folder:
        out = Path(folder, _ACCURACY) if out is None else Path(out).absolute()
        options = {"of": of, "error": error, "budget": budget, "out": out}
        rows = _printed(scene, ["chart", _ACCURACY], options, window, Path(folder), command)
        described = json.loads((out / _TABLES / "datapackage.json").read_text(encoding="utf-8"))
    fields = {resource["path"]: resource["schema"]["fields"] for resource in described["resources"]}
    return {name: _table(fields[f"{name}.csv"], rows[name]) for name in rows}


def _table(fields, rows):
    """Rows as a table, with the units of their fields."""
    columns = [(field["name"], field.get("unit", ""), [row[field["name"]] for row in rows]) for field in fields]
    return _stripmine._table([(name, unit, _type(values), values) for name, unit, values in columns])


def _type(values):
    """The type of a column. Values that are missing are no numbers."""
    if any(isinstance(value, str) for value in values):
        return "words"
    return "counts" if values and all(isinstance(value, int) for value in values) else "numbers"


def _printed(scene, verb, options, window, folder, command):
    """The JSON that a verb of the command prints for a scene. The command works in a folder that exists, where it finds the scene."""
    options = [f"--{name}={value}" for name, value in options.items() if value is not None]
    if window is not None:
        options += ["--window", *map(str, window)]
    program = _program(command)
    (folder / _SCENE).write_text(scene.toml(), encoding="utf-8")
    code, printed, said = _run([program, *verb, _SCENE, *options, "--json"], folder)
    for line in said.splitlines():
        if line.startswith("warning: "):
            warnings.warn(line.removeprefix("warning: "), stacklevel=3)
    try:
        data = json.loads(printed)
    except ValueError:
        data = {}
    if code == 0 and data:
        return data
    # Under this name a plan has a number.
    failure = data.get("error")
    if not isinstance(failure, dict):
        raise Error(f"{program} ended with {code}: {said.strip()}", "input-output")
    raise _error(failure["message"], failure["remedy"], failure["kind"])


def _error(message, remedy, kind="usage"):
    return Error(f"{message}\n  help: {remedy}" if remedy else message, kind, remedy)


def _program(command):
    """The path of the command, which is of the version of this package."""
    named = os.fspath(command or os.environ.get("STRIPMINE") or "stripmine")
    remedy = "install it from the checkout of this package, cargo install --path ., or pass its path as command="
    program = shutil.which(named)
    if program is None:
        raise _error(f"the command {named} is needed for this, and was not found", remedy)
    program = os.path.abspath(program)
    _, version, _ = _run([program, "--version"], None)
    if version.split() != ["stripmine", _stripmine.__version__]:
        known = version.strip()[:80]
        raise _error(f"{program} is {known!r}, and this package needs stripmine {_stripmine.__version__}", remedy)
    return program


def _run(arguments, folder):
    """Exit code, output and error text of a program."""
    pipes = {"stdin": subprocess.DEVNULL, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    # In a group of its own, so that Ctrl-C of a terminal reaches it once: a second one would end it before it has kept its trials.
    group = {"process_group": 0} if _IS_POSIX else {}
    try:
        process = subprocess.Popen(arguments, cwd=folder, encoding="utf-8", errors="replace", **pipes, **group)
    except OSError as cause:
        raise Error(f"{arguments[0]} cannot be run: {cause.strerror}", "input-output") from cause
    printed, said = _ended(process)
    return process.returncode, printed, said


def _ended(process):
    """Output and error text of a process until its end. Ctrl-C is passed on to it."""
    try:
        return process.communicate()
    except KeyboardInterrupt:
        # Elsewhere it has heard of it by itself.
        if _IS_POSIX:
            process.send_signal(signal.SIGINT)
        _ended(process)
        raise
