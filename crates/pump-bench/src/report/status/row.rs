//! The records of all named pumps, a row each.

use serde::Serialize;

use super::Status;
use crate::notice::Wording;
use crate::numbers::{microlitres, significant};

/// The record of a pump of the configuration (`schema` `status-row/1`).
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct StatusRow {
    /// `status-row/1`.
    pub schema: &'static str,
    /// Name of the pump in the configuration.
    pub name: String,
    /// Record of the pump; null if it cannot be read.
    pub status: Option<Status>,
    /// Reason why the record cannot be read; null if it can.
    pub error: Option<String>,
}

impl StatusRow {
    /// Names the record of a pump, or the reason why it cannot be read.
    pub fn new(name: &str, status: Result<Status, String>) -> Self {
        let (status, error) = match status {
            Ok(status) => (Some(status), None),
            Err(error) => (None, Some(error)),
        };
        Self { schema: "status-row/1", name: name.to_owned(), status, error }
    }

    /// One line of JSON.
    pub fn json(&self) -> String {
        serde_json::to_string(self).unwrap_or_else(|error| unreachable!("a status is plain data: {error}"))
    }

    /// The row in words, without its end. Names are padded to `width` letters.
    pub fn text(&self, width: usize) -> String {
        let name = &self.name;
        let Some(status) = &self.status else {
            return self.unread(width);
        };
        let angle =
            status.angle_deg.map_or("unknown angle".to_owned(), |angle_deg| match status.half_width_deg {
                half_deg if half_deg >= 0.005 => format!("at {angle_deg:.2}° ± {half_deg:.2}°"),
                _ => format!("at {angle_deg:.2}°"),
            });
        let life =
            status.tube_life_ml.map_or(String::new(), |life_ml| format!(" of {}", significant(life_ml, 6)));
        let calibration = match &status.calibration {
            Some(used) => format!("calibration {}", used.version),
            None => "no calibration".to_owned(),
        };
        let stands = status.safety.stand.map(|stand| format!("STANDS {}", stand.place()));
        let state = match (&status.in_use_by, &status.unfinished, &status.unfinished_calibration) {
            (Some(holder), Some(dose), _) => Some(format!("in motion, by {holder}: {}", dose.made(true))),
            (Some(holder), None, _) => Some(format!("in use by {holder}")),
            (None, Some(dose), _) => {
                let is_exact = dose.steps_are_exact && dose.delivered_least_ml < dose.delivered_most_ml;
                let exact = match (is_exact, dose.board_may_tell && !dose.steps_are_exact) {
                    (true, _) => " (the steps are exact)",
                    (false, true) => " (by the record alone: the board may know the exact steps)",
                    (false, false) => "",
                };
                Some(format!("unfinished: {}{exact}", dose.made(false)))
            }
            (None, None, Some(_)) => Some("unfinished calibration".to_owned()),
            (None, None, None) if !status.recorded => Some("nothing on record".to_owned()),
            // A pump that stands is not ready.
            (None, None, None) => stands.is_none().then(|| "ready".to_owned()),
        };
        let state = stands.into_iter().chain(state).collect::<Vec<_>>().join(", ");
        let weighed = status.last_by_weight.map_or(String::new(), |last| format!("; {}", last.volume()));
        format!(
            "{name:<width$}  {state}; {angle} ({}), carry {}, tube {:.1}{life} mL, {calibration}{weighed}",
            status.driver,
            microlitres(status.carry_ml),
            status.wear.volume_ml,
        )
    }

    /// The row of the safety limits in words, without its end. Names are padded to `width` letters.
    pub fn safety_text(&self, width: usize, words: Wording) -> String {
        let Some(status) = &self.status else { return self.unread(width) };
        let lines = status.safety.text(words);
        let lines: Vec<&str> = lines.lines().map(|line| line.trim_start_matches("safety: ")).collect();
        format!("{:<width$}  {} ({})", self.name, lines.join("; "), status.driver)
    }

    /// The row of a pump that cannot be read. An error of a file shows its lines, and a row has one.
    fn unread(&self, width: usize) -> String {
        let is_excerpt = |line: &&str| line.contains(" | ") || line.ends_with(" |");
        let error = self.error.as_deref().unwrap_or_default();
        let said: Vec<&str> = error.lines().filter(|line| !is_excerpt(line)).collect();
        format!("{:<width$}  cannot be read: {}", self.name, said.join(": "))
    }
}
