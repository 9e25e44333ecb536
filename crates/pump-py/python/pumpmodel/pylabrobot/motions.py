"""Motions of a bench from the arguments of PyLabRobot's calls, to be planned or made."""

import math
from collections.abc import Awaitable, Callable
from typing import Any, TypeAlias

from pumpmodel._pumpmodel import Limits, _number
from pumpmodel._results.numbers import Number
from pumpmodel.bench import AsyncBench
from pumpmodel.choices import Finish
from pumpmodel.dose import Dose

#: A motion of a bench, which is planned alone if the second argument is True.
Motion: TypeAlias = Callable[[AsyncBench, bool], Awaitable[Dose]]

# Steps by which revolutions may miss, and plans in search of their volume.
_NEAR_STEPS = 2
_ROUNDS = 20


def volume_of(
    speed: Number | None,
    volume: Number | None,
    rate: str | None,
    *,
    smooth: bool = False,
    finish: Finish = "any",
    retract: str | None = None,
    limits: Limits | None = None,
) -> Motion:
    """Return the dose of a volume, mL."""
    if volume is None:
        message = "volume is missing; give it in mL, as volume=25"
        raise TypeError(message)
    _need_one(speed, rate)
    ml = _finite("volume", volume, "mL")
    cruise = None if speed is None else f"{_number('speed', speed, 'r/min')!r}rpm"
    return lambda bench, plan: bench.dose(
        f"{ml!r}mL",
        speed=cruise,
        rate=rate,
        smooth=smooth,
        finish=finish,
        retract=retract,
        limits=limits,
        dry_run=plan,
    )


def revolutions_of(
    num_revolutions: Number, speed: Number | None, rate: str | None, limits: Limits | None = None
) -> Motion:
    """Return the turn by revolutions. Without speed and rate it has the pump's own rate."""
    turns = _finite("num_revolutions", num_revolutions, "revolutions")
    _refuse_both(speed, rate)
    keywords: dict[str, Any] = {"rate": rate, "limits": limits, "reverse": turns < 0}
    keywords["speed"] = None if speed is None else _rpm(speed)
    return lambda bench, plan: _turn(bench, abs(turns), keywords, plan)


def duration_of(
    speed: Number | None,
    duration: Number | None,
    rate: str | None,
    reverse: bool = False,
    limits: Limits | None = None,
) -> Motion:
    """Return the run for a time, s."""
    if duration is None:
        message = "duration is missing; give it in s, as duration=10"
        raise TypeError(message)
    seconds = _finite("duration", duration, "s")
    if seconds <= 0:
        message = f"duration is {seconds}; allowed: a positive number in s"
        raise ValueError(message)
    keywords = _cruise(speed, rate, reverse, limits)
    return lambda bench, plan: bench.run(duration=f"{seconds!r}s", dry_run=plan, **keywords)


def continuous_of(
    speed: Number | None, rate: str | None, reverse: bool = False, limits: Limits | None = None
) -> Motion:
    """Return the run until it is stopped."""
    keywords = _cruise(speed, rate, reverse, limits)
    return lambda bench, plan: bench.run(dry_run=plan, **keywords)


def _need_one(speed: Number | None, rate: str | None) -> None:
    if speed is None and rate is None:
        message = 'neither speed nor rate is given; give a speed in r/min, or a rate as "10 mL/s"'
        raise ValueError(message)
    _refuse_both(speed, rate)


def _refuse_both(speed: Number | None, rate: str | None) -> None:
    if speed is not None and rate is not None:
        message = "speed and rate are both given; give exactly one"
        raise ValueError(message)


def _finite(name: str, given: Number, unit: str) -> float:
    number = _number(name, given, unit)
    if not math.isfinite(number):
        message = f"{name} is {number}; allowed: a finite number in {unit}"
        raise ValueError(message)
    return number


def _rpm(speed: Number) -> str:
    return f"{abs(_number('speed', speed, 'r/min'))!r}rpm"


def _cruise(speed: Number | None, rate: str | None, reverse: bool, limits: Limits | None) -> dict[str, Any]:
    """Return the keywords of a run. The sign of a speed is a direction too."""
    _need_one(speed, rate)
    if speed is None:
        return {"rate": rate, "reverse": reverse, "limits": limits}
    cruise = _rpm(speed)
    return {"speed": cruise, "rate": rate, "reverse": (float(speed) < 0) != reverse, "limits": limits}


async def _turn(bench: AsyncBench, turns: float, keywords: dict[str, Any], plan: bool) -> Dose:
    """Run for the volume that the pump delivers in `turns` revolutions from where the rollers stand."""
    pump = bench.pump
    steps = turns * pump.steps_per_rev
    volume_ml = turns * pump.volume_per_revolution_ml
    for _ in range(_ROUNDS):
        planned = await bench.run(volume=f"{volume_ml!r}mL", dry_run=True, **keywords)
        missing = steps - abs(planned.steps)
        if abs(missing) <= _NEAR_STEPS:
            break
        volume_ml += missing / pump.steps_per_rev * pump.volume_per_revolution_ml
    return await bench.run(volume=f"{volume_ml!r}mL", dry_run=plan, **keywords)
