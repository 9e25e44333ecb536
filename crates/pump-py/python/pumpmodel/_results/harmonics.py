"""The sines into which a pulsation divides."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray


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
