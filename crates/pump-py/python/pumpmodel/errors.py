"""Errors of pumpmodel; bad arguments are plain ValueErrors."""


class PumpError(Exception):
    """Base of this package's own errors."""


class PlanError(PumpError):
    """A dose of good arguments that the pump cannot do."""


class PumpFileError(PumpError, ValueError):
    """A pump file that cannot be used."""


class DriveError(PumpError):
    """A pump or device that another process holds, or a motor that failed.

    If the motor failed on the way, `delivered_least_ml` and `delivered_most_ml` say between which volumes
    (mL) the dose was delivered; without motion both are None.
    """

    delivered_least_ml: float | None = None
    delivered_most_ml: float | None = None


class UnfinishedError(PumpError):
    """An earlier dose was begun and not finished: `Bench.resume` makes the rest, `Bench.discard` leaves it.

    `requested_ml` is what was asked (mL); between `delivered_least_ml` and `delivered_most_ml` were
    delivered.
    """

    requested_ml: float
    delivered_least_ml: float
    delivered_most_ml: float
