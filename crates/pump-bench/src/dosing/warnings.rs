//! Warnings of a plan, for the user to read before the dose runs. One function makes one warning.

mod swing;
mod unweighed;

use pump_ctl::plan::{Finish, LimitedBy, Margin, Margins, Motor, Plan, PlanError, Prediction, Ramps};
use pump_ctl::step::Direction;
use pump_model::units::rpm;
use pump_model::{Extremes, Pump};

use super::uncertainty::{Budget, Share, ShareSource, pressure_uncertainty_kpa};
use super::unknown_angle;
use crate::notice::{Notice, Remedy};
use crate::numbers::{microlitres_within, significant};
use crate::record::Purpose;
pub(crate) use unweighed::copied_uncertainty;
pub(super) use unweighed::{of_calibration, of_pump, unweighed_pump};

/// Part of the room to a limit from which on a dose is warned of.
const CLOSE: f64 = 0.95;

/// Part of the ripple from which on a flow is hardly smooth.
const HARDLY: f64 = 0.9;

/// Part of the requested volume from which on a carry by the size of a step is warned of.
const COARSE: f64 = 0.05;

/// Part of the requested volume from which on the uncertainty of a carry is warned of.
const UNSURE: f64 = 0.001;

/// Swing of pressure by a single step from which on a dose is warned of, in kPa.
const SWING_KPA: f64 = 1.0;

/// Part of the budget's variance from which on an unweighed speed is warned of, in percent. Without it the interval is
/// sqrt(0.9) as wide, so it makes 5 % of the interval.
const NOTABLE_PERCENT: f64 = 10.0;

/// Returns the warnings of a plan, in the order in which the user reads them.
pub(super) fn of_plan(
    model: &Pump,
    plan: &Plan,
    prediction: &Prediction,
    margins: &Margins,
    purpose: Purpose,
) -> Result<Vec<Notice>, PlanError> {
    let mut warnings = Vec::new();
    if !plan.start().is_known(model.pitch_rad()) {
        warnings.extend(unknown_angle::warnings(model, plan, purpose));
    }
    let carry = low_flow_carry(model, plan)?.or_else(|| coarse_step(plan));
    let facts = [short_dose(plan), hurried(model, plan)?, hardly_smooth(model, plan), carry];
    let of_pressures = of_pressures(plan.direction() == Direction::Reverse, prediction, margins);
    warnings.extend(facts.into_iter().flatten().chain(of_pressures).map(Notice::from));
    Ok(warnings)
}

/// Returns the warnings of a retraction: those of its pressures and of its torque.
pub(super) fn of_retraction(prediction: &Prediction, margins: &Margins) -> Vec<String> {
    let warnings = of_pressures(true, prediction, margins);
    warnings.into_iter().map(|warning| format!("while it sucks back: {warning}")).collect()
}

/// Returns the warnings of a motion's pressures and of its torque. In reverse the ports change their roles.
fn of_pressures(is_reverse: bool, prediction: &Prediction, margins: &Margins) -> Vec<String> {
    let (discharge, suction) = if is_reverse { ("inlet", "outlet") } else { ("outlet", "inlet") };
    let mut warnings: Vec<String> =
        [("inlet", prediction.inlet.min_kpa), ("outlet", prediction.outlet.min_kpa)]
            .into_iter()
            .filter_map(|(port, min_kpa)| cavitation(port, min_kpa))
            .collect();
    let discharge_falls = format!("{discharge} pressure where the flow falls");
    warnings.extend(
        [
            (format!("{discharge} pressure"), "kPa", margins.outlet),
            (format!("{suction} pressure"), "kPa", margins.inlet),
            (discharge_falls, "kPa", margins.outlet_suction),
            ("torque".to_owned(), "N m", margins.torque),
        ]
        .into_iter()
        .filter_map(|(quantity, unit, margin)| close_to_limit(&quantity, unit, margin?)),
    );
    let (pushing, sucking) = if is_reverse {
        (prediction.inlet, prediction.outlet)
    } else {
        (prediction.outlet, prediction.inlet)
    };
    warnings.extend(
        [
            (format!("{discharge} pressure"), margins.outlet, pushing),
            (format!("{suction} pressure"), margins.inlet, sucking),
        ]
        .into_iter()
        .filter_map(|(quantity, margin, extremes)| unsure_limit(&quantity, margin?, extremes)),
    );
    warnings.extend(rough_steps(prediction));
    warnings
}

/// Warns of a carry that is known within bounds only.
pub(super) fn unsure_carry(requested_ml: f64, carry_ml: f64, half_width_ml: f64) -> Option<Notice> {
    (half_width_ml.min(carry_ml.abs()) > UNSURE * requested_ml.abs()).then(|| {
        let carry = microlitres_within(carry_ml, half_width_ml);
        Notice::from(format!("earlier motions leave the carry unsure: it is {carry}"))
            .with_remedy(Remedy::FindAngleDropCarry)
    })
}

