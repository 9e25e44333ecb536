from typing import Final

from .bench import Balance as Balance
from .bench import _Bench as _Bench
from .bench import _Call as _Call
from .bench import _Rack as _Rack
from .bench import _Schedule as _Schedule
from .doser import Calibration as Calibration
from .doser import Doser as Doser
from .doser import Limits as Limits
from .functions import _cavitation as _cavitation
from .functions import _choices as _choices
from .functions import _fluid_check as _fluid_check
from .functions import _fluid_water as _fluid_water
from .functions import _heads as _heads
from .functions import _hose_drop as _hose_drop
from .functions import _hose_line as _hose_line
from .functions import _hose_reynolds as _hose_reynolds
from .functions import _hose_volume as _hose_volume
from .functions import _identify_compliance as _identify_compliance
from .functions import _identify_line as _identify_line
from .functions import _identify_line_jointly as _identify_line_jointly
from .functions import _identify_resistance as _identify_resistance
from .functions import _law_check as _law_check
from .functions import _law_published as _law_published
from .functions import _law_revolution as _law_revolution
from .functions import _law_trapped as _law_trapped
from .functions import _number as _number
from .functions import _numbers as _numbers
from .functions import _reading as _reading
from .functions import _steady_states as _steady_states
from .functions import _volume_fit as _volume_fit
from .functions import _volume_fit_at as _volume_fit_at
from .functions import _volume_polynomial as _volume_polynomial
from .functions import _volume_polynomial_at as _volume_polynomial_at
from .functions import _volume_run_falls as _volume_run_falls
from .functions import _volume_runs as _volume_runs
from .functions import nrmse as nrmse
from .functions import pearson as pearson
from .functions import rmse as rmse
from .pump import Line as Line
from .pump import LineLikelihood as LineLikelihood
from .pump import Pump as Pump
from .results import Plan as Plan
from .results import Run as Run
from .results import SteadyState as SteadyState

__all__ = [
    "Balance",
    "Calibration",
    "Doser",
    "Limits",
    "Line",
    "LineLikelihood",
    "Plan",
    "Pump",
    "Run",
    "SteadyState",
    "_Bench",
    "_Call",
    "_Rack",
    "_Schedule",
    "__version__",
    "_cavitation",
    "_choices",
    "_fluid_check",
    "_fluid_water",
    "_heads",
    "_hose_drop",
    "_hose_line",
    "_hose_reynolds",
    "_hose_volume",
    "_identify_compliance",
    "_identify_line",
    "_identify_line_jointly",
    "_identify_resistance",
    "_law_check",
    "_law_published",
    "_law_revolution",
    "_law_trapped",
    "_number",
    "_numbers",
    "_reading",
    "_steady_states",
    "_volume_fit",
    "_volume_fit_at",
    "_volume_polynomial",
    "_volume_polynomial_at",
    "_volume_run_falls",
    "_volume_runs",
    "nrmse",
    "pearson",
    "rmse",
]

__version__: Final[str]
