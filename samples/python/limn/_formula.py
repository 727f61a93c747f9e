"""Formulas: a Python function called once with symbols, its operations recorded as limn's .vm files have them."""

from __future__ import annotations

import numbers
from typing import Any, Callable, List, Optional, Sequence, Union

from . import _text

_UNARY = {
    "sqrt": "sqrt",
    "square": "square",
    "sin": "sin",
    "cos": "cos",
    "tan": "tan",
    "arcsin": "asin",
    "arccos": "acos",
    "arctan": "atan",
    "exp": "exp",
    "log": "ln",
    "absolute": "abs",
    "fabs": "abs",
    "negative": "neg",
    "reciprocal": "recip",
}
_BINARY = {
    "add": "add",
    "subtract": "sub",
    "multiply": "mul",
    "divide": "div",
    "true_divide": "div",
    "minimum": "min",
    "maximum": "max",
    "fmin": "min",
    "fmax": "max",
}


class Recorder:
    """The operations so far, a line each."""

    def __init__(self) -> None:
        self.lines: List[str] = []

    def add(self, operation: str, *operands: str) -> "Symbol":
        name = f"_{len(self.lines):x}"
        self.lines.append(" ".join((name, operation, *operands)))
        return Symbol(self, name)

    def of(self, value: Any) -> "Symbol":
        """A symbol of this recording, or a number."""
        if isinstance(value, Symbol):
            if value.recorder is not self:
                raise _text.refuse("function", "a symbol of another formula", "mixes formulas", "the symbols it is called with")
            return value
        if isinstance(value, bool) or not isinstance(value, numbers.Real):
            raise _text.refuse("function", type(value).__name__, "uses what is no number", "numbers and the symbols x, y and z")
        return self.add("const", repr(float(value)))


class Symbol:
    """A value that is not known yet. It has no truth: formulas do not branch."""

    __slots__ = ("recorder", "name")
    __array_priority__ = 1000

    def __init__(self, recorder: Recorder, name: str) -> None:
        self.recorder = recorder
        self.name = name

    def _unary(self, operation: str) -> "Symbol":
        return self.recorder.add(operation, self.name)

    def _binary(self, operation: str, other: Any, swapped: bool = False) -> "Symbol":
        a, b = self, self.recorder.of(other)
        if swapped:
            a, b = b, a
        return self.recorder.add(operation, a.name, b.name)

    def __add__(self, other: Any) -> "Symbol":
        return self._binary("add", other)

    def __radd__(self, other: Any) -> "Symbol":
        return self._binary("add", other, True)

    def __sub__(self, other: Any) -> "Symbol":
        return self._binary("sub", other)

    def __rsub__(self, other: Any) -> "Symbol":
        return self._binary("sub", other, True)

    def __mul__(self, other: Any) -> "Symbol":
        return self._binary("mul", other)

    def __rmul__(self, other: Any) -> "Symbol":
        return self._binary("mul", other, True)

    def __truediv__(self, other: Any) -> "Symbol":
        return self._binary("div", other)

    def __rtruediv__(self, other: Any) -> "Symbol":
        return self._binary("div", other, True)

    def __neg__(self) -> "Symbol":
        return self._unary("neg")

    def __pos__(self) -> "Symbol":
        return self

    def __abs__(self) -> "Symbol":
        return self._unary("abs")

    def __pow__(self, power: Any) -> "Symbol":
        if isinstance(power, numbers.Real) and power == 0.5:
            return self._unary("sqrt")
        if not isinstance(power, numbers.Real) or float(power) != int(power) or not 1 <= int(power) <= 64:
            raise _text.refuse("function", power, "has a power that is no formula", "a whole number from 1 to 64, or 0.5")
        result: Optional[Symbol] = None
        base, left = self, int(power)
        while left:
            if left & 1:
                result = base if result is None else result * base
            left >>= 1
            if left:
                base = base._unary("square")
        assert result is not None
        return result

    def __bool__(self) -> bool:
        raise _text.refuse("function", "a comparison", "branches on a value that is not known yet", "minimum, maximum and abs")

    __lt__ = __le__ = __gt__ = __ge__ = lambda self, other: bool(self)  # type: ignore[assignment]

    def __float__(self) -> float:
        raise _text.refuse("function", "a symbol", "needs a number where only a symbol is known", "numpy's functions or the symbols' own")

    def sqrt(self) -> "Symbol":
        return self._unary("sqrt")

    def square(self) -> "Symbol":
        return self._unary("square")

    def sin(self) -> "Symbol":
        return self._unary("sin")

    def cos(self) -> "Symbol":
        return self._unary("cos")

    def tan(self) -> "Symbol":
        return self._unary("tan")

    def arcsin(self) -> "Symbol":
        return self._unary("asin")

    def arccos(self) -> "Symbol":
        return self._unary("acos")

    def arctan(self) -> "Symbol":
        return self._unary("atan")

    def exp(self) -> "Symbol":
        return self._unary("exp")

    def log(self) -> "Symbol":
        return self._unary("ln")

    def minimum(self, other: Any) -> "Symbol":
        return self._binary("min", other)

    def maximum(self, other: Any) -> "Symbol":
        return self._binary("max", other)

    def __array_ufunc__(self, function: Any, method: str, *inputs: Any, **options: Any) -> "Symbol":
        if method == "__call__" and not options and len(inputs) == 1 and function.__name__ in _UNARY:
            return self._unary(_UNARY[function.__name__])
        if method == "__call__" and not options and len(inputs) == 2:
            a, b = inputs
            if function.__name__ == "power":
                return self.recorder.of(a) ** b
            if function.__name__ == "hypot":
                return (self.recorder.of(a) ** 2 + self.recorder.of(b) ** 2).sqrt()
            if function.__name__ in _BINARY:
                return self.recorder.of(a)._binary(_BINARY[function.__name__], b)
        raise _text.refuse("function", f"numpy.{function.__name__}", "is no operation of formulas", ", ".join(sorted({*_UNARY, *_BINARY})))


def _box(recorder: Recorder, x: Symbol, y: Symbol, z: Symbol, bounds: Sequence[Sequence[float]]) -> Symbol:
    """The distance-like function of a box: the largest of the distances to its six planes."""
    try:
        (lower, upper) = ([float(v) for v in corner] for corner in bounds)
        if len(lower) != 3 or len(upper) != 3 or not all(a < b for a, b in zip(lower, upper)):
            raise ValueError
    except (TypeError, ValueError):
        raise _text.refuse("bounds", bounds, "is no box", "the lower corner, then the upper one: (2, 3)") from None
    result: Optional[Symbol] = None
    for axis, low, high in zip((x, y, z), lower, upper):
        for side in (low - axis, axis - high):
            result = side if result is None else result.maximum(side)
    assert result is not None
    return result


def text_of(function: Callable[[Any, Any, Any], Any], bounds: Optional[Sequence[Sequence[float]]]) -> str:
    """The function's operations as a .vm file has them."""
    if not callable(function):
        raise _text.refuse("function", type(function).__name__, "cannot be called", "a function of x, y and z")
    recorder = Recorder()
    x, y, z = (recorder.add(name) for name in ("var-x", "var-y", "var-z"))
    made: Union[Symbol, Any] = function(x, y, z)
    value = recorder.of(made)
    if value.name in (x.name, y.name, z.name):
        value = value + 0.0
    if bounds is not None:
        value = value.maximum(_box(recorder, x, y, z, bounds))
    # The last line is the value: what was recorded after it, and not used, would be in its place.
    if not recorder.lines[-1].startswith(value.name + " "):
        value = value + 0.0
    return "\n".join(recorder.lines) + "\n"
