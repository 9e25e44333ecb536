"""The volume of a roller from measured points, or from a function of the angle."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from os import PathLike
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple, Self, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pumpmodel import _pumpmodel as core
from pumpmodel._results import checks
from pumpmodel._results.numbers import Number
from pumpmodel._results.record import Record
from pumpmodel._results.renamed import renamed
from pumpmodel.choices import VolumeMethod
from pumpmodel.volume_fit.doubts import doubts_of
from pumpmodel.volume_fit.engagement import engagement_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes


class Fall(NamedTuple):
    """A fall of a measured volume, from an angle to another, deg, and by how much, mL."""

    from_deg: float
    to_deg: float
    fall_ml: float


# Angles at which a function is sampled: ten in each of the pieces of a spline.
_SAMPLES = 241
_ALLOWED_SAMPLES = range(26, 10_001)

# A volume is taken for 0, and for one that does not fall, within this part of the largest volume.
_ROUNDING = 1e-9


class RunFall(NamedTuple):
    """A fall of the volume within a run: name of the run, from and to, deg, and by how much, mL."""

    run: str
    from_deg: float
    to_deg: float
    fall_ml: float


@dataclass(frozen=True, init=False)
class VolumeFit(Record):
    """The volume that a roller displaces while it engages, fitted to measured points.

    The smallest angle is the first contact, and the largest is the engagement angle.
    `Pump.replace(roller_volume=fit)` returns a pump with this roller volume.

    Parameters
    ----------
    angle_deg : array_like
        Angles since the first contact, deg, shape (n,), in any order.
    volume_ml : array_like
        Volumes displaced since then, mL, shape (n,).
    method : {"spline", "quintic"}
        "spline" is a rising cubic spline, whose flow has no jump: through the mean volume of each of 3 to 25
        angles, and near more angles, hundreds too, by least squares from 0 mL at 0 deg, with 25 knots at
        most. "quintic" is a polynomial of 5th order by least squares over 6 angles or more, as McIntyre et
        al. fit it.
    run : sequence of str, optional
        Name of each point's run, if the points come from several runs; by default all are one run.

    Raises
    ------
    ValueError
        If the points are too few, or no curve can go through them.

    Examples
    --------
    >>> import pumpmodel as pm
    >>> fit = pm.VolumeFit([0, 10, 20, 30, 40, 50], [0, 0.23, 0.83, 1.49, 1.96, 2.1])
    >>> round(pm.Pump.three_roller().replace(roller_volume=fit).roller_volume_ml, 6)
    2.1
    """

    method: VolumeMethod
    angle_deg: tuple[float, ...]
    volume_ml: tuple[float, ...]
    run: tuple[str, ...] | None = None
    # True if the points are samples of a function, which is a curve in the picture.
    _is_function: ClassVar[bool] = False

    def __init__(
        self,
        angle_deg: ArrayLike,
        volume_ml: ArrayLike,
        *,
        method: VolumeMethod = "spline",
        run: Sequence[str] | None = None,
    ) -> None:
        angles, volumes = (
            np.asarray(core._numbers(name, numbers))
            for name, numbers in (("angle_deg", angle_deg), ("volume_ml", volume_ml))
        )
        if angles.ndim != 1 or angles.shape != volumes.shape:
            raise ValueError(
                f"angle_deg has shape {angles.shape} and volume_ml has shape {volumes.shape}; "
                "allowed: (n,) for both"
            )
        checks.chosen("method", method, get_args(VolumeMethod))
        if run is not None and len(run) != len(angles):
            raise ValueError(f"run has {len(run)} names; allowed: {len(angles)}, one for each point")
        object.__setattr__(self, "run", None if run is None else tuple(map(str, run)))
        object.__setattr__(self, "method", method)
        object.__setattr__(self, "angle_deg", tuple(angles.tolist()))
        object.__setattr__(self, "volume_ml", tuple(volumes.tolist()))
        core._volume_fit(*self._fit)

    def __repr__(self) -> str:
        """Return method, number of points, volume and angle: the points may be thousands."""
        return (
            f"VolumeFit(method={self.method!r}, {len(self.angle_deg)} points, total_ml={self.total_ml:.6g}, "
            f"engagement_deg={self.engagement_deg:.6g})"
        )

    @classmethod
    def from_csv(cls, path: str | PathLike[str], *, method: VolumeMethod = "spline") -> Self:
        """Fit the runs of a table, as `dose pumps new --roller-volume-points` reads it.

        Parameters
        ----------
        path : str or os.PathLike
            CSV with the columns `angle_deg`, `volume_ml` and perhaps `run`.
        method : {"spline", "quintic"}
            Curve through the points: a cubic spline, or a polynomial of 5th order by least squares.

        Raises
        ------
        OSError
            If the file cannot be opened. A missing file is a FileNotFoundError.
        ValueError
            If the file is no such table, or no curve can go through its points.
        """
        rows = core._volume_runs(path)
        return cls(
            [angle for _, angle, _ in rows],
            [volume for _, _, volume in rows],
            method=method,
            run=[run for run, _, _ in rows],
        )

    @classmethod
    def from_function(
        cls,
        function: Callable[[Any], Any],
        engagement_deg: Number,
        *,
        samples: int = _SAMPLES,
    ) -> Self:
        """Fit a rising spline to a function of the angle, which is called at even distances.

        `abs(fit.residuals_ml).max()` is the largest deviation of the fit from the function, mL. The slope of
        the fit is 0 at both ends, and features narrower than 1/24 of the engagement are smoothed.

        Parameters
        ----------
        function : callable
            Takes the angle since the first contact, deg, and returns the volume displaced since then, mL: 0
            at 0 deg, and rising. It is called once with an array of all angles. If that raises a TypeError or
            a ValueError, as `math` and `if` do, it is called with each angle as a float.
        engagement_deg : float
            Angle over which a roller engages, phi, deg, more than 0 and less than 360.
        samples : int
            Number of angles, 26 to 10,000. A pump's file holds each of them.

        Raises
        ------
        TypeError
            If `function` cannot be called, or `samples` is no whole number.
        ValueError
            If an argument is outside its range, or the function is not finite, is not 0 at 0 deg, falls, or
            gives another number of volumes than of angles.

        Warns
        -----
        UserWarning
            If the function jumps, has an outlier, or is constant at its beginning or its end: the fit smooths
            the first two, and the engagement is shorter than a constant says.

        Examples
        --------
        >>> import math
        >>> import pumpmodel as pm
        >>> fit = pm.VolumeFit.from_function(lambda deg: 1 - math.cos(math.pi * deg / 50), 50)
        >>> round(fit.total_ml, 4), abs(fit.residuals_ml).max() < 1e-6
        (2.0, True)
        """
        if not callable(function):
            raise TypeError(f"function must be callable, not {type(function).__name__}")
        if isinstance(samples, bool) or not isinstance(samples, int | np.integer):
            raise TypeError(f"samples must be a whole number, not {type(samples).__name__}")
        if samples not in _ALLOWED_SAMPLES:
            raise ValueError(f"samples is {samples:.6g}; allowed: 26 to 10000")
        angles = np.linspace(0, engagement_of(engagement_deg), int(samples))
        fit = cls(angles, _sampled(function, angles))
        object.__setattr__(fit, "_is_function", True)
        for warning in doubts_of(angles, np.asarray(fit.volume_ml)):
            warnings.warn(warning, UserWarning, stacklevel=2)
        return fit

    @classmethod
    def from_dict(cls, data: dict[str, Any]) -> Self:
        """Return the fit of the data that `to_dict` gave.

        Parameters
        ----------
        data : dict
            Data that `to_dict` returned.

        Raises
        ------
        ValueError
            If no curve can go through the points.
        """
        return cls(**data)

    @property
    def engagement_deg(self) -> float:
        """Angle over which a roller engages, phi, deg."""
        return core._volume_fit(*self._fit)[0]

    @property
    def total_ml(self) -> float:
        """Volume of a roller, V_r, mL."""
        return core._volume_fit(*self._fit)[1]

    @property
    def residuals_ml(self) -> NDArray[np.float64]:
        """Residuals, fitted less measured, mL, shape (n,)."""
        return np.array(core._volume_fit(*self._fit)[2])

    @property
    def rms_ml(self) -> float:
        """Root of the mean square of the residuals, mL."""
        return core._volume_fit(*self._fit)[3]

    @property
    def falls(self) -> list[Fall] | None:
        """Falls of the measured volume, as tuples with names; None beyond 25 angles."""
        falls = core._volume_fit(*self._fit)[4]
        return None if falls is None else [Fall(*fall) for fall in falls]

    @property
    def run_falls(self) -> list[RunFall]:
        """Falls of the volume within a run, as tuples with names.

        No roller behaves so: a fall is scatter or a typing error.
        """
        runs = self.run or ("1",) * len(self.angle_deg)
        return [RunFall(*fall) for fall in core._volume_run_falls(runs, self._fit[1])]

    @property
    def held_deg(self) -> list[tuple[float, float]]:
        """Stretches where the fit would not rise and the volume is held: from and to, deg."""
        return core._volume_fit(*self._fit)[5]

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
        return core._volume_fit_at(*self._fit, angle_rad)

    def volume(self, angle_rad: float | NDArray[Any] | Sequence[Any]) -> float | NDArray[np.float64]:
        """Return the volume, by the deprecated name of `displaced_ml`."""
        renamed("VolumeFit.volume", "VolumeFit.displaced_ml")
        return self.displaced_ml(angle_rad)

    def plot(self, *, ax: Axes | None = None) -> Axes:
        """Draw the measured points, and the fitted curve through them.

        Parameters
        ----------
        ax : Axes, optional
            Axes to draw in. By default a new figure.

        Returns
        -------
        Axes
            Axes over the angle since the first contact, deg.

        Raises
        ------
        ImportError
            If matplotlib is missing, which `pip install './crates/pump-py[plot]'` brings.
        """
        from pumpmodel.plotting.fits import plot_volume

        return plot_volume(self, ax=ax)

    def _repr_html_(self) -> str:
        from pumpmodel._results.notebook.shown import volume_html

        return volume_html(self)

    @property
    def _fit(self) -> tuple[VolumeMethod, list[tuple[float, float]]]:
        return self.method, list(zip(self.angle_deg, self.volume_ml, strict=True))


def _sampled(function: Callable[[Any], Any], angles: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the volumes of a function at these angles, deg, in order, or refuse it."""
    try:
        values = function(angles.copy())
    except (TypeError, ValueError):
        values = [function(angle) for angle in angles.tolist()]
    volumes = np.asarray(core._numbers("function", values))
    if volumes.shape != angles.shape:
        cure = "; return an array, as np.full_like(angle, 0.05)" if volumes.shape == () else ""
        raise ValueError(
            f"function returns the shape {volumes.shape} for {len(angles)} angles; "
            f"allowed: ({len(angles)},){cure}"
        )
    infinite = np.flatnonzero(~np.isfinite(volumes))
    if len(infinite):
        at = infinite[0]
        raise ValueError(
            f"function is {volumes[at]} at {angles[at]:.6g} deg; allowed: a volume in mL, finite"
        )
    least = _ROUNDING * abs(volumes).max()
    if abs(volumes[0]) > least:
        raise ValueError(f"function is {volumes[0]:.6g} mL at 0 deg; allowed: 0, the first contact")
    falling = np.flatnonzero(np.diff(volumes) < -least)
    if len(falling):
        at = falling[0]
        raise ValueError(
            f"function falls from {volumes[at]:.6g} mL at {angles[at]:.6g} deg "
            f"to {volumes[at + 1]:.6g} mL at {angles[at + 1]:.6g} deg; allowed: a volume that rises"
        )
    if volumes[-1] <= 0:
        raise ValueError(f"function is {volumes[-1]:.6g} mL at {angles[-1]:.6g} deg; allowed: more than 0")
    return volumes
