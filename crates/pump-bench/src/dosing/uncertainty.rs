//! The uncertainty budget of a dose.

mod angle;
mod default_pulse;
#[cfg(test)]
mod default_pulse_coverage;
pub(super) mod outlet;
mod pressure;
#[cfg(test)]
mod prior_coverage;
#[cfg(test)]
mod pulse_coverage;
mod pulse_share;
mod repeatability;
mod share;
mod weighed;

use libm::{hypot, sqrt};
use pump_model::Pump;

use self::angle::AngleErrors;
pub(crate) use self::pressure::pressure_uncertainty_kpa;
use self::pulse_share::pulse_share_ml;
pub(crate) use self::share::one_more;
pub use self::share::{Share, SharePrior, ShareSource};
pub(crate) use self::weighed::weighed_shares;
use super::swept::Swept;
use crate::calibration::{Applied, READ_DEGC, ScatterPrior, Sureness};
use crate::pump_file::UncertaintyTable;

/// Coverage factor of the expanded uncertainty where all errors are normal (about 95 % of doses).
const COVERAGE_FACTOR: f64 = 2.0;

/// Growth of the cross section of a tube's bore, in 1/°C: twice the linear expansion of silicone rubber,
/// 3e-4. Natural rubber has 2.2e-4, a third of its expansion in volume, 6.6e-4 (Polymer Handbook).
const BORE_PER_DEGC: f64 = 6e-4;

/// Uncertainty budget of a dose. Its shares are independent.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Budget {
    /// Shares of the budget.
    pub(crate) shares: Vec<Share>,
    /// Errors over the angles at which the rollers may stand.
    errors: AngleErrors,
}

impl Budget {
    /// Computes the budget of a turn of `pump`, the pump that it was planned for, with the calibration that
    /// corrected the pump.
    ///
    /// - The model's share is a fraction of the volume, and so is that of the speed. A calibration takes the place
    ///   of both, and so does the speed law of a pump file.
    /// - Repeatability depends on the volume (see `repeatability`).
    /// - A short dose is as unsure as the part of a pulse that it sweeps (see `pulses_unsure`). For a
    ///   calibrated pump that share vanishes over whole pitches.
    /// - Short doses that found the pulse take the place of that share, and of the zero's (see `pulse_share_ml`).
    /// - The step's share is that of a rotor that stands anywhere within a step, rectangular: dV/sqrt(12)
    ///   (GUM, JCGM 100:2008, 4.3.7).
    /// - The angle's share is the root of the mean square deviation from the plan. Every start angle within the
    ///   tolerance is equally likely. An angle that is known to 2 deg or worse makes the phase's share instead,
    ///   about the middle of the range. The volumes crowd at the ends of their range, so a rectangle over it would
    ///   give too little. An identified zero adds its own uncertainty to the phase's share.
    /// - Temperature widens the bore.
    /// - The carry from earlier doses is as unsure as those doses were.
    pub(crate) fn new(
        pump: &Pump,
        swept: &Swept,
        table: &UncertaintyTable,
        calibration: Option<&Applied>,
    ) -> Self {
        let volume_ml = swept.volume_ml.abs();
        let sureness = calibration.and_then(|applied| applied.sureness());
        // Only the pump file states how near a law is that was not fitted to this pump.
        let law = calibration.and_then(|applied| applied.law_standard());
        let unweighed = |percent: f64| {
            if sureness.is_some() || law.is_some() { 0.0 } else { percent / 100.0 }
        };
        let (model, speed) = (unweighed(table.model_percent), unweighed(table.speed_percent.unwrap_or(0.0)));
        let of_calibration = |of: fn(&Sureness) -> f64| sureness.as_ref().map_or(0.0, of);
        let temperature = of_calibration(|sure| {
            BORE_PER_DEGC * sqrt(sure.warmer_degc * sure.warmer_degc + READ_DEGC * READ_DEGC)
        });
        let common = sureness.map_or(law.unwrap_or(hypot(model, speed)), |sureness| sureness.common());
        let pulse = calibration.and_then(|applied| Some((applied.pulse?, applied.correction.zero_rad)));
        // A fitted pulse has the zero's uncertainty in its own.
        let zero_rad =
            calibration.filter(|_| pulse.is_none()).map_or(0.0, |applied| applied.zero_standard_rad);
        let roller_ml = if pulse.is_none() { table.roller_standard_ml() } else { 0.0 };
        let errors = AngleErrors::of(pump, swept);
        let [angle_ml, wide_ml] = errors.shares_ml();
        let mut budget = Self { shares: Vec::new(), errors };
        let mut share = |source, standard_ml| budget.shares.push(Share::new(source, standard_ml));
        share(ShareSource::Model, model * volume_ml);
        let repeatability_ml = repeatability::standard_ml(pump, table, sureness.as_ref(), volume_ml);
        share(ShareSource::Repeatability, repeatability_ml);
        share(ShareSource::RollerVolume, roller_ml * pulses_unsure(pump, swept, sureness.is_some()));
        share(ShareSource::Step, swept.end_step_ml / sqrt(12.0));
        share(ShareSource::Phase, hypot(wide_ml, zero_ml(pump, swept, zero_rad)));
        share(ShareSource::Calibration, of_calibration(|sure| sure.factor) * volume_ml);
        let law = law.unwrap_or(of_calibration(|sure| sure.speed_dependence));
        share(ShareSource::SpeedDependence, law * volume_ml);
        share(ShareSource::Speed, speed * volume_ml);
        share(ShareSource::Temperature, temperature * volume_ml);
        share(ShareSource::Carry, common * swept.carry_in_ml.abs());
        share(ShareSource::Angle, angle_ml);
        if let Some((pulse, zero_rad)) = pulse {
            share(ShareSource::Pulse, pulse_share_ml(pump, swept, &pulse, zero_rad));
        }
        if let Some(prior) = sureness.and_then(|sureness| sureness.prior) {
            budget.rest_on(&prior, repeatability::stated_ml(pump, table, &prior, volume_ml));
        }
        budget.with_percentages()
    }

