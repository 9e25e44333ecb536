//! The refusal of a plan that breaks a limit.

use crate::plan::limits::{Bound, Limits, Lowest, Margin};
use crate::plan::words::{Nearest, PlanError, SetBy};
use crate::step::Direction;

/// Makes the refusal of a plan in this direction that breaks a limit.
pub(super) fn refusal(
    limits: &Limits,
    direction: Direction,
    bound: Bound,
    margin: Margin,
    nearest: Nearest,
) -> PlanError {
    let Margin { reached, limit, used } = margin;
    // A limit that the line breaks at rest leaves no room to use.
    let of = |set_by: SetBy| {
        if used.is_infinite() && set_by == SetBy::Given && nearest == Nearest::Nothing {
            Nearest::RestBreaks
        } else {
            nearest
        }
    };
    let set_by = |lowest: Option<Lowest>| lowest.map_or(SetBy::Given, |lowest| lowest.set_by);
    match bound {
        Bound::DischargePressure => {
            let nearest = of(SetBy::Given);
            PlanError::OutletPressure { direction, predicted_kpa: reached, limit_kpa: limit, nearest }
        }
        Bound::Suction => {
            let set_by = set_by(limits.lowest_where_it_sucks());
            let nearest = of(set_by);
            PlanError::InletPressure { direction, predicted_kpa: reached, limit_kpa: limit, set_by, nearest }
        }
        Bound::DischargeSuction => {
            let set_by = set_by(limits.lowest);
            PlanError::OutletSuction { direction, predicted_kpa: reached, limit_kpa: limit, set_by, nearest }
        }
        Bound::Torque => PlanError::Torque { needed_n_m: reached, limit_n_m: limit, nearest },
    }
}
