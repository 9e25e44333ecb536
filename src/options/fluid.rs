//! The fluid, where it is not the pump file's.

use clap::Args;
use pump_bench::pump_file::PumpFile;
use pump_bench::units;

use crate::failure::Failure;

/// The fluid and its temperature.
#[derive(Debug, Args)]
#[command(next_help_heading = "Fluid")]
pub(crate) struct FluidOptions {
    /// Fluid: water, ethanol, isopropanol, `glycerol 50%` [default: the pump file's]
    #[arg(long, value_name = "NAME")]
    fluid: Option<String>,
    /// Temperature of the fluid, as 20degC [default: the pump file's]
    #[arg(long, value_name = "TEMPERATURE", value_parser = units::temperature_degc)]
    pub(crate) temperature: Option<f64>,
}

impl FluidOptions {
    /// The name of the fluid and its temperature in °C, if they are given.
    pub(crate) fn named(&self) -> (Option<String>, Option<f64>) {
        (self.fluid.clone(), self.temperature)
    }

    /// Puts the fluid that is named in place of the pump file's.
    pub(crate) fn change(&self, file: &mut PumpFile) -> Result<(), Failure> {
        let changed = file.fluid.changed_to(self.fluid.as_deref(), self.temperature);
        file.fluid = changed.map_err(Failure::of)?;
        // A lift that one fluid allows is too high for a heavier one.
        file.check(&file.pump.id).map_err(Failure::of)
    }
}
