//! Where a pump stands: the air's pressure, and the heights of supply and vessel.

use clap::Args;
use pump_bench::pump_file::{AmbientTable, PumpFile, Reservoir};
use pump_bench::setup::check_suction_lift;
use pump_bench::units::{self, Pressure};

use crate::failure::Failure;
use crate::options::limits::ambient_kpa;

/// The place of a pump.
#[derive(Debug, Args)]
#[command(next_help_heading = "Place")]
pub(crate) struct SiteOptions {
    /// Altitude of the pump, as 500m; it gives the air's pressure (ISO 2533) [default: sea level, as assumed]
    #[arg(long, value_name = "HEIGHT", value_parser = units::height_mm, conflicts_with = "ambient")]
    altitude: Option<f64>,
    /// Pressure of the air around the pump, as 98.2kPaa
    #[arg(long, value_name = "PRESSURE", value_parser = units::pressure)]
    ambient: Option<Pressure>,
    /// Height of the pump above the supply's surface, as 1.2m; negative where the supply stands above [default: 0]
    #[arg(long, value_name = "HEIGHT", value_parser = units::height_mm)]
    suction_lift: Option<f64>,
    /// Height of the vessel above the pump, as 0.5m; negative where the vessel lies below [default: 0]
    #[arg(long, value_name = "HEIGHT", value_parser = units::height_mm)]
    discharge_lift: Option<f64>,
}

impl SiteOptions {
    /// Writes the place into a pump file.
    pub(crate) fn write_to(&self, file: &mut PumpFile) -> Result<(), Failure> {
        file.ambient = self.ambient()?.unwrap_or(file.ambient);
        if let Some(lift_mm) = self.suction_lift {
            check_suction_lift(lift_mm, file.ambient.pressure_kpa)?;
            file.inlet.reservoir = Reservoir::Lift(lift_mm);
        }
        if let Some(lift_mm) = self.discharge_lift {
            file.outlet.line.reservoir = Reservoir::Lift(lift_mm);
        }
        Ok(())
    }

    /// The heights that the pump lifts on the sides of suction and discharge, in mm, where they are given.
    pub(crate) fn lifts_mm(&self) -> (Option<f64>, Option<f64>) {
        (self.suction_lift, self.discharge_lift)
    }

    /// The air around the pump, if it is given.
    pub(crate) fn ambient(&self) -> Result<Option<AmbientTable>, Failure> {
        match (self.altitude, self.ambient) {
            (Some(altitude_mm), _) => Ok(Some(AmbientTable::at_altitude_m(1e-3 * altitude_mm))),
            (None, Some(pressure)) => Ok(Some(AmbientTable::of_pressure_kpa(ambient_kpa(pressure)?))),
            (None, None) => Ok(None),
        }
    }
}
