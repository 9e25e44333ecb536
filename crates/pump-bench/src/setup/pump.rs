//! The pump file that answers make.

use pump_model::Geometry;
use pump_model::units::radians;

use super::answers::{Answers, HeadAnswer};
use super::error::SetupError;
use crate::catalogue::{BoughtPump, CataloguedPump, DrawnPump, MotorSteps, StatedMotor};
use crate::heads::{BoughtHead, bought_head, nearest_heads};
use crate::notice::Wording;
use crate::pump_file::{
    AmbientTable, DriveTable, DriverName, HeadTable, PumpFile, Reservoir, RollerVolumeTable,
};

/// Full steps per revolution of a usual stepper motor, of 1.8 deg each.
pub const USUAL_FULL_STEPS: u32 = 200;

/// Length of the hose on either side of a drawn pump, in mm: that of McIntyre et al.
const HOSE_MM: f64 = 331.0;

/// Kind of pump that a head makes.
enum Made {
    Bought(BoughtPump),
    Catalogued(Box<CataloguedPump>),
    Drawn(Box<DrawnPump>),
    /// Copy of another file.
    Copied(Box<PumpFile>),
}

impl Answers {
    /// Returns the pump file of these answers, and its text with remarks. An answer that is missing leaves the usual
    /// value of a new pump. A front end words the remarks' remedies.
    ///
    /// # Errors
    /// [`SetupError::Missing`] without a head or its rollers. Otherwise the error of a pump that cannot work.
    pub fn pump_file(&self, words: Wording) -> Result<(PumpFile, String), SetupError> {
        let made = self.made()?;
        let mut file = match &made {
            Made::Bought(pump) => pump.pump_file(),
            Made::Catalogued(pump) => pump.pump_file()?,
            Made::Drawn(pump) => pump.pump_file()?,
            Made::Copied(file) => (**file).clone(),
        };
        self.write_to(&mut file);
        let text = match &made {
            Made::Bought(pump) => pump.toml_of(&file, words),
            Made::Catalogued(pump) => pump.toml_of(&file, words),
            Made::Drawn(pump) => pump.toml_of(&file, words),
            Made::Copied(file_before) => {
                format!(
                    "# Written from the file of the pump {}.\n\n{}",
                    file_before.pump.name,
                    file.to_toml()
                )
            }
        };
        let file = PumpFile::parse(&text, "of these answers")?;
        Ok((file, text))
    }

    /// Returns the heights that a copied pump file states as absolute pressures, in mm: those of the columns of its
    /// fluid in the air that it states, suction first. A line whose height the file states itself has `None`, and so
    /// have both of a pump without such a file. They say how far a file's pressures stay true in other air.
    ///
    /// # Errors
    /// [`SetupError::PumpFile`] if the file cannot be read.
    pub fn heights_of_pressures_mm(&self) -> Result<[Option<f64>; 2], SetupError> {
        let Some(HeadAnswer::File(path)) = &self.head else { return Ok([None; 2]) };
        Ok(PumpFile::read(path)?.heights_of_pressures_mm())
    }

