//! The back flow and the settling of a dose that was stopped on its way.

use pump_ctl::plan::{Plan, PlannedMotion};
use pump_model::Pump;

use super::Prepared;

impl Prepared {
    /// Returns the back flow of the first `made` steps, in mL: that of the plan, or of the stop that made these
    /// steps the last. `None` if the line does not come to rest within an hour.
    pub(crate) fn backflow_of_ml(&self, made: u64) -> Option<f64> {
        self.backflow_in_ml((&self.plan).into(), made)
    }

    /// Returns the back flow of the first `made` steps of the motion that the dose is made by, in mL, as
    /// [`Self::backflow_of_ml`] does.
    pub(crate) fn backflow_in_ml(&self, motion: PlannedMotion<'_>, made: u64) -> Option<f64> {
        if is_whole(motion, made) {
            return Some(self.back_flow.backflow_ml);
        }
        let backflow_ml = |stop: Plan| Some(stop.back_flow(&self.model).ok()?.backflow_ml);
        stop_after(motion, &self.model, made).map_or(Some(0.0), backflow_ml)
    }

    /// Returns the time from the last of the first `made` steps until the line has settled, in s, as [`settle_of_s`].
    pub(crate) fn settle_of_s(&self, made: u64) -> f64 {
        self.settle_in_s((&self.plan).into(), made)
    }

    /// Returns the time from the last of the first `made` steps of the motion that the dose is made by until the line
    /// has settled, in s, as [`settle_of_s`].
    pub(crate) fn settle_in_s(&self, motion: PlannedMotion<'_>, made: u64) -> f64 {
        settle_of_s(motion, &self.model, self.prediction.settle_s, made)
    }
}

/// Returns the time from the last of the first `made` steps of `plan` until the line has settled, in s: `whole_s`, that
/// of the plan, or that of the stop that made these steps the last. It is infinite if the line does not come to rest
/// within an hour.
pub(crate) fn settle_of_s(plan: PlannedMotion<'_>, model: &Pump, whole_s: f64, made: u64) -> f64 {
    if is_whole(plan, made) {
        return whole_s;
    }
    let settle_s = |stop: Plan| stop.predict(model).map_or(f64::INFINITY, |predicted| predicted.settle_s);
    stop_after(plan, model, made).map_or(0.0, settle_s)
}

/// Returns true if these steps are all of the plan.
fn is_whole(plan: PlannedMotion<'_>, made: u64) -> bool {
    made >= plan.steps().unsigned_abs()
}

/// Returns the stop, the motor's fastest, that ends with the first `made` steps. `None` if the motor stands there.
fn stop_after(plan: PlannedMotion<'_>, model: &Pump, made: u64) -> Option<Plan> {
    let ends_at = |asked: u64| asked + plan.stopping_steps(asked);
    // A later stop ends later. Bisection finds the first that ends with the steps that were made.
    let (mut early, mut late) = (0, made);
    while early < late {
        let middle = early + (late - early) / 2;
        if ends_at(middle) >= made { late = middle } else { early = middle + 1 }
    }
    plan.stop(model, late)
}

#[cfg(test)]
mod tests {
    use pump_ctl::plan::{Cruise, Phase};

    use super::*;
    use crate::dosing::DoseRequest;
    use crate::record::PhaseSource;

    #[test]
    fn a_stop_has_the_back_flow_of_the_fastest_ramp() {
        let file = crate::catalogue::built_in("three-roller").unwrap();
        let model = file.model().unwrap();
        let request = DoseRequest { cruise: Some(Cruise::Flow { ml_s: 5.0 }), ..DoseRequest::dose(25.0) };
        let prepared =
            Prepared::new(&file, &model, request, Phase::known(0.0), PhaseSource::Given, 0.0).unwrap();
        let all = prepared.plan.steps().unsigned_abs();
        assert_eq!(prepared.backflow_of_ml(all), Some(prepared.back_flow.backflow_ml));
        assert!(prepared.back_flow.backflow_ml < 0.003);
        // Between two pulses the fastest ramp from 5 mL/s gives 52 uL back at any angle (docs/accuracy.md).
        let level = (0..all).filter(|made| prepared.plan.speed_after(*made) > 1.0).find(|made| {
            let flow = model.outlet_curve().flow_ml_rad(prepared.plan.angle_after(*made) - 0.5);
            (flow - model.nominal_ml_rad()).abs() < 1e-12 && *made > all / 2
        });
        let back_ml = prepared.backflow_of_ml(level.unwrap() + 50).unwrap();
        assert!((0.03..0.075).contains(&back_ml), "{back_ml}");
        // Hardly a step has no speed to lose.
        assert!(prepared.backflow_of_ml(1).unwrap() < 0.005);
    }

    #[test]
    fn a_stop_settles_as_a_line_does_that_loses_its_whole_flow_at_once() {
        let file = crate::catalogue::built_in("three-roller").unwrap();
        let model = file.model().unwrap();
        let request = DoseRequest { cruise: Some(Cruise::Flow { ml_s: 5.0 }), ..DoseRequest::dose(25.0) };
        let prepared =
            Prepared::new(&file, &model, request, Phase::known(0.0), PhaseSource::Given, 0.0).unwrap();
        let all = prepared.plan.steps().unsigned_abs();
        assert_eq!(prepared.settle_of_s(all), prepared.prediction.settle_s);
        let flow_ml_rad = |made| model.outlet_curve().flow_ml_rad(prepared.plan.angle_after(made));
        let level = (all / 2..all).filter(|made| (flow_ml_rad(*made) - model.nominal_ml_rad()).abs() < 1e-12);
        let made = level.clone().find(|made| (0..400).all(|n| flow_ml_rad(made + n) == flow_ml_rad(*made)));
        let settle_s = prepared.settle_of_s(made.unwrap() + 400);
        // Between two pulses the line carries 6.48 mL/s. The motor stops within 3 ms, an impulse to the line. Its swing
        // then has the amplitude Q/omega_d in the volume, and decays at 13.19 /s to 1 uL (PHYSICS of the
        // published line: 12.75 Hz, R/2L 13.19 /s).
        let amplitude_ml =
            4.398_23 * prepared.plan.profile().cruise_rad_s() / (std::f64::consts::TAU * 12.58);
        let expected_s = (amplitude_ml / 1e-3).ln() / 13.19;
        assert!((settle_s - expected_s).abs() < 0.05, "{settle_s} {expected_s}");
        assert!(settle_s > prepared.prediction.settle_s + 0.1, "{settle_s}");
        assert_eq!(prepared.settle_of_s(0), 0.0);
    }
}
