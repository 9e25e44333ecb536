//! `dose man-pages`: the manual for whoever packages the command.

use std::fs;
use std::path::PathBuf;

use clap::Args;

use crate::failure::Failure;

#[derive(Debug, Args)]
pub(crate) struct ManPagesArgs {
    /// Folder to write dose.1 and a page of each subcommand into
    #[arg(value_name = "FOLDER")]
    folder: PathBuf,
}

impl ManPagesArgs {
    /// Writes the pages of `command`.
    pub(crate) fn run(&self, command: clap::Command) -> Result<(), Failure> {
        fs::create_dir_all(&self.folder)
            .and_then(|()| clap_mangen::generate_to(command, &self.folder))
            .map_err(|error| Failure::unwritten(&self.folder, &error))
    }
}
