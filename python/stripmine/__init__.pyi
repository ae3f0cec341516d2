"""2D particle dynamics: granular discs, hard discs, Langevin dynamics, and gravitating bodies.

Arrays are copies: writing to them changes no simulation. N is the number of particles. Quantities are in the units of the scene.
"""

import os
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, final

import numpy as np
from numpy.typing import NDArray

from ._errors import BusyError as BusyError
from ._errors import Error as Error
from ._errors import Mistake as Mistake
from ._errors import RunError as RunError
from ._errors import SceneError as SceneError
from ._errors import SimulationError as SimulationError

__all__ = [
    "BusyError",
    "Error",
    "Frame",
    "Frames",
    "Kernel",
    "Mistake",
    "Particles",
    "Run",
    "RunError",
    "Scene",
    "SceneError",
    "Simulation",
    "SimulationError",
    "Table",
    "Vector",
    "__version__",
    "average",
    "keys",
    "methods",
    "presets",
    "read",
    "scene",
    "trace",
    "where",
]

__version__: str

def scene(source: str | os.PathLike[str], overrides: dict[str, Any] | list[str] | None = None) -> Scene:
    """Reads and checks a scene, and makes its particles.

    `source` is a preset name, a file path, or the scene itself as TOML text of several lines. `overrides` changes values:
    `{"particles.count": 400}`, or by section `{"particles": {"count": 400}}`. Values are numbers, strings, True and False, lists and
    arrays. A list has strings as on the command line, `["particles.count=400"]`, like the `overrides` of a plan.

    Particles of your own are arrays of numpy, which are passed on as numbers, without a text in between: with `"particles.generate": "list"`
    discs have `"particles.positions"` (length) and `"particles.velocities"` (length/time) of shape (N, 2), and `"particles.radii"` (length),
    `"particles.masses"` (mass) and `"particles.omegas"` (1/time) of shape (N,). Bodies in space have `"particles.bodies"` of shape (N, 7): mass,
    position, velocity. NaN, another shape or length raise `SceneError` with the key and the index.

    Raises `SceneError` with every mistake at once; `TypeError` for a value that no scene can have.
    """

def read(folder: str | os.PathLike[str]) -> Run:
    """Opens the run in a folder, finished or not. Raises `RunError` if there is none."""

def average(*runs: Run) -> Table:
    """Joins the means of several runs of one scene with different seeds. Columns are those of `Run.averages`.

    Raises `RunError` if two runs are of different scenes, or are the same run.
    """

def presets() -> dict[str, str]:
    """Preset scenes of the package: name and title."""

def methods() -> list[dict[str, Any]]:
    """Methods, each with `name`, `source`, `doc` and the observed `quantities`, each with `name`, `unit` and `doc`."""

def keys(method: str | None = None) -> list[dict[str, Any]]:
    """Keys of the scenes of a method (default: "lattice-md"), as `stripmine scene keys METHOD --json` prints them.

    Each has `section`, `key`, `type`, `unit`, `default`, `required`, `used_with` and `meaning`. Raises `ValueError` for an unknown method.
    """

def trace(function: Callable[..., Vector | tuple[Vector, ...] | dict[str, Vector]]) -> Kernel:
    """Traces a function of vectors: calls it once with symbols, and records its operations as a program of the vector machine.

    `stripmine.trace(lambda x, y: (x * x + y * y).sqrt())`. Its parameters are the inputs; it returns a vector, a tuple or a dict of vectors.
    Raises `Error` for a function that branches on data, or uses values that are neither numbers nor its arguments.
    """

def where(condition: Any, a: Vector | float, b: Vector | float) -> Vector:
    """`a` where a comparison of traced vectors holds, else `b`."""

class Vector:
    """Numbers of a traced function. It has + - * /, comparisons, abs, whole powers, and numpy.sqrt of them."""

    def sqrt(self) -> Vector:
        """Square root."""

    def trunc(self) -> Vector:
        """Integer part, rounded towards zero."""

    def minimum(self, other: Vector | float) -> Vector:
        """The smaller of two; the second if one is NaN."""

    def maximum(self, other: Vector | float) -> Vector:
        """The larger of two; the second if one is NaN."""

    def shift(self, distance: int) -> Vector:
        """The elements of an input at a distance from the own ones."""

