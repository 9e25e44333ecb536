"""A roller volume from measured points."""

from collections.abc import Sequence
from dataclasses import dataclass
from os import PathLike
from typing import Any, Literal, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pumpmodel import _pumpmodel as core
from pumpmodel._record import Record


@dataclass(frozen=True, init=False)
class VolumeFit(Record):
    """The volume that a roller displaces while it engages, fitted to measured points.

    The smallest angle is the first contact and the largest the engagement angle.
    `Pump.replace(roller_volume=fit)` makes a pump of it.

    Parameters
    ----------
    angle_deg : array_like
        Angles since the first contact, deg, shape (n,), in any order.
    volume_ml : array_like
        Volumes displaced since then, mL, shape (n,).
    method : {"spline", "quintic"}
        A rising cubic spline through the mean volume of each of 3 to 25 angles, whose flow has no jump; or
        least squares of 5th order over 6 angles or more, as McIntyre et al. do it.
    run : sequence of str, optional
        Name of each point's run, if the points are of several; by default all are one run.

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

    method: Literal["spline", "quintic"]
    angle_deg: tuple[float, ...]
    volume_ml: tuple[float, ...]
    run: tuple[str, ...] | None = None

    def __init__(
        self,
        angle_deg: ArrayLike,
        volume_ml: ArrayLike,
        *,
        method: Literal["spline", "quintic"] = "spline",
        run: Sequence[str] | None = None,
    ) -> None:
        angles, volumes = (np.asarray(numbers, dtype=np.float64) for numbers in (angle_deg, volume_ml))
        if angles.ndim != 1 or angles.shape != volumes.shape:
            raise ValueError(
                f"angle_deg has the shape {angles.shape} and volume_ml {volumes.shape}; "
                "allowed: one (n,) for both"
            )
        if run is not None and len(run) != len(angles):
            raise ValueError(f"run has {len(run)} names; allowed: {len(angles)}, one a point")
        object.__setattr__(self, "run", None if run is None else tuple(map(str, run)))
        object.__setattr__(self, "method", method)
        object.__setattr__(self, "angle_deg", tuple(angles.tolist()))
        object.__setattr__(self, "volume_ml", tuple(volumes.tolist()))
        core._volume_fit(*self._fit)

    @classmethod
    def from_csv(cls, path: str | PathLike[str], *, method: Literal["spline", "quintic"] = "spline") -> Self:
        """Fit the runs of a table, as `dose pumps new --roller-volume-points` reads it.

        Parameters
        ----------
        path : str or os.PathLike
            CSV with the columns `angle_deg`, `volume_ml` and perhaps `run`.
        method : {"spline", "quintic"}
            As of the constructor.

        Raises
        ------
        OSError
            If it cannot be opened; FileNotFoundError if it is not there.
        ValueError
            If it is no such table, or no curve can go through its points.
        """
        rows = core._volume_runs(path)
        return cls(
            [angle for _, angle, _ in rows],
            [volume for _, _, volume in rows],
            method=method,
            run=[run for run, _, _ in rows],
        )

    @classmethod
    def from_dict(cls, data: dict[str, Any]) -> Self:
        """Build the fit of what `to_dict` gave.

        Parameters
        ----------
        data : dict
            What `to_dict` returned.

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
        """The fit less what was measured, mL, shape (n,)."""
        return np.array(core._volume_fit(*self._fit)[2])

    @property
    def rms_ml(self) -> float:
        """Root of the mean square of the residuals, mL."""
        return core._volume_fit(*self._fit)[3]

    @property
    def falls(self) -> list[tuple[float, float, float]] | None:
        """Where measured volumes fall: from and to, deg, and by how much, mL; None of more than 25 angles."""
        return core._volume_fit(*self._fit)[4]

    @property
    def run_falls(self) -> list[tuple[str, float, float, float]]:
        """Where the volumes of a run fall: its name, from and to, deg, and by how much, mL.

        No roller does this: it is scatter, or a slip of the pen.
        """
        runs = self.run or ("1",) * len(self.angle_deg)
        return core._volume_run_falls(runs, self._fit[1])

    @property
    def held_deg(self) -> list[tuple[float, float]]:
        """Stretches over which the fit does not rise and the volume is held: from and to, deg."""
        return core._volume_fit(*self._fit)[5]

    def volume(self, angle_rad: float | NDArray[Any] | Sequence[Any]) -> float | NDArray[np.float64]:
        """Return the volume displaced at an angle since the first contact.

        Parameters
        ----------
        angle_rad : float or array_like
            Angle, rad.

        Returns
        -------
        float or numpy.ndarray
            mL, 0 before the first contact and V_r beyond phi; of arrays an array of float64 of the same
            shape.

        Raises
        ------
        ValueError
            If an angle is not finite.
        """
        return core._volume_fit_at(*self._fit, angle_rad)

    @property
    def _fit(self) -> tuple[str, list[tuple[float, float]]]:
        return self.method, list(zip(self.angle_deg, self.volume_ml, strict=True))
