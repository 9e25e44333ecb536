//! The totals of a log, by day and by tube.

use std::collections::BTreeMap;

use crate::numbers::significant;
use crate::record::{LogEntry, Purpose};

/// Sum over some doses.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub struct LogTotal {
    /// Number of doses; the rest of a dose counts, a retraction does not.
    pub doses: u64,
    /// Volume delivered less that sucked back or run in reverse, in mL.
    pub delivered_ml: f64,
    /// Largest error of the volume where nobody knows how many steps were made, in mL.
    pub unknown_ml: f64,
}

/// Totals of a log, by the day of the local clock and by the tube. They grow by the days and not by the doses.
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
pub struct LogTotals {
    /// Totals of each day, as `2026-11-23`.
    pub by_day: BTreeMap<String, LogTotal>,
    /// Totals of each tube, by its number.
    pub by_tube: BTreeMap<u32, LogTotal>,
}

impl LogTotal {
    fn add(&mut self, entry: &LogEntry) {
        self.doses += u64::from(entry.purpose != Purpose::Retract);
        self.delivered_ml += entry.delivered_ml;
        self.unknown_ml +=
            entry.delivered_range_ml.map_or(0.0, |(least_ml, most_ml)| 0.5 * (most_ml - least_ml));
    }

    fn text(&self) -> String {
        let unknown = match self.unknown_ml {
            0.0 => String::new(),
            ml => format!(", known to ± {} mL", significant(ml, 2)),
        };
        format!("{} mL in {} doses{unknown}", significant(self.delivered_ml, 9), self.doses)
    }
}

impl LogTotals {
    /// Adds a dose.
    pub fn add(&mut self, entry: &LogEntry) {
        self.by_day.entry(entry.time.date()).or_default().add(entry);
        self.by_tube.entry(entry.tube).or_default().add(entry);
    }

    /// Words the totals for people, a line a day and a line a tube.
    pub fn text(&self) -> String {
        let days = self.by_day.iter().map(|(day, total)| format!("{day}: {}\n", total.text()));
        let tubes = self.by_tube.iter().map(|(tube, total)| format!("tube {tube}: {}\n", total.text()));
        days.chain(tubes).collect()
    }

    /// Writes the totals as a table: `day,tube,doses,delivered_ml,unknown_ml`. Each row has a day or a tube.
    pub fn csv(&self) -> String {
        let row = |day: &str, tube: &str, total: &LogTotal| {
            let LogTotal { doses, delivered_ml, unknown_ml } = total;
            format!("{day},{tube},{doses},{delivered_ml},{unknown_ml}\n")
        };
        let days = self.by_day.iter().map(|(day, total)| row(day, "", total));
        let tubes = self.by_tube.iter().map(|(tube, total)| row("", &tube.to_string(), total));
        ["day,tube,doses,delivered_ml,unknown_ml\n".to_owned()].into_iter().chain(days).chain(tubes).collect()
    }

    /// Writes the totals of `pump` by `driver` as JSON (`schema` `log-total/1`), a line a day and a line a tube.
    pub fn json(&self, pump: &str, driver: &str) -> String {
        let row = |key: &str, value: serde_json::Value, total: &LogTotal| {
            let LogTotal { doses, delivered_ml, unknown_ml } = total;
            let mut row = serde_json::json!({
                "schema": "log-total/1", "pump": pump, "driver": driver, "day": null, "tube": null,
                "doses": doses, "delivered_ml": delivered_ml, "unknown_ml": unknown_ml,
            });
            row[key] = value;
            format!("{row}\n")
        };
        let days = self.by_day.iter().map(|(day, total)| row("day", day.as_str().into(), total));
        days.chain(self.by_tube.iter().map(|(tube, total)| row("tube", (*tube).into(), total))).collect()
    }
}
