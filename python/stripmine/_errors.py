"""What may go wrong, as exceptions: the words are those of the command line."""

from dataclasses import dataclass


class Error(Exception):
    """Anything that this package refuses or that fails.

    `kind` is "usage", "input", "precondition", "input-output" or "checkpoint", as the command line has it; `remedy` says what to
    do, where that is known.
    """

    def __init__(self, message, kind="usage", remedy=None):
        super().__init__(message)
        self.kind = kind
        self.remedy = remedy

    def __reduce__(self):
        # From one process to another it goes as it is, whatever it was made of.
        return _again, (type(self), self.args, self.__dict__)


def _again(kind, arguments, state):
    error = kind.__new__(kind, *arguments)
    error.__dict__.update(state)
    return error


@dataclass(frozen=True)
class Mistake:
    """One mistake of a scene: where it stands, what is wrong, what was expected, what to do."""

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
    """The physics broke a precondition, or failed on the way.

    `failure` is what kind of failure, such as "too-deep"; `step` and `time` are when; `particles` are those named, each a dict with
    `called`, `id`, `position` (length) and `velocity` (length/time); `count` is how many particles it is true of; `values` are the
    numbers found and what they were held against.
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
    """A run, or a folder of one, that cannot be made, gone on with or read. `file` is where."""

    def __init__(self, message, kind, remedy, file):
        super().__init__(message, kind, remedy)
        self.file = file


class BusyError(Error, RuntimeError):
    """A simulation that another thread is using."""
