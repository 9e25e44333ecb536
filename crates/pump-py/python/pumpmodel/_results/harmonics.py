"""The sines into which a pulsation divides."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes


class Harmonics(NamedTuple):
    """Harmonics of the pulsation at a port, of which `Pump.harmonics` returns one.

    Flow and pressure are their means plus the real part of the sum of `amplitude * exp(1j * rad_s * t)`.
    """

    #: Frequencies, rad/s, shape (n,).
    rad_s: NDArray[np.float64]
    #: Complex amplitudes of the flow at the rollers, mL/s, shape (n,).
    flow_ml_s: NDArray[np.complex128]
    #: Complex amplitudes of the pressure, kPa, shape (n,).
    pressure_kpa: NDArray[np.complex128]
    #: Mean flow, mL/s; negative in reverse.
    mean_flow_ml_s: float
    #: Mean pressure, kPa absolute.
    mean_kpa: float

    def __eq__(self, other: object) -> bool:
        """Tell if every number is equal."""
        if not isinstance(other, Harmonics):
            return NotImplemented
        return all(np.array_equal(getattr(self, name), getattr(other, name)) for name in self._fields)

    def __ne__(self, other: object) -> bool:
        """Tell if a number differs."""
        return not self == other

    def plot(self, *, ax: Sequence[Axes] | None = None) -> list[Axes]:
        """Draw the amplitudes of flow and pressure over the frequency.

        Parameters
        ----------
        ax : sequence of Axes, optional
            Axes for flow and pressure. By default a new figure.

        Returns
        -------
        list of Axes
            Axes of the flow at the rollers and of the pressure.

        Raises
        ------
        ValueError
            If the number of axes is not 2.
        ImportError
            If matplotlib is missing, which `pip install './crates/pump-py[plot]'` brings.
        """
        from pumpmodel.plotting.spectrum import plot_spectrum

        return plot_spectrum(self, ax=ax)

    def _repr_html_(self) -> str:
        from pumpmodel._results.notebook.shown import harmonics_html

        return harmonics_html(self)
