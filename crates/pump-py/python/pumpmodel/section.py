"""The section through a pump head; `pumpmodel.plotting` draws it."""

from pumpmodel.plotting.section import plot_pump

__all__ = ["plot_pump"]
