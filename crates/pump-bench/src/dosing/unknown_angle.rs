//! The warnings of a dose that is planned without a known angle.

use libm::floor;
use pump_ctl::plan::Plan;
use pump_model::Pump;

use crate::notice::{Notice, Remedy};
use crate::numbers::between;
use crate::numbers::significant;
use crate::record::Purpose;

/// Digits of an offered volume. A ten-thousandth of the volume is less than any share of the budget.
const DIGITS: i32 = 5;

/// Least part of a pitch that is offered as a volume that is exact at any angle.
const LEAST_OFFERED: f64 = 0.01;

/// Returns the warning of a dose that a balance ends, in the place of [`warnings`].
pub(crate) fn by_weight() -> Notice {
    let text = "the rollers' angle is unknown: the first stretches are shorter, and each weighing tells more of the \
                angle; pressures and settling are the worst of all angles";
    Notice::from(text).with_remedy(Remedy::FindOrSayAngle)
}

/// Part of a volume within which it is one from every angle.
const EXACT: f64 = 1e-4;

/// Returns the range that the dose may deliver, and the volumes that are exact at any angle. Whole pitches have one
/// volume, and a run that is weighed needs no more than that.
pub(crate) fn warnings(model: &Pump, plan: &Plan, purpose: Purpose) -> Vec<Notice> {
    if plan.most_ml() - plan.least_ml() <= EXACT * plan.planned_ml().abs() {
        if purpose == Purpose::Calibrate {
            return Vec::new();
        }
        let text = "the rollers' angle is unknown: whole pitches have one volume from every angle; pressures and \
                    settling are the worst of all angles";
        return vec![text.into()];
    }
    of_a_part(model, plan).into()
}

/// Returns the warnings of a dose whose volume depends on the angle.
fn of_a_part(model: &Pump, plan: &Plan) -> [Notice; 2] {
    let pitch_ml = model.outlet_curve().pitch_ml();
    let (asked_ml, carry_ml) = (plan.requested_ml(), plan.carry_in_ml());
    let owed_ml = asked_ml + carry_ml;
    let way = 1.0_f64.copysign(owed_ml);
    let list = |pitches: &[f64]| {
        let volumes = pitches.iter().map(|pitches| way * pitches * pitch_ml - carry_ml);
        // The carry may be more than a pitch, or leave next to nothing of one.
        let volumes = volumes.filter(|volume_ml| volume_ml * way > LEAST_OFFERED * pitch_ml);
        volumes.map(|volume_ml| significant(volume_ml, DIGITS)).collect::<Vec<_>>()
    };
    let (first, below) = (floor(way * carry_ml / pitch_ml).max(0.0), floor(owed_ml.abs() / pitch_ml));
    [
        format!(
            "the rollers' angle is unknown: from this alone, the volume of the whole dose lies {}; pressures and \
             settling are the worst of all angles",
            between(plan.least_ml(), plan.most_ml())
        )
        .into(),
        Notice::from(format!(
            "{} are exact at any angle: {} mL and so on; nearest to {} mL: {} mL",
            if carry_ml == 0.0 { "multiples of a pitch" } else { "multiples of a pitch less the carry" },
            list(&[first + 1.0, first + 2.0, first + 3.0]).join(", "),
            significant(asked_ml, DIGITS + 1),
            list(&[below, below + 1.0]).join(" and "),
        ))
        .with_remedy(Remedy::TurnAndSayAngle),
    ]
}

/// Words an angle that was disturbed, with the half width of its range in deg. One that is unknown may never have been
/// found.
pub(crate) fn disturbed(within_deg: Option<f64>) -> String {
    within_deg.map_or("is unknown".to_owned(), |deg| {
        format!("was disturbed since it was found and is known within {} deg now", significant(deg, 3))
    })
}
