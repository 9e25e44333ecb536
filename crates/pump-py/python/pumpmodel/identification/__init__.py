"""Lines from measurements, and the experiment that tells most of them."""

from pumpmodel.identification.experiment import ExpectedFit, Experiment, next_experiment
from pumpmodel.identification.identified import (
    Estimate,
    Identified,
    identify_compliance,
    identify_line,
    identify_resistance,
)
from pumpmodel.identification.joint import (
    JointlyIdentified,
    PressureRecord,
    RecordingFit,
    identify_line_jointly,
)

__all__ = [
    "Estimate",
    "ExpectedFit",
    "Experiment",
    "Identified",
    "JointlyIdentified",
    "PressureRecord",
    "RecordingFit",
    "identify_compliance",
    "identify_line",
    "identify_line_jointly",
    "identify_resistance",
    "next_experiment",
]