class Kernel:
    """A traced function: a program of the vector machine, with `name`, and names of its `inputs` and `outputs`."""

    name: str
    inputs: list[str]
    outputs: list[str]

    @property
    def nop(self) -> int:
        """Number of vector operations."""

    def counts(self) -> Table:
        """Operations of the program: `operation` and `count`."""

    def listing(self) -> str:
        """Vector instructions, as an assembly listing."""

    def rvv(self, lmul: int = 4) -> str:
        """Code for RISC-V's vector extension, with `lmul` vector registers as one."""

    def clocks(self, machine: str, n: int = 1000, *, command: str | os.PathLike[str] | None = None) -> Table:
        """Clock periods of `n` elements on a machine, by every clock: `clock`, `clock_periods`, `time` (s). Needs the command `stripmine`."""

    def run(
        self, *arrays: NDArray[np.float64], execution: str = "chained", **named: NDArray[np.float64]
    ) -> NDArray[np.float64] | dict[str, NDArray[np.float64]]:
        """Runs the function on arrays of float64, in the order of its parameters or by name.

        `execution` is "chained", "eager" or "strip:N"; all give the same bits. Elements without a neighbour at every shift are NaN. Returns an
        array, or a dict of arrays if the function returns several vectors.
        """

@final
class Scene:
    """Scene that was read and checked. It is immutable, and several threads can use it."""

    @property
    def method(self) -> str:
        """Name of its method: "lattice-md", "hard-disks", "langevin" or "nbody"."""

    def toml(self) -> str:
        """The scene as TOML, with every value and every choice explicit."""

    def particles(self) -> Particles:
        """Particles at the start."""

    def check(self) -> dict[str, Any]:
        """Report of `stripmine scene check --json`.

        It has the box, limits of the step, the expected memory (bytes) and time (s) of a run, `choices`, `left_out` and `warnings`. Takes
        up to half a second, since the beginning of a run is timed.
        """

    def counts(self) -> Table:
        """Whole-array operations of a step, as `stripmine scene programs --json` counts them.

        A row for each `section` of each `part` of the step: the symbol (`length`) and value (`n`, elements) of its vector length, the
        `operations` of a step (NOP of BP93), those that are `computing` rather than moving data, and `divisions_and_roots`. Empty for
        scenes without vector programs, such as hard discs.
        """

    def start(
        self,
        out: str | os.PathLike[str] | None = None,
        *,
        resume: bool = False,
        overwrite: bool = False,
        other_version: bool = False,
    ) -> Simulation:
        """Starts a simulation that is advanced step by step; any number can be started.

        With a folder `out` it is recorded as a run: `advance` writes rows, frames and checkpoints there as they are due, as `run` does, also beyond
        the end of the scene, and changes (`Simulation.set`) are logged. `resume` continues from the newest checkpoint in the folder, or starts
        if there is none; changes after that checkpoint are made again when `advance` comes to them. `overwrite` and `other_version` are those of
        `run`.

        Raises `SceneError` if memory is short, `SimulationError` if the start breaks a precondition, `RunError` if the folder cannot be used.
        """

    def run(
        self,
        out: str | os.PathLike[str] | None = None,
        *,
        resume: bool = False,
        overwrite: bool = False,
        other_version: bool = False,
    ) -> Run:
        """Runs the whole scene into the folder `out`, as `stripmine run` does.

        Without `out` the folder is temporary, and removed with its last `Run`. `resume` resumes the run in the folder, or starts it if
        there is none; `other_version` also resumes a run of another version; `overwrite` replaces a run.

        Other threads continue meanwhile. Ctrl-C ends it with `KeyboardInterrupt` and a checkpoint, from which `resume` continues if `out`
        was given.
        Raises `SimulationError` if the physics fails, `RunError` if the folder is in use or cannot be written.
        """

    def explain(
        self,
        of: str | None = None,
        error: float | str | None = None,
        *,
        time: float | None = None,
        limit: float | None = None,
        window: tuple[float, float] | None = None,
        seconds: int | None = None,
        command: str | os.PathLike[str] | None = None,
    ) -> dict[str, Any]:
        """Finds the cheapest run with a target error of a mean, by trial runs: the plan of `stripmine explain --json`.

        `of` is the quantity, by default the main one of the method. `error` is the target error of its mean (95 % confidence): a number in
        the quantity's unit, or a string such as "1%"; by default the error of the scene as it is. `time` (s) asks for the least error
        within a wall time instead. `limit` (s) is the longest wall time of a plan, by default an hour; longer plans are rejected. `window`
        is a pair of times (time) between which each run is averaged instead of over its steady state. `seconds` (s) limits the trials, by
        default to 10; their results are cached for the next call.

        Keys of the plan: `overrides` of the scene, for `stripmine.scene(scene.toml(), plan["overrides"])`; `step` and `time` (time) of each
        run; `seeds`, the number of runs with different seeds; `mean` with half of its 95 % interval; `expected`, the error with `bias` and
        `chance` (statistical error); `seconds` (s, wall time of the runs) from `least` to `most`; `decisions` with reasons.

        Needs the command: `command`, the environment variable STRIPMINE, or `stripmine` on the path, in the version of this package.
        Ctrl-C stops it with `KeyboardInterrupt`; finished trials are reused by the next call. Raises `Error` if there is no such command,
        or it finds no plan.
        """

    def compare(
        self, against: dict[str, Any], *, command: str | os.PathLike[str] | None = None
    ) -> dict[str, Any]:
        """Runs the scene in two configurations and compares them bit by bit: the data of `stripmine compare --json`.

        `against` has the keys of the second configuration: `{"search.by": "sectors"}`. The data has `same_bits`, `first_difference` (the number
        of the first sample that differs, or None) and `looks`, the samples, with the largest differences of positions and velocities. Needs the
        command, as `explain` does.
        """

    def plot(
        self,
        out: str | os.PathLike[str],
        *,
        color: str | None = None,
        overwrite: bool = False,
        command: str | os.PathLike[str] | None = None,
    ) -> list[Path]:
        """Draws the start, as `stripmine plot SCENE` does: particles, sides and plane walls. Returns the paths of the pictures (SVG and PNG).

        `out` is the folder of the pictures; `color` what colours the particles, as in `Run.plot`. Bodies in space have two pictures. Needs the
        command, as `explain` does.
        """

    def accuracy(
        self,
        of: str | None = None,
        error: float | str | None = None,
        *,
        window: tuple[float, float] | None = None,
        budget: int = 60,
        out: str | os.PathLike[str] | None = None,
        command: str | os.PathLike[str] | None = None,
    ) -> dict[str, Table]:
        """Error of a mean over the wall time of a run, for each integrator and step: the tables of `stripmine chart accuracy`.

        `points` has the curves: `configuration`, `wall_time` (s), `step` (time), and the expected `error` with its upper limit `most`, both
        in the quantity's unit. `marks` has the scene as it is and, with `error`, the plan; `biases` the bias of the mean by step; `wishes`
        the cheapest run for some target errors; `summary` one row with the mean.

        `budget` (s) is the processor time of the trials. `out` is a folder for the tables and the chart, from which interrupted trials are
        resumed; without it nothing is stored. `of`, `error`, `window`, `command` and exceptions are as in `explain`.
        """

    def scan(
        self,
        over: dict[str, Any],
        seeds: int = 1,
        until: str | None = None,
        *,
        out: str | os.PathLike[str] | None = None,
        resume: bool = False,
        overwrite: bool = False,
        command: str | os.PathLike[str] | None = None,
    ) -> Table:
        """Runs the scene over one or more keys, side by side on all cores: the table of `stripmine scan`.

        `over` has a list or an array of values for each key: `{"particles.packing_fraction": [0.1, 0.2]}`; several keys make a grid.
        `seeds` is the number of runs at each point, whose means are joined. `until` ends each run once the mean of a quantity has an error
        (95 % confidence), such as "compressibility=1%"; the duration of the scene is the latest end.

        A row for each point: the keys; for each quantity with a mean its name, with `_error_95` half of its 95 % interval, and with
        `_standard_error` its standard error (`rate_of_` before the name of a counter); the number of `runs`; and `failure`, empty if none
        failed. Missing values are NaN.

        `out` is a folder for the runs, the table and charts; without it nothing is kept. `resume` finishes what is left of a scan in the
        folder, and adds points; `overwrite` replaces its runs. Needs the command, as `explain` does. Raises `Error` if a scene is refused.
        """

