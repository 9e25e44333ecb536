//! Notes for the user on the settings of a board.

use super::scale::Scale;
use super::settings::Settings;
use crate::notice::{Notice, Remedy};

/// Returns notes for the user on these settings.
pub(super) fn remarks(settings: &Settings, scale: &Scale) -> Vec<Notice> {
    let mut notes = Vec::new();
    match settings.holds() {
        Some(true) => {}
        Some(false) => {
            let text = format!(
                "the board cuts the motor's current after each motion ($1={}), so the angle is less sure each \
                 time; $1=255 holds it",
                settings.values.get(&1).copied().unwrap_or(0.0)
            );
            notes.push(Notice::from(text).with_remedy(Remedy::Configure));
        }
        None => notes.push(
            "the board does not tell whether it cuts the motor's current after each motion ($1): the angle \
             is taken to be less sure each time"
                .into(),
        ),
    }
    let thousandths = (scale.steps_per_unit * 1e3).round() as i64;
    if thousandths % 10 != 0 {
        let number = settings.number(100);
        let drift = 2e3 * scale.steps_per_unit;
        notes.push(
            format!(
                "${number}={} is told with three decimals and may have more: then counts drift by a step in \
             {drift:.0}; set a whole number, any will do",
                scale.steps_per_unit
            )
            .into(),
        );
    }
    notes
}
