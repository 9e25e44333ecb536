"""Packages that only some of pumpmodel needs."""

from importlib import import_module
from types import ModuleType


def extra(name: str, package: str, purpose: str) -> ModuleType:
    """Import a package of one of pumpmodel's optional extras.

    Parameters
    ----------
    name : str
        Module to import.
    package : str
        Extra that brings it.
    purpose : str
        What needs it.

    Returns
    -------
    ModuleType
        The module.

    Raises
    ------
    ImportError
        If it is not installed; says how to install it.
    """
    try:
        return import_module(name)
    except ModuleNotFoundError as error:
        message = f"{purpose} needs {name}: pip install 'pumpmodel[{package}]'"
        raise ImportError(message, name=error.name) from error
