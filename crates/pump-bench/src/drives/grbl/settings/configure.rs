//! The settings that a pump needs, written on request.

use pump_ctl::plan::Motor;

use super::super::board::Board;
use super::super::error::GrblError;
use super::{Flavour, MOST_STEPS_S, NEVER_LET_GO, Settings, read, same};

/// Writes the settings that differ, line by line. Returns the settings, notes of what changed, and the numbers of the
/// settings that were written.
pub(super) fn configure(
    board: &mut Board,
    found: Settings,
    motor: &Motor,
) -> Result<(Settings, Vec<String>, Vec<u16>), GrblError> {
    let mut notes = Vec::new();
    let wanted = wanted(&found, motor, &mut notes)?;
    let mut written = Vec::new();
    for (number, value) in wanted {
        let Some(reads) = found.values.get(&number).copied() else {
            notes.push(format!("the board does not list ${number}, so it was not set to {value}"));
            continue;
        };
        if same(reads, value) {
            continue;
        }
        board.command(&format!("${number}={value}"))?;
        notes.push(format!("${number} was {reads} and is {value} now"));
        written.push((number, value));
    }
    let now = read(board, found.flavour, found.axis)?;
    for (number, value) in written.iter().copied() {
        let reads = now.values.get(&number).copied().unwrap_or(f64::NAN);
        if !same(reads, value) {
            return Err(GrblError::NotTaken { number, value, reads });
        }
    }
    Ok((now, notes, written.into_iter().map(|(number, _)| number).collect()))
}

/// Returns the settings that a pump needs, by their numbers.
fn wanted(found: &Settings, motor: &Motor, notes: &mut Vec<String>) -> Result<Vec<(u16, f64)>, GrblError> {
    let steps_per_unit = found.steps_per_unit()?;
    let mut steps_s = motor.max_speed_rad_s / motor.step_rad();
    if found.flavour == Flavour::Grbl && steps_s > MOST_STEPS_S {
        notes.push(format!(
            "the pump file allows {steps_s:.0} steps/s, grbl makes {MOST_STEPS_S:.0} at most; use fewer \
             microsteps to go faster"
        ));
        steps_s = MOST_STEPS_S;
    }
    let report = found.values.get(&10).copied().unwrap_or(1.0) as u32;
    let down = |value: f64| (value * 1e3).floor() / 1e3;
    Ok(vec![
        (1, NEVER_LET_GO),
        (10, f64::from(report | 1)),
        (13, 0.0),
        (20, 0.0),
        (found.number(110), down(steps_s * 60.0 / steps_per_unit)),
        (found.number(120), down(motor.max_acceleration_rad_s2 / motor.step_rad() / steps_per_unit)),
    ])
}
