//! What a dose reports to a person: a few lines, digits cut to the uncertainty.

use std::fmt::Write;

use pump_model::math::{floor, wrap};

use super::dose::DoseReport;
use crate::bench::headline;
use crate::numbers::significant;
use crate::record::PhaseSource;

/// Shares of less of the variance are left out, percent.
const TELLING_PERCENT: f64 = 1e-5;

impl DoseReport {
    /// The report in words.
    pub fn text(&self) -> String {
        let mut text = String::new();
        // Writing to a String cannot fail.
        let _ = self.write_text(&mut text);
        text
    }

    fn write_text(&self, to: &mut String) -> std::fmt::Result {
        let decimals = decimals_of(self.expanded_uncertainty_ml);
        let uncertainty = format!("{:.decimals$}", self.expanded_uncertainty_ml);
        let (volume, verb) = match (self.delivered_ml, self.purpose) {
            (None, _) => (self.planned_ml, "planned (dry run, nothing recorded)"),
            (Some(delivered), _) if !self.completed => (delivered, "delivered, then stopped"),
            (Some(delivered), "prime") => (delivered, "primed"),
            (Some(delivered), "purge") => (delivered, "purged"),
            (Some(delivered), "calibrate") => (delivered, "delivered to be weighed"),
            (Some(delivered), _) => (delivered, "delivered"),
        };
        let asked = significant(self.requested_ml, 6);
        let repaid = match self.carry_in_ml {
            0.0 => String::new(),
            carry => format!(", with {}", owed(carry, "from before")),
        };
        if self.delivered_ml.is_none() && !self.simulated {
            writeln!(to, "DRY RUN: {} does not move", self.pump)?;
        } else {
            writeln!(to, "{}", headline(&self.pump, self.simulated, self.device.as_deref()))?;
        }
        writeln!(
            to,
            "{}: {volume:.decimals$} mL ± {uncertainty} mL {verb}, {asked} mL asked{repaid}",
            self.pump
        )?;
        writeln!(to)?;
        let wrapped = match wrap(self.end_angle_deg, 360.0) {
            same if same == self.end_angle_deg => String::new(),
            wrapped => format!(", that is {wrapped:.2}°"),
        };
        if self.phase.known {
            writeln!(
                to,
                "  rollers      from {:.2}° ({}) to {:.2}°{wrapped}",
                self.start_angle_deg,
                self.known(),
                self.end_angle_deg
            )?;
        } else {
            let turned_deg = self.end_angle_deg - self.start_angle_deg;
            writeln!(to, "  rollers      turned by {turned_deg:.2}° from an unknown angle")?;
        }
        let steps = match self.steps_made {
            Some(made) if !self.completed => format!("{made} of {}", self.steps),
            _ => self.steps.to_string(),
        };
        let rest = if self.steps_made.is_some() && !self.completed {
            "`dose resume` makes the rest, `dose discard` leaves it".to_owned()
        } else {
            owed(self.carry_ml, "to the next dose")
        };
        writeln!(to, "  steps        {steps} (a revolution has {}); {rest}", self.steps_per_rev)?;
        if let Some(back_ml) = self.retraction_ml {
            writeln!(
                to,
                "  retraction   {} µL sucked back, for the next dose to repay",
                significant(1e3 * back_ml, 4)
            )?;
        }
        let limited = match self.limited_by {
            "none" => String::new(),
            limit => format!(" (limited by {limit})"),
        };
        let peak = match self.peak_speed_rpm {
            peak_rpm if peak_rpm > 1.001 * self.cruise_speed_rpm => {
                format!(" on average, {} at most", significant(peak_rpm, 4))
            }
            _ => String::new(),
        };
        writeln!(
            to,
            "  speed        {} r/min{peak}, {} mL/s cruising{limited}",
            significant(self.cruise_speed_rpm, 4),
            significant(self.cruise_flow_ml_s, 4)
        )?;
        if self.ripple_after != self.ripple_before {
            writeln!(
                to,
                "  flow         ripple {} % peak to peak, {} % RMS; at constant speed {} and {} %",
                significant(100.0 * self.ripple_after.peak_to_peak, 3),
                significant(100.0 * self.ripple_after.rms, 3),
                significant(100.0 * self.ripple_before.peak_to_peak, 3),
                significant(100.0 * self.ripple_before.rms, 3)
            )?;
        }
        writeln!(
            to,
            "  time         {:.3} s in motion, {:.3} s to settle within 1 µL",
            self.motion_s, self.settle_s
        )?;
        writeln!(
            to,
            "  pressures    inlet {:.2} to {:.2} kPa, outlet {:.2} to {:.2} kPa absolute (ambient {} kPa)",
            self.inlet_min_kpa,
            self.inlet_max_kpa,
            self.outlet_min_kpa,
            self.outlet_max_kpa,
            self.ambient_kpa
        )?;
        if let Some((limit_kpa, of)) = self.inlet_limit_kpa.zip(self.inlet_limit) {
            writeln!(to, "  suction      not below {limit_kpa:.2} kPa absolute ({})", of.replace('_', " "))?;
        }
        if let Some((needed_n_m, available_n_m)) = self.torque_needed_n_m.zip(self.torque_available_n_m) {
            let [needed, available] = [needed_n_m, available_n_m].map(|n_m| significant(n_m, 3));
            writeln!(to, "  torque       {needed} N m needed where the motor has {available}")?;
        }
        let not_checked = match self.limits_not_checked.join(", ").replace('_', " ") {
            none if none.is_empty() => "nothing: every limit has a value".to_owned(),
            names => names,
        };
        writeln!(to, "  not checked  {not_checked}")?;
        writeln!(to, "  uncertainty  {}", self.budget_line())?;
        if let Some(remedy) = self.remedy_line() {
            writeln!(to, "  surer        {remedy}")?;
        }
        for warning in &self.warnings {
            writeln!(to, "  warning      {warning}")?;
        }
        Ok(())
    }

