//! The cautions of a smooth flow, by the code of the command: how sure its ripple is, and the swing of the pressures.

use pump_ctl::plan::{Motor, Plan, PlanError};
use pump_model::Pump;

use crate::draws::{COVERED, DRAWS, Draw, covering, draws};
use crate::other_pump::{ENGAGEMENT_DEG, other_pump};
use crate::pulse_sureness::PulseSureness;
use crate::swing;
use pump_model::units::degrees;

/// Number of figures.
pub const CAUTIONS: usize = 10;

/// Room for the ripples of the pumps that this one may be.
type Ripples = [f64; DRAWS as usize];

/// Knowledge of a head's pulse.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Knowledge {
    /// The roller volume has this standard uncertainty, mL.
    Measured(f64),
    /// The pulse is the usual one.
    Usual(PulseSureness),
}

impl Knowledge {
    /// Returns the errors of a draw: of the roller volume, mL, and of the engagement angle, degrees.
    fn errors(&self, pump: &Pump, draw: &Draw) -> (f64, f64) {
        match self {
            Self::Measured(roller_ml) => (roller_ml * draw.roller_volume, ENGAGEMENT_DEG * draw.engagement),
            Self::Usual(sureness) => {
                let [part, engagement_rad, _] =
                    sureness.errors([draw.roller_volume, draw.engagement, draw.zero]);
                (part * pump.roller_volume().total_ml(), degrees(engagement_rad))
            }
        }
    }
}

/// Sorts a few numbers by insertion. The sort of the library would make the page 10 kB longer.
fn sort(numbers: &mut [f64]) {
    for end in 1..numbers.len() {
        for n in (1..=end).rev() {
            if numbers[n - 1].total_cmp(&numbers[n]).is_le() {
                break;
            }
            numbers.swap(n - 1, n);
        }
    }
}

/// Returns the cautions of a smooth plan, in the order of `engine.js`.
///
/// # Errors
/// Returns the [`PlanError`] of a dose that cannot be made at constant speed.
pub(crate) fn cautions(
    pump: &Pump,
    plan: &Plan,
    motor: Motor,
    knowledge: &Knowledge,
) -> Result<[f64; CAUTIONS], PlanError> {
    let planned = plan.ripples(pump);
    let (mut at_rollers, mut at_end): (Ripples, Ripples) = ([0.0; DRAWS as usize], [0.0; DRAWS as usize]);
    let (mut count, mut count_at_end) = (0, 0);
    for draw in draws() {
        let (more_ml, more_deg) = knowledge.errors(pump, &draw);
        // Draws that no head can have are left out.
        let Ok(other) = other_pump(pump, more_ml, more_deg, 0.0) else { continue };
        let there = plan.ripples_beside(&other, plan.start().half_width_rad() * draw.start);
        at_rollers[count] = there.after.peak_to_peak;
        count += 1;
        if let Some(ripple) = there.outflow_after {
            at_end[count_at_end] = ripple.peak_to_peak;
            count_at_end += 1;
        }
    }
    // The end of a line at an undamped resonance has no ripple.
    let (before, after, drawn) = match planned.outflow_before.zip(planned.outflow_after) {
        Some((before, after)) => (before, after, &mut at_end[..count_at_end]),
        None => (planned.before, planned.after, &mut at_rollers[..count]),
    };
    sort(drawn);
    let at = |part: f64| covering(drawn, part).unwrap_or(after.peak_to_peak);
    let (median, most) = (at(0.5), at(COVERED));
    let even = swing::at_constant_speed(pump, plan, motor)?;
    let is_wider = swing::is_wider(plan.predict(pump)?.inlet, even.inlet);
    Ok([
        100.0 * before.peak_to_peak,
        100.0 * after.peak_to_peak,
        100.0 * median,
        100.0 * most,
        f64::from(u8::from(median >= before.peak_to_peak)),
        even.inlet.min_kpa,
        even.inlet.max_kpa,
        even.outlet.min_kpa,
        even.outlet.max_kpa,
        f64::from(u8::from(is_wider)),
    ])
}
