//! The identity and settings of a board.

mod configure;
mod record;

pub(in crate::drives) use record::recorded_limits;

use std::collections::BTreeMap;

use pump_ctl::plan::Motor;

use super::board::Board;
use super::error::GrblError;
use super::reply::{Reply, leading_version, version_of};
use super::scale::Scale;
use crate::drives::Opening;
use crate::drives::grbl_speeds::LEAST_STEPS_S;
pub(super) use crate::drives::grbl_speeds::MOST_STEPS_S;
use crate::pump_file::{Axis, DriveTable};

/// Slowest feed of every planner of this family, in units/min (MINIMUM_FEED_RATE in grbl's planner).
const LEAST_FEED_UNITS_MIN: f64 = 1.0;

/// Value of `$1` with which the motor is never released.
pub(super) const NEVER_LET_GO: f64 = 255.0;

/// Number of the setting that turns directions round, by bits of the axes.
const DIRECTIONS: u16 = 3;

/// Firmware of the family.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Flavour {
    /// grbl 1.1 on an Arduino.
    Grbl,
    /// grblHAL.
    GrblHal,
    /// FluidNC, and the ESP32 firmwares before it.
    FluidNc,
}

/// Settings that a board tells.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Settings {
    pub(super) flavour: Flavour,
    pub(super) axis: Axis,
    /// Values of the settings by their numbers.
    pub(super) values: BTreeMap<u16, f64>,
}

/// Board by its own words.
pub(super) struct SelfDescription {
    pub(super) flavour: Flavour,
    /// Text that somebody has given the board, with `$I=` or in its configuration.
    pub(super) text: Option<String>,
}

/// Asks a board for its firmware and its text. Refuses firmware older than 1.1.
pub(super) fn described(board: &mut Board) -> Result<SelfDescription, GrblError> {
    let mut said = board.first_command("$I")?;
    // The piece of a line that another program left may have been a comment, which hides the line.
    if said.is_empty() {
        said = board.command("$I")?;
    }
    let text = |reply: &Reply| match reply {
        Reply::Version(text) | Reply::Message(text) | Reply::Banner(text) => Some(text.to_lowercase()),
        _ => None,
    };
    let texts: Vec<_> = said.iter().filter_map(text).collect();
    let says = |name: &str| texts.iter().any(|text| text.contains(name));
    let version = said.iter().find_map(|reply| match reply {
        // Firmware before 1.1 has no `VER:`.
        Reply::Version(text) | Reply::Message(text) => leading_version(text),
        Reply::Banner(text) => version_of(text),
        _ => None,
    });
    let (major, minor) = version.unwrap_or((0, 0));
    if (major, minor) < (1, 1) {
        return Err(GrblError::Old { major, minor });
    }
    // As in `[VER:1.1h.20190830:text]`.
    let text = said.iter().find_map(|reply| match reply {
        Reply::Version(version) => version.split_once(':').map(|(_, text)| text.trim().to_owned()),
        _ => None,
    });
    let flavour = if says("grblhal") {
        Flavour::GrblHal
    } else if says("fluidnc") || (major, minor) > (1, 1) {
        Flavour::FluidNc
    } else {
        Flavour::Grbl
    };
    Ok(SelfDescription { flavour, text: text.filter(|text| !text.is_empty()) })
}

