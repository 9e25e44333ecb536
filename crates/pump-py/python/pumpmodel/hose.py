"""Hoses, and the lines that follow from them."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, overload

import numpy as np
from numpy.typing import NDArray

from pumpmodel import _pumpmodel as core
from pumpmodel._pumpmodel import Line
from pumpmodel._results.numbers import Number, floats_of
from pumpmodel._results.record import Record
from pumpmodel.fluid import Fluid


@dataclass(frozen=True, kw_only=True)
class Hose(Record):
    """A straight hose of one bore, which gives R, C and L with the fluid in it.

    Parameters
    ----------
    bore_radius_mm : float
        Inner radius, mm.
    outer_radius_mm : float
        Outer radius, mm.
    length_mm : float
        Length, mm.
    modulus_mpa : float
        Young's modulus of the wall, MPa.
    poisson_ratio : float
        Poisson ratio of the wall, 0 to 0.5; 0.5 is rubber, which keeps its volume.
    minor_loss : float
        Loss of ends, bends and fittings together, in velocity heads of the bore.

    Raises
    ------
    ValueError
        If a value is outside its range.

    Examples
    --------
    The hose of McIntyre et al., who took R at 210 mL/s:

    >>> import pumpmodel as pm
    >>> hose = pm.Hose(
    ...     bore_radius_mm=5, outer_radius_mm=7, length_mm=331, modulus_mpa=3.5, minor_loss=5.75
    ... )
    >>> line = hose.line(pm.Fluid.water(temperature_degc=25), reservoir_kpa=88.637, flow_ml_s=210)
    >>> round(line.resistance_kpa_s_ml, 3)
    0.111
    """

    bore_radius_mm: float
    outer_radius_mm: float
    length_mm: float
    modulus_mpa: float
    poisson_ratio: float = 0.5
    minor_loss: float = 0.0

    if TYPE_CHECKING:

        def __init__(
            self,
            *,
            bore_radius_mm: Number,
            outer_radius_mm: Number,
            length_mm: Number,
            modulus_mpa: Number,
            poisson_ratio: Number = 0.5,
            minor_loss: Number = 0.0,
        ) -> None: ...

    def __post_init__(self) -> None:
        """Refuse dimensions that no hose has."""
        floats_of(
            self,
            "bore_radius_mm",
            "outer_radius_mm",
            "length_mm",
            "modulus_mpa",
            "poisson_ratio",
            "minor_loss",
        )
        core._hose_volume(self._numbers())

    @property
    def volume_ml(self) -> float:
        """Volume of the bore, mL."""
        return core._hose_volume(self._numbers())

    def line(self, fluid: Fluid, *, reservoir_kpa: Number, flow_ml_s: Number) -> Line:
        """Return the linear line of this hose.

        C adds the compliance of the fluid and of a thick-walled cylinder whose ends are held (Lamé, plane
        strain). L is rho l/A.

        Parameters
        ----------
        fluid : Fluid
            Fluid in the hose.
        reservoir_kpa : float
            Pressure of the reservoir, kPa absolute.
        flow_ml_s : float
            Flow, mL/s, at which R is the pressure drop over the flow. 0 takes the R of laminar flow alone.

        Raises
        ------
        ValueError
            If a value is outside its range.
        """
        return core._hose_line(self._numbers(), _numbers_of(fluid), reservoir_kpa, flow_ml_s)

    @overload
    def pressure_drop_kpa(self, fluid: Fluid, *, flow_ml_s: Number) -> float: ...
    @overload
    def pressure_drop_kpa(
        self, fluid: Fluid, *, flow_ml_s: NDArray[Any] | Sequence[Any]
    ) -> NDArray[np.float64]: ...
    def pressure_drop_kpa(
        self, fluid: Fluid, *, flow_ml_s: Number | NDArray[Any] | Sequence[Any]
    ) -> float | NDArray[np.float64]:
        """Return the pressure drop along the hose at a flow.

        It adds the friction of a smooth wall, laminar to turbulent, by Churchill's formula (Chem. Eng. 84,
        1977), and the minor loss.

        Parameters
        ----------
        fluid : Fluid
            Fluid in the hose.
        flow_ml_s : float or array_like
            Flow, mL/s, either way, up to 1e6.

        Returns
        -------
        float or numpy.ndarray
            Pressure drop in the direction of the flow, kPa. Array input gives an array of float64 of its
            shape.

        Raises
        ------
        ValueError
            If a flow is not finite or beyond 1e6 mL/s.
        """
        return core._hose_drop(self._numbers(), _numbers_of(fluid), flow_ml_s)

    @overload
    def reynolds(self, fluid: Fluid, *, flow_ml_s: Number) -> float: ...
    @overload
    def reynolds(self, fluid: Fluid, *, flow_ml_s: NDArray[Any] | Sequence[Any]) -> NDArray[np.float64]: ...
    def reynolds(
        self, fluid: Fluid, *, flow_ml_s: Number | NDArray[Any] | Sequence[Any]
    ) -> float | NDArray[np.float64]:
        """Return the Reynolds number of a flow.

        Parameters
        ----------
        fluid : Fluid
            Fluid in the hose.
        flow_ml_s : float or array_like
            Flow, mL/s, either way, up to 1e6.

        Returns
        -------
        float or numpy.ndarray
            Reynolds number rho v d/mu. Array input gives an array of float64 of its shape.

        Raises
        ------
        ValueError
            If a flow is not finite or beyond 1e6 mL/s.
        """
        return core._hose_reynolds(self._numbers(), _numbers_of(fluid), flow_ml_s)

    def _numbers(self) -> tuple[float, float, float, float, float, float]:
        return (
            self.bore_radius_mm,
            self.outer_radius_mm,
            self.length_mm,
            self.modulus_mpa,
            self.poisson_ratio,
            self.minor_loss,
        )


def _numbers_of(fluid: object) -> tuple[float, float, float, float | None]:
    if not isinstance(fluid, Fluid):
        told = f"the class {fluid.__name__} itself" if isinstance(fluid, type) else type(fluid).__name__
        message = f"fluid must be a Fluid, not {told}; pm.Fluid.water(temperature_degc=20) makes one"
        raise TypeError(message)
    return fluid._numbers()
