//! `dose identify`: lines from measurements.

mod compliance;
mod line;
mod resistance;

use std::fs;
use std::path::PathBuf;

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{Args, Subcommand};
use pump_bench::PumpFile;
use pump_bench::export::{Axes, Fitted, fit_plot};
use pump_bench::files::TableError;
use pump_bench::identification::Identified;
use pump_model::{Port, Pump};

use crate::failure::Failure;
use crate::options::files::{PlotOption, differ};
use crate::options::pump::PumpOption;
use crate::options::report::FormatOption;
use crate::outputs::Outputs;
use crate::terminal::{print, tell};

#[derive(Debug, Args)]
pub(crate) struct IdentifyArgs {
    #[command(subcommand)]
    command: IdentifyCommand,
}

#[derive(Debug, Subcommand)]
enum IdentifyCommand {
    /// R from steady flows and the pressures that they take: dP = R Q
    ///
    /// Columns: flow_ml_s; drop_kpa along the flow, or the absolute pressure at the pump as p_in_kpa or p_out_kpa;
    /// perhaps standard_kpa, by which the points weigh.
    Resistance(resistance::ResistanceArgs),
    /// C from a syringe that injects into the closed line: C = dV/dP
    ///
    /// Columns: volume_ml injected since the start; pressure_kpa, or p_in_kpa or p_out_kpa.
    Compliance(compliance::ComplianceArgs),
    /// R, C and L from the pressure over time while the pump turns (--speed or --rate)
    ///
    /// Columns: time_s, rising; the absolute pressures p_in_kpa, p_out_kpa or both. A trace is such a table. The start
    /// angle is sought unless --start-angle tells it.
    Line(line::LineArgs),
}

/// The data that every identification reads, and what it writes.
#[derive(Debug, Args)]
struct DataArgs {
    /// Table of measurements, CSV, with the units in the columns' names
    #[arg(long, value_name = "FILE")]
    data: PathBuf,
    #[command(flatten)]
    pump: PumpOption,
    #[command(flatten)]
    format: FormatOption,
    #[command(flatten)]
    plot: PlotOption,
}

/// The line whose constants are sought.
#[derive(Debug, Args)]
struct LineOption {
    /// Line that was measured: inlet or outlet
    #[arg(long, value_name = "inlet|outlet", default_value = "outlet", hide_possible_values = true)]
    #[arg(value_parser = line_named())]
    line: Port,
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
    fn pump(&self) -> Result<(PumpFile, Pump), Failure> {
        differ(&[self.plot.plot.as_deref()])?;
        let file = self.pump.file()?;
        let pump = file.model().map_err(Failure::refused)?;
        Ok((file, pump))
    }

    /// Reads the table; what is wrong in it is said with file and line.
    fn read<T>(&self, table: impl FnOnce(&str) -> Result<T, TableError>) -> Result<T, Failure> {
        let shown = self.data.display();
        let text = fs::read_to_string(&self.data)
            .map_err(|error| Failure::refused(format!("cannot read {shown}: {error}")))?;
        table(&text).map_err(|error| self.in_table(error))
    }

    fn in_table(&self, error: impl std::fmt::Display) -> Failure {
        Failure::refused(format!("{}: {error}", self.data.display()))
    }
}

impl IdentifyArgs {
    pub(crate) fn run(&self) -> Result<(), Failure> {
        match &self.command {
            IdentifyCommand::Resistance(args) => args.run(),
            IdentifyCommand::Compliance(args) => args.run(),
            IdentifyCommand::Line(args) => args.run(),
        }
    }
}

/// Draws and reports a line that was identified.
fn report(found: &Identified, axes: Axes, data: &DataArgs) -> Result<(), Failure> {
    let mut outputs = Outputs::default();
    plot(&mut outputs, data, &found.headline, axes, &found.points)?;
    outputs.put()?;
    if data.format.json() { print(&found.json()) } else { tell(&found.text()) }
}

/// Draws a fit, if a picture is asked for.
fn plot(
    outputs: &mut Outputs,
    data: &DataArgs,
    title: &str,
    axes: Axes,
    points: &[Fitted],
) -> Result<(), Failure> {
    match &data.plot.plot {
        Some(path) => outputs.drawing(path, fit_plot::svg(title, axes, points)),
        None => Ok(()),
    }
}
