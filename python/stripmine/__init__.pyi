"""2D particle dynamics: granular discs, hard discs, Langevin dynamics, and bodies that attract each other.

Arrays are copies: writing to one changes no simulation. N is the number of particles. Quantities are in the units of the scene.
"""

import os
from collections.abc import Iterator
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
    "Mistake",
    "Particles",
    "Run",
    "RunError",
    "Scene",
    "SceneError",
    "Simulation",
    "SimulationError",
    "Table",
    "__version__",
    "average",
    "keys",
    "methods",
    "presets",
    "read",
    "scene",
]

__version__: str

def scene(source: str | os.PathLike[str], overrides: dict[str, Any] | list[str] | None = None) -> Scene:
    """Reads and checks a scene, and makes its particles.

    `source` is a preset's name, a file's path, or the scene itself as a text in TOML of several lines. `overrides` says what is to be
    otherwise: `{"particles.count": 400}`, or section by section `{"particles": {"count": 400}}`. Values are numbers, texts, True
    and False, lists and arrays; `{"particles.positions": xy}` takes an array of shape (N, 2) (length). A list holds texts as the
    command line takes them: `["particles.count=400"]`, as the `overrides` of a plan.

    Raises `SceneError` with every mistake at once; `TypeError` for a value that no scene can have.
    """

def read(folder: str | os.PathLike[str]) -> Run:
    """The run in a folder, finished or not. Raises `RunError` where there is none."""

def average(*runs: Run) -> Table:
    """The means of several runs of one scene with seeds of their own, joined. Columns are those of `Run.averages`.

    Raises `RunError` where two of them are not of one scene, or are the same run twice.
    """

def presets() -> dict[str, str]:
    """The scenes that come with the package: name, and what it shows."""

def methods() -> list[dict[str, Any]]:
    """The methods, each with `name`, `source`, `doc`, and `quantities`: what it observes, each with `name`, `unit` and `doc`."""

def keys(method: str | None = None) -> list[dict[str, Any]]:
    """Every key of the scenes of a method, as `stripmine scene keys METHOD --json` prints it.

    Each has `section`, `key`, `type`, `unit`, `default`, `required`, `used_with` and `meaning`. Without a method those of
    "lattice-md". Raises `ValueError` for a method that there is not.
    """

@final
class Scene:
    """A scene that was read and checked. It is never changed, and may be used by several threads."""

    @property
    def method(self) -> str:
        """The name of its method: "lattice-md", "hard-disks", "langevin" or "nbody"."""

    def toml(self) -> str:
        """The scene as TOML, every value spelled out and every choice made."""

    def particles(self) -> Particles:
        """The particles at the start."""

    def check(self) -> dict[str, Any]:
        """What there is to be said of the scene, as `stripmine scene check --json` prints it.

        Among it the box, limits of the step, the memory (bytes) and the time (s) that a run is expected to take, `choices`,
        `left_out` and `warnings`. Takes up to half a second: the beginning of a run is timed.
        """

    def counts(self) -> Table:
        """The whole-array operations of a step, as `stripmine scene programs --json` counts them.

        A row for each `section` of each `part` of the step: what its vectors are as long as (`length`) and how long that is (`n`, elements),
        the `operations` of a step (the NOP of BP93), those of them that are `computing` and move no data, and `divisions_and_roots`. No
        rows where a scene has no such programs, as hard discs have none.
        """

    def start(self) -> Simulation:
        """Begins a simulation that is advanced step by step; any number of them may be begun.

        Raises `SceneError` where the machine has not the memory, `SimulationError` where the start breaks a precondition.
        """

    def run(
        self,
        out: str | os.PathLike[str] | None = None,
        *,
        resume: bool = False,
        overwrite: bool = False,
        other_version: bool = False,
    ) -> Run:
        """Runs the scene as a whole, as `stripmine run` does, into the folder `out`.

        Without `out` the folder is a temporary one, which goes with the last `Run` that is of it. `resume` goes on with the run in the
        folder, or begins where there is none; `other_version` goes on also where another version began it; `overwrite` begins again.

        Other threads go on meanwhile. Ctrl-C ends it with `KeyboardInterrupt` and a checkpoint, from which `resume` goes on where `out` was
        given.
        Raises `SimulationError` where the physics fails, `RunError` where the folder is not free or cannot be written.
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
        """The cheapest run that gives a mean within an error, by trials: what `stripmine explain --json` prints.

        `of` is the quantity, by default what the method is mostly asked for. `error` is the target error of its mean with a probability of
        95 %: a number in the quantity's unit, or a text such as "1%"; by default that of the scene's own values. `time` (s) asks for the
        least error within a wall time instead. `limit` (s) is the longest wall time of a plan, by default an hour; longer plans are refused.
        `window` is a pair of times (time) between which each run is averaged, in place of the steady state. `seconds` (s) is what the trials
        take at most, by default 10; their results are kept for the next call.

        Keys of the plan: `overrides` are what the scene needs, for `stripmine.scene(scene.toml(), plan["overrides"])`; `step` and `time`
        (time) of each run; `seeds`, the number of runs that differ in their seeds; `mean` and half of its interval of 95 %; `expected`, the error with `bias` and
        `chance`; `seconds` (s, wall time of the runs) from `least` to `most`; `decisions` with reasons.

        The command carries it out: `command`, or that of the environment variable STRIPMINE, or `stripmine` on the path; it must have the
        version of this package. Ctrl-C stops it with `KeyboardInterrupt`; trials that are finished are used by the next call. Raises
        `Error` where there is no such command, or it finds no plan.
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
        """The error of a mean over the wall time of a run, for each integrator and step: the tables of `stripmine chart accuracy`.

        `points` has the curves: `configuration`, `wall_time` (s), `step` (time), and the expected `error` and the `most` that it is, both
        in the quantity's unit. `marks` has the scene as it stands and, where an `error` is asked for, its plan; `biases` the bias of the
        mean by the step; `wishes` the cheapest run for each of some errors; `summary` one row with the mean.

        `budget` (s) is the processor time of the trials. `out` is a folder for the tables and the chart, in which trials that Ctrl-C
        stopped are resumed; without it nothing is kept. `of`, `error`, `window`, `command` and errors are as those of `explain`.
        """

