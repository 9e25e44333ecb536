"""Numbers that a caller gives: Python's and NumPy's."""

from dataclasses import fields
from typing import Any, TypeAlias

import numpy as np

from pumpmodel._pumpmodel import _number

#: One number, for annotations.
Number: TypeAlias = float | np.floating[Any] | np.integer[Any]


def floats_of(record: Any, *names: str) -> None:
    """Make attributes of a frozen dataclass numbers of Python, but for those that may be None and are.

    Anything but a number is refused by the attribute's name and unit.
    """
    defaults = {field.name: field.default for field in fields(record)}
    for name in names:
        given = getattr(record, name)
        if given is None and defaults[name] is None:
            continue
        number = _number(name, given)
        if type(given) not in (int, float):
            object.__setattr__(record, name, number)
