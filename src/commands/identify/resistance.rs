//! `dose identify resistance`: R from steady flows and pressures.

use clap::Args;
use pump_bench::export::Axes;
use pump_bench::identification::{flow_points_of_csv, identified_resistance};

use super::data::{DataArgs, LineOption, report};
use crate::failure::Failure;

#[derive(Debug, Args)]
pub(super) struct ResistanceArgs {
    #[command(flatten)]
    line: LineOption,
    /// Seek also the pressure at no flow: a reservoir or a sensor that is off
    #[arg(long)]
    offset: bool,
    #[command(flatten)]
    data: DataArgs,
}

impl ResistanceArgs {
    pub(super) fn run(&self) -> Result<(), Failure> {
        let (file, pump) = self.data.pump()?;
        let port = self.line.line;
        let line = pump.line(port);
        let points = self.data.read(|text| flow_points_of_csv(text, port, line.reservoir_kpa))?;
        let rate_ml_s = file.pump.default_rate_ml_s;
        let found = identified_resistance(&points, self.offset, (port, line), rate_ml_s)
            .map_err(|error| self.data.in_table(error))?
            .with_nozzle_of(&file);
        let axes = Axes { x: "flow, mL/s", y: "pressure drop, kPa", left: "measured less fitted, kPa" };
        report(&found, axes, &self.data)
    }
}
