"""The types of arguments and fields that are one of a few words.

Each type is a `Literal`. `typing.get_args(choices.Finish)` lists its words.
"""

from typing import Literal, TypeAlias

#: Protocol of a balance at a serial port.
BalanceProtocol: TypeAlias = Literal["mt-sics", "sbi"]
#: Motion at the start of a record, for `identify_line`.
Begin: TypeAlias = Literal["ramp", "step", "steady"]
#: Curve that weighed runs are fitted with.
CalibrationFit: TypeAlias = Literal["best", "line", "factor", "speed-law"]
#: Driver of a motor.
Driver: TypeAlias = Literal["sim", "grbl", "node", "klipper"]
#: Places in a pitch where a dose may end.
Finish: TypeAlias = Literal["any", "low-flow"]
#: Kind of an identification.
Identification: TypeAlias = Literal["resistance", "compliance", "line"]
#: State of the lines at time 0 of `Pump.simulate`.
Initial: TypeAlias = Literal["rest", "steady"]
#: Reason for the smallest pressure that is allowed, in `Dose.inlet_limit`.
InletLimit: TypeAlias = Literal["given", "tube_collapse", "vapour_pressure"]
#: Limit that keeps a dose from being faster. A pressure has the name of its port: "suction" is the smallest
#: pressure allowed there, "pressure" the largest. In reverse the outlet sucks and the inlet pushes.
LimitedBy: TypeAlias = Literal[
    "none",
    "speed",
    "acceleration",
    "inlet_suction",
    "inlet_pressure",
    "outlet_suction",
    "outlet_pressure",
    "torque",
]
#: Parameter of a line that `identify_line` seeks.
LineParameter: TypeAlias = Literal["R", "C", "L", "reservoir", "start"]
#: Solution of `Pump.simulate`.
Method: TypeAlias = Literal["auto", "exact", "rodas5p", "radau"]
#: Choice of what happens to a dose of a batch whose time has passed.
Missed: TypeAlias = Literal["skip", "now"]
#: Model of `Pump.simulate`.
Model: TypeAlias = Literal["flow-centric", "roller-centric"]
#: Pace of simulated motors: that of their plans, or as fast as they can.
Pace: TypeAlias = Literal["real", "fast"]
#: Panel of `plot`.
Panel: TypeAlias = Literal["flow", "pressure", "speed", "delivered"]
#: Source of the rotor's angle. "recorded" follows from the motions on record, and "assumed" is the middle of
#: the angles that an unknown angle may be.
PhaseSource: TypeAlias = Literal["home", "mark", "recorded", "given", "assumed"]
#: Cause for which the rotor's angle, once known, is unknown.
AngleLoss: TypeAlias = Literal[
    "disturbed",
    "current_lost",
    "emergency_stop",
    "taken_over",
    "other_count",
    "uncounted_steps",
    "other_head",
    "other_steps",
]
#: Port of a pump.
Port: TypeAlias = Literal["inlet", "outlet"]
#: Kind of the document that a head's figures are from: the maker's own, one that quotes the maker's
#: figures, or the table of a program.
Provenance: TypeAlias = Literal["maker", "quoted", "program"]
#: End of a dose in the log.
LogEnd: TypeAlias = Literal["done", "weighed", "stopped", "fault", "cut-off"]

#: Purpose of a motion.
Purpose: TypeAlias = Literal["dose", "prime", "purge", "run", "calibrate", "retract", "jog"]
#: End of a rack. "planned" is a rehearsal.
RackEnd: TypeAlias = Literal["planned", "completed", "stopped", "fault"]
#: Ramps in which a dose starts and stops. "line-aware", the name of earlier versions for "line", is read too.
Ramps: TypeAlias = Literal["line", "fastest"]
#: Result of `sweep` and `Pump.steady_state`, for `plot_map`.
SteadyQuantity: TypeAlias = Literal[
    "inlet_min_kpa",
    "inlet_max_kpa",
    "inlet_mean_kpa",
    "outlet_min_kpa",
    "outlet_max_kpa",
    "outlet_mean_kpa",
    "mean_flow_ml_s",
    "ripple_peak_to_peak",
    "ripple_rms",
]
#: Source of a dose's uncertainty.
UncertaintySource: TypeAlias = Literal[
    "model",
    "repeatability",
    "roller_volume",
    "step",
    "phase",
    "calibration",
    "speed_law",
    "speed",
    "temperature",
    "drop",
    "backflow",
    "carry",
    "angle",
    "balance",
    "density",
    "pulse",
]
#: Limit for which no value is known. "discharge_pressure" is the largest pressure at the port that pushes,
#: "suction_pressure" the smallest at the port that sucks.
UncheckedLimit: TypeAlias = Literal[
    "discharge_pressure", "suction_pressure", "tube_collapse", "vapour_pressure", "torque", "settling"
]
#: Variant of a built-in pump.
Variant: TypeAlias = Literal["measured", "published", "as-built"]
#: Basis of a dose's volume: the model, the model of a drawing, the volumes that were weighed, or the
#: balance that ended the dose.
VolumeBasis: TypeAlias = Literal["model", "estimated", "calibrated", "weighed"]
#: Curve through the measured points of a roller volume.
VolumeMethod: TypeAlias = Literal["spline", "quintic"]
