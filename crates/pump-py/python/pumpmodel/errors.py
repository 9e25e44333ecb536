"""Errors of pumpmodel. Bad arguments raise a plain ValueError."""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pumpmodel.rack import RackReport


class PumpError(Exception):
    """Base of the errors of pumpmodel.

    `report` tells what each pump of a rack delivered, if one of them failed on the way; otherwise it is None.
    """

    report: "RackReport | None" = None


class PlanError(PumpError):
    """The pump cannot make a dose, although its arguments are valid."""


class PumpFileError(PumpError, ValueError):
    """A pump file cannot be used."""


class DriveError(PumpError):
    """Another process holds the pump or its device, or the motor failed.

    If the motor failed on the way, the delivered volume (mL) is between `delivered_least_ml` and
    `delivered_most_ml`. Without motion both are None.
    """

    delivered_least_ml: float | None = None
    delivered_most_ml: float | None = None


class BalanceError(PumpError):
    """A balance cannot be read, or a dose by weight ended before the balance showed what was asked for.

    If the pump turned, `turned_ml` is the volume delivered by the model (mL) and `weighed_g` the mass
    delivered by the last reading (g). The dose is unfinished then. Without motion both are None.
    """

    turned_ml: float | None = None
    weighed_g: float | None = None


class SafetyError(PumpError):
    """The pump stands at a safety limit: `Bench.clear_safety` lets it go on. Nothing has moved.

    `used_ml` counted before the dose, which would have pumped `planned_ml` (mL). The limit allows
    `allowed_ml`. A run until it is stopped that the limit has ended raises it too, after its motion:
    `planned_ml` is 0 then, a note says how much was delivered, and the run is complete on record. All
    three are 0 for a pump that was ordered to stand; the message has the reason.
    """

    used_ml: float
    planned_ml: float
    allowed_ml: float


class StoppedError(PumpError):
    """A stop came before the motion of a call: nothing was delivered, and nothing new is on record."""


class UnfinishedError(PumpError):
    """An earlier dose is unfinished: `Bench.resume` makes the rest, `Bench.discard` accepts it as it is.

    `requested_ml` is the requested volume (mL), and None for a run until it is stopped. The delivered volume
    (mL) is between `delivered_least_ml` and `delivered_most_ml`.
    """

    requested_ml: float | None = None
    delivered_least_ml: float
    delivered_most_ml: float
