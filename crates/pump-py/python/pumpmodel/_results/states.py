"""The state of the lines at an instant."""

from typing import NamedTuple


class LineStates(NamedTuple):
    """Pressures and flows of both lines at an instant.

    `Run.end_state` is one, and `Pump.simulate(initial=...)` takes one. The flows are those of the lines,
    which lag behind the flows at the rollers.
    """

    #: Pressure at the inlet, kPa absolute.
    inlet_kpa: float
    #: Flow in the inlet's line, mL/s, towards the pump.
    inlet_line_ml_s: float
    #: Pressure at the outlet, kPa absolute.
    outlet_kpa: float
    #: Flow in the outlet's line, mL/s, away from the pump.
    outlet_line_ml_s: float
