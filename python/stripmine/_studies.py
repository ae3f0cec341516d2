"""Studies of a scene, made by the command `stripmine`: the package links the physics, but not the laboratory."""

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
# File name of the scene in its temporary folder.
_SCENE = "scene.toml"
# Name of the study of means, and path of its tables.
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
    """The type of a column. Missing values make it "numbers"."""
    if any(isinstance(value, str) for value in values):
        return "words"
    return "counts" if values and all(isinstance(value, int) for value in values) else "numbers"


def _printed(scene, verb, options, window, folder, command):
    """The JSON that a verb of the command prints for a scene. The command runs in an existing folder with the scene file."""
    options = [f"--{name}={value}" for name, value in options.items() if value is not None]
    if window is not None:
        options += ["--window", *map(str, window)]
    (folder / _SCENE).write_text(scene.toml(), encoding="utf-8")
    return printed_data([*verb, _SCENE, *options], folder, command)


def printed_data(arguments, folder, command):
    """The JSON that the command prints in a folder."""
    program = _program(command)
    code, printed, said = _run([program, *arguments, "--json"], folder)
    for line in said.splitlines():
        if line.startswith("warning: "):
            warnings.warn(line.removeprefix("warning: "), stacklevel=3)
    try:
        data = json.loads(printed)
    except ValueError:
        data = {}
    if code == 0 and data:
        return data
    # A plan has a number under this name.
    failure = data.get("error")
    if not isinstance(failure, dict):
        raise Error(f"{program} failed with exit code {code}: {said.strip()}", "input-output")
    raise _error(failure["message"], failure["remedy"], failure["kind"])


def _error(message, remedy, kind="usage"):
    return Error(f"{message}\n  help: {remedy}" if remedy else message, kind, remedy)


def _program(command):
    """Path of the command, which must have the version of this package."""
    named = os.fspath(command or os.environ.get("STRIPMINE") or "stripmine")
    remedy = "install it from the checkout of this package (cargo install --path .), or pass its path as command="
    program = shutil.which(named)
    if program is None:
        raise _error(f"the command {named} was not found", remedy)
    program = os.path.abspath(program)
    _, version, _ = _run([program, "--version"], None)
    if version.split() != ["stripmine", _stripmine.__version__]:
        known = version.strip()[:80]
        raise _error(f"{program} is {known!r}; this package needs stripmine {_stripmine.__version__}", remedy)
    return program


def _run(arguments, folder):
    """Exit code, output and error text of a program."""
    pipes = {"stdin": subprocess.DEVNULL, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    # In its own process group, so that Ctrl-C reaches it once: a second signal would end it before it has stored its trials.
    group = {"process_group": 0} if _IS_POSIX else {}
    try:
        process = subprocess.Popen(arguments, cwd=folder, encoding="utf-8", errors="replace", **pipes, **group)
    except OSError as cause:
        raise Error(f"{arguments[0]} cannot be run: {cause.strerror}", "input-output") from cause
    printed, said = _ended(process)
    return process.returncode, printed, said


def _ended(process):
    """Output and error text of a process until its end. Forwards Ctrl-C to it."""
    try:
        return process.communicate()
    except KeyboardInterrupt:
        # On other systems it has received the signal itself.
        if _IS_POSIX:
            process.send_signal(signal.SIGINT)
        _ended(process)
        raise
