"""Arguments that are refused by their names, in few words."""

from collections.abc import Callable, Iterable
from typing import Any, TypeVar

import numpy as np

_Item = TypeVar("_Item")

# Longest text that a message repeats.
_LONGEST = 40


def told(given: object) -> str:
    """Return the words for what an argument is: a class, a text, or an object of a type."""
    if isinstance(given, type):
        return f"the class {given.__name__} itself"
    if isinstance(given, str):
        return f"the text {short(given)}"
    return type(given).__name__


def short(text: str) -> str:
    """Return a text in quotes; a long one is cut, and its length told."""
    if len(text) <= _LONGEST:
        return repr(text)
    return f"{text[:_LONGEST]!r}... ({len(text):,} characters)"


def chosen(name: str, given: object, allowed: Iterable[str]) -> str:
    """Return a word of a fixed set."""
    words = tuple(allowed)
    if not isinstance(given, str):
        message = f"{name} must be a text, not {told(given)}; allowed: {', '.join(words)}"
        raise TypeError(message)
    if given not in words:
        message = f"{name} is {short(given)}; allowed: {', '.join(words)}"
        raise ValueError(message)
    return given


def items(name: str, given: Any, kind: type[_Item], *, plural: str | None = None) -> list[_Item]:
    """Return the objects of one type that an iterable has."""
    many = plural or f"{kind.__name__}s"
    if isinstance(given, str | type) or not isinstance(given, Iterable):
        message = f"{name} must be a sequence of {many}, not {told(given)}"
        raise TypeError(message)
    found = list(given)
    for place, item in enumerate(found):
        if not isinstance(item, kind):
            article = "an" if kind.__name__[0] in "AEIOU" else "a"
            message = f"{name}[{place}] must be {article} {kind.__name__}, not {told(item)}"
            raise TypeError(message)
    return found


def function(name: str, given: Any, takes: str) -> None:
    """Refuse what cannot be called."""
    if not callable(given):
        message = f"{name} must be a function of {takes}, not {told(given)}"
        raise TypeError(message)


def having(name: str, given: Any, method: str, kind: str) -> None:
    """Refuse an object without a method."""
    if isinstance(given, type) or not callable(getattr(given, method, None)):
        message = f"{name} must be {kind}, not {told(given)}"
        raise TypeError(message)


def whole(name: str, given: Any, least: int) -> int:
    """Return a whole number of at least so much."""
    if isinstance(given, bool) or not isinstance(given, int | np.integer):
        message = f"{name} must be an integer, not {told(given)}"
        raise TypeError(message)
    if given < least:
        number = "a whole number below -1e18" if given < -(10**18) else f"{given}"
        message = f"{name} is {number}; allowed: {least} or more"
        raise ValueError(message)
    return int(given)


def path(name: str, given: object, read: Callable[[Any], Any]) -> Any:
    """Return a path as `read` makes it."""
    try:
        return read(given)
    except TypeError:
        message = f"{name} must be a text or a path, not {told(given)}"
        raise TypeError(message) from None
