//! The files that a command writes.

use std::path::{Path, PathBuf, absolute};

use clap::Args;
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

/// Refuses standard output as a file, and two outputs in one file.
pub(crate) fn differ(paths: &[Option<&Path>]) -> Result<(), Failure> {
    let paths: Vec<&Path> = paths.iter().copied().flatten().collect();
    for (n, path) in paths.iter().enumerate() {
        if path.as_os_str() == "-" {
            return Err(Failure::refused("`-` is no file; standard output carries the report"));
        }
        let place = |path: &Path| absolute(path).unwrap_or_else(|_| path.to_owned());
        if paths[..n].iter().any(|other| place(other) == place(path)) {
            let path = path.display();
            return Err(Failure::refused(format!("{path} is named for two outputs; give each its own file")));
        }
    }
    Ok(())
}