    /// Says of the shares of scatter and calibration that they rest on a prior of `standard_ml` of this dose.
    fn rest_on(&mut self, prior: &ScatterPrior, standard_ml: f64) {
        let sources = [ShareSource::Repeatability, ShareSource::Calibration];
        for share in self.shares.iter_mut().filter(|share| sources.contains(&share.source)) {
            *share = share.clone().resting_on(prior, standard_ml);
        }
    }

    /// Returns the budget with a carry of `carry_ml` that is known within `half_width_ml`, rectangular:
    /// / sqrt(3) (GUM, JCGM 100:2008, 4.3.7). The dose repays no more than the carry, so it is not more unsure.
    #[must_use]
    pub(crate) fn with_carry_within(mut self, carry_ml: f64, half_width_ml: f64) -> Self {
        let half_width_ml = half_width_ml.min(carry_ml.abs());
        for share in self.shares.iter_mut().filter(|share| share.source == ShareSource::Carry) {
            let square = share.standard_ml * share.standard_ml + half_width_ml * half_width_ml / 3.0;
            share.standard_ml = sqrt(square);
        }
        self.with_percentages()
    }

    /// Sets each share's part of the variance.
    fn with_percentages(mut self) -> Self {
        let variance = self.standard_ml() * self.standard_ml();
        for share in &mut self.shares {
            share.variance_percent =
                if variance > 0.0 { 100.0 * share.standard_ml * share.standard_ml / variance } else { 0.0 };
        }
        self
    }

    /// Returns the combined standard uncertainty, in mL.
    pub(crate) fn standard_ml(&self) -> f64 {
        sqrt(self.shares.iter().map(|share| share.standard_ml * share.standard_ml).sum())
    }

    /// Returns the expanded uncertainty, in mL: 95.45 % of doses lie within it. That is k = 2, as all errors but that
    /// of a stated angle are taken as normal. The stated angle's error has its own distribution.
    ///
    /// An angle that is known less well keeps k = 2, which covers more than that. The roller volume then matters by
    /// the angle too, and is no independent error. With a default pulse both have their joint distribution instead.
    pub(crate) fn expanded_ml(&self) -> f64 {
        let all_ml = self.standard_ml();
        self.errors.expanded_ml(all_ml).unwrap_or(COVERAGE_FACTOR * all_ml)
    }
}