/// Ways to a back flow that is smaller.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LessBackFlow {
    /// Slower rate, in mL/s, whose back flow is within the dose's uncertainty, and that back flow, in mL.
    pub(super) slower: Option<(f64, f64)>,
    /// Back flow with an end at low flow, in mL, if it is smaller.
    pub(super) low_flow_ml: Option<f64>,
    /// Back flow with line-aware ramps, in mL, if it is smaller.
    pub(super) line_aware_ml: Option<f64>,
    /// True if a retraction would draw in what still hangs at the nozzle.
    pub(super) by_retraction: bool,
}

/// Warns of a back flow that exceeds the expanded uncertainty that the dose has beside it. `is_in_air` is true for a
/// nozzle that is said to be in air.
pub(super) fn back_flow(
    plan: &Plan,
    backflow_ml: f64,
    expanded_ml: f64,
    is_in_air: bool,
    less: &LessBackFlow,
) -> Notice {
    let (back, expanded) = (significant(1e3 * backflow_ml, 3), significant(1e3 * expanded_ml, 3));
    let swing = match plan.direction() {
        Direction::Forward if is_in_air => {
            format!("gives {back} µL too much and takes in as much air in their place")
        }
        Direction::Forward => {
            format!(
                "gives {back} µL too much and takes them back, unless the nozzle is in air and takes in air instead"
            )
        }
        Direction::Reverse => format!("takes {back} µL too much from the vessel and gives them back"),
    };
    let contained = match is_in_air {
        true => format!("the dose's \u{b1} contains that; it is {expanded} µL without"),
        false => format!("the dose's \u{b1} {expanded} µL does not contain that"),
    };
    let text = format!("when the motor stops, the line {swing}; {contained}; {}", less.text());
    less.remedies().fold(text.into(), Notice::with_remedy)
}

impl LessBackFlow {
    /// Says what makes the back flow smaller.
    fn text(&self) -> String {
        let slower = self.slower.map(|(ml_s, back_ml)| {
            let rate = significant(ml_s, 4);
            format!("at {rate} mL/s it is {} µL", significant(1e3 * back_ml, 2))
        });
        let with = |what: &str, back_ml: Option<f64>| {
            back_ml.map(|back_ml| format!("with {what} it is {} µL", significant(1e3 * back_ml, 2)))
        };
        let line_aware = with("line-aware ramps", self.line_aware_ml);
        let low_flow = with("an end at low flow", self.low_flow_ml);
        let ways: Vec<String> = line_aware.into_iter().chain(slower).chain(low_flow).collect();
        let ways = match ways.is_empty() {
            true => "a much slower rate makes it less".to_owned(),
            false => ways.join(", "),
        };
        match self.by_retraction {
            true => format!("{ways}; a retraction draws in what then still hangs at the nozzle"),
            false => ways,
        }
    }

    /// Returns what a person chooses for less.
    fn remedies(&self) -> impl Iterator<Item = Remedy> {
        let ways = [
            self.line_aware_ml.map(|_| Remedy::TakeLineAwareRamps),
            self.slower.map(|_| Remedy::SlowDown),
            self.low_flow_ml.map(|_| Remedy::EndAtLowFlow),
            self.by_retraction.then_some(Remedy::SuckBack),
        ];
        ways.into_iter().flatten()
    }
}

/// Warns by `text` of a speed at which nothing was weighed, where that makes the interval of the dose notably wider.
pub(super) fn unweighed_speed(text: &str, budget: &Budget) -> Option<Notice> {
    let of_speed = |share: &&Share| share.source == ShareSource::SpeedDependence;
    let part = budget.shares.iter().find(of_speed)?.variance_percent;
    (part >= NOTABLE_PERCENT).then(|| Notice::from(text))
}

/// Warns of a dose that is too short to reach its cruise speed.
fn short_dose(plan: &Plan) -> Option<String> {
    (plan.limited_by() == LimitedBy::Acceleration).then(|| {
        let ramps = match plan.ramps() {
            Ramps::LineAware => "in ramps that leave the line at rest".to_owned(),
            Ramps::Fastest => format!("at {} rad/s2", significant(plan.profile().acceleration_rad_s2(), 4)),
        };
        format!(
            "the dose is too short to reach its cruise speed {ramps}; it peaks at {:.4} r/min",
            rpm(plan.profile().peak_rad_s()),
        )
    })
}

/// Warns of a time that leaves no room for ramps that leave the line nearly at rest.
fn hurried(model: &Pump, plan: &Plan) -> Result<Option<String>, PlanError> {
    if !plan.is_hurried() {
        return Ok(None);
    }
    let back_ml = plan.back_flow(model)?.backflow_ml;
    Ok(Some(format!(
        "the time leaves no room for ramps that leave the line at rest: the line gives up to {} µL too much and takes \
         them back; a longer time makes it less",
        significant(1e3 * back_ml, 2)
    )))
}

