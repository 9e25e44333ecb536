//! Answers that contradict one another.

use pump_model::Fluid;
use pump_model::units::{rad_s, rpm};

use super::answers::Answers;
use super::error::SetupError;
use crate::config::Config;
use crate::pump_file::{AmbientTable, DriverName};

/// Fewest steps per second of grbl 1.1: its 16-bit timer counts 2 MHz (16 MHz / 8).
const LEAST_STEPS_S: f64 = 16e6 / 8.0 / 65_536.0;

/// Most steps per second of grbl 1.1 (its documentation: 30 kHz).
const MOST_STEPS_S: f64 = 30_000.0;

/// Standard acceleration of free fall, in m/s² (3rd CGPM, 1901; ISO 80000-3).
const GRAVITY_M_S2: f64 = 9.806_65;

/// Temperature of the water that is lifted, in °C.
const WATER_DEGC: f64 = 25.0;

impl Answers {
    /// Refuses the first answer that cannot be, by itself or beside the others. An answer that is missing contradicts
    /// none.
    ///
    /// # Errors
    /// [`SetupError`] with the values, and what is allowed.
    pub fn check(&self) -> Result<(), SetupError> {
        self.check_rollers()?;
        self.check_lift()?;
        let is_known = self.rollers.is_some() || self.is_of_file() || self.catalogued()?.is_some();
        if self.head.is_none() || !is_known {
            return Ok(());
        }
        // The rate is looked at by itself, so that its message says what the head and the board allow.
        match (Self { rate_ml_s: None, ..self.clone() }).pump_file(|_| "") {
            Err(SetupError::Missing { .. }) => Ok(()),
            Err(error) => Err(error),
            Ok((file, _)) => {
                let ml_per_rev = file.model()?.revolution_ml();
                let Some(rate_ml_s) = self.rate_ml_s else { return Ok(()) };
                check_speed(rate_ml_s, ml_per_rev, file.motor.max_speed_rpm)?;
                let steps = f64::from(file.motor.steps_per_rev) * file.motor.gear;
                let is_stated = self.has_steps() || self.is_of_file();
                match file.driver() {
                    DriverName::Grbl if is_stated => check_steps(rate_ml_s, ml_per_rev, steps),
                    DriverName::Grbl | DriverName::Sim => Ok(()),
                }
            }
        }
    }

    /// Returns the rate to suggest, in mL/s: that of a new pump file, as far as a grbl board makes its steps.
    ///
    /// # Errors
    /// Errors of [`Answers::pump_file`].
    pub fn usual_rate_ml_s(&self) -> Result<f64, SetupError> {
        let (file, _) = Self { rate_ml_s: None, ..self.clone() }.pump_file(|_| "")?;
        let ml_per_step =
            file.model()?.revolution_ml() / (f64::from(file.motor.steps_per_rev) * file.motor.gear);
        let usual_ml_s = file.pump.default_rate_ml_s;
        Ok(match file.driver() {
            DriverName::Sim => usual_ml_s,
            // Half of the range, so that the digits that are cut away leave it.
            DriverName::Grbl => {
                usual_ml_s.min(0.5 * MOST_STEPS_S * ml_per_step).max(2.0 * LEAST_STEPS_S * ml_per_step)
            }
        })
    }

    /// Refuses a name that cannot name a pump, and one that another pump of the configuration has.
    ///
    /// # Errors
    /// [`SetupError::Name`] or [`SetupError::Taken`].
    pub fn check_name(&self, config: &Config) -> Result<(), SetupError> {
        let name = &self.name;
        let letters = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-' || c == '_';
        let is_named = (1..=64).contains(&name.len()) && name.chars().all(letters);
        if !is_named || crate::catalogue::built_in(name).is_some() {
            return Err(SetupError::Name { name: name.clone() });
        }
        let taken =
            |path: &std::path::Path| Err(SetupError::Taken { name: name.clone(), path: path.to_owned() });
        for (other, path) in config.pumps() {
            let is_own = other == name && self.done.written.is_some();
            let has_id = || crate::PumpFile::read(path).is_ok_and(|file| file.pump.id == *name);
            if !is_own && (other == name && !self.wrote(path) || other != name && has_id()) {
                return taken(path);
            }
        }
        Ok(())
    }

    /// Returns true if the file is what these answers write: the process ended before it noted that.
    fn wrote(&self, path: &std::path::Path) -> bool {
        crate::PumpFile::read(path).is_ok_and(|file| self.pump_file(|_| "").is_ok_and(|(own, _)| own == file))
    }

    fn check_rollers(&self) -> Result<(), SetupError> {
        let published = self.catalogued()?.and_then(|head| Some((head, head.rollers?)));
        match (published, self.rollers) {
            (Some((head, published)), Some(rollers)) if published != rollers => {
                Err(SetupError::Rollers { head: head.name.clone(), published, rollers })
            }
            _ => Ok(()),
        }
    }

    /// Refuses a height that the air's pressure less the vapour pressure does not lift water to: rho g h.
    fn check_lift(&self) -> Result<(), SetupError> {
        let Some(lift_mm) = self.suction_lift_mm else { return Ok(()) };
        let ambient = match (self.ambient_kpa, self.altitude_m) {
            (Some(kpa), _) => AmbientTable::of_pressure_kpa(kpa),
            (None, Some(altitude_m)) => AmbientTable::at_altitude_m(altitude_m),
            (None, None) => return Ok(()),
        };
        let ambient_kpa = ambient.pressure_kpa;
        let water = Fluid::water(WATER_DEGC)?;
        let falls_kpa = ambient_kpa - water.vapour_kpa.unwrap_or(0.0);
        let most_m = falls_kpa * 1e3 / (water.density_kg_m3 * GRAVITY_M_S2);
        let lift_m = 1e-3 * lift_mm;
        if lift_m < most_m { Ok(()) } else { Err(SetupError::Lift { lift_m, most_m, ambient_kpa }) }
    }
}

/// Refuses a rate for which the head would turn faster than it may.
fn check_speed(rate_ml_s: f64, ml_per_rev: f64, most_rpm: f64) -> Result<(), SetupError> {
    let needed_rpm = rpm(rate_ml_s / ml_per_rev * core::f64::consts::TAU);
    if needed_rpm <= most_rpm {
        return Ok(());
    }
    let most_ml_s = ml_per_rev * rad_s(most_rpm) / core::f64::consts::TAU;
    Err(SetupError::Fast { rate_ml_s, needed_rpm, ml_per_rev, most_rpm, most_ml_s })
}

/// Refuses a rate whose steps no grbl board makes.
fn check_steps(rate_ml_s: f64, ml_per_rev: f64, steps: f64) -> Result<(), SetupError> {
    let needed_steps_s = rate_ml_s / ml_per_rev * steps;
    if (LEAST_STEPS_S..=MOST_STEPS_S).contains(&needed_steps_s) {
        return Ok(());
    }
    Err(SetupError::Steps {
        rate_ml_s,
        needed_steps_s,
        ml_per_rev,
        steps,
        least_steps_s: LEAST_STEPS_S,
        most_steps_s: MOST_STEPS_S,
        least_ml_s: LEAST_STEPS_S / steps * ml_per_rev,
        most_ml_s: MOST_STEPS_S / steps * ml_per_rev,
    })
}
