//! The warnings of a dose that is planned without a known angle.

use pump_ctl::plan::Plan;
use pump_model::Pump;
use pump_model::math::floor;

use crate::numbers::between;
use crate::numbers::significant;

/// Digits of an offered volume. A ten-thousandth of the volume is less than any share of the budget.
const DIGITS: i32 = 5;

/// Returns the range that the dose may deliver, and the volumes that are exact at any angle.
pub(crate) fn warnings(model: &Pump, plan: &Plan) -> [String; 2] {
    let pitch_ml = model.outlet_curve().pitch_ml();
    let asked_ml = plan.requested_ml;
    let list = |pitches: &[f64]| {
        let volumes = pitches.iter().filter(|pitches| **pitches > 0.0);
        let volumes = volumes.map(|pitches| significant((pitches * pitch_ml).copysign(asked_ml), DIGITS));
        volumes.collect::<Vec<_>>()
    };
    let below = floor(asked_ml.abs() / pitch_ml);
    [
        format!(
            "the rollers' angle is unknown: by that alone the volume lies {}; pressures and settling are the \
             worst of all angles",
            between(plan.least_ml, plan.most_ml)
        ),
        format!(
            "multiples of a pitch are exact at any angle: {} mL and so on; nearest to {} mL: {} mL; to dose \
             other volumes, turn a roller to where it begins to leave the outlet and say `dose home --set \
             0deg`, or give --start-angle",
            list(&[1.0, 2.0, 3.0]).join(", "),
            significant(asked_ml, DIGITS + 1),
            list(&[below, below + 1.0]).join(" and "),
        ),
    ]
}
