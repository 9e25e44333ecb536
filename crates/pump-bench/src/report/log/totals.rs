//! The totals of a log, by day and by tube.

use std::collections::BTreeMap;

use crate::numbers::significant;
use crate::record::{LogEntry, Purpose};

/// Sum over some doses.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub struct LogTotal {
    /// Number of doses; the rest of a dose counts, a retraction and a turn to the index do not.
    pub doses: u64,
    /// Volume delivered less that sucked back or run in reverse, in mL. Turns to the index are not in it.
    pub delivered_ml: f64,
    /// Volume that was pumped in either direction, with primes, purges and retractions, in mL. Turns to the index are
    /// not in it.
    pub pumped_ml: f64,
    /// Volume of turns to the index in either direction, in mL, while a dose was unfinished. The log has no others.
    pub searched_ml: f64,
    /// Number of doses whose time is before that of the dose before them: the clock had gone back.
    pub clock_went_back: u64,
    /// Largest error of the volume by doses that were cut off, in mL: nobody knows how many steps they made. The
    /// uncertainty of each dose, and of the rollers' angle, is not in it.
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
    fn add(&mut self, entry: &LogEntry, went_back: bool) {
        self.clock_went_back += u64::from(went_back);
        if entry.purpose == Purpose::Jog {
            // No dose has it, and another turn to the index has no entry.
            self.searched_ml += entry.delivered_ml.abs();
            return;
        }
        self.pumped_ml += entry.delivered_ml.abs();
        self.doses += u64::from(entry.purpose != Purpose::Retract);
        self.delivered_ml += entry.delivered_ml;
        let delivered_ml = entry.delivered_ml;
        self.unknown_ml += entry
            .delivered_range_ml
            .map_or(0.0, |(least_ml, most_ml)| (most_ml - delivered_ml).max(delivered_ml - least_ml));
    }

    fn text(&self) -> String {
        let unknown = match self.unknown_ml {
            0.0 => String::new(),
            ml => format!(", of which ± {} mL by doses that were cut off", significant(ml, 2)),
        };
        let [net, pumped] = [self.delivered_ml, self.pumped_ml].map(|ml| significant(ml, 4));
        let volume = if net == pumped {
            format!("{net} mL")
        } else {
            format!("{net} mL net, {pumped} mL in either direction,")
        };
        let doses = if self.doses == 1 { "dose" } else { "doses" };
        let clock = match self.clock_went_back {
            0 => String::new(),
            count => format!("; the clock had gone back {count} times"),
        };
        let searched = match self.searched_ml {
            0.0 => String::new(),
            ml => format!("; turns to the index pumped another {} mL", significant(ml, 4)),
        };
        format!("{volume} in {} {doses}{unknown}{searched}{}", self.doses, clock.replace(" 1 times", " once"))
    }
}

impl LogTotals {
    /// Adds a dose. `went_back` is true if its time is before that of the dose before it.
    pub fn add(&mut self, entry: &LogEntry, went_back: bool) {
        self.by_day.entry(entry.time.date()).or_default().add(entry, went_back);
        self.by_tube.entry(entry.tube).or_default().add(entry, went_back);
    }

    /// Words the totals for people, a line a day and a line a tube.
    pub fn text(&self) -> String {
        let days = self.by_day.iter().map(|(day, total)| format!("{day}: {}\n", total.text()));
        let tubes = self.by_tube.iter().map(|(tube, total)| format!("tube {tube}: {}\n", total.text()));
        days.chain(tubes).collect()
    }

    /// Writes the totals as a table: `day,tube,doses,delivered_ml,unknown_ml,pumped_ml,clock_went_back,searched_ml`.
    /// Each row has a day or a tube.
    pub fn csv(&self) -> String {
        let row = |day: &str, tube: &str, total: &LogTotal| {
            let LogTotal { doses, delivered_ml, unknown_ml, pumped_ml, clock_went_back, searched_ml } = total;
            let volumes = format!("{delivered_ml},{unknown_ml},{pumped_ml}");
            format!("{day},{tube},{doses},{volumes},{clock_went_back},{searched_ml}\n")
        };
        let days = self.by_day.iter().map(|(day, total)| row(day, "", total));
        let tubes = self.by_tube.iter().map(|(tube, total)| row("", &tube.to_string(), total));
        let header = "day,tube,doses,delivered_ml,unknown_ml,pumped_ml,clock_went_back,searched_ml\n";
        [header.to_owned()].into_iter().chain(days).chain(tubes).collect()
    }

    /// Writes the totals of `pump` by `driver` as JSON (`schema` `log-total/1`), a line a day and a line a tube.
    pub fn json(&self, pump: &str, driver: &str) -> String {
        let row = |key: &str, value: serde_json::Value, total: &LogTotal| {
            let LogTotal { doses, delivered_ml, unknown_ml, pumped_ml, clock_went_back, searched_ml } = total;
            let mut row = serde_json::json!({
                "schema": "log-total/1", "pump": pump, "driver": driver, "day": null, "tube": null,
                "doses": doses, "delivered_ml": delivered_ml, "unknown_ml": unknown_ml, "pumped_ml": pumped_ml,
                "clock_went_back": clock_went_back, "searched_ml": searched_ml,
            });
            row[key] = value;
            format!("{row}\n")
        };
        let days = self.by_day.iter().map(|(day, total)| row("day", day.as_str().into(), total));
        days.chain(self.by_tube.iter().map(|(tube, total)| row("tube", (*tube).into(), total))).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bounds_of_a_total_hold_those_of_doses_that_were_cut_off() {
        let mut cut = LogEntry::example(1, 0);
        (cut.delivered_ml, cut.delivered_range_ml) = (2.5, Some((0.5, 3.0)));
        let mut totals = LogTotals::default();
        totals.add(&cut, false);
        totals.add(&LogEntry::example(2, 0), false);
        let total = totals.by_tube[&1];
        assert_eq!((total.delivered_ml, total.unknown_ml), (3.5, 2.0));
        assert_eq!(total.text(), "3.5 mL in 2 doses, of which ± 2 mL by doses that were cut off");
    }

    #[test]
    fn a_turn_to_the_index_is_told_beside_the_doses_and_is_in_no_volume_of_theirs() {
        let turn = LogEntry { purpose: Purpose::Jog, delivered_ml: -1.21, ..LogEntry::example(2, 0) };
        let mut totals = LogTotals::default();
        totals.add(&LogEntry::example(1, 0), false);
        totals.add(&turn, false);
        let total = totals.by_tube[&1];
        assert_eq!(
            (total.doses, total.delivered_ml, total.pumped_ml, total.searched_ml),
            (1, 1.0, 1.0, 1.21)
        );
        assert_eq!(total.text(), "1 mL in 1 dose; turns to the index pumped another 1.21 mL");
    }

    #[test]
    fn a_total_tells_what_was_pumped_beside_what_is_left_of_it() {
        let one = LogTotal { doses: 1, delivered_ml: 9.537_426, pumped_ml: 9.537_426, ..LogTotal::default() };
        assert_eq!(one.text(), "9.537 mL in 1 dose");
        let both = LogTotal { doses: 5, delivered_ml: -5.751_642, pumped_ml: 25.0, ..one };
        assert_eq!(both.text(), "-5.752 mL net, 25 mL in either direction, in 5 doses");
        let jumped = LogTotal { clock_went_back: 1, ..one };
        assert_eq!(jumped.text(), "9.537 mL in 1 dose; the clock had gone back once");
    }
}