/// Returns the number of roller volumes by which another roller volume changes what the turn delivers.
///
/// With known dimensions that number is the roller volumes that the turn sweeps, one at most. The common part
/// of several is in the model's share. With a known volume of a revolution it is the swept number less the
/// average number in the turn.
fn pulses_unsure(pump: &Pump, swept: &Swept, revolution_is_known: bool) -> f64 {
    let turn_rad = (swept.end_rad - swept.start.angle_rad()).abs();
    let taken_ml = pump.nominal_ml_rad() * turn_rad - swept.volume_ml.abs();
    let pulses = taken_ml / pump.roller_volume().total_ml();
    if revolution_is_known { (pulses - turn_rad / pump.pitch_rad()).abs() } else { pulses.clamp(0.0, 1.0) }
}

/// Returns the error of the volume, in mL, that an error of `zero_standard_rad` in the zero of the angle makes.
fn zero_ml(pump: &Pump, swept: &Swept, zero_standard_rad: f64) -> f64 {
    let curve = pump.outlet_curve();
    let slope_ml_rad = curve.flow_ml_rad(swept.end_rad) - curve.flow_ml_rad(swept.start.angle_rad());
    (slope_ml_rad * zero_standard_rad).abs()
}

#[cfg(test)]
mod tests {
    use super::*;
    use pump_ctl::plan::{Cruise, Doser, Phase, Request};

    fn budget(volume_ml: f64, start: Phase) -> Budget {
        let file = crate::catalogue::built_in("three-roller").unwrap();
        let pump = file.model().unwrap();
        let request = Request::new(volume_ml, Cruise::Flow { ml_s: 5.0 });
        let plan = Doser::new(&pump, file.limits()).unwrap().plan(start, &request).unwrap();
        Budget::new(&pump, &Swept::whole(&pump, &plan), &file.uncertainty, None)
    }

    #[test]
    fn an_uncalibrated_dose_carries_the_papers_figures() {
        let budget = budget(25.0, Phase::known(0.0));
        // 2.4 % of the volume, and 0.47 % of ten revolutions of independent pitches.
        let (model_ml, scatter_ml) = (0.024 * 25.0, 0.0047 * sqrt(25.0 * 213.185));
        let standard_ml = sqrt(model_ml * model_ml + scatter_ml * scatter_ml + 0.026 * 0.026);
        assert!((budget.expanded_ml() - 2.0 * standard_ml).abs() < 1e-4, "{budget:?}");
        let percent: f64 = budget.shares.iter().map(|share| share.variance_percent).sum();
        assert!((percent - 100.0).abs() < 1e-9 && budget.shares[0].variance_percent > 70.0, "{budget:?}");
        assert_eq!(budget.shares[0].source, ShareSource::Model);
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
                let plan = Doser::new(&pump, file.limits())
                    .unwrap()
                    .plan(Phase::known(start_rad), &request)
                    .unwrap();
                let expanded_ml =
                    Budget::new(&pump, &Swept::whole(&pump, &plan), &file.uncertainty, None).expanded_ml();
                let turn_rad = plan.end_angle_rad() - start_rad;
                for other in ["three-roller-published", "three-roller-as-built"] {
                    let difference_ml = volume_of(other, start_rad, turn_rad) - plan.planned_ml();
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
        let anywhere = Phase::within(0.0, 10.0);
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
                let start = Phase::within(0.7, half_width_rad);
                let request = Request::new(volume_ml, Cruise::Flow { ml_s: 5.0 });
                let plan = Doser::new(&pump, file.limits()).unwrap().plan(start, &request).unwrap();
                let source = if start.is_stated() { ShareSource::Angle } else { ShareSource::Phase };
                let budget = Budget::new(&pump, &Swept::whole(&pump, &plan), &file.uncertainty, None);
                let of_source = |share: &&Share| share.source == source;
                let share_ml = budget.shares.iter().find(of_source).unwrap().standard_ml;
                let half_ml = 0.5 * (plan.most_ml() - plan.least_ml());
                assert!(share_ml < half_ml && COVERAGE_FACTOR * share_ml > half_ml, "{share_ml} {half_ml}");
            }
        }
    }
}
