//! The files that a command writes.

use std::path::{Path, PathBuf};

use clap::Args;
use pump_bench::files::{is_one_file, names_in};
use pump_bench::record::is_of_record;
use pump_bench::report::ErrorKind;
use pump_bench::units;

use crate::failure::Failure;

/// The list of steps.
#[derive(Debug, Args)]
#[command(next_help_heading = "Output")]
pub(crate) struct StepsOption {
    /// Write every planned step as CSV
    #[arg(long, value_name = "FILE")]
    pub(crate) steps: Option<PathBuf>,
}

/// The waveform as a table.
#[derive(Debug, Args)]
#[command(next_help_heading = "Output")]
pub(crate) struct TraceOptions {
    /// Write the predicted waveform as CSV
    #[arg(long, value_name = "FILE")]
    pub(crate) trace: Option<PathBuf>,
    /// Time between the rows of --trace [default: 1ms]
    #[arg(long, value_name = "TIME", value_parser = units::time_s)]
    pub(crate) dt: Option<f64>,
}

/// A picture.
#[derive(Debug, Args)]
#[command(next_help_heading = "Output")]
pub(crate) struct PlotOption {
    /// Draw a picture of the result
    #[arg(long, value_name = "FILE.svg")]
    pub(crate) plot: Option<PathBuf>,
}

/// The files of a command: outputs with their options, the files that it reads, and the folder of all records.
pub(crate) struct Files<'a> {
    pub(crate) outputs: &'a [(&'static str, Option<&'a Path>)],
    pub(crate) inputs: &'a [Option<&'a Path>],
    /// The configuration file, which every command reads.
    pub(crate) config: Option<PathBuf>,
    pub(crate) state_dir: Option<PathBuf>,
}

impl Files<'_> {
    /// Refuses standard output as a file, two outputs in one file, and outputs that would replace an input or a file
    /// of a record.
    pub(crate) fn check(&self) -> Result<(), Failure> {
        let outputs: Vec<_> =
            self.outputs.iter().filter_map(|(option, path)| path.map(|path| (*option, path))).collect();
        let inputs = self.inputs.iter().copied().flatten().chain(self.config.as_deref());
        for (n, (option, path)) in outputs.iter().enumerate() {
            let refused = |why: String| {
                let message = format!("{option} {}: {why}", path.display());
                Err(Failure::refused(message).kind(ErrorKind::Output).value(path.display()))
            };
            if path.as_os_str() == "-" {
                return refused("`-` is no file; standard output carries the report".to_owned());
            }
            if outputs[..n].iter().any(|(_, other)| is_one_file(other, path)) {
                return refused("it is named for two outputs; give each its own file".to_owned());
            }
            if let Some(input) = inputs.clone().find(|input| is_one_file(input, path)) {
                let input = input.display();
                return refused(format!("{input} is read by this command; name another file"));
            }
            let Some(state_dir) = &self.state_dir else { continue };
            if is_of_record(state_dir, path) {
                return refused("it would lie in the record of a pump; name a file elsewhere".to_owned());
            }
            if let Some(name) = names_in(state_dir, path).iter().find(|name| is_of_record(state_dir, name)) {
                let name = name.display();
                return refused(format!(
                    "it is {name} of a pump's record by another name; name another file"
                ));
            }
        }
        Ok(())
    }
}
