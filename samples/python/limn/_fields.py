"""Fields: shapes, Python's own functions, formulas, samples on a grid."""

from __future__ import annotations

from typing import Any, Callable, Optional, Sequence

from . import _limn, _text
from ._formula import text_of
from ._limn import Field


def shape(name: str, **parameters: Any) -> Field:
    """A shape by name (limn.names("shapes")), its parameters in world units: limn.shape("torus", major=1, minor=0.3)."""
    return _limn.shape(name, parameters)


def field(
    function: Callable[[Any, Any, Any], Any],
    *,
    bounds: Sequence[Sequence[float]],
    lipschitz: float,
    gradient: Optional[Callable[[Any, Any, Any], Any]] = None,
    vectorized: bool = False,
) -> Field:
    """A field from any Python function of x, y and z (world units), negative inside: a trained network, another library.

    vectorized: the function takes arrays x, y and z (n,) and returns (n,), or (n, 1). A picture asks for some fifty values a ray, mostly 16
    at a time, a mesh or a level set for hundreds at a time: what takes little longer for many points than for one is drawn in a small part
    of the time. A point's value must not depend on the others.

    Otherwise it takes and returns floats, and is slow: each value is a call with the interpreter's lock, for which threads wait in turn. A
    formula (limn.formula) or samples (limn.field_from_grid) take a small part of the time of either.

    bounds: (2, 3), a box that holds the surface. lipschitz: |f(p) - f(q)| <= lipschitz * |p - q| everywhere; pictures and the true border
    rely on it. gradient: a function to (3,), vectorized to (n, 3); missing: central differences.
    """
    if isinstance(lipschitz, bool) or not isinstance(lipschitz, (int, float)):
        raise _text.refuse("lipschitz", lipschitz, "is no number", "a number above 0")
    if not isinstance(vectorized, bool):
        raise _text.refuse("vectorized", vectorized, "is no flag", "True or False")
    return _limn.field_of(function, bounds, float(lipschitz), gradient, vectorized)


def formula(function: Callable[[Any, Any, Any], Any], *, bounds: Optional[Sequence[Sequence[float]]] = None, name: str = "formula") -> Field:
    """A field from a formula: the function is called once, with symbols for x, y and z, and limn records what it does with them.

    Symbols know + - * / ** (whole powers and 0.5), abs, and the methods sqrt, square, sin, cos, tan, arcsin, arccos, arctan, exp, log,
    minimum and maximum, and so numpy's functions of these names work on them. The field is as quick as a built-in shape, and its bounds are known
    everywhere: values are scaled so that no slope is steeper than 1. bounds: (2, 3), a box that cuts a surface without end.
    """
    text = text_of(function, bounds)
    return _limn.formula_of(text, name)


def field_from_grid(values: Any, *, origin: Sequence[float], spacing: float) -> Field:
    """A field from samples (nx, ny, nz) at origin + spacing * (i, j, k), world units; trilinear between them, negative inside. Copied,
    to 32 bits. Values on the grid's faces must be above 0. For distances in a narrow band see limn.level_set_from_array."""
    if isinstance(spacing, bool) or not isinstance(spacing, (int, float)):
        raise _text.refuse("spacing", spacing, "is no number", "a length above 0 in world units")
    return _limn.grid_of(values, origin, float(spacing))
