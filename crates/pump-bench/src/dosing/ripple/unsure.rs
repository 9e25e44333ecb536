//! The warning of a smooth flow on a pump whose pulse is not known well enough for it.

use pump_ctl::plan::Plan;
use pump_model::Pump;

use super::pulse_errors::PulseErrors;
use super::ripple::{SureRipples, sure_ripples};
use crate::calibration::Applied;
use crate::notice::{Notice, Remedy};
use crate::numbers::significant;
use crate::pump_file::PumpFile;

/// Warns of a smooth flow whose ripple is expected to be no smaller than that at constant speed. The median over the
/// pumps that this one may be stands for what is expected.
///
/// The speed follows the pulse of the model. Where the pump's own pulse is narrower, the motor is fast in a part of the
/// turn in which nothing is lacking, so that a wrong pulse makes more ripple than it removes.
pub(in crate::dosing) fn unsure_smooth(
    file: &PumpFile,
    model: &Pump,
    plan: &Plan,
    applied: Option<&Applied>,
) -> Option<Notice> {
    if !plan.is_smooth() {
        return None;
    }
    let SureRipples { rollers, line_end } = sure_ripples(plan, model, &PulseErrors::of(file, applied));
    let line_end = line_end.filter(|_| !file.outlet.line.is_unknown());
    no_smoother(&SureRipples { rollers, line_end })
}

/// Warns of ripples that are expected to be no smaller than those at constant speed.
fn no_smoother(ripples: &SureRipples) -> Option<Notice> {
    let (at, place) = match &ripples.line_end {
        Some(at) => (at, "at the line's end"),
        None => (&ripples.rollers, "at the rollers"),
    };
    let (expected, even) = (at.peak_to_peak_median, at.constant_speed.peak_to_peak);
    (!at.is_smoother()).then(|| {
        let percent = |ripple: f64| significant(100.0 * ripple, 2);
        let text = format!(
            "the pulse of this pump, or its angle, is not known well enough for a smooth flow: the ripple {place} is \
             expected to be {} % peak to peak (at most {} % in 95 % of such pumps), and {} % at constant speed; leave \
             the smooth flow out, or measure the roller volume",
            percent(expected),
            percent(at.peak_to_peak_95),
            percent(even)
        );
        Notice::from(text).with_remedy(Remedy::UseShortDoses)
    })
}

#[cfg(test)]
mod tests {
    use pump_ctl::plan::{Cruise, Doser, Phase, Request};

    use super::*;

    fn warned(roller_volume_ml: f64, smooth: bool) -> Option<Notice> {
        let file = crate::catalogue::built_in("three-roller").unwrap();
        let pump = file.model().unwrap();
        let request = Request::new(30.0, Cruise::Flow { ml_s: 3.0 }).with_smooth(smooth);
        let plan = Doser::new(&pump, file.limits()).unwrap().plan(Phase::known(0.3), &request).unwrap();
        if !smooth {
            return unsure_smooth(&file, &pump, &plan, None);
        }
        let errors = PulseErrors { roller_volume_ml, ..PulseErrors::of(&file, None) };
        no_smoother(&sure_ripples(&plan, &pump, &errors))
    }

    #[test]
    fn a_smooth_flow_is_warned_of_where_the_pulse_is_not_known() {
        assert_eq!(warned(0.026, true), None);
        let warning = warned(0.45, true).unwrap();
        assert!(warning.text().contains("% in 95 % of such pumps), and 1"), "{warning}");
        assert_eq!(warning.remedies(), [Remedy::UseShortDoses]);
        assert_eq!(warned(0.45, false), None);
    }
}