/// Reads the settings of a board twice, and compares them with each other and with those on record. Writes
/// them first if `opening` allows it. Returns notes of what was written or accepted.
pub(super) fn agreed(
    board: &mut Board,
    flavour: Flavour,
    axis: Axis,
    motor: &Motor,
    opening: &Opening,
) -> Result<(Settings, Vec<String>), GrblError> {
    let mut settings = read(board, flavour, axis)?;
    let (mut notes, mut written) = (Vec::new(), Vec::new());
    if opening.configure {
        let most_rad_s2 = motor.max_acceleration_rad_s2;
        let gentle_rad_s2 = opening.acceleration_rad_s2.map_or(most_rad_s2, |rad_s2| rad_s2.min(most_rad_s2));
        let gentle = motor.with_max_acceleration_rad_s2(gentle_rad_s2);
        (settings, notes, written) = configure::configure(board, settings, &gentle)?;
        if opening.acceleration_rad_s2.is_some() {
            notes.push(format!(
                "the board starts and stops every dose with {gentle_rad_s2:.1} rad/s2, the best plain ramp for \
                 the pump's default rate"
            ));
        }
    }
    let again = read(board, flavour, axis)?;
    settings.agree(&again)?;
    if let Some(path) = &opening.settings_record {
        let accepts = opening.configure || opening.accept_settings;
        let accepted = record::compare(&settings, path, accepts, !opening.records_later)?;
        // A setting that was written just now has its note.
        let others = accepted.into_iter().filter(|(number, _)| !written.contains(number));
        notes.extend(others.map(|(_, note)| note));
    }
    Ok((settings, notes))
}

/// Puts the settings of a board on record in place of any others. [`agreed`] has compared them before.
pub(super) fn put_on_record(settings: &Settings, opening: &Opening) -> Result<(), GrblError> {
    let path = opening.settings_record.as_deref();
    path.map_or(Ok(()), |path| record::compare(settings, path, true, true).map(drop))
}

/// Asks a board for its settings.
fn read(board: &mut Board, flavour: Flavour, axis: Axis) -> Result<Settings, GrblError> {
    let listed = board.command("$$")?.into_iter().filter_map(|reply| match reply {
        Reply::Setting { number, value } => Some((number, value)),
        _ => None,
    });
    let mut settings = Settings { flavour, axis, values: listed.collect() };
    if flavour == Flavour::FluidNc {
        settings.complete(board)?;
    }
    Ok(settings)
}

impl Settings {
    /// Returns the number of this axis's setting in the group that begins with `first`.
    pub(super) fn number(&self, first: u16) -> u16 {
        first + self.axis.number() as u16
    }

    /// Returns the numbers of the settings on which the way of the motor depends.
    fn numbers(&self) -> Vec<u16> {
        let shared = [1, DIRECTIONS, 13];
        let of_axis = [100, 110, 120].map(|first| self.number(first));
        // grblHAL sets the microsteps of some motor drivers.
        let microsteps = (self.flavour == Flavour::GrblHal).then_some(self.number(150));
        shared.into_iter().chain(of_axis).chain(microsteps).collect()
    }

    /// Returns true if a setting has equal values for this axis.
    fn same(&self, number: u16, one: Option<f64>, two: Option<f64>) -> bool {
        match (one, two) {
            (Some(one), Some(two)) if number == DIRECTIONS => {
                let of_axis = |mask: f64| (mask as u64) >> self.axis.number() & 1;
                of_axis(one) == of_axis(two)
            }
            (Some(one), Some(two)) => same(one, two),
            (one, two) => one == two,
        }
    }

    /// Refuses settings that were read with two values.
    fn agree(&self, again: &Self) -> Result<(), GrblError> {
        for number in self.numbers().into_iter().chain([10, 20]) {
            let [one, two] = [self, again].map(|read| read.values.get(&number).copied());
            if !self.same(number, one, two) {
                let [one, two] = [one, two].map(|value| value.unwrap_or(f64::NAN));
                return Err(GrblError::Unsteady { number, one, two });
            }
        }
        Ok(())
    }

