"""The volume of a roller from the coefficients of a polynomial."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pumpmodel import _pumpmodel as core
from pumpmodel._results.record import Record
from pumpmodel.volume_fit.engagement import engagement_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes

# Coefficients of a polynomial of the highest degree.
_MOST = 6


@dataclass(frozen=True, init=False)
class VolumePolynomial(Record):
    """The volume that a roller displaces while it engages, by the coefficients of a polynomial.

    `Pump.replace(roller_volume=polynomial)` returns a pump with this roller volume. The volume counts from 0
    at the first contact, and is held where the polynomial falls.

    Parameters
    ----------
    coefficients_ml_deg : array_like
        Coefficients of the volume, mL over deg, highest order first, as McIntyre et al. publish them, pump
        files have them and `numpy.polyfit` returns them; 1 to 6 of them, up to the fifth order.
        `numpy.polynomial` has the lowest order first: give `convert().coef[::-1]` of its polynomials.
    engagement_deg : float
        Angle over which a roller engages, phi, deg, more than 0 and less than 360.

    Raises
    ------
    ValueError
        If a value is outside its range, there are more coefficients, or the volume does not rise.

    Examples
    --------
    >>> import pumpmodel as pm
    >>> volume = pm.VolumePolynomial([-3.2e-5, 0.0024, 0, 0], 50)
    >>> round(volume.total_ml, 6)
    2.0
    >>> round(pm.Pump.three_roller().replace(roller_volume=volume).roller_volume_ml, 6)
    2.0
    """

    coefficients_ml_deg: tuple[float, ...]
    engagement_deg: float

    def __init__(self, coefficients_ml_deg: ArrayLike, engagement_deg: float) -> None:
        coefficients = np.asarray(core._numbers("coefficients_ml_deg", coefficients_ml_deg))
        if coefficients.ndim != 1 or not 1 <= len(coefficients) <= _MOST:
            raise ValueError(
                f"coefficients_ml_deg has the shape {coefficients.shape}; allowed: 1 to {_MOST} numbers, "
                "highest order first"
            )
        if not np.isfinite(coefficients).all():
            raise ValueError(f"coefficients_ml_deg is {coefficients.tolist()}; allowed: finite numbers")
        engagement = engagement_of(engagement_deg)
        object.__setattr__(self, "coefficients_ml_deg", tuple(coefficients.tolist()))
        object.__setattr__(self, "engagement_deg", engagement)
        core._volume_polynomial(*self._polynomial)

    @property
    def total_ml(self) -> float:
        """Volume of a roller, V_r, mL."""
        return core._volume_polynomial(*self._polynomial)[0]

    @property
    def held_deg(self) -> list[tuple[float, float]]:
        """Stretches where the polynomial falls and the volume is held: from and to, deg."""
        return core._volume_polynomial(*self._polynomial)[1]

    def displaced_ml(self, angle_rad: float | NDArray[Any] | Sequence[Any]) -> float | NDArray[np.float64]:
        """Return the volume displaced at an angle after the first contact.

        Parameters
        ----------
        angle_rad : float or array_like
            Angle, rad.

        Returns
        -------
        float or numpy.ndarray
            Volume, mL: 0 before the first contact and V_r beyond phi. Array input gives an array of float64
            of its shape.

        Raises
        ------
        ValueError
            If an angle is not finite.
        """
        return core._volume_polynomial_at(*self._polynomial, angle_rad)

    def plot(self, *, ax: Axes | None = None) -> Axes:
        """Draw the volume that a roller displaces over its angle.

        Parameters
        ----------
        ax : Axes, optional
            Axes to draw in. By default a new figure.

        Returns
        -------
        Axes
            Axes over the angle since the first contact, deg. Stretches where the volume is held are grey.

        Raises
        ------
        ImportError
            If matplotlib is missing, which `pip install './crates/pump-py[plot]'` brings.
        """
        from pumpmodel.plotting.fits import plot_polynomial

        return plot_polynomial(self, ax=ax)

    def _repr_html_(self) -> str:
        from pumpmodel._results.notebook.knowledge import polynomial_html

        return polynomial_html(self)

    @property
    def _polynomial(self) -> tuple[tuple[float, ...], float]:
        padding = (0.0,) * (_MOST - len(self.coefficients_ml_deg))
        return padding + self.coefficients_ml_deg, self.engagement_deg
