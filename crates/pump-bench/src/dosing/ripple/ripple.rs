//! The ripple of a dose's flow at the rollers and at the line's end, with its uncertainty.

use pump_ctl::plan::{Plan, Ripples};
use pump_model::{Pump, Ripple};
use serde::Serialize;

use super::errors::{COVERED, covering, draws};
use super::pulse_errors::PulseErrors;

/// Ripple of a flow: its departure from its mean over time, over the mean.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[non_exhaustive]
pub struct RippleReport {
    /// Peak to peak: (largest - smallest) / mean.
    pub peak_to_peak: f64,
    /// Root of the mean square deviation from the mean, over the mean.
    pub rms: f64,
}

impl From<Ripple> for RippleReport {
    fn from(ripple: Ripple) -> Self {
        Self { peak_to_peak: ripple.peak_to_peak, rms: ripple.rms }
    }
}

/// Ripple at one place: of constant speed, as planned, and as sure as the pump is known.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[non_exhaustive]
pub struct RippleAt {
    /// Ripple at constant speed, with the same mean flow.
    pub constant_speed: RippleReport,
    /// Ripple of the planned motion if the pump is exactly as its model and the rollers stand at the stated angle.
    pub planned: RippleReport,
    /// Largest ripple peak to peak of that pump over the half width of the start angle.
    pub peak_to_peak_worst_angle: f64,
    /// Ripple peak to peak that is expected: the median over what is not known of roller volume, engagement angle and
    /// start angle. It decides against `constant_speed` whether the flow is smoother than at an even speed.
    pub peak_to_peak_median: f64,
    /// Ripple peak to peak that 95 % of such pumps do not exceed.
    pub peak_to_peak_95: f64,
}

/// Ripples of a dose at both places.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SureRipples {
    /// Ripple at the outlet's rollers.
    pub(crate) rollers: RippleAt,
    /// Ripple at the end of the outlet line. None at an undamped resonance.
    pub(crate) line_end: Option<RippleAt>,
}

/// Returns the ripples of a plan on `pump`, whose pulse is known to `errors`.
///
/// The motion is fixed and the errors are drawn. A linear law would not do: without errors the ripple is near its
/// minimum, so it rises with an error of either sign. Draws that no head can have are left out.
pub(crate) fn sure_ripples(plan: &Plan, pump: &Pump, errors: &PulseErrors) -> SureRipples {
    let planned = plan.ripples_beside(pump, 0.0);
    let worst = plan.ripples(pump);
    let half_width_rad = plan.start().half_width_rad().min(0.5 * pump.pitch_rad());
    let (mut rollers, mut line_end) = (Vec::new(), Vec::new());
    for draw in draws() {
        let Ok((other, zero_rad)) = errors.drawn(pump, &draw) else { continue };
        let there = plan.ripples_beside(&other, half_width_rad * draw.start + zero_rad);
        rollers.push(there.after.peak_to_peak);
        line_end.extend(there.outflow_after.map(|ripple| ripple.peak_to_peak));
    }
    let Ripples { before, after, outflow_before, outflow_after, .. } = planned;
    SureRipples {
        rollers: RippleAt::new(before, after, worst.after, rollers),
        line_end: outflow_before.zip(outflow_after).map(|(before, after)| {
            RippleAt::new(before, after, worst.outflow_after.unwrap_or(after), line_end)
        }),
    }
}

impl RippleAt {
    /// True if the flow is expected to be smoother than at constant speed.
    pub(crate) fn is_smoother(&self) -> bool {
        self.peak_to_peak_median < self.constant_speed.peak_to_peak
    }