    /// Completes the settings of FluidNC, which lists no axes, or only three, and not all settings. Its
    /// configuration has them by name.
    fn complete(&mut self, board: &mut Board) -> Result<(), GrblError> {
        let letter = self.axis.letter().to_ascii_lowercase();
        let items = [
            (1, "stepping/idle_ms".to_owned()),
            (self.number(100), format!("axes/{letter}/steps_per_mm")),
            (self.number(110), format!("axes/{letter}/max_rate_mm_per_min")),
            (self.number(120), format!("axes/{letter}/acceleration_mm_per_sec2")),
        ];
        for (number, path) in items {
            if self.values.contains_key(&number) {
                continue;
            }
            let said = match board.command(&format!("$/{path}")) {
                Ok(said) => said,
                Err(GrblError::Refused { .. }) => continue,
                Err(error) => return Err(error),
            };
            let value = said.iter().find_map(|reply| match reply {
                Reply::Item { path: told, text } if *told == path => text.parse().ok(),
                _ => None,
            });
            if let Some(value) = value {
                self.values.insert(number, value);
            }
        }
        Ok(())
    }

    /// Returns the value of this axis's setting in the group that begins with `first`, which must be listed.
    fn needed(&self, first: u16, what: &str) -> Result<f64, GrblError> {
        let number = self.number(first);
        let value = self.values.get(&number).copied().filter(|value| *value > 0.0);
        value.ok_or_else(|| GrblError::NoSetting {
            number,
            what: format!("{what} of axis {}", self.axis.letter()),
        })
    }

    /// Returns the value of a switch or a mask, or grbl's default if it is not listed.
    fn mask(&self, number: u16, usual: f64) -> u32 {
        self.values.get(&number).copied().unwrap_or(usual) as u32
    }

    /// Returns the steps per unit.
    pub(super) fn steps_per_unit(&self) -> Result<f64, GrblError> {
        self.needed(100, "steps per unit")
    }

    /// Returns the scale of the axis. Refuses reports that do not tell single steps apart.
    pub(super) fn scale(&self, table: &DriveTable) -> Result<Scale, GrblError> {
        let scale = Scale {
            axis: self.axis,
            steps_per_unit: self.steps_per_unit()?,
            inverted: table.invert,
            inches: self.mask(13, 0.0) & 1 != 0,
            summed: self.mask(10, 1.0) & 1 == 0,
        };
        if scale.tells_steps() {
            return Ok(scale);
        }
        Err(GrblError::Coarse {
            step: scale.report_error(),
            steps_per_unit: scale.steps_per_unit,
            number: self.number(100),
            most: Scale::most_steps_per_unit(),
        })
    }

    /// Returns the largest rate, in units/min.
    pub(super) fn rate_units_min(&self) -> Result<f64, GrblError> {
        self.needed(110, "largest rate")
    }

    /// Returns the most steps per second that the board makes.
    pub(super) fn most_steps_s(&self, scale: &Scale) -> Result<f64, GrblError> {
        let set = self.rate_units_min()? / 60.0 * scale.steps_per_unit;
        Ok(if self.flavour == Flavour::Grbl { set.min(MOST_STEPS_S) } else { set })
    }

    /// Returns the acceleration, in units/s².
    pub(super) fn acceleration_units_s2(&self) -> Result<f64, GrblError> {
        self.needed(120, "acceleration")
    }

    /// Returns the fewest steps per second that the board makes.
    pub(super) fn least_steps_s(&self, scale: &Scale) -> f64 {
        let feed = LEAST_FEED_UNITS_MIN / 60.0 * scale.steps_per_unit;
        if self.flavour == Flavour::Grbl { feed.max(LEAST_STEPS_S) } else { feed }
    }

    /// Returns true if the motor holds at rest. `None` if the board does not list `$1`.
    pub(super) fn holds(&self) -> Option<bool> {
        self.values.get(&1).map(|delay_ms| *delay_ms == NEVER_LET_GO)
    }

    /// Returns true if the board refuses to go beyond a travel.
    pub(super) fn soft_limits(&self) -> bool {
        self.mask(20, 0.0) & 1 != 0
    }
}

/// Returns true if two values of a setting are equal. Settings are kept in single precision and told with
/// three decimals.
fn same(reads: f64, value: f64) -> bool {
    (reads - value).abs() <= 0.000_6 + 1e-6 * value.abs()
}
