//! The report of a rack in words: a row a pump, and the total.

use super::pump_row::{RackPumpReport, sum};
use super::rack_report::{RackEnd, RackReport};
use crate::numbers::{microlitres, significant, told_apart};

impl RackReport {
    /// Returns the report in words: a line of the rack, a row a pump, and the total. Warnings are not in it.
    pub fn text(&self) -> String {
        let width = self.pumps.iter().map(|row| row.name.chars().count()).max().unwrap_or(0).max(5);
        let rows: String = self.pumps.iter().map(|row| row.line(width, self.end)).collect();
        let total = &self.total;
        let told_ml = sum(self.pumps.iter().map(RackPumpReport::told_ml));
        let volume = volume(told_ml, total.expanded_uncertainty_ml);
        let requested = significant(total.requested_ml, 6);
        let ended = match (self.end, &self.fault) {
            (RackEnd::Planned, _) => "planned (dry run, nothing recorded)".to_owned(),
            (RackEnd::Completed, _) => "completed".to_owned(),
            (RackEnd::Stopped, _) => "stopped".to_owned(),
            (RackEnd::Fault, Some(fault)) => self.faults_of(&fault.pump),
            (RackEnd::Fault, None) => "stopped by a fault".to_owned(),
        };
        let (pumps, steps) = (counted(self.pumps.len(), "pump"), counted(self.steps, "step"));
        let planned_s = self.planned_s;
        let time = match (self.end, self.ended_s) {
            (RackEnd::Stopped | RackEnd::Fault, Some(ended_s)) => format!("{ended_s:.3} of {planned_s:.3}"),
            (_, ended_s) => format!("{:.3}", ended_s.unwrap_or(planned_s)),
        };
        let began = self.time.map_or(String::new(), |time| format!(", began {time}"));
        format!(
            "{}: {pumps}, {steps} in {time} s, {ended}{began}\n{rows}{:<width$}  {volume}, \
             {requested} mL requested\n{}",
            self.rack,
            "total",
            self.further_errors()
        )
    }

    /// Returns the names of the pumps that failed. A stop of a whole board is a fault of each of its pumps.
    fn faults_of(&self, first: &str) -> String {
        let further = self.further_faults().map(|row| row.name.as_str());
        let names: Vec<&str> = std::iter::once(first).chain(further).collect();
        let a = if names.len() == 1 { "a fault" } else { "faults" };
        format!("stopped by {a} of {}", names.join(", "))
    }

    /// Returns the pumps that failed, but for the one whose fault is told as the rack's.
    fn further_faults(&self) -> impl Iterator<Item = &RackPumpReport> {
        let first = self.fault.as_ref().map(|fault| fault.pump.as_str());
        self.pumps.iter().filter(move |row| row.error.is_some() && Some(row.name.as_str()) != first)
    }

    /// Returns the causes for which further pumps failed, a line each. A stop of a whole board is one cause.
    fn further_errors(&self) -> String {
        let mut lines: Vec<(Option<&str>, Vec<&RackPumpReport>)> = Vec::new();
        for row in self.further_faults() {
            let cause = row.cause.as_deref();
            match lines.iter_mut().find(|(known, _)| *known == cause) {
                Some((_, rows)) => rows.push(row),
                None => lines.push((cause, vec![row])),
            }
        }
        let first = self.fault.as_ref().map(|fault| fault.pump.as_str());
        let first = first.and_then(|first| self.pumps.iter().find(|row| row.name == first));
        let line = |(cause, rows): &(Option<&str>, Vec<&RackPumpReport>)| {
            let names = rows.iter().map(|row| row.name.as_str()).collect::<Vec<_>>().join(", ");
            match (first.filter(|first| first.cause.as_deref() == *cause), rows.as_slice()) {
                (Some(first), _) => format!("{names} failed too, for the reason of {}\n", first.name),
                (None, [row]) => {
                    format!("{names} failed too: {}\n", row.error.as_deref().unwrap_or_default())
                }
                _ => format!("{names} failed too: {}\n", cause.unwrap_or_default()),
            }
        };
        lines.iter().map(line).collect()
    }

    /// Returns the warnings, a line each, with the name of their pump.
    pub fn warning_lines(&self) -> String {
        let of = |row: &RackPumpReport| {
            let line = |warning| format!("warning: {}: {warning}\n", row.name);
            row.warnings.iter().map(line).collect::<String>()
        };
        self.pumps.iter().map(of).collect()
    }
}

impl RackPumpReport {
    fn line(&self, width: usize, end: RackEnd) -> String {
        let name = &self.name;
        let unsure_ml = self.expanded_uncertainty_ml;
        let volume = volume(self.told_ml(), unsure_ml);
        let (least_ml, most_ml) = (self.delivered_least_ml, self.delivered_most_ml);
        let range = if self.error.is_some() && most_ml - least_ml > 1e-9 {
            let (least, most) = told_apart(least_ml, most_ml, decimals(unsure_ml));
            format!(", between {least} mL and {most} mL by the steps and the angle")
        } else {
            String::new()
        };
        let requested = significant(self.requested_ml, 6);
        let done = match end {
            RackEnd::Planned => counted(self.steps, "step"),
            _ => format!("{} of {} done", self.steps_completed, counted(self.steps, "step")),
        };
        let carry = self.carry_ml.map_or(String::new(), |carry| format!(", carry {}", microlitres(carry)));
        let state = match (&self.error, self.unfinished) {
            (Some(_), true) if self.over_time => ", FAILED, the unfinished flow over time has no rest",
            (Some(_), true) => ", FAILED, the rest of the unfinished step is on record",
            (Some(_), false) => ", FAILED",
            (None, true) => ", the rest of the unfinished step is on record",
            (None, false) => "",
        };
        let undone = match self.steps_not_begun {
            0 => String::new(),
            steps => format!(", {} not begun", counted(steps, "step")),
        };
        format!("{name:<width$}  {volume}{range}, {requested} mL requested, {done}{carry}{state}{undone}\n")
    }
}

/// Words a volume and its uncertainty with the digits of the uncertainty.
fn volume(volume_ml: f64, expanded_ml: f64) -> String {
    format!("{} ± {}", digits(volume_ml, expanded_ml), digits(expanded_ml, expanded_ml))
}

/// Words a volume with the digits of an uncertainty.
fn digits(volume_ml: f64, expanded_ml: f64) -> String {
    let decimals = decimals(expanded_ml);
    format!("{volume_ml:.decimals$} mL")
}

/// Returns the decimals of a volume that is as unsure as `expanded_ml`.
fn decimals(expanded_ml: f64) -> usize {
    match expanded_ml {
        expanded_ml if expanded_ml > 0.0 => (1.0 - expanded_ml.log10().floor()).clamp(0.0, 4.0) as usize,
        _ => 2,
    }
}

fn counted(number: usize, noun: &str) -> String {
    format!("{number} {noun}{}", if number == 1 { "" } else { "s" })
}
