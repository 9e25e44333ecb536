//! `dose identify`: lines from measurements.

mod compliance;
mod data;
mod line;
mod resistance;

use clap::{Args, Subcommand};

use crate::failure::Failure;

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

impl IdentifyArgs {
    pub(crate) fn run(&self) -> Result<(), Failure> {
        match &self.command {
            IdentifyCommand::Resistance(args) => args.run(),
            IdentifyCommand::Compliance(args) => args.run(),
            IdentifyCommand::Line(args) => args.run(),
        }
    }
}
