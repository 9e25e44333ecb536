"""The section through a pump head: backplate, rotor, rollers and the squeezed tube."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from pumpmodel._pumpmodel import Pump, _number
from pumpmodel.plotting.axes import BLUE, GREEN, VERMILION, axes_for, ink, paper
from pumpmodel.plotting.dimensions import draw_dimensions

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_STEP_MM = 0.25
_PLATE_MM = 6.0
# Room for a name between the middle and the tube's inner side at the end of a straight.
_APART_MM = 20.0


class _Backplate(NamedTuple):
    """The surface of the backplate from the outlet's end to the inlet's, and its normal into the tube."""

    x_mm: NDArray[np.float64]
    y_mm: NDArray[np.float64]
    normal_x: NDArray[np.float64]
    normal_y: NDArray[np.float64]

    def at(self, depth_mm: NDArray[np.float64] | float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return the points at a depth from the surface toward the rotor; negative is into the plate."""
        return self.x_mm + depth_mm * self.normal_x, self.y_mm + depth_mm * self.normal_y


def plot_pump(pump: Pump, angle_rad: float = 0.0, *, ax: Axes | None = None) -> Axes:
    """Draw the section through a pump head to scale.

    The backplate is an arc of pi + 2 beta that continues as straights. The tube lies against it, and the
    rollers squeeze it. Liquid flows from the inlet (left) to the outlet (right) while the rotor turns
    counterclockwise. Marks show the contact angle beta, the engagement angle phi over which a roller engages
    (blue) and leaves (red), the inlet phase psi (green) from the place where a roller begins to leave to the
    place where it begins to engage, the pitch between rollers, and the rotor's angle theta. Arrows show tube,
    backplate, roller and offset, by the names that `dose pumps new` gives them and by their symbols.

    Letters and marks have the colours of the axes, as of `matplotlib.style.context("dark_background")`.

    Parameters
    ----------
    pump : Pump
        Pump to draw.
    angle_rad : float
        Angle of the rotor, rad; at 0 a roller begins to leave the outlet.
    ax : Axes, optional
        Axes to draw in. By default a new figure.

    Returns
    -------
    Axes
        Axes in mm around the shaft.

    Raises
    ------
    ValueError
        If the angle is not finite.
    ImportError
        If matplotlib is missing, which `pip install './crates/pump-py[plot]'` brings.
    """
    if not isinstance(pump, Pump):
        message = f"pump must be a Pump, not {type(pump).__name__}"
        raise TypeError(message)
    angle_rad = _number("angle_rad", angle_rad)
    if not math.isfinite(angle_rad):
        message = f"angle_rad is {angle_rad}; allowed: a finite number"
        raise ValueError(message)
    own_figure = ax is None
    (axis,) = axes_for(["section"], ax)
    if own_figure:
        axis.figure.set_size_inches(6.6, 6.4)  # type: ignore[union-attr]
    draw_head(axis, pump, angle_rad)
    _mark_angles(axis, pump, angle_rad)
    # The roller at the bottom carries the dimensions: there its place is the freest.
    lowest = min(_rollers_rad(pump, angle_rad), key=math.sin)
    draw_dimensions(axis, pump, float(lowest), pump.backplate_radius_mm + _PLATE_MM)
    axis.set_xlabel("mm")
    axis.set_ylabel("mm")
    axis.set_title(pump.name, fontsize="medium")
    return axis


def draw_head(axis: Axes, pump: Pump, angle_rad: float) -> None:
    """Draw backplate, tube and rotor to scale, without marks."""
    rollers = _rollers_rad(pump, angle_rad)
    _draw_tube(axis, pump, rollers)
    _draw_rotor(axis, pump, rollers)
    axis.set_aspect("equal")
    reach = pump.backplate_radius_mm + _PLATE_MM
    axis.set_xlim(-1.4 * reach, 1.4 * reach)
    axis.set_ylim(-1.16 * reach, 1.3 * reach)


def _leaving_rad(pump: Pump) -> float:
    """Return the angle of a roller that begins to leave: the end of its fully engaged turn."""
    sealed_rad = math.tau - pump.engagement_rad - pump.inlet_phase_rad
    return (sealed_rad - math.pi) / 2


