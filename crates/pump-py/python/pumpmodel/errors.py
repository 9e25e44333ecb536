"""Errors of pumpmodel; bad arguments are plain ValueErrors."""


class PumpError(Exception):
    """Base of this package's own errors."""


class PlanError(PumpError):
    """A dose of good arguments that the pump cannot do."""


class PumpFileError(PumpError, ValueError):
    """A pump file that cannot be used."""
