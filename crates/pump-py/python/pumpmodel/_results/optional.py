"""Packages that only an extra of pumpmodel installs."""

from importlib import import_module
from types import ModuleType


def optional(module: str, extra: str) -> ModuleType:
    """Import a package of an extra. The ImportError of a missing package says how to install it."""
    try:
        return import_module(module)
    except ImportError as error:
        raise ImportError(f'{module} is not installed: pip install "pumpmodel[{extra}]"') from error