    fn new(before: Ripple, after: Ripple, worst: Ripple, mut drawn: Vec<f64>) -> Self {
        drawn.sort_by(f64::total_cmp);
        let at = |part: f64| covering(&drawn, part).unwrap_or(after.peak_to_peak);
        Self {
            constant_speed: before.into(),
            planned: after.into(),
            peak_to_peak_worst_angle: worst.peak_to_peak.max(after.peak_to_peak),
            peak_to_peak_median: at(0.5),
            peak_to_peak_95: at(COVERED),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use pump_ctl::plan::{Cruise, Doser, Phase, Request};
    use pump_model::units::radians;

    fn ripples(flow_ml_s: f64, half_width_deg: f64, roller_volume_ml: f64) -> SureRipples {
        let file = crate::catalogue::built_in("three-roller").unwrap();
        let pump = file.model().unwrap();
        let request = Request::new(30.0, Cruise::Flow { ml_s: flow_ml_s }).with_smooth(true);
        let start = Phase::within(0.3, radians(half_width_deg));
        let plan = Doser::new(&pump, file.limits()).unwrap().plan(start, &request).unwrap();
        sure_ripples(&plan, &pump, &PulseErrors { roller_volume_ml, ..PulseErrors::of(&file, None) })
    }

    #[test]
    fn what_is_not_known_of_the_pump_makes_most_of_a_smooth_flows_ripple() {
        // Of 2.9 % V_r alone makes a median of 10 % and a 95th percentile of 21 to 27 %, found independently.
        let at = ripples(3.0, 0.0, 0.026).rollers;
        assert!((0.025..0.035).contains(&at.planned.peak_to_peak), "{at:?}");
        assert!((0.08..0.2).contains(&at.peak_to_peak_median), "{at:?}");
        assert!((0.2..0.4).contains(&at.peak_to_peak_95), "{at:?}");
        // An angle that is less sure makes it more unsure, and constant speed hardly depends on all that.
        let wide = ripples(3.0, 1.0, 0.026).rollers;
        assert!(wide.peak_to_peak_median > at.peak_to_peak_median, "{wide:?} {at:?}");
        assert!((at.constant_speed.peak_to_peak - 1.177).abs() < 0.005, "{at:?}");
    }

    #[test]
    fn an_angles_width_leaves_the_planned_ripple_and_is_stated_beside_it() {
        let (exact, wide) = (ripples(8.0, 0.0, 0.026), ripples(8.0, 1.0, 0.026));
        for (exact, wide) in
            [(exact.rollers, wide.rollers), (exact.line_end.unwrap(), wide.line_end.unwrap())]
        {
            assert_eq!(exact.planned, wide.planned);
            assert_eq!(exact.peak_to_peak_worst_angle, exact.planned.peak_to_peak);
            assert!(wide.peak_to_peak_worst_angle > 1.1 * wide.planned.peak_to_peak, "{wide:?}");
        }
    }

    #[test]
    fn the_line_end_has_a_ripple_of_its_own() {
        let SureRipples { rollers, line_end } = ripples(8.0, 0.0, 0.026);
        let line_end = line_end.unwrap();
        // At 8 mL/s the smoothest flow of the rollers has 30 % there and 38 % at the line's end.
        assert!(
            line_end.planned.peak_to_peak < 0.15 && rollers.planned.peak_to_peak > 0.3,
            "{rollers:?} {line_end:?}"
        );
        assert!(line_end.peak_to_peak_95 > line_end.peak_to_peak_median, "{line_end:?}");
        assert!(line_end.constant_speed.peak_to_peak > rollers.constant_speed.peak_to_peak);
    }

    #[test]
    fn a_calibrated_pump_has_the_ripple_of_its_model() {
        let file = crate::catalogue::built_in("three-roller").unwrap();
        let model = file.model().unwrap();
        let zero_rad = radians(20.0);
        let pump = model.scaled(1.05).unwrap().shifted(zero_rad).unwrap();
        let request = Request::new(30.0, Cruise::Flow { ml_s: 3.0 }).with_smooth(true);
        let plan = Doser::new(&pump, file.limits()).unwrap().plan(Phase::known(0.3), &request).unwrap();
        let errors = PulseErrors { zero_rad, ..PulseErrors::of(&file, None) };
        let at = sure_ripples(&plan, &pump, &errors).rollers;
        let of_model = ripples(3.0, 0.0, 0.026).rollers;
        assert!(
            (at.peak_to_peak_median / of_model.peak_to_peak_median - 1.0).abs() < 0.1,
            "{at:?} {of_model:?}"
        );
        assert!((at.peak_to_peak_95 / of_model.peak_to_peak_95 - 1.0).abs() < 0.1, "{at:?} {of_model:?}");
    }
}
