//! What a person should know of a dose that is planned without knowing where the rollers stand.

use pump_ctl::plan::Plan;
use pump_model::Pump;
use pump_model::math::floor;

use crate::numbers::between;
use crate::numbers::significant;

/// Digits of a volume that is offered: a ten-thousandth of it is less than any budget's share.
const DIGITS: i32 = 5;

/// What the dose may deliver, and how to have it exactly.
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
            "where the rollers stand is unknown: by that alone the volume lies {}; pressures and settling are the \
             worst of all angles",
            between(plan.least_ml, plan.most_ml)
        ),
        format!(
            "multiples of a pitch are exact at any angle: {} mL and so on; nearest to {} mL: {} mL; to dose other volumes, \
             turn a roller to where it begins to leave the outlet and say `dose home --set 0deg`, or give --start-angle",
            list(&[1.0, 2.0, 3.0]).join(", "),
            significant(asked_ml, DIGITS + 1),
            list(&[below, below + 1.0]).join(" and "),
        ),
    ]
}
