//! The back flow of a dose that was stopped on its way.

use super::Prepared;

impl Prepared {
    /// Returns the back flow of the first `made` steps, in mL: that of the plan, or of the stop that made these
    /// steps the last. The stop is the motor's fastest. `None` if the line does not come to rest within an hour.
    pub(crate) fn backflow_of_ml(&self, made: u64) -> Option<f64> {
        let (plan, model) = (&self.plan, &self.model);
        let ends_at =
            |asked: u64| asked + plan.stop(model, asked).map_or(0, |stop| stop.steps().unsigned_abs());
        if made >= plan.steps().unsigned_abs() {
            return Some(self.back_flow.backflow_ml);
        }
        // A later stop ends later. Bisection finds the first that ends with the steps that were made.
        let (mut early, mut late) = (0, made);
        while early < late {
            let middle = early + (late - early) / 2;
            if ends_at(middle) >= made { late = middle } else { early = middle + 1 }
        }
        let stop = plan.stop(model, late);
        stop.map_or(Some(0.0), |stop| stop.back_flow(model).ok().map(|back_flow| back_flow.backflow_ml))
    }
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
}
