"""The reports of a bench: a dose, the log, the status of the record, and a verification."""

from pumpmodel.dose.dose import (
    ByWeight,
    CalibrationUsed,
    Dose,
    Phase,
    Profile,
    Ripple,
    RippleAt,
    Run,
    Share,
    SharePrior,
)
from pumpmodel.dose.log import (
    LoggedDose,
)
from pumpmodel.dose.status import (
    BoardOnRecord,
    CalibrationInUse,
    LastByWeight,
    Safety,
    Stand,
    Status,
    Unfinished,
    UnfinishedCalibration,
    Wear,
)
from pumpmodel.dose.verification import (
    Tolerance,
    Verification,
)

__all__ = [
    "BoardOnRecord",
    "ByWeight",
    "CalibrationInUse",
    "CalibrationUsed",
    "Dose",
    "LastByWeight",
    "LoggedDose",
    "Phase",
    "Profile",
    "Ripple",
    "RippleAt",
    "Run",
    "Safety",
    "Share",
    "SharePrior",
    "Stand",
    "Status",
    "Tolerance",
    "Unfinished",
    "UnfinishedCalibration",
    "Verification",
    "Wear",
]
