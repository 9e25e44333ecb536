//! `dose config`: the configuration that is in force, and its place.

use clap::{Args, Subcommand};
use pump_bench::report::ShownConfig;

use crate::failure::Failure;
use crate::options::pump::{ConfigOption, RecordOption};
use crate::options::report::FormatOption;
use crate::terminal::{print, print_json, tell};

#[derive(Debug, Args)]
pub(crate) struct ConfigArgs {
    #[command(subcommand)]
    command: ConfigCommand,
}

#[derive(Debug, Subcommand)]
enum ConfigCommand {
    /// Print the path of the configuration file, whether it is there or not
    Path(ShowArgs),
    /// Say which pumps are known by name, which one is usual, and where the records are
    Show(ShowArgs),
}

#[derive(Debug, Args)]
struct ShowArgs {
    #[command(flatten)]
    config: ConfigOption,
    #[command(flatten)]
    record: RecordOption,
    #[command(flatten)]
    format: FormatOption,
}

impl ConfigArgs {
    pub(crate) fn run(&self) -> Result<(), Failure> {
        match &self.command {
            ConfigCommand::Path(args) => args.path(),
            ConfigCommand::Show(args) => args.show(),
        }
    }
}

impl ShowArgs {
    /// The path alone, so that a script can use it, and even if the file cannot.
    fn path(&self) -> Result<(), Failure> {
        if self.format.json() {
            return self.show();
        }
        match self.config.path() {
            Some(path) => print(&format!("{}\n", path.display())),
            None => Err(Failure::refused(
                "the configuration has no place: neither HOME nor XDG_CONFIG_HOME is set; name a file with --config",
            )),
        }
    }

    fn show(&self) -> Result<(), Failure> {
        let shown = ShownConfig::of(&self.config.config()?, self.record.named()?.as_deref())?;
        if self.format.json() { print_json(&(shown.json() + "\n")) } else { tell(&shown.text()) }
    }
}
