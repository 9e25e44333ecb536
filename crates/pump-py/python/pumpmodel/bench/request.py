"""The keywords of a dose, as the compiled half takes them."""

from typing import Any

from pumpmodel._pumpmodel import Limits
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
    start_angle_rad: float | None,
    start_half_width_rad: float,
    limits: Limits | None,
) -> dict[str, Any]:
    """Return the keywords as a dict. No volume asks for the rest of an unfinished dose."""
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
    }
