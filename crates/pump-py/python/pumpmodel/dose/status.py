"""The status of a record."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from pumpmodel._results.record import Record
from pumpmodel.choices import AngleLoss, LogEnd, PhaseSource


@dataclass(frozen=True)
class Wear(Record):
    """The volume, the revolutions and the time of motion of a tube since it was new."""

    volume_ml: float
    revolutions: float
    motion_s: float


@dataclass(frozen=True)
class Unfinished(Record):
    """A dose or a run that was begun and not finished.

    A run that was to go on until it is stopped has `until_stopped`, and as `requested_ml` the most that one
    run makes. A flow over time has `over_time`: no rest of it can be made, and it can be accepted alone.
    Turns to find the angle have pumped `searched_ml` meanwhile, which counts as not delivered. `end` and
    `cause` are those of its last motion; None as long as the log does not have it.
    """

    number: int | None
    requested_ml: float
    planned_ml: float
    delivered_least_ml: float
    delivered_most_ml: float
    searched_ml: float
    steps: int
    steps_made_least: int
    steps_made_most: int
    began_unix_s: int
    until_stopped: bool
    over_time: bool
    by_weight: bool
    target_g: float | None
    end: LogEnd | None
    cause: str | None


@dataclass(frozen=True)
class LastByWeight(Record):
    """The weighing of the last dose, which a balance ended: masses in g, volumes in mL.

    The balance was to show `target_g` and showed `mass_g`. The pump turned for `turned_ml` by the model.
    From an unknown angle (`from_known_angle` is False) that is one volume of many. `dropped_ml` is the
    carry of earlier doses that was dropped.
    """

    target_g: float
    mass_g: float
    digit_g: float
    volume_ml: float
    turned_ml: float
    from_known_angle: bool
    dropped_ml: float
    began_unix_s: int


@dataclass(frozen=True)
class CalibrationInUse(Record):
    """The calibration that doses use, and the pulse that its short doses found; None without one."""

    version: int
    date: str
    zero_deg: float
    roller_volume_ml: float | None
    roller_volume_standard_ml: float | None
    engagement_deg: float | None
    engagement_standard_deg: float | None


@dataclass(frozen=True)
class UnfinishedCalibration(Record):
    """A guided calibration that was begun and not finished: readings on record, and readings that it needs.

    Both are None if the readings cannot be read.
    """

    readings: int | None
    planned: int | None


@dataclass(frozen=True)
class BoardOnRecord(Record):
    """Board that the record of a pump names, by its `number` in hexadecimal and the name of its port.

    Either is None if the board or its port has none. `axis` is None for a board without axes.
    """

    number: str | None
    port_name: str | None
    axis: str | None


@dataclass(frozen=True)
class Stand(Record):
    """Stand of a pump at a safety limit, `day` or `vessel`, until `Bench.clear_safety`. Volumes in mL.

    A pump that was ordered to stand (`dose safety stand`) has the limit `ordered`, the `reason` and
    no volumes.
    """

    limit: str
    since: str
    used_ml: float
    planned_ml: float
    allowed_ml: float
    reason: str | None


@dataclass(frozen=True)
class Safety(Record):
    """The volumes that the safety limits of the pump file count, mL. A limit that is not set is None.

    A motion under way counts with the most that it may have pumped so far; `under_way_ml` is the rest of its
    plan, and what is left is free beside it.
    """

    _records: ClassVar[dict[str, type[Record]]] = {"stand": Stand}

    max_ml_per_day: float | None
    day_ml: float
    day_left_ml: float | None
    vessel_ml: float | None
    received_ml: float
    vessel_left_ml: float | None
    under_way_ml: float
    clock_behind_s: int
    cleared: str | None
    stand: Stand | None


@dataclass(frozen=True)
class Status(Record):
    """The record of a bench: the fields of the command's JSON `status/1`."""

    _records: ClassVar[dict[str, type[Record]]] = {
        "wear": Wear,
        "calibration": CalibrationInUse,
        "unfinished": Unfinished,
        "last_by_weight": LastByWeight,
        "unfinished_calibration": UnfinishedCalibration,
        "safety": Safety,
        "board": BoardOnRecord,
    }

    schema: str
    pump: str
    driver: str
    recorded: bool
    angle_deg: float | None
    half_width_deg: float
    angle_known: bool
    angle_source: PhaseSource
    angle_lost_by: AngleLoss | None
    disturbances: int
    device_count: int | None
    carry_ml: float
    carry_half_width_ml: float
    wear: Wear
    tube_life_ml: float | None
    tube_life_h: float | None
    tube_life_revolutions: float | None
    calibration: CalibrationInUse | None
    unfinished: Unfinished | None
    last_by_weight: LastByWeight | None
    unfinished_calibration: UnfinishedCalibration | None
    safety: Safety
    board: BoardOnRecord | None
    in_use_by: str | None
    folder: str
