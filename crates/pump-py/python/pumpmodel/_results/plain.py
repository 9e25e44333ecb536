"""Plain data of a caller as JSON: dicts, lists, texts and numbers, of NumPy too."""

import json
import math
from typing import Any

import numpy as np

# Deeper data hold themselves.
_DEEPEST = 50


def json_of(what: str, data: Any) -> str:
    """Return the JSON of the data of `what`, as "a pump".

    Raises
    ------
    ValueError
        If a number is not finite, or the data hold themselves. The message has the keys that lead there.
    TypeError
        If something is no plain data.
    """
    _check(what, data, "", 0)
    return json.dumps(data, allow_nan=False, default=_converted)


def _converted(value: Any) -> Any:
    """Return what Python makes of a scalar or an array of NumPy."""
    return value.tolist()


def _check(what: str, value: Any, place: str, depth: int) -> None:
    if depth > _DEEPEST:
        message = f"these are not the data of {what}: {_short(place)} holds itself; allowed: plain data"
        raise ValueError(message)
    if isinstance(value, np.generic | np.ndarray):
        value = value.tolist()
    if isinstance(value, dict):
        for key, part in value.items():
            if not isinstance(key, str):
                message = f"the data of {what} have the key {_short(repr(key))}; allowed: texts as keys"
                raise TypeError(message)
            _check(what, part, f"{place}.{key}" if place else key, depth + 1)
    elif isinstance(value, list | tuple):
        for n, part in enumerate(value):
            _check(what, part, f"{place}[{n}]", depth + 1)
    elif isinstance(value, float) and not math.isfinite(value):
        message = f"these are not the data of {what}: {_short(place)} is {value}; allowed: a finite number"
        raise ValueError(message)
    elif isinstance(value, int) and abs(value) > 2**64:
        message = (
            f"these are not the data of {what}: {_short(place)} is a whole number beyond 64 bits; "
            "allowed: a smaller one"
        )
        raise ValueError(message)
    elif not isinstance(value, str | int | float | None):
        message = (
            f"the data of {what} hold a {type(value).__name__}{' at ' * bool(place)}{_short(place)}; "
            "allowed: dicts, lists, texts, numbers, True, False and None"
        )
        raise TypeError(message)


def _short(place: str) -> str:
    return place if len(place) <= 80 else f"{place[:76]}..."
