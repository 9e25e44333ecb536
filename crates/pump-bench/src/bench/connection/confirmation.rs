//! The confirmation of a pump: a real motor does not move by values that the program filled in.

use crate::bench::bench::{Bench, print_of};
use crate::bench::session::Session;
use crate::catalogue::built_in;
use crate::dosing::DoseError;
#[cfg(feature = "klipper")]
use crate::drives::KlipperError;
use crate::notice::{Notice, Remedy};
use crate::numbers::significant;
#[cfg(feature = "klipper")]
use crate::pump_file::DriverName;
use crate::pump_file::PumpFile;
use crate::record::{MotorWay, PumpState, Why, motor_way};

/// Tables of a pump file that say what the head delivers and how the motor turns it.
const TABLES: [&str; 7] = ["head", "tube", "rollers", "backplate", "roller_volume", "motor", "drive"];

/// Keys that count of tables with others beside them: how far and which way a step turns the head, and what a turn
/// delivers. A tube's life or stiffness says neither, and a bought head's bore says only how sure its volume is.
const KEYS: [(&str, &[&str]); 4] = [
    ("motor", &["steps_per_rev", "gear"]),
    ("drive", &["axis", "invert"]),
    ("tube", &["bore_radius_mm", "outer_radius_mm"]),
    ("head", &["ml_per_rev"]),
];

impl Bench {
    /// Returns true if the motor is real and values of the pump are filled in by the program.
    fn needs_confirmation(&self) -> bool {
        !self.is_simulated() && self.file().motor.has_assumed_direction()
    }

    /// Returns the print of the pump: a number that changes with every value that says how far and which way the
    /// motor turns the head, and what the head delivers.
    fn print(&self) -> u32 {
        let file = PumpFile { drive: Some(self.drive().clone()), ..self.file().clone() };
        print_of(&file, &TABLES, &KEYS)
    }

    /// Returns the way in which the pump file turns the motor.
    pub(in crate::bench) fn motor_way(&self) -> MotorWay {
        motor_way(&self.file().motor, self.drive())
    }

    /// Returns the values that the program filled in, in words.
    fn filled_in(&self) -> String {
        let (file, motor) = (self.file(), &self.file().motor);
        let mut values = Vec::new();
        if motor.has_assumed_steps() {
            values.push(format!(
                "{} steps per revolution of the motor, gear {}",
                motor.steps_per_rev, motor.gear
            ));
        }
        if file.drive.is_none() || motor.direction_confirmed == Some(false) {
            let way = if self.drive().invert { "in reverse" } else { "forward" };
            values.push(match &self.drive().klipper {
                Some(pins) => format!("the direction ({way} with the pin {} active)", pins.dir),
                None => format!("the direction ({way} as axis {:?} counts up)", self.drive().axis),
            });
        }
        let is_head = |known: &PumpFile| {
            (&known.tube, &known.rollers, &known.backplate) == (&file.tube, &file.rollers, &file.backplate)
                && known.roller_volume == file.roller_volume
        };
        if built_in(&file.pump.id).is_some_and(|known| is_head(&known)) {
            let (rollers, ml) = (file.rollers.count, significant(self.model().revolution_ml(), 4));
            values.push(format!("a head of {rollers} rollers and {ml} mL per revolution"));
        }
        values.join(", ")
    }

    /// Refuses a real motor that its pump file turns in another way than when it moved last, and one while values of
    /// its pump are filled in, as long as nobody has confirmed them and the user does not do so now. `state` is that on
    /// record.
    ///
    /// # Errors
    ///
    /// [`DoseError::TurnedOtherwise`] or [`DoseError::Unconfirmed`] with the values, and [`DoseError::Connection`] if
    /// no pins of a Klipper board are named.
    pub(in crate::bench) fn check_confirmed(&self, state: Option<&PumpState>) -> Result<(), DoseError> {
        // Whoever confirms a pump without pins would only be asked for them next.
        #[cfg(feature = "klipper")]
        if self.drive().driver == DriverName::Klipper && self.drive().klipper.is_none() {
            return Err(DoseError::Connection(KlipperError::NoPins.into()));
        }
        if let Some(then) = state.and_then(|state| state.turned_by).filter(|_| !self.may_turn_otherwise())
            && let now = self.motor_way()
            && now != then
        {
            let [now, then] = [now, then].map(|way| way.as_str().to_owned());
            return Err(DoseError::TurnedOtherwise { pump: self.file().pump.id.clone(), now, then });
        }
        let recorded = state.and_then(|state| state.confirmed_pump);
        if !self.needs_confirmation() || self.confirms_pump() || recorded == Some(self.print()) {
            return Ok(());
        }
        let pump = self.file().pump.id.clone();
        Err(DoseError::Unconfirmed { pump, values: self.filled_in(), changed: recorded.is_some() })
    }

    /// Returns the warning of a dry run whose dose would be refused on the real motor. `state` is the state on record.
    pub(in crate::bench) fn confirmation_missing(&self, state: Option<&PumpState>) -> Option<Notice> {
        let error = self.check_confirmed(state).err()?;
        let remedy = match error {
            DoseError::TurnedOtherwise { .. } => Remedy::ConfirmTurning,
            _ => Remedy::WriteOrConfirmPump,
        };
        Some(Notice::from(error.to_string()).with_remedy(remedy))
    }
}

impl Session<'_> {
    /// Refuses to move a real motor by values that nobody has confirmed.
    ///
    /// # Errors
    ///
    /// [`DoseError::Unconfirmed`] with the values.
    pub(in crate::bench) fn check_confirmed(&self) -> Result<(), DoseError> {
        self.bench.check_confirmed(self.state.as_ref())
    }

    /// Returns `state` with the user's confirmation of the pump, if the user gives one now.
    pub(in crate::bench) fn confirmed(&self, state: PumpState) -> PumpState {
        if !(self.bench.needs_confirmation() && self.bench.confirms_pump()) {
            return state;
        }
        PumpState { confirmed_pump: Some(self.bench.print()), ..state }
    }

    /// Records the user's confirmation of the pump, unless it is on record.
    ///
    /// # Errors
    ///
    /// [`DoseError::Journal`] if it cannot be recorded.
    pub(in crate::bench) fn record_confirmation(&mut self) -> Result<(), DoseError> {
        let stands = self.stands();
        let confirmed = self.confirmed(stands);
        if confirmed.confirmed_pump == stands.confirmed_pump {
            return Ok(());
        }
        Ok(self.rest(Why::Confirmed, confirmed)?)
    }
}
