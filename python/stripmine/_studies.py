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


def scan(scene, over, seeds=1, until=None, *, out=None, resume=False, overwrite=False, command=None):
    """The means over some keys that the command finds, as one table."""
    with tempfile.TemporaryDirectory(prefix="stripmine-") as folder:
        out = Path(folder, "scan") if out is None else Path(out).absolute()
        options = {"seeds": seeds if seeds > 1 else None, "until": until, "out": out}
        flags = [f"--{name}" for name, given in {"resume": resume, "overwrite": overwrite}.items() if given]
        axes = [f"--over={key}={_listed(key, values)}" for key, values in over.items()]
        scanned = _printed(scene, ["scan"], options, None, Path(folder), command, [*axes, *flags], is_partial=True)
    points = scanned["points"]
    columns = [(it["key"], it["unit"], [point["values"][at] for point in points]) for at, it in enumerate(scanned["keys"])]
    columns = [(name, unit, _type(values), values) for name, unit, values in columns]
    for name, unit, values in _means(points):
        columns.append((name, unit, "numbers", values))
    reasons = [(point["failure"] or {}).get("message", "") for point in points]
    columns += [("runs", "", "counts", [len(point["folders"]) for point in points]), ("failure", "", "words", reasons)]
    return _stripmine._table(columns)


def compare(scene, against, *, command=None):
    """The comparison that the command prints."""
    overrides = [f"--against={key}={_value(value)}" for key, value in against.items()]
    with tempfile.TemporaryDirectory(prefix="stripmine-") as folder:
        return _printed(scene, ["compare"], {}, None, Path(folder), command, overrides)


def plot(run, columns=None, *, color=None, out=None, overwrite=False, command=None):
    """Paths of the pictures that the command draws."""
    columns = None if columns is None else ",".join([columns] if isinstance(columns, str) else columns)
    return _drawn(run, {"columns": columns, "color": color}, [], out, overwrite, command)


def film(run, *, color=None, out=None, overwrite=False, command=None):
    """Path of the film that the command makes."""
    return _drawn(run, {"color": color}, ["--film"], out, overwrite, command)[-1]


def _drawn(run, options, flags, out, overwrite, command):
    """Paths of the files that `plot` writes for a run, by default to a folder beside that of the run."""
    folder = Path(run.folder)
    if out is None and run._is_temporary:
        raise Error("the run is in a temporary folder\n  help: pass out=, a folder for the pictures", "usage")
    out = folder.with_name(f"{folder.stem}.plots") if out is None else Path(out).absolute()
    options = [f"--{name}={value}" for name, value in {**options, "out": out}.items() if value is not None]
    flags = [*flags, "--overwrite"] if overwrite else flags
    return [Path(file) for file in printed_data(["plot", str(folder), *options, *flags], folder, command)["files"]]


def _value(value):
    """A value of a key as the command takes it."""
    return json.dumps(value.tolist() if hasattr(value, "tolist") else value)


def _listed(key, values):
    """Values of a key as the command takes them."""
    texts = [_value(value) for value in values]
    if not texts:
        raise ValueError(f"{key} has no values: expected a list of at least one")
    return ",".join(texts)


def _means(points):
    """Columns of all quantities that have a mean, or are constant, at a point: the mean, and the errors that it has."""
    averages = [point["averages"] for point in points]
    for at, quantity in enumerate(next(filter(None, averages), {"quantities": []})["quantities"]):
        found = [it["quantities"][at] if it else {} for it in averages]
        # Other outcomes than a mean have numbers of the same names.
        found = [it if it.get("says") in ("mean", "constant") else {} for it in found]
        if any(found):
            name = f"rate_of_{quantity['quantity']}" if quantity["of"] == "rate" else quantity["quantity"]
            for ending, key in [("", "mean"), ("_error_95", "bar"), ("_standard_error", "standard_error")]:
                yield name + ending, quantity["unit"], [it.get(key) for it in found]


def _table(fields, rows):
    """Rows as a table, with the units of their fields."""
    columns = [(field["name"], field.get("unit", ""), [row[field["name"]] for row in rows]) for field in fields]
    return _stripmine._table([(name, unit, _type(values), values) for name, unit, values in columns])


def _type(values):
    """The type of a column. Missing values make it "numbers"."""
    if any(isinstance(value, str) for value in values):
        return "words"
    return "counts" if values and all(isinstance(value, int) for value in values) else "numbers"


def _printed(scene, verb, options, window, folder, command, more=(), is_partial=False):
    """The JSON that a verb of the command prints for a scene. The command runs in an existing folder with the scene file."""
    options = [f"--{name}={value}" for name, value in options.items() if value is not None]
    if window is not None:
        options += ["--window", *map(str, window)]
    (folder / _SCENE).write_text(scene.toml(), encoding="utf-8")
    return printed_data([*verb, _SCENE, *options, *more], folder, command, is_partial)


def printed_data(arguments, folder, command, is_partial=False):
    """The JSON that the command prints in a folder. A partial result counts, although the command fails."""
    program = _program(command)
    code, printed, said = _run([program, *arguments, "--json"], folder)
    for line in said.splitlines():
        if line.startswith("warning: "):
            warnings.warn(line.removeprefix("warning: "), stacklevel=3)
    try:
        data = json.loads(printed)
    except ValueError:
        data = {}
    if data and (code == 0 or is_partial and "error" not in data):
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
