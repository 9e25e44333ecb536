"""Axes and colours of every picture."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from pumpmodel._results.optional import optional

if TYPE_CHECKING:
    from matplotlib.axes import Axes

# Colours that colour-blind readers can tell apart (Okabe and Ito, 2008), as in `dose --plot`. The inlet is
# blue and the outlet vermilion; a curve that belongs to neither port is green.
BLUE = "#0072B2"
VERMILION = "#D55E00"
GREEN = "#009E73"
ORANGE = "#E69F00"

# A line that shows on both sides of one that covers it, as the inlet's below the outlet's.
WIDE = 2.4

_Colour = tuple[float, float, float]


def axes_for(names: Sequence[str], ax: Axes | Sequence[Axes] | None) -> list[Axes]:
    """Return axes for each name: the caller's, or the axes of a new figure, which no window shows."""
    pyplot = optional("matplotlib.pyplot", "plot")
    axes_type = optional("matplotlib.axes", "plot").Axes
    if ax is None:
        height = 1.0 + 1.5 * len(names) if len(names) > 1 else 4.0
        _, grid = pyplot.subplots(
            len(names), sharex=True, squeeze=False, figsize=(7.0, height), layout="constrained"
        )
        return list(grid[:, 0])
    axes = [ax] if isinstance(ax, axes_type) else list(ax)  # type: ignore[arg-type]
    if len(axes) != len(names):
        message = f"{len(axes)} axes for {len(names)} panels; give one for each panel"
        raise ValueError(message)
    return axes


def panels_for(names: Sequence[str], ax: Axes | Sequence[Axes] | None) -> list[Axes]:
    """Return axes as `axes_for` does. Axes that are not in a sequence are those of the first panel alone."""
    single = ax is not None and isinstance(ax, optional("matplotlib.axes", "plot").Axes)
    return axes_for(names[:1] if single else names, ax)


def paper(axis: Axes) -> _Colour:
    """Return the colour behind the curves; of transparent axes that of the figure."""
    colors = optional("matplotlib.colors", "plot")
    behind: list[_Colour] = [
        (red, green, blue)
        for red, green, blue, alpha in map(
            colors.to_rgba,
            (axis.get_facecolor(), axis.get_figure(root=True).get_facecolor()),  # type: ignore[union-attr]
        )
        if alpha > 0
    ]
    return behind[0] if behind else (1.0, 1.0, 1.0)


def ink(axis: Axes, strength: float = 1.0) -> _Colour:
    """Return the colour of the axes' labels, faded towards the paper where `strength` is less than 1."""
    red, green, blue = optional("matplotlib.colors", "plot").to_rgb(axis.xaxis.label.get_color())
    behind = paper(axis)
    return (
        strength * red + (1 - strength) * behind[0],
        strength * green + (1 - strength) * behind[1],
        strength * blue + (1 - strength) * behind[2],
    )


def finish(axis: Axes, *, legend: bool = True) -> None:
    """Draw the grid, and the legend beside the axes."""
    axis.grid(alpha=0.25)
    axis.margins(x=0)
    if legend:
        axis.legend(loc="upper left", bbox_to_anchor=(1.0, 1.02), frameon=False, fontsize="small")
