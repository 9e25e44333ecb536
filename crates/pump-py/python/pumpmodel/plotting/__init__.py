"""Pictures of results and pumps, by matplotlib (`pip install './crates/pump-py[plot]'`)."""

from pumpmodel.plotting.animation import animate
from pumpmodel.plotting.axes import BLUE, VERMILION, axes_for
from pumpmodel.plotting.doses import plot_budget
from pumpmodel.plotting.map import plot_map
from pumpmodel.plotting.pitch import plot_dose_error, plot_pitch
from pumpmodel.plotting.section import plot_pump
from pumpmodel.plotting.waveform import plot

__all__ = [
    "BLUE",
    "VERMILION",
    "animate",
    "axes_for",
    "plot",
    "plot_budget",
    "plot_dose_error",
    "plot_map",
    "plot_pitch",
    "plot_pump",
]
