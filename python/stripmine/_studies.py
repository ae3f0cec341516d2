"""Studies of a scene, made by the command `stripmine`: the package links the physics, but not the laboratory."""

import json
import os
import shutil
import signal
import subprocess
import tempfile
import warnings
from contextlib import contextmanager
from pathlib import Path

from . import _stripmine
from ._errors import Error

_IS_POSIX = os.name == "posix"
# File name of the scene in its temporary folder.
_SCENE = "scene.toml"
# Name of the study of means, and path of its tables.
_ACCURACY = "accuracy"
_TABLES = Path("host", _ACCURACY)


class OfScene:
    """Methods of `Scene`."""

    def explain(self, of=None, error=None, *, time=None, limit=None, window=None, seconds=None, command=None):
        """Plan of `stripmine explain --json`."""
        options = {"of": of, "error": error, "time": time, "limit": limit, "seconds": seconds, "window": _pair(window)}
        with _scene_file(self) as (folder, _):
            return printed_data(["explain", _SCENE, *_arguments(options)], folder, command)

    def compare(self, against, *, command=None):
        """Comparison of `stripmine compare --json`."""
        options = {"against": [f"{key}={_value(value)}" for key, value in against.items()]}
        with _scene_file(self) as (folder, _):
            return printed_data(["compare", _SCENE, *_arguments(options)], folder, command)

    def accuracy(self, of=None, error=None, *, window=None, budget=60, out=None, command=None):
        """Tables of `stripmine chart accuracy`, by name."""
        with _scene_file(self, out) as (folder, out):
            options = {"of": of, "error": error, "budget": budget, "out": out, "window": _pair(window)}
            rows = printed_data(["chart", _ACCURACY, _SCENE, *_arguments(options)], folder, command)
            described = json.loads((out / _TABLES / "datapackage.json").read_text(encoding="utf-8"))
        fields = {resource["path"]: resource["schema"]["fields"] for resource in described["resources"]}
        return {name: _table(fields[f"{name}.csv"], rows[name]) for name in rows}

    def scan(self, over, seeds=1, until=None, *, out=None, resume=False, overwrite=False, command=None):
        """Table of `stripmine scan`."""
        with _scene_file(self, out) as (folder, out):
            options = {"seeds": seeds if seeds > 1 else None, "until": until, "out": out}
            options |= {"over": [f"{key}={_listed(key, values)}" for key, values in over.items()], "resume": resume, "overwrite": overwrite}
            scanned = printed_data(["scan", _SCENE, *_arguments(options)], folder, command, is_partial=True)
        points = scanned["points"]
        columns = [(it["key"], it["unit"], [point["values"][at] for point in points]) for at, it in enumerate(scanned["keys"])]
        columns = [(name, unit, _type(values), values) for name, unit, values in columns]
        for name, unit, values in _means(points):
            columns.append((name, unit, "numbers", values))
        reasons = [(point["failure"] or {}).get("message", "") for point in points]
        columns += [("runs", "", "counts", [len(point["folders"]) for point in points]), ("failure", "", "words", reasons)]
        return _stripmine._table(columns)

    def plot(self, out, *, color=None, overwrite=False, command=None):
        """Pictures of the start by `stripmine plot`."""
        with _scene_file(self, out) as (folder, out):
            return _drawn(_SCENE, {"color": color, "out": out, "overwrite": overwrite}, folder, command)


class OfRun:
    """Methods of `Run`."""

    def plot(self, columns=None, *, color=None, out=None, overwrite=False, command=None):
        """Pictures of `stripmine plot`."""
        columns = None if columns is None else ",".join([columns] if isinstance(columns, str) else columns)
        options = {"columns": columns, "color": color, "out": _beside(self, out), "overwrite": overwrite}
        return _drawn(self.folder, options, self.folder, command)

    def film(self, *, color=None, out=None, overwrite=False, command=None):
        """Film of `stripmine plot --film`."""
        options = {"color": color, "out": _beside(self, out), "film": True, "overwrite": overwrite}
        return _drawn(self.folder, options, self.folder, command)[-1]


def register():
    """Gives the classes of the physics their methods."""
    for kind, methods in ((_stripmine.Scene, OfScene), (_stripmine.Run, OfRun)):
        for name, method in vars(methods).items():
            if not name.startswith("_"):
                setattr(kind, name, method)


@contextmanager
def _scene_file(scene, out=None):
    """A temporary folder with the file of a scene, and the path of the folder for results: `out`, or one in it."""
    with tempfile.TemporaryDirectory(prefix="stripmine-") as folder:
        folder = Path(folder)
        (folder / _SCENE).write_text(scene.toml(), encoding="utf-8")
        yield folder, folder / "out" if out is None else Path(out).absolute()


def _beside(run, out):
    """Path of the folder for the pictures of a run, by default beside that of the run."""
    if out is not None:
        return Path(out).absolute()
    if run._is_temporary:
        raise Error("the run is in a temporary folder\n  help: pass out=, a folder for the pictures", "usage")
    folder = Path(run.folder)
    return folder.with_name(f"{folder.stem}.plots")


def _drawn(what, options, folder, command):
    """Paths of the files that `plot` writes."""
    return [Path(file) for file in printed_data(["plot", str(what), *_arguments(options)], folder, command)["files"]]


def _arguments(options):
    """Options as the command takes them: none for None and False, a flag for True, one for each item of a list, a pair as two words."""
    for name, value in options.items():
        match value:
            case None | False:
                pass
            case True:
                yield f"--{name}"
            case tuple():
                yield from (f"--{name}", *map(str, value))
            case _:
                yield from (f"--{name}={each}" for each in (value if isinstance(value, list) else [value]))


def _pair(window):
    return None if window is None else tuple(window)


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
