//! The report of a dose in three lines for people; digits are cut to the uncertainty.

use pump_ctl::plan::LimitedBy;

use super::dose::DoseReport;
use crate::bench::headline;
use crate::numbers::{decimals_of, microlitres, significant};
use crate::record::{Purpose, ShortText};
use crate::units::{Amount, amount};

impl DoseReport {
    /// The first line: whether a motor moves.
    pub fn headline(&self) -> String {
        if self.delivered_ml.is_none() && !self.simulated {
            return format!("DRY RUN: {} does not move", self.pump);
        }
        headline(&self.pump, self.simulated, self.device.as_deref())
    }

    /// The second and the third line: the volume with its uncertainty, and the motion, the pressures and the carry.
    ///
    /// `asked` is the volume as it was typed; without it the requested volume stands there. `of_batch` is the number of
    /// the dose and of all doses of its batch.
    pub fn summary(&self, asked: Option<&str>, of_batch: Option<(u64, u64)>) -> String {
        self.lines(asked, of_batch, "")
    }

    /// The lines of [`Self::summary`], with the time at which the dose began.
    pub fn dated_summary(&self, asked: Option<&str>, of_batch: Option<(u64, u64)>) -> String {
        let began = self.time.map_or(String::new(), |time| format!("; began {time}"));
        self.lines(asked, of_batch, &began)
    }

    fn lines(&self, asked: Option<&str>, of_batch: Option<(u64, u64)>, began: &str) -> String {
        let place = of_batch.map_or(String::new(), |(number, count)| format!(", dose {number} of {count}"));
        let weighed = self.by_weight.as_ref().map_or(String::new(), |weighed| weighed.line());
        let run = self.run.map_or(String::new(), |run| run.line(self.moved_s()));
        let (volume, motion) = (self.volume_line(asked), self.motion_line());
        format!("{}{place}: {volume}\n{motion}{began}\n{run}{weighed}", self.pump)
    }

    /// The dose in one line, as one of a batch: its volume with its uncertainty, and its end.
    pub fn batch_line(&self, number: u64, count: u64) -> String {
        format!("{}, dose {number} of {count}: {}; {}", self.pump, self.volume(), self.end())
    }

    /// The warnings, a line each.
    pub fn warning_lines(&self) -> String {
        self.warnings.iter().map(|warning| format!("warning: {warning}\n")).collect()
    }

    fn volume_line(&self, asked: Option<&str>) -> String {
        let requested = || format!("{} mL", significant(self.requested_ml, 6));
        // The rest of a dose keeps the mass that the dose was asked for.
        let of_record = self.asked.as_ref().map(ShortText::as_str).filter(|typed| is_mass(typed));
        let asked = asked.or(of_record);
        let asked = match asked {
            _ if self.is_endless() => "run until stopped".to_owned(),
            Some(typed) if is_mass(typed) => {
                format!("{typed} requested by a balance in air: {}", requested())
            }
            Some(typed) => format!("{typed} requested"),
            None => format!("{} requested", requested()),
        };
        let carry_in = match self.carry_in_ml {
            0.0 => String::new(),
            carry_ml => format!(", {} carried over", microlitres(carry_ml)),
        };
        format!("{}, {asked}{carry_in}", self.volume())
    }

    /// True if the volume is that of one angle, or a balance's.
    fn is_sure(&self) -> bool {
        self.phase.is_stated() || self.by_weight.is_some()
    }

    /// Volume that the text and the log tell, mL.
    pub(crate) fn told_ml(&self) -> f64 {
        self.delivered_ml.unwrap_or(self.booked_ml)
    }

    /// True for a run that goes on until somebody stops it.
    fn is_endless(&self) -> bool {
        self.run.is_some_and(|run| run.is_endless())
    }

    /// The volume that was delivered or planned, and its uncertainty.
    fn volume(&self) -> String {
        let is_sure = self.is_sure();
        let volume_ml = self.told_ml();
        let verb = match (self.delivered_ml, self.purpose) {
            (None, _) if self.is_endless() => "at most (dry run, nothing recorded)",
            (None, _) => "planned (dry run, nothing recorded)",
            (Some(_), _) if !self.completed => "delivered, then stopped",
            (Some(_), Purpose::Prime) => "primed",
            (Some(_), Purpose::Purge) => "purged",
            (Some(_), Purpose::Calibrate) => "delivered to be weighed",
            (Some(_), _) => "delivered",
        };
        let unsure_ml = self.expanded_uncertainty_ml;
        let decimals = decimals_of(unsure_ml);
        let by_angle = if is_sure { String::new() } else { self.by_angle() };
        format!("{volume_ml:.decimals$} mL ± {unsure_ml:.decimals$} mL {verb}{by_angle}")
    }

    /// The range of the volume over the angles at which the rollers may have stood: one share of the uncertainty.
    fn by_angle(&self) -> String {
        let (least_ml, most_ml) = (self.volume_least_ml, self.volume_most_ml);
        // A digit more than the uncertainty has: the range is exact.
        let decimals =
            1 + decimals_of(self.expanded_uncertainty_ml).min(decimals_of(0.5 * (most_ml - least_ml)));
        let [least, most] = [least_ml, most_ml].map(|ml| format!("{ml:.decimals$}"));
        if least == most {
            return String::new();
        }
        format!(" ({least} to {most} mL by the rollers' angle alone)")
    }

    /// Time of the motion, s: that of the plan, or of the part that was made of a dose that was stopped.
    pub(super) fn moved_s(&self) -> f64 {
        self.measured_motion_s.filter(|_| self.is_part()).unwrap_or(self.motion_s)
    }

    /// True if a part of the planned steps was made.
    pub(super) fn is_part(&self) -> bool {
        self.delivered_ml.is_some() && (!self.completed || self.run.is_some_and(|run| run.is_stopped()))
    }

    fn motion_line(&self) -> String {
        let limited = match self.limited_by {
            LimitedBy::Nothing => String::new(),
            limit => format!(" (limited by {})", limit.name().replace('_', " ")),
        };
        let least_kpa = self.inlet_min_kpa.into_iter().chain(self.outlet_min_kpa).reduce(f64::min);
        let most_kpa = self.inlet_max_kpa.into_iter().chain(self.outlet_max_kpa).reduce(f64::max);
        let pressure = match least_kpa.zip(most_kpa) {
            Some((least_kpa, most_kpa)) => format!("pressure {least_kpa:.2} to {most_kpa:.2} kPa"),
            None => "pressure not known".to_owned(),
        };
        let retracted = match self.retraction_ml {
            Some(back_ml) => format!("; {} µL sucked back", significant(1e3 * back_ml, 4)),
            None => String::new(),
        };
        let moved_s = self.moved_s();
        let time =
            self.by_weight.as_ref().map_or(format!("{moved_s:.3} s"), |weighed| weighed.times(moved_s));
        let at_most = if self.by_weight.is_some() { " at most" } else { "" };
        format!(
            "{time} at {} mL/s{at_most}{limited}; {pressure}{retracted}; {}",
            significant(self.cruise_flow_ml_s, 4),
            self.end(),
        )
    }

    /// The steps that were made of a dose that was stopped, or else the carry.
    fn end(&self) -> String {
        match self.steps_made {
            Some(made) if !self.completed && self.by_weight.is_some() => format!("{made} steps made"),
            Some(made) if !self.completed => format!("{made} of {} steps made", self.steps),
            _ => format!("carry {}", microlitres(self.carry_ml)),
        }
    }
}

/// True for an amount that was typed as a mass.
fn is_mass(typed: &str) -> bool {
    matches!(amount(typed), Ok(Amount::Mass(_)))
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
