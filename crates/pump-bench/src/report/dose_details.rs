//! The details of a dose's report for people, a line each, down to the uncertainty budget.

use libm::sqrt;
use pump_model::units::wrap;

use super::choices::VolumeBasis;
use super::dose::{CalibrationReport, DoseReport};
use crate::dosing::{RippleAt, Share, ShareSource};
use crate::numbers::{decimals_of, microlitres, short, significant};
use crate::record::PhaseSource;

/// Share of the variance below which a source of uncertainty is left out, percent.
const TELLING_PERCENT: f64 = 1e-5;

impl DoseReport {
    /// Angles, steps, speeds, pressures, limits and the uncertainty budget, a line each.
    pub fn details(&self) -> String {
        let lines = [
            ("began", self.time.map(|time| time.to_string())),
            ("rollers", Some(self.rollers())),
            ("steps", Some(self.steps())),
            ("retraction", self.retraction()),
            ("speed", Some(self.speed())),
            ("flow", self.ripple()),
            ("time", Some(self.time())),
            ("back flow", self.back_flow()),
            ("balance", self.balance()),
            ("pressures", Some(self.pressures())),
            ("suction", self.suction()),
            ("torque", self.torque()),
            ("not checked", Some(self.not_checked())),
            ("uncertainty", Some(self.budget())),
            ("remedy", self.remedy()),
        ];
        lines.into_iter().filter_map(|(name, text)| Some(format!("  {name:<13}{}\n", text?))).collect()
    }

    fn rollers(&self) -> String {
        let (start_deg, end_deg) = (self.start_angle_deg, self.end_angle_deg);
        if !self.phase.known {
            return format!("turned by {:.2}° from an unknown angle", end_deg - start_deg);
        }
        let wrapped = match wrap(end_deg, 360.0) {
            same if same == end_deg => String::new(),
            wrapped_deg => format!(", that is {wrapped_deg:.2}°"),
        };
        format!("from {start_deg:.2}° ({}) to {end_deg:.2}°{wrapped}", self.known())
    }

    /// The source of the start angle, and its largest error.
    fn known(&self) -> String {
        let source = match self.phase.source {
            PhaseSource::Home => "home",
            PhaseSource::Mark => "by its mark",
            PhaseSource::Recorded => "as recorded",
            PhaseSource::Given => "as given",
            PhaseSource::Assumed => "unknown",
        };
        match self.phase.half_width_deg {
            width_deg if width_deg > 0.0 => format!("{source}, ± {width_deg:.2}°"),
            _ => source.to_owned(),
        }
    }

    fn steps(&self) -> String {
        let of_revolution = format!("(a revolution has {})", self.steps_per_rev);
        match self.steps_made {
            Some(made) if self.is_part() => format!("{made} of {} {of_revolution}", self.steps),
            _ => {
                format!(
                    "{} {of_revolution}; carry {} to the next dose",
                    self.steps,
                    microlitres(self.carry_ml)
                )
            }
        }
    }

    fn retraction(&self) -> Option<String> {
        let back = significant(1e3 * self.retraction_ml?, 4);
        Some(format!("{back} µL sucked back, for the next dose to repay"))
    }

    fn speed(&self) -> String {
        let peak = match self.peak_speed_rpm {
            peak_rpm if peak_rpm > 1.001 * self.cruise_speed_rpm => {
                format!(" on average, {} at most", significant(peak_rpm, 4))
            }
            _ => String::new(),
        };
        let cruise_rpm = significant(self.cruise_speed_rpm, 4);
        format!("{cruise_rpm} r/min{peak}, {} mL/s cruising", significant(self.cruise_flow_ml_s, 4))
    }

    fn ripple(&self) -> Option<String> {
        let percent = |ripple: f64| significant(100.0 * ripple, 2);
        let said = |at: &RippleAt| {
            let off = match self.phase.half_width_deg {
                half_width_deg if half_width_deg > 0.0 => format!(
                    ", up to {} % at an angle {} deg off",
                    percent(at.peak_to_peak_worst_angle),
                    significant(half_width_deg, 2)
                ),
                _ => String::new(),
            };
            format!(
                "{} % expected (at most {} % in 95 % of such pumps; {} % if this one is exactly as its model{off}), \
                 {} % at constant speed",
                percent(at.peak_to_peak_median),
                percent(at.peak_to_peak_95),
                percent(at.planned.peak_to_peak),
                percent(at.constant_speed.peak_to_peak)
            )
        };
        (self.ripple_after != self.ripple_before).then(|| {
            let (rollers, line_end) = (&self.ripple_at_rollers, self.ripple_at_line_end.as_ref());
            let end = line_end.map_or(String::new(), |at| format!("at the line's end {}; ", said(at)));
            // The warning of a smooth flow decides by the same place and figures.
            let verdict = match line_end.unwrap_or(rollers).is_smoother() {
                true => "smoother than at constant speed",
                false => "no smoother than at constant speed",
            };
            format!("{verdict}: ripple peak to peak {end}at the rollers {}", said(rollers))
        })
    }

    fn time(&self) -> String {
        let settles = match self.settle_s {
            Some(settle_s) if settle_s.is_infinite() => {
                "and the line does not come to rest within an hour".to_owned()
            }
            Some(settle_s) => format!("{settle_s:.3} s to settle within 1 µL"),
            None => "settling not known, as the outlet's line is not".to_owned(),
        };
        format!("{:.3} s in motion, {settles}", self.moved_s())
    }

    fn back_flow(&self) -> Option<String> {
        let back = significant(1e3 * self.backflow_ml?, 2);
        let all =
            self.reverse_flow_ml.map(|ml| format!("; {} µL flow back in all", significant(1e3 * ml, 2)));
        Some(format!("{back} µL after the line's swing at the stop{}", all.unwrap_or_default()))
    }