@final
class Simulation:
    """Running simulation, advanced step by step. Two threads cannot use it at the same time: the second gets `BusyError`."""

    @staticmethod
    def restore(folder: str | os.PathLike[str], *, other_version: bool = False) -> Simulation:
        """Restores a simulation from the newest checkpoint in a folder, to the bit. Nothing is written there, so any number can be restored.

        `save`, a run and a recorded simulation write checkpoints. Later changes of a recorded simulation are not made again: for that use
        `scene.start(folder, resume=True)`. `other_version` also restores one of another version. Raises `RunError` if there is no checkpoint.
        """

    @property
    def folder(self) -> Path | None:
        """Folder of its run, as an absolute path; None if it is not recorded."""

    def save(self, folder: str | os.PathLike[str] | None = None, *, overwrite: bool = False) -> None:
        """Writes a checkpoint, from which `Simulation.restore` and `scene.start(folder, resume=True)` continue.

        A recorded simulation is saved in its own folder; any other needs a `folder`, which gets a row, a frame and a checkpoint of this moment.
        `overwrite` replaces a run there. Raises `RunError` if the folder cannot be written.
        """

    def finish(self) -> Run:
        """Ends a recorded simulation: writes a last checkpoint, the last frame and the summary, and returns the run."""

    def set(
        self,
        *,
        velocities: Any = None,
        angular_velocities: Any = None,
        bath_temperature: Any = None,
        gravity: Any = None,
        wall_velocities: Any = None,
    ) -> None:
        """Changes quantities at this moment, one after the other.

        `velocities` (length/time) have the shape (N, D) and `angular_velocities` (1/time) the shape (N,), in the order of `particles()`; values of
        wall discs must stay. `bath_temperature` is kT (energy), and `gravity` an acceleration (length/time²) of shape (2,).
        `wall_velocities` (length/time) have a row for each table [[walls]], without oscillations; rows of walls that a force drives stay 0. Granular
        discs have velocities, angular velocities (with friction), gravity and velocities of walls, hard discs velocities and gravity (along closed sides), Langevin particles
        velocities and the temperature of their bath, bodies velocities.

        The integrator restarts at this state, as at the start of a scene. The work of a change is counted apart: energy errors and balances leave it
        out, and `summary.json` has it as `work_of_changes`. Means of hard discs since the last row begin at the change.

        A recorded simulation logs each change in `changes.csv`, exact to the bit. If it resumes from an earlier checkpoint, also with
        `scene.run` or `stripmine run --resume`, the change is made again, and the results have the same bits.

        Raises `Error` with the reason and a remedy if the method has no such quantity, for NaN and for another shape; that quantity and later
        ones are not changed.
        """

    def advance(
        self, *, steps: int | None = None, time: float | None = None, events: int | None = None
    ) -> None:
        """Advances by a number of steps, by a time (time), or by a number of events.

        Hard discs have no steps; they advance by a time, which is reached exactly, or by events. The other methods end with the first step
        that reaches the time. Any pieces give the same bits and number of steps as one: times add up without rounding.

        Other threads continue meanwhile. Ctrl-C ends the call with `KeyboardInterrupt`; the simulation can continue from there. Raises
        `SimulationError` if the physics fails; the state of the failed step can be read, and further calls raise the same error.
        """

    def observe(self) -> dict[str, float]:
        """Values of the quantities of the method, by name: the columns of `thermo.csv`, in the units `units`.

        `compressibility` and `collision_rate` of hard discs are means since the start, or since the last change; rows, and recorded simulations,
        have them since the previous row.
        """

    @property
    def units(self) -> dict[str, str]:
        """Units of the quantities, such as "energy" or "length/time"; empty for pure numbers."""

    def particles(self) -> Particles:
        """Current particles, positions inside the box, without particles that a bath has lost."""

    def forces(self) -> NDArray[np.float64]:
        """Sum of the pair forces on each particle, shape (N, 2) (force), in the order of `particles()`.

        Excludes gravity, the bath and closed sides. Raises `Error` for methods without such forces (hard discs and bodies).
        """

    def warnings(self) -> list[str]:
        """Warnings about suspicious events so far."""

    @property
    def time(self) -> float:
        """Time since the start (time)."""

    @property
    def step(self) -> int:
        """Steps since the start; 0 for hard discs."""

    @property
    def events(self) -> int:
        """Events since the start; 0 for methods with steps."""

