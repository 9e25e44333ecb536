//! How sure a dose is: its uncertainty budget.

use pump_ctl::plan::{Phase, Plan};
use pump_model::Pump;
use pump_model::math::sqrt;
use serde::Serialize;

use crate::calibration::{Applied, Sureness};
use crate::pump_file::UncertaintyTable;

/// Coverage factor of the expanded uncertainty (about 95 % of doses).
pub const COVERAGE_FACTOR: f64 = 2.0;

/// How much the cross section of a tube's bore grows, 1/°C: twice the linear expansion of silicone rubber, 3e-4 (natural
/// rubber: 2.2e-4, a third of its expansion in volume, 6.6e-4; Polymer Handbook).
const BORE_PER_DEGC: f64 = 6e-4;

/// Standard uncertainty of the difference between two temperatures, °C, each read to a degree.
const READ_DEGC: f64 = 0.8;

/// One source of uncertainty.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Share {
    /// `model`, `repeatability`, `roller_volume`, `step`, `phase`, `calibration`, `speed_law`, `temperature` or `carry`.
    pub source: &'static str,
    /// Standard uncertainty, mL.
    pub standard_ml: f64,
    /// Its part of the budget's variance, percent.
    pub variance_percent: f64,
    /// The cheapest way to make it smaller.
    pub remedy: &'static str,
}

/// The budget of a dose; its shares are independent.
#[derive(Debug, Clone, PartialEq)]
pub struct Budget {
    /// Every share.
    pub shares: Vec<Share>,
}

impl Budget {
    /// Budget of `plan` on `pump`, the one that it was planned for, with the calibration that made it so.
    ///
    /// Model and repeatability are fractions of the volume, measured over many revolutions; a calibration takes the model's
    /// place, and so does the speed law of a pump file. A short dose is as unsure as the part of a pulse that it sweeps (see `pulses_unsure`); of a calibrated pump
    /// that vanishes over whole pitches. The step's share is that of a rotor that stands anywhere within a step,
    /// rectangular: dV/sqrt(12) (GUM, JCGM 100:2008, 4.3.7). The phase's share is the root of the mean square deviation from
    /// the plan, the middle of the range, over the start angles that the record allows, each as likely: the volumes crowd at
    /// the ends of their range, so a rectangle over it would say too little; a zero that was identified adds its own
    /// uncertainty. Temperature widens the bore. What is repaid of earlier doses is as unsure as they were.
    pub fn new(pump: &Pump, plan: &Plan, table: &UncertaintyTable, calibration: Option<&Applied>) -> Self {
        let volume_ml = plan.planned_ml.abs();
        let sureness = calibration.and_then(|applied| applied.sureness());
        // Nobody knows how near a speed law is that was not fitted to this pump but by what the pump file says of it.
        let law = calibration.and_then(|applied| applied.speed_law());
        let model = if sureness.is_some() || law.is_some() { 0.0 } else { table.model_percent / 100.0 };
        let of_calibration = |of: fn(&Sureness) -> f64| sureness.as_ref().map_or(0.0, of);
        let repeatability =
            (table.repeatability_percent / 100.0).max(of_calibration(|sure| sure.repeatability));
        let temperature = of_calibration(|sure| {
            BORE_PER_DEGC * sqrt(sure.warmer_degc * sure.warmer_degc + READ_DEGC * READ_DEGC)
        });
        let common = sureness.map_or(law.unwrap_or(model), |sureness| sureness.common());
        let zero_rad = calibration.map_or(0.0, |applied| applied.zero_standard_rad);
        let mut budget = Self { shares: Vec::new() };
        let mut share = |source, standard_ml, remedy| {
            budget.shares.push(Share { source, standard_ml, variance_percent: 0.0, remedy });
        };
        share("model", model * volume_ml, "weigh what it delivers: `dose calibrate run`");
        share(
            "repeatability",
            repeatability * volume_ml,
            "measure it, `dose calibrate verify`, and put the CV into the pump file",
        );
        share(
            "roller_volume",
            table.roller_volume_ml * pulses_unsure(pump, plan, sureness.is_some()),
            "dose whole pitches, or find the roller \
            volume: `dose calibrate phase`",
        );
        share("step", plan.end_step_ml(pump) / sqrt(12.0), "use more microsteps");
        share(
            "phase",
            phase_share_ml(pump, plan, zero_rad),
            "say where the rollers stand, `dose home --set`, or dose whole \
            pitches",
        );
        share(
            "calibration",
            of_calibration(|sure| sure.factor) * volume_ml,
            "weigh more runs, or longer ones, on a better \
            scale",
        );
        share(
            "speed_law",
            law.unwrap_or(of_calibration(|sure| sure.speed_law)) * volume_ml,
            "calibrate at three speeds or more, this \
            one among them",
        );
        share("temperature", temperature * volume_ml, "calibrate at the temperature at which you dose");
        share("carry", common * plan.carry_in_ml.abs(), "calibrate, so that what earlier doses owe is surer");
        let variance = budget.standard_ml() * budget.standard_ml();
        for share in &mut budget.shares {
            share.variance_percent =
                if variance > 0.0 { 100.0 * share.standard_ml * share.standard_ml / variance } else { 0.0 };
        }
        budget
    }