@final
class Simulation:
    """A simulation under way, advanced step by step. Two threads cannot use it at the same time: the second has `BusyError`."""

    def advance(
        self, *, steps: int | None = None, time: float | None = None, events: int | None = None
    ) -> None:
        """Goes on by a number of steps, by a time (time), or by a number of events.

        Hard discs take no steps, and are advanced by a time, which is met exactly, or by events; the other methods come to the end of
        the first step at which the time is over. Any pieces give the same bits, and as many steps, as one: times add up without rounding.

        Other threads go on meanwhile. Ctrl-C ends it with `KeyboardInterrupt`; the simulation stands where it was interrupted, and
        may go on. Raises `SimulationError` where the physics fails; the state is then that of the failing step, can be looked at, and does
        not go on: the same error is raised again.
        """

    def observe(self) -> dict[str, float]:
        """A value for each quantity that the method observes, energies among them; the columns of `thermo.csv`. Units: `units`.

        `compressibility` and `collision_rate` of hard discs are means since the start; rows have them since the row before.
        """

    @property
    def units(self) -> dict[str, str]:
        """The unit of each quantity, such as "energy" or "length/time"; empty for pure numbers."""

    def particles(self) -> Particles:
        """The particles as they stand, positions inside the box. Particles that a bath has lost are not there."""

    def forces(self) -> NDArray[np.float64]:
        """The sum of the forces that pairs exert on each particle, shape (N, 2) (force), in the order of `particles()`.

        Gravity, a bath and closed sides are no pairs. Raises `Error` where a method has no such forces (hard discs and bodies).
        """

    def warnings(self) -> list[str]:
        """What seldom means well and has happened on the way."""

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
    """Particles at a moment, as arrays: those that forces move first, then discs of walls. D is 2, or 3 for bodies in space."""

    @property
    def id(self) -> NDArray[np.uint32]:
        """A number of its own, which stays with it; shape (N,)."""

    @property
    def wall(self) -> NDArray[np.bool_]:
        """Whether it is a disc of a wall, which no force moves; shape (N,)."""

    @property
    def positions(self) -> NDArray[np.float64]:
        """Centres (length), shape (N, D)."""

    @property
    def velocities(self) -> NDArray[np.float64]:
        """Velocities (length/time), shape (N, D)."""

    @property
    def angle(self) -> NDArray[np.float64]:
        """Angles (radian), counter-clockwise, shape (N,); 0 in frames, which have none."""

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
    """A run in its folder. Its files are read when they are asked for."""

    @property
    def folder(self) -> Path:
        """Where it is, an absolute path."""

    def thermo(self) -> Table:
        """The rows of `thermo.csv`: `step` (for hard discs the number of events), `time`, and what the method observes."""

    def averages(self) -> Table:
        """The mean of each quantity with its error, a row for each, as `stripmine average` finds them.

        `says` is "mean", "constant", "too-short", "changing" or "kept", and decides which columns are there; others are no
        numbers. `bar` is half the width of the interval that holds the true mean with a probability of 95 %. `unit` is that of mean, bar,
        errors, first and last.
        """

    def frames(self) -> Frames:
        """The frames of `trajectory.xyz`, or of `trajectory.gsd` where that has none, one after the other, each read when it is asked for."""

    def toml(self) -> str:
        """The scene as TOML, every value spelled out and every choice made."""

    def summary(self) -> dict[str, Any]:
        """`summary.json`: what the run says of itself at its end. Raises `RunError` before."""

@final
class Frames(Iterator[Frame]):
    """The frames of a trajectory."""

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
        """The sides of the box along x and y (length); infinite where there is no box."""

    @property
    def origin(self) -> list[float]:
        """The lower left corner of the box (length)."""

    @property
    def periodic(self) -> list[bool] | None:
        """Whether the box repeats along x and along y."""

@final
class Table:
    """A table of columns as long as each other.

    `table["name"]` is a column as an array. Programs that know the Arrow PyCapsule interface read all of it, with the units in the
    fields' metadata: `polars.DataFrame(table)`, `pyarrow.table(table)`, `pandas.DataFrame.from_arrow(table)`.
    """

    @property
    def columns(self) -> list[str]:
        """The names of the columns."""

    @property
    def units(self) -> dict[str, str]:
        """The unit of each column; empty for pure numbers and for words."""

    def to_dict(self) -> dict[str, NDArray[Any]]:
        """All columns as arrays of shape (rows,), by name."""

    def to_pandas(self) -> Any:
        """A `pandas.DataFrame`; needs pandas."""

    def __getitem__(self, name: str, /) -> NDArray[Any]: ...
    def __contains__(self, name: str, /) -> bool: ...
    def __len__(self) -> int: ...
    def __arrow_c_stream__(self, requested_schema: object | None = None) -> object: ...
