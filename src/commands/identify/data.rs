//! The data of an identification, and what it writes.

use std::path::PathBuf;

use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use pump_bench::PumpFile;
use pump_bench::export::{Axes, Fitted, fit_svg};
use pump_bench::files::{MOST_TABLE_BYTES, TableError, read_text};
use pump_bench::identification::Identified;
use pump_bench::report::Explain;
use pump_model::{Port, Pump};

use crate::advice;
use crate::failure::Failure;
use crate::options::files::{Files, PlotOption};
use crate::options::pump::{ForeignRecord, PumpOption};
use crate::options::report::FormatOption;
use crate::outputs::Outputs;
use crate::terminal::{print_json, tell};

/// The data that every identification reads, and what it writes.
#[derive(Debug, Args)]
pub(super) struct DataArgs {
    /// Table of measurements, CSV, with the units in the columns' names
    #[arg(long, value_name = "FILE")]
    data: PathBuf,
    #[command(flatten)]
    pump: PumpOption,
    #[command(flatten)]
    pub(super) format: FormatOption,
    #[command(flatten)]
    pub(super) plot: PlotOption,
    #[command(flatten)]
    record: ForeignRecord,
}

/// The line whose constants are sought.
#[derive(Debug, Args)]
pub(super) struct LineOption {
    /// Line that was measured: inlet or outlet
    #[arg(long, value_name = "inlet|outlet", default_value = "outlet")]
    #[arg(value_parser = line_named())]
    pub(super) line: Port,
}

/// Reads the port of a line.
fn line_named() -> impl TypedValueParser<Value = Port> {
    let inlet = PossibleValue::new("inlet").help("From the inlet's reservoir to the pump");
    let outlet = PossibleValue::new("outlet").help("From the pump to the outlet's reservoir");
    PossibleValuesParser::new([inlet, outlet])
        .map(|word| if word == "inlet" { Port::Inlet } else { Port::Outlet })
}

impl DataArgs {
    /// The pump file that is named and its model, once the outputs are known to be files of their own.
    pub(super) fn pump(&self) -> Result<(PumpFile, Pump), Failure> {
        let outputs = [("--plot", self.plot.plot.as_deref())];
        let pump_path = self.pump.path()?;
        let inputs = [Some(self.data.as_path()), pump_path.as_deref()];
        let state_dir = self.record.folder(&self.pump.config()?);
        Files { outputs: &outputs, inputs: &inputs, config: self.pump.config_path(), state_dir }.check()?;
        let file = self.pump.file()?;
        let pump = file.model().map_err(Failure::of)?;
        Ok((file, pump))
    }

    /// Reads the table; what is wrong in it is said with file and line.
    pub(super) fn read<T>(&self, table: impl FnOnce(&str) -> Result<T, TableError>) -> Result<T, Failure> {
        let text =
            read_text(&self.data, MOST_TABLE_BYTES).map_err(|error| Failure::unread(&self.data, &error))?;
        table(&text).map_err(|error| self.in_table(error))
    }

    /// Says in which table an error is.
    pub(super) fn in_table(&self, error: impl Explain) -> Failure {
        Failure::of(error).after(&format!("{}: ", self.data.display()))
    }
}

/// Draws and reports a line that was identified.
pub(super) fn report(found: &Identified, axes: Axes, data: &DataArgs) -> Result<(), Failure> {
    let mut outputs = Outputs::default();
    plot(&mut outputs, data, &found.headline, axes, &found.points)?;
    outputs.put()?;
    let found = found.clone().worded(advice::words);
    if data.format.json() { print_json(&found.json()) } else { tell(&found.text()) }
}

/// Draws a fit, if a picture is asked for.
pub(super) fn plot(
    outputs: &mut Outputs,
    data: &DataArgs,
    title: &str,
    axes: Axes,
    points: &[Fitted],
) -> Result<(), Failure> {
    match &data.plot.plot {
        Some(path) => outputs.drawing(path, fit_svg(title, axes, points)),
        None => Ok(()),
    }
}