    /// Combined standard uncertainty, mL.
    pub fn standard_ml(&self) -> f64 {
        sqrt(self.shares.iter().map(|share| share.standard_ml * share.standard_ml).sum())
    }

    /// Expanded uncertainty (k = 2), mL.
    pub fn expanded_ml(&self) -> f64 {
        COVERAGE_FACTOR * self.standard_ml()
    }

    /// The largest share.
    pub fn largest(&self) -> Option<&Share> {
        self.shares.iter().max_by(|a, b| a.standard_ml.total_cmp(&b.standard_ml))
    }
}

/// By how many roller volumes another roller volume changes what `plan` delivers. With the dimensions known, by as many as
/// it sweeps, one at most, since what several have in common is in the model's share; with the volume of a revolution known,
/// by those less as many as are in its turn on average.
fn pulses_unsure(pump: &Pump, plan: &Plan, revolution_is_known: bool) -> f64 {
    let turn_rad = (plan.end_angle_rad() - plan.start.angle_rad).abs();
    let taken_ml = pump.nominal_ml_rad() * turn_rad - plan.planned_ml.abs();
    let pulses = taken_ml / pump.roller_volume().total_ml();
    if revolution_is_known { (pulses - turn_rad / pump.pitch_rad()).abs() } else { pulses.clamp(0.0, 1.0) }
}

/// Root of the mean square deviation from the planned volume between start and end angle when both shift together within
/// the half width, and by a zero of this standard uncertainty.
fn phase_share_ml(pump: &Pump, plan: &Plan, zero_standard_rad: f64) -> f64 {
    const POINTS: i32 = 256;
    let Phase { angle_rad, half_width_rad } = plan.start;
    let curve = pump.outlet_curve();
    let slope_ml_rad = curve.flow_ml_rad(plan.end_angle_rad()) - curve.flow_ml_rad(angle_rad);
    let zero_ml = slope_ml_rad * zero_standard_rad;
    if half_width_rad == 0.0 {
        return zero_ml.abs();
    }
    // Beyond half a pitch every angle within the pitch is as likely.
    let half_width_rad = half_width_rad.min(0.5 * pump.pitch_rad());
    let turn_rad = plan.end_angle_rad() - angle_rad;
    let error_ml = |n| {
        let start = angle_rad + half_width_rad * ((2.0 * f64::from(n) + 1.0) / f64::from(POINTS) - 1.0);
        curve.volume_ml(start + turn_rad) - curve.volume_ml(start) - plan.planned_ml
    };
    let square = (0..POINTS).map(|n| error_ml(n) * error_ml(n)).sum::<f64>() / f64::from(POINTS);
    sqrt(square + zero_ml * zero_ml)
}

#[cfg(test)]
mod tests {
    use super::*;
    use pump_ctl::plan::{Cruise, Request, plan};

