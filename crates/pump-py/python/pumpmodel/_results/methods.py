"""Methods of the compiled classes that are written in Python: pictures, and what notebooks show.

Their imports wait until they are called, as matplotlib takes a while.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

from pumpmodel._pumpmodel import Calibration, Plan, Pump, Run, SteadyState

if TYPE_CHECKING:
    from matplotlib.animation import FuncAnimation
    from matplotlib.axes import Axes

    from pumpmodel.choices import Panel


def _plot_run(
    self: Run | Plan,
    *,
    panels: Panel | list[Panel] | tuple[Panel, ...] | None = None,
    ax: Axes | Sequence[Axes] | None = None,
) -> Any:
    """Draw the columns over time, as `pumpmodel.plot` does."""
    from pumpmodel.plotting import plot

    drawn: Any = plot
    return drawn(self, panels=panels, ax=ax)


def _plot_steady(self: SteadyState[Any], *, ax: Axes | Sequence[Axes] | None = None) -> list[Axes]:
    """Draw pressures with their range, mean flow and ripple over the speed.

    Parameters
    ----------
    ax : Axes or sequence of Axes, optional
        Axes for pressures, flow and ripple, or axes for the pressures alone. By default a new figure.

    Returns
    -------
    list of Axes
        Axes of the panels.

    Raises
    ------
    ValueError
        If there is no speed, or the number of axes is neither 1 nor 3.
    ImportError
        If matplotlib is missing, which `pip install './crates/pump-py[plot]'` brings.
    """
    from pumpmodel.plotting.steady import plot_steady

    return plot_steady(self, ax=ax)


def _plot_calibration(self: Calibration, *, pump: Pump | None = None, ax: Axes | None = None) -> Axes:
    """Draw the displacement factor over the speed, with the band that covers 95 %.

    Parameters
    ----------
    pump : Pump, optional
        Pump of the calibration. With it the weighed runs are drawn as points; a fitted speed law needs it.
    ax : Axes, optional
        Axes to draw in. By default a new figure.

    Returns
    -------
    Axes
        Axes over the speed.

    Raises
    ------
    ValueError
        If a speed law was fitted and no pump is given, or the calibration has no runs.
    ImportError
        If matplotlib is missing, which `pip install './crates/pump-py[plot]'` brings.
    """
    from pumpmodel.plotting.calibration import plot_calibration

    return plot_calibration(self, pump=pump, ax=ax)


def _plot_pump(self: Pump, angle_rad: float = 0.0, *, ax: Axes | None = None) -> Axes:
    """Draw the section through the head, as `pumpmodel.plot_pump` does."""
    from pumpmodel.plotting import plot_pump

    return plot_pump(self, angle_rad, ax=ax)


def _animate_pump(self: Pump, run: Run, *, slower: float = 1.0, frames_per_s: float = 25.0) -> FuncAnimation:
    """Return an animation of the head over a run, as `pumpmodel.animate` makes it."""
    from pumpmodel.plotting import animate

    return animate(self, run, slower=slower, frames_per_s=frames_per_s)


def _animate_plan(self: Plan, *, slower: float = 1.0, frames_per_s: float = 25.0) -> FuncAnimation:
    """Return an animation of the head over the dose, as `pumpmodel.animate` makes it."""
    from pumpmodel.plotting import animate

    return animate(self.pump, self, slower=slower, frames_per_s=frames_per_s)


def _shown(name: str) -> Callable[[Any], str]:
    def _repr_html_(self: Any) -> str:
        """Return what a notebook shows: a table of the main numbers and a small picture, as HTML."""
        from pumpmodel._results.notebook import shown

        html: str = getattr(shown, name)(self)
        return html

    return _repr_html_


_METHODS: dict[type, dict[str, Callable[..., Any]]] = {
    Run: {"plot": _plot_run, "_repr_html_": _shown("run_html")},
    Plan: {"plot": _plot_run, "animate": _animate_plan, "_repr_html_": _shown("plan_html")},
    SteadyState: {"plot": _plot_steady, "_repr_html_": _shown("steady_html")},
    Calibration: {"plot": _plot_calibration, "_repr_html_": _shown("calibration_html")},
    Pump: {"plot": _plot_pump, "animate": _animate_pump, "_repr_html_": _shown("pump_html")},
}


def attach() -> None:
    """Give the compiled classes their methods of Python."""
    for owner, methods in _METHODS.items():
        for name, method in methods.items():
            setattr(owner, name, method)
