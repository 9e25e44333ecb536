"""The keywords of a dose, as the compiled half takes them."""

from typing import Any

from pumpmodel._pumpmodel import Balance, Limits
from pumpmodel._results.numbers import Number
from pumpmodel.choices import Finish, Ramps


def asked(
    volume: str | None,
    rate: str | None,
    speed: str | None,
    within: str | None,
    smooth: bool,
    finish: Finish | None,
    ramps: Ramps | None,
    retract: str | None,
    start_angle_rad: Number | None,
    start_half_width_rad: Number,
    limits: Limits | None,
    *,
    duration: str | None = None,
    until_stopped: bool = False,
    reverse: bool = False,
) -> dict[str, Any]:
    """Return the keywords as a dict.

    Without a volume a duration or a stop ends the motion; without those it is the rest of an unfinished dose.
    """
    if limits is not None and not isinstance(limits, Limits):
        raise TypeError(f"limits must be a Limits, not {type(limits).__name__}")
    for name, is_set in (("smooth", smooth), ("reverse", reverse)):
        if not isinstance(is_set, bool):
            raise TypeError(f"{name} must be True or False, not {type(is_set).__name__}")
    for name, word in (("finish", finish), ("ramps", ramps)):
        if not isinstance(word, str | None):
            raise TypeError(f"{name} must be a word, not {type(word).__name__}")
    return {
        "volume": volume,
        "rate": rate,
        "speed": speed,
        "within": within,
        "smooth": smooth,
        "finish": finish,
        "ramps": ramps,
        "retract": retract,
        "start_angle_rad": start_angle_rad,
        "start_half_width_rad": start_half_width_rad,
        "limits": limits,
        "duration": duration,
        "until_stopped": until_stopped,
        "reverse": reverse,
    }


def one_end(volume: str | None, duration: str | None) -> None:
    """Refuse a motion that has no end, or two."""
    if (volume is None) == (duration is None):
        raise ValueError("volume and duration each end the motion; give one of them")


def by_weight(
    until_scale: Balance | None, max_volume: str | None, slow_rate: str | None, scale: str | None
) -> dict[str, Any] | None:
    """Return the keywords of a dose by weight as a dict, and None for a dose that no balance ends."""
    if until_scale is None:
        given = {"max_volume": max_volume, "slow_rate": slow_rate, "scale": scale}
        for name, value in given.items():
            if value is not None:
                raise ValueError(f"{name} is given without until_scale, the balance that ends the dose")
        return None
    if not isinstance(until_scale, Balance):
        raise TypeError(f"until_scale must be a Balance, not {type(until_scale).__name__}")
    return {"balance": until_scale, "max_volume": max_volume, "slow_rate": slow_rate, "scale": scale}
