//! `dose pumps show`: a pump as a pump file, or as constants for firmware.

use clap::Args;
use pump_bench::export::rust_source;

use crate::advice;
use crate::failure::Failure;
use crate::options::pump::ConfigOption;
use crate::terminal::print;

#[derive(Debug, Args)]
pub(crate) struct ShowArgs {
    /// Built-in pump or pump file
    name: String,
    /// Constants for firmware (rust) in place of a pump file
    #[arg(long, value_name = "rust", help_heading = "Output", value_parser = is_rust)]
    format: Option<()>,
    #[command(flatten)]
    config: ConfigOption,
}

/// Reads the one format besides a pump file.
fn is_rust(word: &str) -> Result<(), &'static str> {
    match word {
        "rust" => Ok(()),
        _ => Err("`dose pumps show` prints a pump file (TOML), or Rust with `--format rust`"),
    }
}

impl ShowArgs {
    pub(super) fn run(&self) -> Result<(), Failure> {
        let file = self.config.config()?.pump(&self.name).map_err(Failure::of)?;
        match self.format {
            None => print(&file.to_toml()),
            Some(()) => print(&rust_source(&file, advice::words).map_err(Failure::of)?),
        }
    }
}