/// Warns of a smooth flow that keeps most of its ripple.
fn hardly_smooth(model: &Pump, plan: &Plan) -> Option<String> {
    if !plan.is_smooth() {
        return None;
    }
    let ripples = plan.ripples(model);
    let at_rollers = (ripples.before, ripples.after);
    let (before, after) = ripples.outflow_before.zip(ripples.outflow_after).unwrap_or(at_rollers);
    (after.rms > HARDLY * before.rms).then(|| {
        let goes = if after.rms > before.rms { "rises" } else { "only falls" };
        format!(
            "the motor has no room for a smooth flow at this rate: the ripple at the line's end {goes} from {:.1} to \
             {:.1} % (RMS); {}",
            100.0 * before.rms,
            100.0 * after.rms,
            if after.rms > before.rms { "a constant speed is smoother" } else { "a slower rate is smoother" }
        )
    })
}

/// Warns of a smooth flow that widens the swing of the inlet pressure: the outlet's flow is evened out, and the
/// inlet's is not.
pub(super) fn wider_inlet_swing(
    model: &Pump,
    plan: &Plan,
    prediction: &Prediction,
    motor: Motor,
) -> Result<Option<String>, PlanError> {
    if !plan.is_smooth() {
        return Ok(None);
    }
    let even = swing::at_constant_speed(model, plan, motor)?;
    let said = |range: Extremes| format!("{:.2} to {:.2} kPa", range.min_kpa, range.max_kpa);
    Ok(swing::is_wider(prediction.inlet, even.inlet).then(|| {
        format!(
            "the smooth flow widens the swing of the inlet pressure: inlet {}, {} at constant speed; outlet {}, \
             {} at constant speed (absolute)",
            said(prediction.inlet),
            said(even.inlet),
            said(prediction.outlet),
            said(even.outlet)
        )
    }))
}

/// Warns of the carry that an end at low flow costs, and offers volumes that carry nothing.
fn low_flow_carry(model: &Pump, plan: &Plan) -> Result<Option<String>, PlanError> {
    // Within half a step of the volume asked for, the end is where it would be anyway.
    let half_step_ml = 0.5 * plan.step_rad() * model.nominal_ml_rad();
    if plan.finish() == Finish::Any || plan.carry_ml().abs() <= half_step_ml {
        return Ok(None);
    }
    let volumes = plan.low_flow_volumes_ml(model)?.into_iter().flatten();
    let nearest: Vec<String> =
        volumes.map(|volume_ml| format!("{:.4} mL", volume_ml - plan.carry_in_ml())).collect();
    Ok(Some(format!(
        "to end at low flow the dose gives {:.4} mL for {} mL requested and carries {:+.2} µL to the next; \
         nearest volumes that end there and carry nothing: {}",
        plan.planned_ml(),
        plan.requested_ml(),
        1e3 * plan.carry_ml(),
        nearest.join(" and ")
    )))
}

/// Warns of a motor step that is coarse for the dose.
fn coarse_step(plan: &Plan) -> Option<String> {
    (plan.carry_ml().abs() > COARSE * plan.requested_ml().abs()).then(|| {
        format!(
            "a motor step is coarse for this dose: it gives {:.2} µL, and the other {:.2} µL are carried to \
             the next",
            1e3 * plan.planned_ml(),
            1e3 * plan.carry_ml()
        )
    })
}

/// Warns of a pressure below 0 kPa absolute at a port.
fn cavitation(port: &str, min_kpa: f64) -> Option<String> {
    (min_kpa < 0.0).then(|| {
        format!(
            "the {port} pressure would fall to {min_kpa:.1} kPa absolute, which no liquid can: it would \
             cavitate and the dose would be short; lower the rate"
        )
    })
}

/// Warns of a quantity that comes close to its limit.
fn close_to_limit(quantity: &str, unit: &str, margin: Margin) -> Option<String> {
    let Margin { reached, limit, used, .. } = margin;
    (used > CLOSE).then(|| {
        format!(
            "the {quantity} comes close to its limit: {reached:.4} of {limit:.4} {unit}{}, {:.1} % of the \
             room from rest",
            // A margin counts them, the report's pressures do not.
            if unit == "kPa" { " with the motor's steps" } else { "" },
            100.0 * used
        )
    })
}

/// Warns of a pressure that is less far from its limit than its prediction is unsure. A pressure that comes close
/// to its limit has a warning of its own.
fn unsure_limit(quantity: &str, margin: Margin, extremes: Extremes) -> Option<String> {
    let Margin { reached, limit, used, .. } = margin;
    let unsure_kpa = pressure_uncertainty_kpa(extremes);
    (used <= CLOSE && (limit - reached).abs() < unsure_kpa).then(|| {
        format!(
            "the {quantity} is predicted at {reached:.2} kPa with the motor's steps, {:.2} kPa from its limit of \
             {limit:.2} kPa, and the prediction is uncertain by {unsure_kpa:.2} kPa (k = 2); a slower rate leaves \
             more room",
            (limit - reached).abs()
        )
    })
}

/// Warns of steps that move the pressure noticeably beyond the prediction.
fn rough_steps(prediction: &Prediction) -> Option<String> {
    (prediction.step_kpa > SWING_KPA).then(|| {
        format!(
            "the motor's steps move the pressure by up to {:.1} kPa on top of the prediction; use more \
             microsteps",
            prediction.step_kpa
        )
    })
}
