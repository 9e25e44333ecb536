//! `dose vessel emptied`: the receiving vessel is empty.

use clap::{Args, Subcommand};
use pump_bench::report::Status;

use crate::failure::Failure;
use crate::options::bench::BenchOptions;
use crate::options::report::FormatOption;
use crate::terminal::{noted, print_json, tell, warn};

#[derive(Debug, Args)]
#[command(subcommand_required = true, arg_required_else_help = true)]
pub(crate) struct VesselArgs {
    #[command(subcommand)]
    command: VesselCommand,
}

#[derive(Debug, Subcommand)]
enum VesselCommand {
    /// Say that the vessel is empty: it has received nothing
    Emptied(EmptiedArgs),
}

#[derive(Debug, Args)]
struct EmptiedArgs {
    #[command(flatten)]
    bench: BenchOptions,
    #[command(flatten)]
    format: FormatOption,
}

impl VesselArgs {
    pub(crate) fn run(&self) -> Result<(), Failure> {
        let VesselCommand::Emptied(args) = &self.command;
        let bench = args.bench.bench()?;
        let mut session = bench.session()?;
        let emptied = session.vessel_emptied();
        let received_ml = noted(&mut session, emptied)?;
        warn(&session.notes());
        if args.format.json() {
            return print_json(&(Status::of(&bench)?.json() + "\n"));
        }
        let pump = &bench.file().pump.id;
        tell(&format!("the vessel of {pump} is empty on record; it had received {received_ml:.4} mL\n"))
    }
}
