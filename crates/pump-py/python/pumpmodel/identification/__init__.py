"""Lines from measurements, and the experiment that tells most of them."""

from pumpmodel.identification.experiment import ExpectedFit, Experiment, next_experiment
from pumpmodel.identification.identified import (
    Estimate,
    Identified,
    identify_compliance,
    identify_line,
    identify_resistance,
)

__all__ = [
    "Estimate",
    "ExpectedFit",
    "Experiment",
    "Identified",
    "identify_compliance",
    "identify_line",
    "identify_resistance",
    "next_experiment",
]