def _rollers_rad(pump: Pump, angle_rad: float) -> NDArray[np.float64]:
    return _leaving_rad(pump) + angle_rad + pump.pitch_rad * np.arange(pump.rollers, dtype=np.float64)


def _backplate(pump: Pump) -> _Backplate:
    radius, beta = pump.backplate_radius_mm, pump.contact_angle_rad
    # Beyond half a turn the straights lean towards each other and end before they meet.
    apart = (radius - 2 * pump.tube_outer_radius_mm) * math.cos(beta) - _APART_MM
    straight = 0.8 * radius if beta <= 0 else min(0.8 * radius, apart / math.sin(beta))
    length = np.arange(max(straight, _STEP_MM), 0, -_STEP_MM, dtype=np.float64)
    arc = np.linspace(beta, -math.pi - beta, math.ceil(radius * (math.pi + 2 * beta) / _STEP_MM))
    # A straight has the normal of the arc's end.
    polar = np.concatenate((np.full_like(length, arc[0]), arc, np.full_like(length, arc[-1])))
    along = np.concatenate((length, np.zeros_like(arc), -length[::-1]))
    x, y = np.cos(polar), np.sin(polar)
    return _Backplate(radius * x - along * y, radius * y + along * x, -x, -y)


def _thickness_mm(pump: Pump, plate: _Backplate, rollers: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the thickness that the rollers leave to the tube, along the normal of the backplate."""
    thickness = np.full_like(plate.x_mm, 2 * pump.tube_outer_radius_mm)
    for polar in rollers:
        to_x = pump.roller_offset_mm * math.cos(polar) - plate.x_mm
        to_y = pump.roller_offset_mm * math.sin(polar) - plate.y_mm
        deep = to_x * plate.normal_x + to_y * plate.normal_y
        aside = to_x * plate.normal_y - to_y * plate.normal_x
        meets = (np.abs(aside) < pump.roller_radius_mm) & (deep > 0)
        gap = deep - np.sqrt(np.where(meets, pump.roller_radius_mm**2 - aside**2, 0))
        # Along the normal, the far side of the pump lies behind the shaft.
        near = meets & (deep < pump.backplate_radius_mm)
        thickness = np.where(near, np.minimum(thickness, gap), thickness)
    return thickness


def _draw_tube(axis: Axes, pump: Pump, rollers: NDArray[np.float64]) -> None:
    from matplotlib.patches import Polygon

    plate = _backplate(pump)
    thickness = _thickness_mm(pump, plate, rollers)
    walls = 2 * (pump.tube_outer_radius_mm - pump.bore_radius_mm)
    lumen = np.clip(thickness - walls, 0, None)
    wall = (thickness - lumen) / 2

    def band(outer: NDArray[np.float64] | float, inner: NDArray[np.float64] | float, colour: str) -> None:
        (x0, y0), (x1, y1) = plate.at(outer), plate.at(inner)
        corners = np.column_stack((np.append(x0, x1[::-1]), np.append(y0, y1[::-1])))
        # An artist, as `Axes.fill` would search each of the thousand edges for the limits that are known.
        axis.add_artist(Polygon(corners, color=colour, linewidth=0, zorder=1))

    band(-_PLATE_MM, 0.0, "#9aa0a6")
    band(0.0, thickness, "#e8c9a0")
    band(wall, thickness - wall, "#cfe8f7")
    for label, depth in (
        ("backplate", np.zeros_like(thickness)),
        ("lumen, outer side", wall),
        ("lumen, inner side", thickness - wall),
        ("tube, inner side", thickness),
    ):
        axis.plot(*plate.at(depth), color="#5f4b32", linewidth=0.7, label=label, zorder=2)
    middle = pump.tube_outer_radius_mm
    x, y = plate.at(middle)
    for end, name, way in ((-1, "inlet", -1), (0, "outlet", 1)):
        outward = np.array([plate.normal_y[end], -plate.normal_x[end]]) * way
        tip = np.array([x[end], y[end]])
        head, tail = (tip + 10 * outward, tip + 2 * outward)[:: (1 if name == "outlet" else -1)]
        axis.annotate("", head, tail, arrowprops={"arrowstyle": "-|>", "color": ink(axis, 0.8)})
        x_text, y_text = tip + 14 * outward
        axis.text(
            x_text,
            max(y_text, 1.1 * (pump.backplate_radius_mm + _PLATE_MM)),
            name,
            ha="center",
            va="center",
            color=ink(axis),
        )


def _draw_rotor(axis: Axes, pump: Pump, rollers: NDArray[np.float64]) -> None:
    from matplotlib.patches import Circle

    for number, polar in enumerate(rollers):
        centre = pump.roller_offset_mm * np.array([math.cos(polar), math.sin(polar)])
        axis.plot([0, centre[0]], [0, centre[1]], color="0.6", linewidth=5, solid_capstyle="round", zorder=3)
        axis.add_patch(
            Circle(
                (float(centre[0]), float(centre[1])),
                pump.roller_radius_mm,
                facecolor=(0.92, 0.92, 0.93, 0.85),
                edgecolor="0.35",
                linewidth=1,
                label=f"roller {number}",
                zorder=4,
            )
        )
        axis.plot(*centre, marker="+", color="0.35", markersize=7, zorder=5)
    axis.add_patch(Circle((0, 0), 0.09 * pump.roller_offset_mm, color="0.35", label="shaft", zorder=5))


def _mark_angles(axis: Axes, pump: Pump, angle_rad: float) -> None:
    leaving, phi, beta = _leaving_rad(pump), pump.engagement_rad, pump.contact_angle_rad
    outside = pump.backplate_radius_mm + _PLATE_MM
    inside = pump.backplate_radius_mm - 2 * pump.tube_outer_radius_mm

    def ray(polar: float, start: float, end: float) -> None:
        x, y = math.cos(polar), math.sin(polar)
        axis.plot([start * x, end * x], [start * y, end * y], color=ink(axis, 0.7), linewidth=0.7, zorder=6)

    def arc(
        start: float, end: float, radius: float, label: str, colour: str | None = None, width: float = 1.2
    ) -> None:
        polar = np.linspace(start, end, 60)
        axis.plot(
            radius * np.cos(polar),
            radius * np.sin(polar),
            color=colour or ink(axis, 0.7),
            linewidth=width,
            solid_capstyle="butt",
            label=label,
            zorder=6,
        )

    def text(polar: float, radius: float, words: str, colour: str | None = None) -> None:
        axis.text(
            radius * math.cos(polar),
            radius * math.sin(polar),
            words,
            color=colour or ink(axis),
            ha="center",
            va="center",
            fontsize="small",
            bbox={"boxstyle": "round,pad=0.15", "facecolor": paper(axis), "alpha": 0.85, "linewidth": 0},
            zorder=7,
        )

    if beta > 0:
        ray(0, outside + 1, outside + 7)
        ray(beta, outside + 1, outside + 7)
        arc(0, beta, outside + 4, "beta")
        text(beta / 2, outside + 14, f"β {math.degrees(beta):.4g}°")
    engaging = math.pi - leaving
    arc(leaving, leaving + phi, inside, "phi, leaving", VERMILION, 3)
    arc(engaging - phi, engaging, inside, "phi, engaging", BLUE, 3)
    for place, colour in ((leaving + 0.6 * phi, VERMILION), (engaging - 0.6 * phi, BLUE)):
        text(place, inside - 8, f"φ {math.degrees(phi):.4g}°", colour)
    psi = pump.inlet_phase_rad
    arc(leaving, leaving + psi, inside + 5, "psi", GREEN, 3)
    text(leaving + 0.88 * psi, inside + 12, f"ψ {math.degrees(psi):.4g}°", GREEN)
    first = leaving + angle_rad
    if pump.rollers > 1:
        radius = 0.3 * pump.roller_offset_mm
        arc(first, first + pump.pitch_rad, radius, "pitch")
        text(first + pump.pitch_rad / 2, radius + 5, f"pitch {math.degrees(pump.pitch_rad):.4g}°")
    turned = math.remainder(angle_rad, math.tau)
    if turned:
        radius = 0.55 * pump.roller_offset_mm
        ray(leaving, 0, inside)
        arc(leaving, leaving + turned, radius, "theta")
        text(leaving + 0.3 * turned, radius + 6, f"θ {math.degrees(turned):.4g}°")
