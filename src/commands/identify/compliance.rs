//! `dose identify compliance`: C from a syringe injection.

use clap::Args;
use pump_bench::export::Axes;
use pump_bench::identification::{identified_compliance, injection_of_csv};
use pump_bench::units;

use super::data::{DataArgs, LineOption, report};
use crate::failure::Failure;

#[derive(Debug, Args)]
pub(super) struct ComplianceArgs {
    #[command(flatten)]
    line: LineOption,
    /// Volume that the closed line holds, as 26mL: gives its effective bulk modulus
    #[arg(long, value_name = "VOLUME", value_parser = units::volume_ml)]
    total_volume: Option<f64>,
    #[command(flatten)]
    data: DataArgs,
}

impl ComplianceArgs {
    pub(super) fn run(&self) -> Result<(), Failure> {
        let (file, pump) = self.data.pump()?;
        let port = self.line.line;
        let points = self.data.read(|text| injection_of_csv(text, port))?;
        let found = identified_compliance(&points, self.total_volume, (port, pump.line(port)))
            .map_err(|error| self.data.in_table(error))?
            .with_nozzle_of(&file);
        let axes = Axes { x: "injected, mL", y: "pressure, kPa", left: "measured less fitted, kPa" };
        report(&found, axes, &self.data)
    }
}
