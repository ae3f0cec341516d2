"""Functions on vectors, traced into programs of the vector machine."""

import inspect
import json
import tempfile
from pathlib import Path

import numpy as np

from . import _stripmine, _studies
from ._errors import Error

# numpy functions of traced vectors, by the method that records them.
_UFUNCS = {
    np.add: "__add__",
    np.subtract: "__sub__",
    np.multiply: "__mul__",
    np.divide: "__truediv__",
    np.sqrt: "sqrt",
    np.absolute: "__abs__",
    np.trunc: "trunc",
    np.negative: "__neg__",
    np.less: "__lt__",
    np.less_equal: "__le__",
    np.greater: "__gt__",
    np.greater_equal: "__ge__",
}


class _Trace:
    """Nodes recorded so far. An operation that was recorded before is the same node."""

    def __init__(self):
        self.nodes = []
        self.known = {}

    def node(self, kind, *operands):
        key = (kind, *operands)
        if key not in self.known:
            self.known[key] = len(self.nodes)
            self.nodes.append({kind: list(operands) if len(operands) > 1 else operands[0]})
        return self.known[key]


class _Value:
    """A value of a trace."""

    __slots__ = ("_trace", "_at")
    __hash__ = None

    def __init__(self, trace, at):
        self._trace, self._at = trace, at

    def __bool__(self):
        raise Error("the function branches on data; use stripmine.where(condition, a, b)")

    def _new(self, kind, *operands, to=None):
        return (to or Vector)(self._trace, self._trace.node(kind, *operands))


class Predicate(_Value):
    """Truth values of a trace: the result of a comparison."""

    __slots__ = ()

    def __and__(self, other):
        if not isinstance(other, Predicate):
            return NotImplemented
        return self._new("connective", "and", self._at, _at(self._trace, other), to=Predicate)

    def __or__(self, other):
        return ~(~self & ~other) if isinstance(other, Predicate) else NotImplemented

    def __invert__(self):
        return self._new("negation", "not", self._at, to=Predicate)


class Vector(_Value):
    """Numbers of a trace: an input of the function, or computed from one."""

    __module__ = "stripmine"
    __slots__ = ("_input",)
    # Higher than that of arrays, so that `array * vector` asks this class.
    __array_priority__ = 1000

    def __init__(self, trace, at, input=None):
        super().__init__(trace, at)
        self._input = input

    def __array_ufunc__(self, ufunc, method, *inputs, **options):
        name = _UFUNCS.get(ufunc)
        if name is None or method != "__call__" or options:
            raise Error(f"numpy.{ufunc.__name__} cannot be traced; use + - * /, comparisons, abs, sqrt, trunc, minimum, maximum, where, shift")
        first, *others = (_vector(self._trace, it) for it in inputs)
        return getattr(first, name)(*others)

    def _binary(self, op, a, b):
        return self._new("binary", op, _number(self._trace, a), _number(self._trace, b))

    def _compare(self, op, a, b):
        return self._new("compare", op, _number(self._trace, a), _number(self._trace, b), to=Predicate)

    def __add__(self, other):
        return self._binary("add", self, other)

    def __radd__(self, other):
        return self._binary("add", other, self)

    def __sub__(self, other):
        return self._binary("subtract", self, other)

    def __rsub__(self, other):
        return self._binary("subtract", other, self)

    def __mul__(self, other):
        return self._binary("multiply", self, other)

    def __rmul__(self, other):
        return self._binary("multiply", other, self)

    def __truediv__(self, other):
        return self._binary("divide", self, other)

    def __rtruediv__(self, other):
        return self._binary("divide", other, self)

    def __neg__(self):
        return -1.0 * self

    def __pos__(self):
        return self

    def __abs__(self):
        return self._new("unary", "absolute", self._at)

    def __pow__(self, power):
        if not isinstance(power, int) or isinstance(power, bool) or not 1 <= power <= 64:
            raise Error(f"a vector to the power {power!r} cannot be traced; use a whole number from 1 to 64, or sqrt")
        result = self
        for _ in range(power - 1):
            result = result * self
        return result

    def __lt__(self, other):
        return self._compare("less_than", self, other)

    def __le__(self, other):
        return self._compare("less_equal", self, other)

    def __gt__(self, other):
        return self._compare("less_than", other, self)

    def __ge__(self, other):
        return self._compare("less_equal", other, self)

    def __eq__(self, other):
        return self._compare("equal", self, other)

    def __ne__(self, other):
        return ~(self == other)

    def sqrt(self):
        """Square root."""
        return self._new("unary", "square_root", self._at)

    def trunc(self):
        """Integer part, rounded towards zero."""
        return self._new("unary", "truncate", self._at)

    def minimum(self, other):
        """The smaller of two; the second if one is NaN."""
        return self._binary("minimum", self, other)

    def maximum(self, other):
        """The larger of two; the second if one is NaN."""
        return self._binary("maximum", self, other)

    def shift(self, distance):
        """The elements of an input at a distance from the own ones."""
        if self._input is None:
            raise Error("only inputs of the function can be shifted, since computed vectors are not stored; return it, and shift it in a second function")
        if not isinstance(distance, int) or isinstance(distance, bool):
            raise Error(f"a shift by {distance!r}; use a whole number of elements")
        return self._new("input", self._input, distance)


