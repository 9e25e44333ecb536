//! `dose status`: what is on record.

use clap::Args;
use pump_bench::report::Status;

use crate::advice;
use crate::failure::Failure;
use crate::options::bench::RecordOptions;
use crate::options::limits::TubeLimit;
use crate::options::motor::PortOption;
use crate::options::report::FormatOption;
use crate::terminal::{print, tell};

#[derive(Debug, Args)]
pub(crate) struct StatusArgs {
    #[command(flatten)]
    record: RecordOptions,
    #[command(flatten)]
    port: PortOption,
    #[command(flatten)]
    tube_limit: TubeLimit,
    #[command(flatten)]
    format: FormatOption,
}

impl StatusArgs {
    pub(crate) fn run(&self) -> Result<(), Failure> {
        let mut file = self.record.pump.file()?;
        self.tube_limit.change(&mut file);
        let status = Status::of(&self.record.bench_of(file, Some(&self.port))?)?;
        if self.format.json() { print(&(status.json() + "\n")) } else { tell(&status.text(advice::words)) }
    }
}
