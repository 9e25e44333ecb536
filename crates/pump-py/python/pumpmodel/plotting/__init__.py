"""Pictures of runs, plans, sweeps and pumps, by matplotlib (`pip install 'pumpmodel[plot]'`)."""

from pumpmodel.plotting.axes import BLUE, VERMILION, axes_for
from pumpmodel.plotting.map import plot_map
from pumpmodel.plotting.section import plot_pump
from pumpmodel.plotting.waveform import plot

__all__ = ["BLUE", "VERMILION", "axes_for", "plot", "plot_map", "plot_pump"]
