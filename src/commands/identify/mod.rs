//! `dose identify`: lines from measurements.

mod compliance;
mod line;
mod resistance;

use std::fs;
use std::path::{Path, PathBuf};

use clap::{Args, Subcommand, ValueEnum};
use pump_bench::export::fit_plot;
use pump_bench::export::{Axes, Fitted};
use pump_bench::files::TableError;
use pump_model::Port;

use crate::failure::Failure;
use crate::options::Options;
use crate::outputs::Outputs;

#[derive(Debug, Subcommand)]
pub(crate) enum IdentifyCommand {
    /// R from steady flows and the pressures that they take: dP = R Q
    ///
    /// Columns: flow_ml_s; drop_kpa along the flow, or the absolute pressure at the pump as p_in_kpa or p_out_kpa; perhaps
    /// standard_kpa, by which the points weigh.
    Resistance(resistance::ResistanceArgs),
    /// C from a syringe that injects into the closed line: C = dV/dP
    ///
    /// Columns: volume_ml injected since the start; pressure_kpa, or p_in_kpa or p_out_kpa.
    Compliance(compliance::ComplianceArgs),
    /// R, C and L from the pressure over time while the pump turns (--speed or --rate)
    ///
    /// Columns: time_s, rising; the absolute pressures p_in_kpa, p_out_kpa or both. A trace is such a table. The start angle is
    /// sought unless --start-angle tells it.
    Line(line::LineArgs),
}

/// A line of the pump.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum LineName {
    /// From the inlet's reservoir to the pump
    Inlet,
    /// From the pump to the outlet's reservoir
    Outlet,
}

impl LineName {
    fn port(self) -> Port {
        match self {
            Self::Inlet => Port::Inlet,
            Self::Outlet => Port::Outlet,
        }
    }
}

/// What every identification reads.
#[derive(Debug, Args)]
pub(crate) struct DataArgs {
    /// Table of measurements, CSV, with the units in the columns' names
    #[arg(long, value_name = "FILE")]
    data: PathBuf,
}

impl DataArgs {
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

pub(crate) fn identify(command: &IdentifyCommand, options: &Options) -> Result<(), Failure> {
    match command {
        IdentifyCommand::Resistance(args) => resistance::resistance(args, options),
        IdentifyCommand::Compliance(args) => compliance::compliance(args, options),
        IdentifyCommand::Line(args) => line::line(args, options),
    }
}

/// Draws a fit.
fn plot(
    outputs: &mut Outputs,
    path: &Path,
    title: &str,
    axes: Axes,
    points: &[Fitted],
) -> Result<(), Failure> {
    outputs.drawing(path, fit_plot::svg(title, axes, points))
}
