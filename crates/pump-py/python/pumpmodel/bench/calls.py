"""Calls of a bench that a stop reaches."""

from collections.abc import Callable
from functools import wraps
from typing import Concatenate, ParamSpec, TypeVar

from pumpmodel._pumpmodel import _Bench


class HasCore:
    """A bench by its compiled half. Base of `Bench`."""

    _core: _Bench


_P = ParamSpec("_P")
_Result = TypeVar("_Result")
_Self = TypeVar("_Self", bound=HasCore)


def stoppable(
    method: Callable[Concatenate[_Self, _P], _Result],
) -> Callable[Concatenate[_Self, _P], _Result]:
    """Have `Bench.stop` reach a method from its first instruction to its last."""

    @wraps(method)
    def call(self: _Self, /, *arguments: _P.args, **keywords: _P.kwargs) -> _Result:
        with self._core.begin(method.__name__):
            return method(self, *arguments, **keywords)

    return call