    fn pressures(&self) -> String {
        let said = |port: &str, range: Option<(f64, f64)>, unsure_kpa: Option<f64>| {
            let ((least_kpa, most_kpa), unsure_kpa) = range.zip(unsure_kpa)?;
            Some(format!("{port} {least_kpa:.2} to {most_kpa:.2} ± {} kPa", significant(unsure_kpa, 2)))
        };
        let inlet = self.inlet_min_kpa.zip(self.inlet_max_kpa);
        let outlet = self.outlet_min_kpa.zip(self.outlet_max_kpa);
        let known: Vec<String> = said("inlet", inlet, self.inlet_pressure_uncertainty_kpa)
            .into_iter()
            .chain(said("outlet", outlet, self.outlet_pressure_uncertainty_kpa))
            .collect();
        let ambient = format!("ambient {} kPa", short(self.ambient_kpa));
        match known.as_slice() {
            [] => format!("not known: the pump file names no lines ({ambient})"),
            known => format!("{} absolute (k = 2; {ambient})", known.join(", ")),
        }
    }

    /// The reading of a balance for the volume, with the pressure of its air.
    fn balance(&self) -> Option<String> {
        // A gram of fluid is about a millilitre, so the volume's digits are those of the mass.
        let (grams, decimals) = (self.balance_g?, decimals_of(self.expanded_uncertainty_ml));
        let kpa = short(self.ambient_kpa);
        Some(format!("shows {grams:.decimals$} g in air of {kpa} kPa (Z of ISO 8655-6)"))
    }

    fn suction(&self) -> Option<String> {
        let (limit_kpa, limit) = self.inlet_limit_kpa.zip(self.inlet_limit)?;
        Some(format!("not below {limit_kpa:.2} kPa absolute ({})", spoken(limit.name())))
    }

    fn torque(&self) -> Option<String> {
        let (needed_n_m, available_n_m) = self.torque_needed_n_m.zip(self.torque_available_n_m)?;
        let [needed, available] = [needed_n_m, available_n_m].map(|n_m| significant(n_m, 3));
        Some(format!("{needed} N m needed where the motor has {available}"))
    }

    fn not_checked(&self) -> String {
        if self.limits_not_checked.is_empty() {
            return "nothing: every limit has a value".to_owned();
        }
        let names: Vec<String> = self.limits_not_checked.iter().map(|limit| spoken(limit.as_str())).collect();
        names.join(", ")
    }

    /// Each share of the uncertainty in percent of the volume.
    fn budget(&self) -> String {
        let volume_ml = self.booked_ml.abs();
        if volume_ml == 0.0 {
            return "none: nothing was delivered".to_owned();
        }
        let shares: Vec<String> = self
            .uncertainty_budget
            .iter()
            .filter(|share| share.variance_percent >= TELLING_PERCENT)
            .map(|share| {
                let percent = 100.0 * share.standard_ml / volume_ml;
                let prior = prior(share, volume_ml).unwrap_or_default();
                format!("{} {}{prior}", spoken(share.source.as_str()), significant(percent, 2))
            })
            .collect();
        let variance: f64 =
            self.uncertainty_budget.iter().map(|share| share.standard_ml * share.standard_ml).sum();
        let factor = significant(self.expanded_uncertainty_ml / sqrt(variance), 3);
        format!("k = {factor}, {}; standard, % of volume: {}", self.basis(), shares.join(", "))
    }

    /// The basis of the volume, with the factor of the calibration or of the speed law.
    fn basis(&self) -> String {
        match (&self.calibration, self.speed_law_factor) {
            (Some(calibration), _) if self.volume_basis == VolumeBasis::Calibrated => {
                let factor = format!("{:.4}", calibration.displacement_factor);
                let pulse = pulse(calibration);
                format!("calibration {} (model volume times {factor}{pulse})", calibration.version)
            }
            (_, Some(factor)) => {
                format!("not calibrated, speed law (model volume times {factor:.4})")
            }
            (Some(calibration), None) if calibration.roller_volume_ml.is_some() => {
                format!("calibration {} (of the pulse alone{})", calibration.version, pulse(calibration))
            }
            (_, None) => "not calibrated".to_owned(),
        }
    }

    /// The largest share of the uncertainty, and how to make it smaller.
    fn remedy(&self) -> Option<String> {
        let shares = self.uncertainty_budget.iter();
        let largest = shares.max_by(|a, b| a.standard_ml.total_cmp(&b.standard_ml))?;
        let (source, percent) = (spoken(largest.source.as_str()), largest.variance_percent);
        (percent > 0.0).then(|| format!("{source} makes {percent:.0} % of the variance: {}", largest.remedy))
    }
}

/// The prior that the share of repeatability rests on.
fn prior(share: &Share, volume_ml: f64) -> Option<String> {
    let prior = share.prior.filter(|_| share.source == ShareSource::Repeatability)?;
    let percent = significant(100.0 * prior.standard_ml / volume_ml, 2);
    let weighed = match prior.weighed {
        1 => "1 weighed dose".to_owned(),
        count => format!("{count} weighed doses"),
    };
    Some(format!(
        " (on a stated prior of {percent}, {} times the pump file's, beside {weighed})",
        prior.over_pump_file
    ))
}

/// The pulse of a calibration that found one.
fn pulse(calibration: &CalibrationReport) -> String {
    let found = calibration.roller_volume_ml.zip(calibration.engagement_deg);
    found.map_or(String::new(), |(volume_ml, engagement_deg)| {
        format!(", roller volume {} mL over {engagement_deg:.2}°", significant(volume_ml, 5))
    })
}

/// The word of a choice without underscores.
fn spoken(word: &str) -> String {
    word.replace('_', " ")
}
