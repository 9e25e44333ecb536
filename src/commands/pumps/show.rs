//! `dose pumps show`: a pump as a pump file, or as constants for firmware.

use std::path::{Path, PathBuf};

use clap::Args;
use pump_bench::export::{rust_source, section_svg};
use pump_bench::pump_file::PumpFile;
use pump_bench::report::ErrorKind;

use crate::advice;
use crate::failure::Failure;
use crate::options::files::Files;
use crate::options::pump::{ConfigOption, ForeignRecord};
use crate::outputs::Outputs;
use crate::terminal::print;

#[derive(Debug, Args)]
pub(crate) struct ShowArgs {
    /// Built-in pump or pump file
    name: String,
    /// Constants for firmware (rust) in place of a pump file
    #[arg(long, value_name = "rust", help_heading = "Output", value_parser = is_rust)]
    format: Option<()>,
    /// Draw the section through the head, with its dimensions by the names of the options of `dose pumps new`
    #[arg(long, value_name = "FILE.svg", help_heading = "Output")]
    plot: Option<PathBuf>,
    #[command(flatten)]
    config: ConfigOption,
    #[command(flatten)]
    record: ForeignRecord,
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
        let config = self.config.config()?;
        let outputs = [("--plot", self.plot.as_deref())];
        let pump = config.find(&self.name).map_err(Failure::of)?;
        let state_dir = self.record.folder(&config);
        Files { outputs: &outputs, inputs: &[pump.file()], config: self.config.path(), state_dir }.check()?;
        let file = config.pump(&self.name).map_err(Failure::of)?;
        if let Some(path) = &self.plot {
            let mut outputs = Outputs::default();
            draw_section(&mut outputs, path, &file)?;
            outputs.put()?;
        }
        match self.format {
            None => print(&file.to_toml()),
            Some(()) => print(&rust_source(&file, advice::words).map_err(Failure::of)?),
        }
    }
}

/// Draws the section through the head of a pump.
pub(super) fn draw_section(outputs: &mut Outputs, path: &Path, file: &PumpFile) -> Result<(), Failure> {
    let pump = file.model().map_err(Failure::of)?;
    if !pump.geometry().is_known() {
        let id = &file.pump.id;
        let refused = format!(
            "--plot: {id} is a bought head, known by its volume alone; there are no dimensions to draw"
        );
        return Err(Failure::refused(refused)
            .kind(ErrorKind::PumpFile)
            .value(id)
            .allowed("a pump from a drawing"));
    }
    outputs.drawing(path, Ok(section_svg(&file.pump.id, pump.geometry())))
}
