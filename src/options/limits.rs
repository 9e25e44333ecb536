//! The limits of a dose.

use clap::Args;
use pump_bench::pump_file::{AmbientTable, PumpFile};
use pump_bench::units::{self, Pressure};
use pump_ctl::plan::PressureLimits;

use crate::failure::Failure;

/// The pressures that a dose must keep.
#[derive(Debug, Args)]
#[command(next_help_heading = "Limits")]
pub(crate) struct PressureOptions {
    /// Largest pressure at the port that pushes, as 120kPaa or 20kPag
    #[arg(long, value_name = "PRESSURE", value_parser = units::pressure)]
    max_outlet_pressure: Option<Pressure>,
    /// Smallest pressure at the port that sucks, as 45kPaa
    #[arg(long, value_name = "PRESSURE", value_parser = units::pressure)]
    min_inlet_pressure: Option<Pressure>,
    /// Pressure of the air today, as 98.2kPaa [default: the pump file's]
    #[arg(
        long_help = "Pressure of the air today, as 98.2kPaa, in place of the pump file's [ambient]: gauge pressures \
        are measured against it, and lifts begin at it. A reservoir whose absolute pressure the file states keeps it."
    )]
    #[arg(long, value_name = "PRESSURE", value_parser = units::pressure)]
    ambient: Option<Pressure>,
}

/// Reads the pressure of the air, which is absolute.
pub(crate) fn ambient_kpa(pressure: Pressure) -> Result<f64, Failure> {
    match pressure {
        Pressure::Absolute(kpa) => Ok(kpa),
        Pressure::Gauge(kpa) => {
            let refused = Failure::refused(
                "the air's pressure is what gauge pressures are measured against; give it absolute",
            );
            Err(refused.value(format!("{kpa} kPa gauge")).allowed("an absolute pressure, as 98.2kPaa"))
        }
    }
}

/// The most volume in 24 hours.
#[derive(Debug, Args)]
#[command(next_help_heading = "Limits")]
pub(crate) struct DayLimit {
    /// Most volume in any 24 hours, as 50mL
    #[arg(
        long_help = "Most volume in any 24 hours, as 50mL: doses, primes, purges and runs in either direction. Beyond \
        it the pump stands (exit code 5) until `dose safety clear`. It may be less than the pump file's [safety] \
        max_ml_per_day, and not more."
    )]
    #[arg(long, value_name = "VOLUME", value_parser = units::volume_ml)]
    max_per_day: Option<f64>,
}

impl DayLimit {
    /// Puts the limit that is named in place of the pump file's. A limit that the file sets is never widened.
    pub(crate) fn change(&self, file: &mut PumpFile) -> Result<(), Failure> {
        let Some(most_ml) = self.max_per_day else { return Ok(()) };
        if most_ml <= 0.0 {
            let refused = Failure::refused(format!("--max-per-day is {most_ml} mL; allowed: more than 0"));
            return Err(refused.value(format!("{most_ml} mL")).allowed("more than 0"));
        }
        if let Some(file_ml) = file.safety.max_ml_per_day.filter(|file_ml| most_ml > *file_ml) {
            let message = format!(
                "--max-per-day is {most_ml} mL, more than the pump file's [safety] max_ml_per_day = {file_ml}; change \
                 the file to allow more"
            );
            let refused = Failure::refused(message).value(format!("{most_ml} mL"));
            return Err(refused.allowed(format!("{file_ml} mL at most")));
        }
        file.safety.max_ml_per_day = Some(most_ml);
        Ok(())
    }
}

/// The life of the tube.
#[derive(Debug, Args)]
#[command(next_help_heading = "Limits")]
pub(crate) struct TubeLimit {
    /// Life of a tube, as 100L, 500h or 1e6rev
    #[arg(
        long_help = "Life of a tube, as 100L, 500h or 1e6rev. Doses warn from 90 % of it on, and are refused \
        beyond. The default is the pump file's, of which the first that is reached counts."
    )]
    #[arg(long, value_name = "LIFE", value_parser = tube_life)]
    tube_limit: Option<AskedLife>,
}

/// A life of a tube that was asked for.
#[derive(Debug, Clone, Copy)]
enum AskedLife {
    /// Volume, in mL.
    Volume(f64),
    /// Time in motion, in h.
    Time(f64),
    /// Revolutions.
    Turns(f64),
}

/// Reads a volume, a time, or a number of revolutions.
fn tube_life(text: &str) -> Result<AskedLife, units::QuantityError> {
    let unit = text.trim().trim_start_matches(|letter: char| !letter.is_alphabetic());
    let is_time = units::time_s(&format!("1{unit}")).is_ok();
    if is_time {
        return units::time_s(text).map(|time_s| AskedLife::Time(time_s / 3600.0));
    }
    match units::angle_rad(text) {
        Ok(turn_rad) if unit.ends_with("rev") => Ok(AskedLife::Turns(turn_rad / std::f64::consts::TAU)),
        _ => units::life_ml(text).map(AskedLife::Volume),
    }
}

impl PressureOptions {
    /// Puts the air's pressure that is named in place of the pump file's.
    pub(crate) fn change(&self, file: &mut PumpFile) -> Result<(), Failure> {
        if let Some(kpa) = self.ambient.map(ambient_kpa).transpose()? {
            file.ambient = AmbientTable::of_pressure_kpa(kpa);
        }
        Ok(())
    }

    /// The limits that are named, kPa absolute.
    pub(crate) fn pressures(&self, file: &PumpFile) -> PressureLimits {
        let absolute_kpa = |pressure: Pressure| pressure.absolute_kpa(file.ambient.pressure_kpa);
        PressureLimits {
            max_outlet_kpa: self.max_outlet_pressure.map(absolute_kpa),
            min_inlet_kpa: self.min_inlet_pressure.map(absolute_kpa),
        }
    }
}

impl TubeLimit {
    /// Puts the life that is named in place of the pump file's.
    pub(crate) fn change(&self, file: &mut PumpFile) {
        match self.tube_limit {
            None => {}
            Some(AskedLife::Volume(life_ml)) => file.tube.life_ml = Some(life_ml),
            Some(AskedLife::Time(life_h)) => file.tube.life_h = Some(life_h),
            Some(AskedLife::Turns(life_rev)) => file.tube.life_rev = Some(life_rev),
        }
    }
}
