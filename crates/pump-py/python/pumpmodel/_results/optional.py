"""Packages that only an extra of pumpmodel installs."""

from importlib import import_module
from types import ModuleType


def optional(module: str, extra: str) -> ModuleType:
    """Import a package of an extra. The ImportError of a missing package says how to install it.

    A package that is there and fails is not missing: its own error is raised.
    """
    package = module.partition(".")[0]
    try:
        import_module(package)
    except ModuleNotFoundError as error:
        if error.name != package:
            raise
        message = (
            f'{package} is not installed; in a clone of pump-dose: pip install "./crates/pump-py[{extra}]"'
        )
        raise ModuleNotFoundError(message, name=package) from error
    return import_module(module)