    fn budget(volume_ml: f64, start: Phase) -> Budget {
        let file = crate::catalogue::built_in("three-roller").unwrap();
        let pump = file.model().unwrap();
        let request = Request::new(volume_ml, Cruise::Flow { ml_s: 5.0 });
        let plan = plan(&pump, start, &request, &file.limits()).unwrap();
        Budget::new(&pump, &plan, &file.uncertainty, None)
    }

    #[test]
    fn an_uncalibrated_dose_carries_the_papers_figures() {
        let budget = budget(25.0, Phase::known(0.0));
        let relative = sqrt(0.024 * 0.024 + 0.0047 * 0.0047);
        let standard_ml = sqrt(25.0 * 25.0 * relative * relative + 0.026 * 0.026);
        assert!((budget.expanded_ml() - 2.0 * standard_ml).abs() < 1e-4, "{budget:?}");
        let percent: f64 = budget.shares.iter().map(|share| share.variance_percent).sum();
        assert!((percent - 100.0).abs() < 1e-9 && budget.shares[0].variance_percent > 95.0, "{budget:?}");
        assert_eq!(budget.largest().unwrap().source, "model");
    }

    #[test]
    fn doses_within_a_pulse_cover_what_the_papers_own_figures_leave_open() {
        let volume_of = |name: &str, start_rad: f64, turn_rad: f64| {
            let pump = crate::catalogue::built_in(name).unwrap().model().unwrap();
            let curve = pump.outlet_curve();
            curve.volume_ml(start_rad + turn_rad) - curve.volume_ml(start_rad)
        };
        for volume_ml in [0.05, 0.1, 0.5, 1.0, 2.0] {
            for n in 0..24 {
                let start_rad = f64::from(n) * 0.0873;
                let file = crate::catalogue::built_in("three-roller").unwrap();
                let pump = file.model().unwrap();
                let request = Request::new(volume_ml, Cruise::Flow { ml_s: 5.0 });
                let plan = plan(&pump, Phase::known(start_rad), &request, &file.limits()).unwrap();
                let expanded_ml = Budget::new(&pump, &plan, &file.uncertainty, None).expanded_ml();
                let turn_rad = plan.end_angle_rad() - start_rad;
                for other in ["three-roller-published", "three-roller-as-built"] {
                    let difference_ml = volume_of(other, start_rad, turn_rad) - plan.planned_ml;
                    assert!(
                        difference_ml.abs() < expanded_ml,
                        "{volume_ml} mL from {start_rad}: {difference_ml}"
                    );
                }
            }
        }
    }

    #[test]
    fn an_unknown_angle_dominates_a_small_dose_and_vanishes_over_whole_pitches() {
        let anywhere = Phase { angle_rad: 0.0, half_width_rad: 10.0 };
        let phase_of = |volume_ml| budget(volume_ml, anywhere).shares[4].standard_ml;
        assert!(phase_of(1.0) > 0.2);
        let pitch_ml =
            crate::catalogue::built_in("three-roller").unwrap().model().unwrap().revolution_ml() / 3.0;
        assert!(phase_of(pitch_ml) < 2e-3);
    }

    #[test]
    fn the_phases_share_lies_within_the_range_of_the_volume_and_doubled_covers_it() {
        let file = crate::catalogue::built_in("three-roller").unwrap();
        let pump = file.model().unwrap();
        for half_width_rad in [1e-4, 0.01, 0.3, 2.0] {
            for volume_ml in [0.5, 5.0, 25.0, -25.0] {
                let start = Phase { angle_rad: 0.7, half_width_rad };
                let request = Request::new(volume_ml, Cruise::Flow { ml_s: 5.0 });
                let plan = plan(&pump, start, &request, &file.limits()).unwrap();
                let share_ml = Budget::new(&pump, &plan, &file.uncertainty, None).shares[4].standard_ml;
                let half_ml = 0.5 * (plan.most_ml - plan.least_ml);
                assert!(share_ml < half_ml && COVERAGE_FACTOR * share_ml > half_ml, "{share_ml} {half_ml}");
            }
        }
    }
}
