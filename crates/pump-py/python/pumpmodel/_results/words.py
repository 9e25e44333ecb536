"""Numbers as people read them."""

import math
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from pumpmodel.identification.identified import Estimate

# Symbol or name, and unit, of the parameters of an identified line.
_PARAMETERS = {
    "resistance_kpa_s_ml": ("R", "kPa s/mL"),
    "compliance_ml_kpa": ("C", "mL/kPa"),
    "inertance_kpa_s2_ml": ("L", "kPa s²/mL"),
    "reservoir_kpa": ("reservoir", "kPa absolute"),
    "start_angle_deg": ("start angle", "deg"),
    "start_s": ("start", "s"),
    "offset_kpa": ("offset", "kPa"),
    "start_kpa": ("pressure at the start", "kPa"),
    "bulk_modulus_kpa": ("bulk modulus", "kPa"),
}


def number(value: float | None, unit: str = "", digits: int = 4) -> str:
    """Return a number of so many significant digits with its unit; what is None is not known."""
    if value is None:
        return "not known"
    if not math.isfinite(value) or abs(value) >= 1e9:
        return f"{value:.{digits}g} {unit}".rstrip()
    # Less than a picolitre or a nanopascal is rounding.
    small = abs(value) < 1e-9
    told = np.format_float_positional(
        0.0 if small else value, precision=digits, unique=False, fractional=False, trim="-"
    )
    return f"{told} {unit}".rstrip()


def between(least: float | None, most: float | None, unit: str) -> str:
    """Return a range with its unit."""
    if least is None or most is None:
        return number(None)
    return f"{number(least)} to {number(most, unit)}"


def give_or_take(value: float, expanded: float) -> str:
    """Return a value with its expanded uncertainty, both to two digits of the uncertainty."""
    if not (expanded > 0 and math.isfinite(expanded)):
        return number(value, digits=5)
    decimals = max(0, 1 - math.floor(math.log10(expanded)))
    return f"{value:.{decimals}f} ± {expanded:.{decimals}f}"


def parameter(name: str, estimate: "Estimate") -> tuple[str, str]:
    """Return the name of an identified parameter, and its value with its unit."""
    called, unit = _PARAMETERS.get(name, (name, ""))
    if estimate.held:
        return called, f"{number(estimate.value, unit, 5)}, held"
    return called, f"{give_or_take(estimate.value, 2 * estimate.standard)} {unit}".rstrip()
