"""A dose of the log."""

from __future__ import annotations

from dataclasses import dataclass

from pumpmodel._results.record import Record
from pumpmodel.choices import LogEnd, Purpose


@dataclass(frozen=True)
class LoggedDose(Record):
    """A dose in the log of a bench: the fields of the command's JSON `log/1`.

    `delivered_least_ml` and `delivered_most_ml` are numbers where nobody knows how many steps were made, and
    None otherwise. `end` tells how the dose ended, and `cause` the reason of a fault, or who or what
    stopped the dose. `rack` is the rack of which it was a part, and `order` the order of a service that
    made it. `requested_ml` is None for a run until it
    is stopped. `clock_went_back` is True if the time is before that of the dose before. The rest of a dose
    that was stopped, and the retraction after a dose, have entries of their own.
    """

    schema: str
    pump: str
    driver: str
    number: int
    time: str
    purpose: Purpose
    asked: str | None
    requested_ml: float | None
    delivered_ml: float
    delivered_least_ml: float | None
    delivered_most_ml: float | None
    expanded_uncertainty_ml: float | None
    carry_ml: float
    end: LogEnd
    cause: str | None
    resumed: bool
    tube: int
    calibration: int | None
    steps: int | None
    motion_s: float | None
    rack: str | None
    order: str | None
    clock_went_back: bool
    fluid: str | None
    temperature_degc: float | None
