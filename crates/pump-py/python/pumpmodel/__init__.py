"""First-principles model of a roller-type peristaltic pump, and doses planned from the angle of its rollers.

Units are mL, kPa absolute, s and rad, and stand in every name; speeds are given as ``speed_rpm`` or
``speed_rad_s``.

Examples
--------
>>> import pumpmodel as pm
>>> pump = pm.Pump.three_roller()
>>> run = pump.simulate(speed_rpm=100, duration_s=1)
>>> f"{run.p_in_kpa.min():.1f} to {run.p_in_kpa.max():.1f} kPa"
'71.7 to 98.1 kPa'
"""

from pumpmodel._pumpmodel import Doser, Limits, Line, Plan, Pump, Run, SteadyState, __version__
from pumpmodel.errors import PlanError, PumpError, PumpFileError
from pumpmodel.plotting import plot, plot_map
from pumpmodel.section import plot_pump
from pumpmodel.sweeps import Sweep, sweep

__all__ = [
    "Doser",
    "Limits",
    "Line",
    "Plan",
    "PlanError",
    "Pump",
    "PumpError",
    "PumpFileError",
    "Run",
    "SteadyState",
    "Sweep",
    "__version__",
    "plot",
    "plot_map",
    "plot_pump",
    "sweep",
]
