//! Answers that contradict one another.

use pump_model::units::{rad_s, rpm};
use pump_model::{Fluid, Geometry};

use super::answers::{Answers, HeadAnswer};
use super::error::SetupError;
use crate::config::Config;
use crate::drives::grbl_speeds::{LEAST_STEPS_S, MOST_STEPS_S};
use crate::heads::possible_ml;
use crate::pump_file::{AmbientTable, DriverName, most_lift_mm};
use crate::sizing::LONGEST_PITCH_S;

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
        self.check_bore()?;
        self.check_lift()?;
        self.check_stepper_driver()?;
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
                let pitch_ml = ml_per_rev / f64::from(file.rollers.count.max(1));
                check_speed(rate_ml_s, ml_per_rev, pitch_ml / LONGEST_PITCH_S, file.motor.max_speed_rpm)
            }
        }
    }

    /// Refuses a rate at which the board does not turn the head. `range_rad_s` are the slowest and the fastest speed of
    /// the head that the board makes.
    ///
    /// # Errors
    /// [`SetupError::Board`] with the rates that are allowed. Otherwise as [`Answers::pump_file`].
    pub fn check_board(&self, range_rad_s: (f64, f64)) -> Result<(), SetupError> {
        let (file, _) = self.pump_file(|_| "")?;
        let (rate_ml_s, ml_per_rev) = (file.pump.default_rate_ml_s, file.model()?.revolution_ml());
        let ml_rad = ml_per_rev / core::f64::consts::TAU;
        let (least_rad_s, most_rad_s) = range_rad_s;
        let needed_rad_s = rate_ml_s / ml_rad;
        if (least_rad_s..=most_rad_s).contains(&needed_rad_s) {
            return Ok(());
        }
        Err(SetupError::Board {
            rate_ml_s,
            needed_rpm: rpm(needed_rad_s),
            least_rpm: rpm(least_rad_s),
            most_rpm: rpm(most_rad_s),
            least_ml_s: least_rad_s * ml_rad,
            most_ml_s: most_rad_s * ml_rad,
        })
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
            DriverName::Sim | DriverName::Node | DriverName::Klipper => usual_ml_s,
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
        if let Some(rollers) = self.rollers {
            Geometry::of_rollers(rollers).validate_rollers()?;
        }
        let published = self.catalogued()?.and_then(|head| Some((head, head.rollers?)));
        match (published, self.rollers) {
            (Some((head, published)), Some(rollers)) if published != rollers => {
                Err(SetupError::Rollers { head: head.name.clone(), published, rollers })
            }
            _ => Ok(()),
        }
    }

    /// Refuses a volume that no head delivers through the bore, before the head is known as a whole.
    fn check_bore(&self) -> Result<(), SetupError> {
        let Some(HeadAnswer::Volume { ml_per_rev }) = self.head else { return Ok(()) };
        let Some(bore_mm) = self.tube_bore_mm.filter(|bore_mm| *bore_mm > 0.0) else { return Ok(()) };
        let (least_ml, most_ml) = possible_ml(bore_mm);
        if (least_ml..=most_ml).contains(&ml_per_rev) {
            return Ok(());
        }
        Err(SetupError::Bore { ml_per_rev, bore_mm, least_ml, most_ml })
    }

    /// Refuses a height that the air's pressure less the vapour pressure does not lift water to.
    fn check_lift(&self) -> Result<(), SetupError> {
        let Some(lift_mm) = self.suction_lift_mm else { return Ok(()) };
        let ambient = match (self.ambient_kpa, self.altitude_m) {
            (Some(kpa), _) => AmbientTable::of_pressure_kpa(kpa),
            (None, Some(altitude_m)) => AmbientTable::at_altitude_m(altitude_m),
            (None, None) => return Ok(()),
        };
        check_suction_lift(lift_mm, ambient.pressure_kpa)
    }
}

/// Refuses a height of the pump above the supply, in mm, to which air of this pressure, in kPa absolute, does not lift
/// water.
///
/// # Errors
/// [`SetupError::Lift`] for such a height.
pub fn check_suction_lift(lift_mm: f64, ambient_kpa: f64) -> Result<(), SetupError> {
    let water = Fluid::water(WATER_DEGC)?;
    let most_m = 1e-3 * most_lift_mm(water.density_kg_m3, ambient_kpa, water.vapour_kpa);
    let lift_m = 1e-3 * lift_mm;
    if lift_m < most_m { Ok(()) } else { Err(SetupError::Lift { lift_m, most_m, ambient_kpa }) }
}

/// Refuses a rate for which the head would turn faster than it may, or slower than any dose of a setup.
fn check_speed(rate_ml_s: f64, ml_per_rev: f64, least_ml_s: f64, most_rpm: f64) -> Result<(), SetupError> {
    let needed_rpm = rpm(rate_ml_s / ml_per_rev * core::f64::consts::TAU);
    let most_ml_s = ml_per_rev * rad_s(most_rpm) / core::f64::consts::TAU;
    if rate_ml_s < least_ml_s {
        return Err(SetupError::Slow { rate_ml_s, needed_rpm, ml_per_rev, least_ml_s, most_ml_s });
    }
    if needed_rpm <= most_rpm {
        return Ok(());
    }
    Err(SetupError::Fast { rate_ml_s, needed_rpm, ml_per_rev, most_rpm, most_ml_s })
}
