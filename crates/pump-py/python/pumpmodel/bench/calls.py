"""Calls of a bench that a stop reaches."""

from collections.abc import Callable
from functools import wraps
from typing import Any, TypeVar, cast

from pumpmodel._pumpmodel import _Bench


class HasCore:
    """A bench by its compiled half. Base of `Bench`."""

    _core: _Bench


_Method = TypeVar("_Method", bound=Callable[..., Any])


def stoppable(method: _Method) -> _Method:
    """Have `Bench.stop` reach a method from its first instruction to its last."""

    @wraps(method)
    def call(self: HasCore, *arguments: Any, **keywords: Any) -> Any:
        with self._core.begin(method.__name__):
            return method(self, *arguments, **keywords)

    return cast(_Method, call)