    fn known(&self) -> String {
        let source = match self.phase.source {
            PhaseSource::Home => "home",
            PhaseSource::Mark => "by its mark",
            PhaseSource::Recorded => "as recorded",
            PhaseSource::Given => "as given",
            PhaseSource::Assumed => "unknown",
        };
        if self.phase.half_width_deg > 0.0 {
            format!("{source}, ± {:.2}°", self.phase.half_width_deg)
        } else {
            source.to_owned()
        }
    }

    /// Each share of the uncertainty in percent of the volume, and how to make the largest smaller.
    fn budget_line(&self) -> String {
        let volume_ml = self.delivered_ml.unwrap_or(self.planned_ml).abs();
        if volume_ml == 0.0 {
            return "none: nothing was delivered".to_owned();
        }
        let shares: Vec<String> = self
            .uncertainty_budget
            .iter()
            .filter(|share| share.variance_percent >= TELLING_PERCENT)
            .map(|share| {
                let percent = 100.0 * share.standard_ml / volume_ml;
                format!("{} {}", share.source.replace('_', " "), significant(percent, 2))
            })
            .collect();
        let basis = match &self.calibration {
            Some(calibration) if self.volume_basis == "calibrated" => {
                let factor = significant(calibration.displacement_factor, 6);
                format!("calibration {} (model volume times {factor})", calibration.version)
            }
            _ => match self.speed_law_factor {
                Some(factor) => {
                    format!("not calibrated, speed law (model volume times {})", significant(factor, 6))
                }
                None => "not calibrated".to_owned(),
            },
        };
        format!("k = 2, {basis}; standard, % of volume: {}", shares.join(", "))
    }

    /// The largest share, and how to make it smaller.
    fn remedy_line(&self) -> Option<String> {
        let shares = self.uncertainty_budget.iter();
        let largest = shares.max_by(|a, b| a.standard_ml.total_cmp(&b.standard_ml))?;
        let percent = largest.variance_percent;
        (percent > 0.0).then(|| {
            format!(
                "{} makes {percent:.0} % of the variance: {}",
                largest.source.replace('_', " "),
                largest.remedy
            )
        })
    }
}

/// A carry in words: positive is owed, negative is ahead.
fn owed(carry_ml: f64, when: &str) -> String {
    let word = if carry_ml < 0.0 { "too much" } else { "owed" };
    format!("{:.2} µL {word} {when}", 1e3 * carry_ml.abs())
}

/// Decimals that show an uncertainty with two significant digits.
fn decimals_of(uncertainty: f64) -> usize {
    if !(uncertainty > 0.0 && uncertainty.is_finite()) {
        return 6;
    }
    // 12 at most: nobody weighs a picolitre.
    (1.0 - floor(uncertainty.log10())).clamp(0.0, 12.0) as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_are_cut_to_the_uncertainty() {
        assert_eq!(decimals_of(1.223), 1);
        assert_eq!(decimals_of(0.0489), 3);
        assert_eq!(decimals_of(24.0), 0);
        assert_eq!(decimals_of(240.0), 0);
        assert_eq!(decimals_of(0.0), 6);
        assert_eq!(significant(0.004_812, 2), "0.0048");
        assert_eq!(significant(2.4, 2), "2.4");
        assert_eq!(significant(25.075_225_677, 6), "25.0752");
        assert_eq!(significant(-25.0, 6), "-25");
        assert_eq!(significant(123_456_789.0, 3), "123456789");
    }
}
