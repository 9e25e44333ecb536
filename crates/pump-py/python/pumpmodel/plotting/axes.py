"""Axes and colours of every picture."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from pumpmodel._results.optional import optional

if TYPE_CHECKING:
    from matplotlib.axes import Axes

# Colours that colour-blind readers can tell apart (Okabe and Ito, 2008), as in `dose --plot`.
BLUE = "#0072B2"
VERMILION = "#D55E00"


def axes_for(names: list[str], ax: Axes | Sequence[Axes] | None) -> list[Axes]:
    """Return axes for each name: the caller's, or the axes of a new figure."""
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
