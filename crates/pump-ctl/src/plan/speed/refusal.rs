//! The refusal of a plan that breaks a limit.

use crate::plan::limits::{Limits, Lowest, Margin};
use crate::plan::words::{LimitedBy, Nearest, PlanError, SetBy};

/// Makes the refusal of a plan that breaks a limit.
pub(super) fn refusal(
    limits: &Limits,
    limited_by: LimitedBy,
    margin: Option<Margin>,
    nearest: Nearest,
) -> PlanError {
    let (reached, limit) = margin.map_or((f64::NAN, f64::NAN), |margin| (margin.reached, margin.limit));
    let set_by = |lowest: Option<Lowest>| lowest.map_or(SetBy::Given, |lowest| lowest.set_by);
    match limited_by {
        LimitedBy::OutletPressure => {
            PlanError::OutletPressure { predicted_kpa: reached, limit_kpa: limit, nearest }
        }
        LimitedBy::InletPressure => {
            let set_by = set_by(limits.lowest_where_it_sucks());
            PlanError::InletPressure { predicted_kpa: reached, limit_kpa: limit, set_by, nearest }
        }
        LimitedBy::OutletSuction => {
            let set_by = set_by(limits.lowest);
            PlanError::OutletSuction { predicted_kpa: reached, limit_kpa: limit, set_by, nearest }
        }
        _ => PlanError::Torque { needed_n_m: reached, limit_n_m: limit, nearest },
    }
}
