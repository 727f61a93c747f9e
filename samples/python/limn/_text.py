"""Arguments as the text that the command line would have: limn reads both by the same rules, so that messages are the same."""

from __future__ import annotations

import os
from typing import Any, Iterable, List, Tuple

from ._limn import InputError

Fields = List[Tuple[str, str]]


def refuse(field: str, value: Any, problem: str, expected: str) -> InputError:
    """An InputError with its parts."""
    line = f"{field}: {problem}" + (f" (got {value}, expected {expected})" if value != "" else f" (expected {expected})")
    error = InputError(line)
    for name, part in (("file", ""), ("field", field), ("value", str(value)), ("problem", problem), ("expected", expected)):
        setattr(error, name, part)
    return error


def number(value: Any) -> str:
    """A number, exactly; anything else as it is, for limn to refuse."""
    if hasattr(value, "item") and getattr(value, "ndim", 1) == 0:  # a number of numpy's
        value = value.item()
    return repr(value) if isinstance(value, (int, float)) and not isinstance(value, bool) else str(value)


def numbers(field: str, value: Any) -> str:
    """Several numbers with commas between them."""
    if isinstance(value, str):
        return value
    try:
        return ",".join(number(one) for one in value)
    except TypeError:
        raise refuse(field, value, "is no list of numbers", "such as (0, 1, 0)") from None


def listed(field: str, value: Any) -> List[str]:
    """Names: one, or several."""
    if value is None:
        return []
    if isinstance(value, str):
        return [value]
    try:
        return [str(one) for one in value]
    except TypeError:
        raise refuse(field, value, "is no name", "a str, or a list of them") from None


def path(value: Any) -> str:
    """A file's name."""
    return os.fspath(value)


def size(value: Any) -> str:
    """Width and height as "1280x720"."""
    if isinstance(value, str):
        return value
    try:
        return "x".join(number(one) for one in value)
    except TypeError:
        raise refuse("size", value, "is no size", "width and height, such as (1280, 720)") from None


def color(field: str, value: Any) -> str:
    """A name, "#rrggbb", or linear RGB."""
    return value if isinstance(value, str) else numbers(field, value)


def parameter(value: Any) -> str:
    """The value of a method's parameter."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return value
    if hasattr(value, "__len__"):
        return numbers("parameters", value)
    return number(value)


def flag(value: Any) -> str:
    """True or False; anything else as it is, for limn to refuse."""
    return str(value)


def add(fields: Fields, name: str, text: Any) -> None:
    """Adds a field unless it is None."""
    if text is not None:
        fields.append((name, text))


def add_all(fields: Fields, name: str, texts: Iterable[str]) -> None:
    """Adds a field once for each text."""
    fields.extend((name, text) for text in texts)
