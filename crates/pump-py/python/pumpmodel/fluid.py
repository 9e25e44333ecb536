"""Properties of the pumped fluid."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Self

from pumpmodel import _pumpmodel as core
from pumpmodel._results.numbers import Number, floats_of
from pumpmodel._results.record import Record


@dataclass(frozen=True, kw_only=True)
class Fluid(Record):
    """Properties of a fluid at one temperature, at about atmospheric pressure.

    Parameters
    ----------
    density_kg_m3 : float
        Density, kg/m³, more than zero.
    viscosity_mpa_s : float
        Dynamic viscosity, mPa s, more than zero.
    bulk_modulus_mpa : float
        Isothermal bulk modulus, MPa, more than zero.
    vapour_kpa : float, optional
        Vapour pressure, kPa absolute, if it is known.

    Raises
    ------
    ValueError
        If a property is outside its range.

    Examples
    --------
    >>> import pumpmodel as pm
    >>> round(pm.Fluid.water(temperature_degc=25).density_kg_m3, 1)
    997.0
    """

    density_kg_m3: float
    viscosity_mpa_s: float
    bulk_modulus_mpa: float
    vapour_kpa: float | None = None

    if TYPE_CHECKING:

        def __init__(
            self,
            *,
            density_kg_m3: Number,
            viscosity_mpa_s: Number,
            bulk_modulus_mpa: Number,
            vapour_kpa: Number | None = None,
        ) -> None: ...

    def __post_init__(self) -> None:
        """Refuse properties that no fluid has."""
        floats_of(self, "density_kg_m3", "viscosity_mpa_s", "bulk_modulus_mpa", "vapour_kpa")
        core._fluid_check(self._numbers())

    @classmethod
    def water(cls, *, temperature_degc: Number) -> Self:
        """Return the properties of water.

        Density and compressibility follow Kell (J. Chem. Eng. Data 20:97, 1975), viscosity IAPWS SR6-08, and
        vapour pressure IAPWS SR1-86.

        Parameters
        ----------
        temperature_degc : float
            Temperature, degC, 0 to 100.

        Raises
        ------
        ValueError
            If the temperature is outside its range.
        """
        density, viscosity, modulus, vapour = core._fluid_water(temperature_degc)
        return cls(
            density_kg_m3=density, viscosity_mpa_s=viscosity, bulk_modulus_mpa=modulus, vapour_kpa=vapour
        )

    def _numbers(self) -> tuple[float, float, float, float | None]:
        return (self.density_kg_m3, self.viscosity_mpa_s, self.bulk_modulus_mpa, self.vapour_kpa)