@final
class Particles:
    """Particles at one time, as arrays: moving particles first, then wall discs. D is 2, or 3 for bodies in space."""

    @property
    def id(self) -> NDArray[np.uint32]:
        """Unique, permanent number of each particle; shape (N,)."""

    @property
    def wall(self) -> NDArray[np.bool_]:
        """True for wall discs, which no force moves; shape (N,)."""

    @property
    def positions(self) -> NDArray[np.float64]:
        """Centres (length), shape (N, D)."""

    @property
    def velocities(self) -> NDArray[np.float64]:
        """Velocities (length/time), shape (N, D)."""

    @property
    def angle(self) -> NDArray[np.float64]:
        """Angles (radian), counter-clockwise, shape (N,); 0 in frames, which store none."""

    @property
    def angular_velocity(self) -> NDArray[np.float64]:
        """Angular velocities (1/time), counter-clockwise, shape (N,)."""

    @property
    def radius(self) -> NDArray[np.float64]:
        """Radii (length), shape (N,)."""

    @property
    def mass(self) -> NDArray[np.float64]:
        """Masses (mass), shape (N,)."""

    def __len__(self) -> int: ...

@final
class Run:
    """Run in its folder. Its files are read when they are requested."""

    @property
    def folder(self) -> Path:
        """Absolute path of the folder."""

    def thermo(self) -> Table:
        """Rows of `thermo.csv`: `step` (for hard discs the number of events), `time`, and the quantities of the method."""

    def averages(self) -> Table:
        """Mean of each quantity with its error, a row for each, as `stripmine average` finds them.

        `says` is "mean", "constant", "too-short", "changing", "kept" or "undefined", and decides which columns have values; others are
        NaN. `bar` is half the width of the 95 % confidence interval of the mean. `unit` is that of mean, bar, errors, first and last.
        """

    def frames(self) -> Frames:
        """Frames of `trajectory.xyz`, or of `trajectory.gsd` if that has none, each read when it is requested."""

    def toml(self) -> str:
        """The scene as TOML, with every value and every choice explicit."""

    def plot(
        self,
        columns: str | list[str] | None = None,
        *,
        color: str | None = None,
        out: str | os.PathLike[str] | None = None,
        overwrite: bool = False,
        command: str | os.PathLike[str] | None = None,
    ) -> list[Path]:
        """Draws the run, as `stripmine plot` does, and returns the paths of the pictures (SVG and PNG).

        `columns` names columns of `thermo.csv`, by default all that change; `color` what colours the particles. `out` is the folder of the
        pictures, by default beside the run's, with `.plots` added. Needs the command, as `Scene.explain` does. Raises `Error` if it draws nothing.
        """

    def film(
        self,
        *,
        color: str | None = None,
        out: str | os.PathLike[str] | None = None,
        overwrite: bool = False,
        command: str | os.PathLike[str] | None = None,
    ) -> Path:
        """Makes the film of the trajectory beside the pictures of `plot`, a page for a browser, and returns its path."""

    def summary(self) -> dict[str, Any]:
        """Contents of `summary.json`. Raises `RunError` before the run has ended."""

