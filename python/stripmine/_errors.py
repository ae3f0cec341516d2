"""Exceptions, with the messages of the command line."""

from dataclasses import dataclass


class Error(Exception):
    """Base class of all errors of this package.

    `kind` is "usage", "input", "precondition", "input-output" or "checkpoint", as on the command line; `remedy` is what to do, if known.
    """

    def __init__(self, message, kind="usage", remedy=None):
        super().__init__(message)
        self.kind = kind
        self.remedy = remedy

    def __reduce__(self):
        # Pickled by its attributes, since subclasses have other constructors.
        return _again, (type(self), self.args, self.__dict__)


def _again(kind, arguments, state):
    error = kind.__new__(kind, *arguments)
    error.__dict__.update(state)
    return error


@dataclass(frozen=True)
class Mistake:
    """One mistake of a scene: its location, what is wrong, what was expected, what to do."""

    file: str
    line: int | None
    column: int | None
    reason: str
    message: str
    expected: str | None
    suggestion: str | None


class SceneError(Error, ValueError):
    """Every mistake of a scene at once, in `mistakes`."""

    def __init__(self, message, mistakes):
        super().__init__(message, "input", next((it.suggestion for it in mistakes if it.suggestion), None))
        self.mistakes = mistakes


class SimulationError(Error, RuntimeError):
    """The physics broke a precondition, or failed during the simulation.

    `failure` is the kind of failure, such as "too-deep"; `step` and `time` are when it happened; `particles` are those named, each a
    dict with `called`, `id`, `position` (length) and `velocity` (length/time); `count` is the number of affected particles; `values`
    are the measured values and their limits.
    """

    def __init__(self, message, remedy, details):
        super().__init__(message, "precondition", remedy)
        when = details["when"]
        self.failure = details["kind"]
        self.step = when and when["steps"]
        self.time = when and when["time"]
        self.particles = details["who"]
        self.count = details["count"]
        self.values = details["values"]


class RunError(Error):
    """A run or its folder cannot be made, resumed or read. `file` is its location."""

    def __init__(self, message, kind, remedy, file):
        super().__init__(message, kind, remedy)
        self.file = file


class BusyError(Error, RuntimeError):
    """The simulation is in use by another thread."""
