"""First-principles model of a roller-type peristaltic pump, and doses planned from the angle of its rollers.

Units are mL, kPa absolute, s and rad. A name that takes or returns a number with a unit ends with the unit;
text has its unit in itself, as ``"25mL"``. Functions take a speed as ``speed_rpm`` or ``speed_rad_s``. The
ports are ``inlet`` and ``outlet``: ``inlet_kpa`` is the pressure at the inlet, ``inlet_flow_ml_s`` the flow.
Choices are words, whose types are in ``pumpmodel.choices``. Former names still work, with a
DeprecationWarning.

Examples
--------
>>> import pumpmodel as pm
>>> pump = pm.Pump.three_roller()
>>> run = pump.simulate(speed_rpm=100, duration_s=1)
>>> f"{run.inlet_kpa.min():.1f} to {run.inlet_kpa.max():.1f} kPa"
'71.7 to 98.1 kPa'
"""

from pumpmodel import choices
from pumpmodel._pumpmodel import (
    Balance,
    Calibration,
    Doser,
    Limits,
    Line,
    LineLikelihood,
    Plan,
    Pump,
    Run,
    SteadyState,
    __version__,
    nrmse,
    pearson,
    rmse,
)
from pumpmodel._results import methods as _methods
from pumpmodel._results.harmonics import Harmonics
from pumpmodel._results.sensitivity import Sensitivity
from pumpmodel._results.states import LineStates
from pumpmodel.bench import AsyncBench, Bench
from pumpmodel.dose import Dose, LoggedDose, Status, Verification
from pumpmodel.errors import (
    BalanceError,
    DriveError,
    PlanError,
    PumpError,
    PumpFileError,
    SafetyError,
    StoppedError,
    UnfinishedError,
)
from pumpmodel.fluid import Fluid
from pumpmodel.heads import Head, HeadSource, heads
from pumpmodel.hose import Hose
from pumpmodel.identification import (
    Estimate,
    ExpectedFit,
    Experiment,
    Identified,
    JointlyIdentified,
    PressureRecord,
    RecordingFit,
    identify_compliance,
    identify_line,
    identify_line_jointly,
    identify_resistance,
    next_experiment,
)
from pumpmodel.monte_carlo import VolumeTrials, monte_carlo
from pumpmodel.plotting import (
    animate,
    plot,
    plot_budget,
    plot_dose_error,
    plot_map,
    plot_pitch,
    plot_pump,
)
from pumpmodel.rack import Rack, RackDose, RackPump, RackReport, RackTotal
from pumpmodel.speed_law import SpeedLaw
from pumpmodel.sweeps import Sweep, sweep, sweep_in_parts
from pumpmodel.volume_fit import VolumeFit, VolumePolynomial
from pumpmodel.weighed import PhaseFit, ShortDose, WeighedRun

__all__ = [
    "AsyncBench",
    "Balance",
    "BalanceError",
    "Bench",
    "Calibration",
    "Dose",
    "Doser",
    "DriveError",
    "Estimate",
    "ExpectedFit",
    "Experiment",
    "Fluid",
    "Harmonics",
    "Head",
    "HeadSource",
    "Hose",
    "Identified",
    "JointlyIdentified",
    "Limits",
    "Line",
    "LineLikelihood",
    "LineStates",
    "LoggedDose",
    "PhaseFit",
    "Plan",
    "PlanError",
    "PressureRecord",
    "Pump",
    "PumpError",
    "PumpFileError",
    "Rack",
    "RackDose",
    "RackPump",
    "RackReport",
    "RackTotal",
    "RecordingFit",
    "Run",
    "SafetyError",
    "Sensitivity",
    "ShortDose",
    "SpeedLaw",
    "Status",
    "SteadyState",
    "StoppedError",
    "Sweep",
    "UnfinishedError",
    "Verification",
    "VolumeFit",
    "VolumePolynomial",
    "VolumeTrials",
    "WeighedRun",
    "__version__",
    "animate",
    "choices",
    "heads",
    "identify_compliance",
    "identify_line",
    "identify_line_jointly",
    "identify_resistance",
    "monte_carlo",
    "next_experiment",
    "nrmse",
    "pearson",
    "plot",
    "plot_budget",
    "plot_dose_error",
    "plot_map",
    "plot_pitch",
    "plot_pump",
    "rmse",
    "sweep",
    "sweep_in_parts",
]

_methods.attach()
