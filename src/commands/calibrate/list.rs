//! `dose calibrate list`: the calibrations of a pump.

use clap::Args;
use pump_bench::report::{calibrations_json, calibrations_text};

use crate::advice;
use crate::failure::Failure;
use crate::options::bench::RecordOptions;
use crate::options::report::FormatOption;
use crate::terminal::{print_json, tell};

#[derive(Debug, Args)]
pub(super) struct ListArgs {
    #[command(flatten)]
    record: RecordOptions,
    #[command(flatten)]
    format: FormatOption,
}

impl ListArgs {
    pub(super) fn run(&self) -> Result<(), Failure> {
        let bench = self.record.bench()?;
        let calibrations = bench.calibrations();
        let (all, active) = (calibrations.list()?, calibrations.active_version()?);
        if self.format.json() {
            print_json(&calibrations_json(&all, active))
        } else {
            tell(&calibrations_text(&bench, &all, active, advice::words))
        }
    }
}