@final
class Frames(Iterator[Frame]):
    """Frames of a trajectory."""

    def __iter__(self) -> Frames: ...
    def __next__(self) -> Frame: ...

@final
class Frame:
    """Particles in their box at one time."""

    @property
    def time(self) -> float:
        """Time since the start (time)."""

    @property
    def step(self) -> int:
        """Steps since the start; for hard discs the number of events."""

    @property
    def particles(self) -> Particles:
        """The particles."""

    @property
    def sides(self) -> list[float]:
        """Sides of the box along x and y (length); infinite without a box."""

    @property
    def origin(self) -> list[float]:
        """Lower left corner of the box (length)."""

    @property
    def periodic(self) -> list[bool] | None:
        """True where the box is periodic, along x and along y."""

@final
class Table:
    """Table of columns of equal length.

    `table["name"]` is a column as an array. Programs with the Arrow PyCapsule interface read the whole table, with units in the fields'
    metadata: `polars.DataFrame(table)`, `pyarrow.table(table)`, `pandas.DataFrame.from_arrow(table)`.
    """

    @property
    def columns(self) -> list[str]:
        """Names of the columns."""

    @property
    def units(self) -> dict[str, str]:
        """Units of the columns; empty for pure numbers and strings."""

    def to_dict(self) -> dict[str, NDArray[Any]]:
        """All columns as arrays of shape (rows,), by name."""

    def to_pandas(self) -> Any:
        """Converts to a `pandas.DataFrame`; needs pandas."""

    def __getitem__(self, name: str, /) -> NDArray[Any]: ...
    def __contains__(self, name: str, /) -> bool: ...
    def __len__(self) -> int: ...
    def __arrow_c_stream__(self, requested_schema: object | None = None) -> object: ...