def _at(trace, value):
    if value._trace is not trace:
        raise Error("a vector of another traced function was used; pass it as an argument")
    return value._at


def _number(trace, value):
    """Node of a number or a vector."""
    if isinstance(value, Vector):
        return _at(trace, value)
    if isinstance(value, (int, float, np.integer, np.floating)) and not isinstance(value, bool):
        if not np.isfinite(value):
            raise Error(f"the constant {value} cannot be traced; use finite numbers")
        return trace.node("constant", float(value))
    raise Error(f"a value of type {type(value).__name__} cannot be traced; use numbers, and pass arrays as arguments")


def _vector(trace, value):
    return value if isinstance(value, _Value) else Vector(trace, _number(trace, value))


def where(condition, a, b):
    """`a` where the condition of a traced function holds, else `b`."""
    if not isinstance(condition, Predicate):
        raise Error(f"the condition of where is a {type(condition).__name__}; expected a comparison of traced vectors")
    trace = condition._trace
    return condition._new("select", condition._at, _number(trace, a), _number(trace, b))


class Kernel:
    """A traced function. `trace` makes it."""

    __module__ = "stripmine"

    def __init__(self, name, inputs, outputs, text):
        self.name, self.inputs, self.outputs = name, inputs, outputs
        self._text = text
        self._program = _stripmine._traced(text)

    def __reduce__(self):
        return Kernel, (self.name, self.inputs, self.outputs, self._text)

    def __repr__(self):
        return f"<Kernel {self.name}: {', '.join(self.inputs)} to {', '.join(self.outputs)}, {self.nop} operations>"

    @property
    def nop(self):
        """Number of vector operations."""
        return sum(count for *_, count in self._program.counts())

    def counts(self):
        """Table of the operations."""
        rows = self._program.counts()
        return _stripmine._table(
            [
                ("operation", "", "words", [operation for _, operation, _ in rows]),
                ("count", "", "counts", [count for *_, count in rows]),
            ]
        )

    def listing(self):
        """Vector instructions, as an assembly listing."""
        return self._program.listing()

    def rvv(self, lmul=4):
        """Code for RISC-V's vector extension, with `lmul` vector registers as one."""
        return self._program.rvv(self.name if self.name.isidentifier() else "kernel", lmul)

    def clocks(self, machine, n=1000, *, command=None):
        """Table of the clock periods of `n` elements on a machine, by every clock. Needs the command `stripmine`."""
        with tempfile.TemporaryDirectory(prefix="stripmine-") as folder:
            Path(folder, "kernel.json").write_text(self._text, encoding="utf-8")
            rows = _studies.printed_data(["price", "kernel.json", f"--machine={machine}", f"--elements={n}"], Path(folder), command)["clocks"]
        return _stripmine._table(
            [
                ("clock", "", "words", [row["clock"] for row in rows]),
                ("clock_periods", "", "numbers", [row["clock_periods"] for row in rows]),
                ("time", "s", "numbers", [row["time"] for row in rows]),
            ]
        )

    def run(self, *arrays, execution="chained", **named):
        """Runs the function on arrays of float64, in the order of its parameters or by name.

        `execution` is "chained", "eager" or "strip:N"; all give the same bits. Elements without a neighbour at every shift are NaN. Returns an array,
        or a dict of arrays if the function returns several vectors.
        """
        given = dict(zip(self.inputs, arrays, strict=False))
        if len(arrays) > len(self.inputs) or given.keys() & named.keys() or set(given) | set(named) != set(self.inputs):
            raise Error(f"{self.name} takes one array for each of {', '.join(self.inputs)}")
        columns = []
        for name in self.inputs:
            array = np.asarray((given | named)[name])
            if array.ndim != 1 or array.dtype != np.float64:
                raise Error(f"array {name} has shape {array.shape} and type {array.dtype}; expected one dimension of float64")
            columns.append(array)
        found = self._program.run(columns, execution)
        return found[0] if len(found) == 1 else dict(zip(self.outputs, found, strict=True))


def trace(function):
    """Traces a function of vectors: calls it once with symbols, and records its operations.

    `stripmine.trace(lambda x, y: (x * x + y * y).sqrt())`. Its parameters are the inputs. It returns a vector, a tuple of vectors, or a dict of them.
    """
    record = _Trace()
    parameters = inspect.signature(function).parameters.values()
    if not parameters or any(it.kind not in (it.POSITIONAL_ONLY, it.POSITIONAL_OR_KEYWORD) for it in parameters):
        raise Error("a traced function has one or more positional parameters, one for each array")
    inputs = [it.name for it in parameters]
    returned = function(*(Vector(record, record.node("input", at, 0), at) for at in range(len(inputs))))
    if isinstance(returned, tuple):
        returned = {f"out{at}": value for at, value in enumerate(returned)}
    outputs = returned if isinstance(returned, dict) else {"out": returned}
    named = [(name, _number(record, value)) for name, value in outputs.items()]
    clash = next((name for name, _ in named if name in inputs), None)
    if clash is not None:
        raise Error(f"output {clash} has the name of an input; choose another name")
    name = getattr(function, "__name__", "kernel")
    text = json.dumps({"inputs": inputs, "nodes": record.nodes, "outputs": named})
    return Kernel("kernel" if name == "<lambda>" else name, inputs, [name for name, _ in named], text)
