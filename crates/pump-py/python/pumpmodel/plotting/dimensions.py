"""The dimensions of a pump head in its section: arrows, and labels beside the head."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from pumpmodel._pumpmodel import Pump
from pumpmodel.plotting.axes import BLUE, GREEN, VERMILION, ink, paper

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def draw_dimensions(axis: Axes, pump: Pump, roller_rad: float, reach_mm: float) -> None:
    """Draw offset, roller, backplate and tube, by the names that `dose pumps new` gives them.

    `roller_rad` is the polar angle of the roller that carries the arrows. `reach_mm` is the distance from the
    shaft to the backplate's back. The labels stand in the two lower corners, where the head is not.
    """
    offset, roller = pump.roller_offset_mm, pump.roller_radius_mm
    centre = (offset * math.cos(roller_rad), offset * math.sin(roller_rad))
    tangent = roller_rad - math.pi / 2
    rim = (centre[0] + roller * math.cos(tangent), centre[1] + roller * math.sin(tangent))
    between = roller_rad + min(pump.pitch_rad / 2, math.radians(50))
    plate = (pump.backplate_radius_mm * math.cos(between), pump.backplate_radius_mm * math.sin(between))
    depth = pump.backplate_radius_mm - pump.tube_outer_radius_mm
    aside = between + 0.12 * pump.pitch_rad
    tube = (depth * math.cos(aside), depth * math.sin(aside))
    outer = (pump.backplate_radius_mm * math.cos(aside), pump.backplate_radius_mm * math.sin(aside))

    def arrow(start: tuple[float, float], end: tuple[float, float], colour: str, style: str = "-|>") -> None:
        props = {"arrowstyle": style, "color": colour, "shrinkA": 0, "shrinkB": 0, "linewidth": 1.4}
        axis.annotate("", end, start, arrowprops=props, zorder=8)

    arrow((0.0, 0.0), centre, BLUE, "<|-|>")
    arrow(centre, rim, VERMILION)
    arrow((0.0, 0.0), plate, GREEN)
    # From the middle of the bore to the tube's outside, which lies on the backplate.
    arrow(tube, outer, VERMILION)
    side, low = 1.36 * reach_mm, -1.07 * reach_mm
    half = (centre[0] / 2, centre[1] / 2)
    labels = [
        (rf"offset $r_\mathrm{{offset}}$ {offset:.4g} mm", half, -side, low + 0.16 * reach_mm, "left"),
        (rf"roller $r_\mathrm{{roller}}$ {roller:.4g} mm", rim, -side, low, "left"),
        (
            rf"backplate $r_\mathrm{{b}}$ {pump.backplate_radius_mm:.4g} mm",
            plate,
            side,
            low + 0.16 * reach_mm,
            "right",
        ),
        (
            rf"tube {2 * pump.bore_radius_mm:.4g} x {2 * pump.tube_outer_radius_mm:.4g} mm, "
            rf"$r_\mathrm{{o}}$ {pump.tube_outer_radius_mm:.4g} mm",
            tube,
            side,
            low,
            "right",
        ),
    ]
    for words, to, x, y, align in labels:
        props = {"arrowstyle": "-", "color": ink(axis, 0.55), "linewidth": 0.7, "shrinkA": 2, "shrinkB": 0}
        axis.annotate("", to, (x, y), arrowprops=props, zorder=8)
        # The label hides the lines that pass behind it.
        box = {"boxstyle": "round,pad=0.15", "facecolor": paper(axis), "linewidth": 0}
        axis.text(x, y, words, ha=align, va="center", fontsize="small", color=ink(axis), bbox=box, zorder=9)