    /// Returns the head of the catalogue that the answers name, if they name one.
    ///
    /// # Errors
    /// [`SetupError::UnknownHead`] for a name that the catalogue does not have.
    pub fn catalogued(&self) -> Result<Option<&'static BoughtHead>, SetupError> {
        let Some(HeadAnswer::Catalogue(name)) = &self.head else { return Ok(None) };
        bought_head(name).map(Some).ok_or_else(|| SetupError::UnknownHead {
            name: name.clone(),
            nearest: nearest_heads(name).join(", "),
        })
    }

    /// Returns the bore of the head's tube, in mm. `None` if nobody knows it, or the head is not complete.
    pub fn bore_mm(&self) -> Option<f64> {
        match self.made().ok()? {
            Made::Bought(pump) => pump.head.tube_bore_mm,
            Made::Catalogued(_) => self.catalogued().ok()??.bore_mm,
            Made::Drawn(pump) => Some(2.0 * pump.geometry.bore_radius_mm),
            Made::Copied(file) => match &file.head {
                Some(head) => head.tube_bore_mm,
                None => file.tube.bore_radius_mm.map(|radius_mm| 2.0 * radius_mm),
            },
        }
    }

    /// Returns the motor as its owner states it, if its steps are said.
    pub fn motor(&self) -> Option<StatedMotor> {
        let micro = self.microsteps.map(|microsteps| MotorSteps::Microsteps {
            full_steps: self.full_steps.unwrap_or(USUAL_FULL_STEPS),
            microsteps,
        });
        let steps = self.steps_per_rev.map(MotorSteps::PerRevolution).or(micro)?;
        Some(StatedMotor::new(steps).with_gear(self.gear.unwrap_or(1.0)))
    }

    fn made(&self) -> Result<Made, SetupError> {
        let id = self.name.clone();
        let head = self.head.as_ref().ok_or(SetupError::Missing { what: "which head the pump has" })?;
        let rollers = || self.rollers.ok_or(SetupError::Missing { what: "how many rollers the head has" });
        Ok(match head {
            HeadAnswer::Catalogue(_) => {
                let head =
                    self.catalogued()?.ok_or(SetupError::Missing { what: "which head the pump has" })?;
                let rollers = self.rollers.or(head.rollers).map_or_else(rollers, Ok)?;
                Made::Catalogued(Box::new(CataloguedPump::new(id, head, rollers)))
            }
            HeadAnswer::Volume { ml_per_rev } => {
                let mut head = HeadTable::new(*ml_per_rev);
                head.tube_bore_mm = self.tube_bore_mm.filter(|bore_mm| *bore_mm > 0.0);
                Made::Bought(BoughtPump { id, head, rollers: rollers()? })
            }
            HeadAnswer::Drawing { bore_mm, outer_mm, backplate_mm, roller_mm, offset_mm, contact_deg } => {
                let geometry = Geometry {
                    rollers: rollers()?,
                    bore_radius_mm: 0.5 * bore_mm,
                    tube_outer_radius_mm: 0.5 * outer_mm,
                    backplate_radius_mm: *backplate_mm,
                    contact_angle_rad: radians(*contact_deg),
                    roller_radius_mm: *roller_mm,
                    roller_offset_mm: *offset_mm,
                };
                let roller_volume = RollerVolumeTable::Drawing;
                Made::Drawn(Box::new(DrawnPump { id, geometry, hose_length_mm: HOSE_MM, roller_volume }))
            }
            HeadAnswer::File(path) => {
                let mut file = PumpFile::read(path)?;
                file.pump.id = id;
                Made::Copied(Box::new(file))
            }
        })
    }

    /// Writes motor, drive, place and rate into a file.
    fn write_to(&self, file: &mut PumpFile) {
        if let Some(motor) = self.motor() {
            motor.write_to(file);
        }
        // A person has said the steps, or has seen those of the file.
        if self.motor().is_some() || file.motor.confirmed != Some(false) {
            file.motor.confirmed = Some(true);
        }
        if let Some(most_rpm) = self.max_speed_rpm {
            // A slower motor has a slower usual rate.
            file.pump.default_rate_ml_s *= (most_rpm / file.motor.max_speed_rpm).min(1.0);
            file.motor.max_speed_rpm = most_rpm;
        }
        // A real motor that nobody has watched may turn either way.
        let is_real = self.driver.is_some_and(|driver| driver != DriverName::Sim);
        let is_unseen = is_real && self.invert.is_none() && !self.done.directed;
        file.motor.direction_confirmed = is_unseen.then_some(false);
        if let Some(driver) = self.driver {
            let mut drive = file.drive.clone().filter(|drive| drive.driver == driver);
            let table = drive.get_or_insert_with(|| DriveTable::of(driver));
            table.port = self.port.clone().or(table.port.take());
            if driver != DriverName::Klipper {
                table.axis = self.axis.unwrap_or(table.axis);
            }
            table.invert = self.invert.unwrap_or(table.invert);
            if let Some(socket) = self.socket.as_ref().filter(|_| driver == DriverName::Klipper) {
                table.klipper = Some(socket.table(self.current_a, self.hold_a));
            }
            // A board whose pins nobody has said yet turns no motor.
            file.drive = drive.filter(|table| driver != DriverName::Klipper || table.klipper.is_some());
        }
        if let Some(altitude_m) = self.altitude_m {
            file.ambient = AmbientTable::at_altitude_m(altitude_m);
        }
        if let Some(kpa) = self.ambient_kpa {
            file.ambient = AmbientTable::of_pressure_kpa(kpa);
        }
        if let Some(lift_mm) = self.suction_lift_mm {
            file.inlet.reservoir = Reservoir::Lift(lift_mm);
        }
        if let Some(lift_mm) = self.discharge_lift_mm {
            file.outlet.line.reservoir = Reservoir::Lift(lift_mm);
        }
        file.outlet.end = self.outlet_end.or(file.outlet.end);
        file.outlet.nozzle_bore_mm =
            self.nozzle_bore_mm.filter(|bore_mm| *bore_mm > 0.0).or(file.outlet.nozzle_bore_mm);
        file.pump.default_rate_ml_s = self.rate_ml_s.unwrap_or(file.pump.default_rate_ml_s);
    }
}
