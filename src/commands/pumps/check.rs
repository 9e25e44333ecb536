//! `dose pumps check`: a pump file is checked.

use std::path::PathBuf;

use clap::Args;
use pump_bench::built_in;
use pump_bench::pump_file::PumpFile;
use pump_bench::report::pump_check;

use crate::failure::Failure;
use crate::terminal::tell;

#[derive(Debug, Args)]
pub(crate) struct CheckArgs {
    /// Pump file (TOML)
    file: PathBuf,
}

impl CheckArgs {
    pub(super) fn run(&self) -> Result<(), Failure> {
        let file = &self.file;
        if !file.exists() && file.to_str().is_some_and(|name| built_in(name).is_some()) {
            let name = file.display();
            return Err(Failure::refused(format!(
                "{name} is built in; `dose pumps show {name}` prints its file"
            )));
        }
        let origin = file.display().to_string();
        let file = PumpFile::read(file).map_err(Failure::of)?;
        file.check_port(&origin).map_err(Failure::of)?;
        tell(&pump_check(&file).map_err(Failure::of)?)
    }
}
