//! `dose safety stand`: a person or a program puts a pump to stand.

use clap::Args;
use pump_bench::Bench;
use pump_bench::report::Status;

use crate::failure::Failure;
use crate::options::motor::DriverOption;
use crate::options::pump::{ConfigOption, RecordOption};
use crate::options::report::FormatOption;
use crate::terminal::{noted, print_json, tell, warn};

#[derive(Debug, Args)]
pub(crate) struct StandArgs {
    /// Pump to put to stand, by its name: a name of the configuration, a built-in pump or a pump file
    #[arg(value_name = "NAME")]
    name: String,
    /// Reason why the pump stands; it is kept on record, and every refusal shows it
    #[arg(long, value_name = "TEXT", required = true)]
    reason: String,
    #[command(flatten)]
    config: ConfigOption,
    #[command(flatten)]
    record: RecordOption,
    #[command(flatten)]
    driver: DriverOption,
    /// Put the pump to stand by the record of this computer, also where the configuration names a service by its url
    #[arg(long, hide_short_help = true)]
    no_service: bool,
    #[command(flatten)]
    format: FormatOption,
}

impl StandArgs {
    pub(crate) fn run(&self) -> Result<(), Failure> {
        if self.reason.trim().is_empty() {
            return Err(Failure::refused("--reason is empty; say why the pump stands").value("\"\""));
        }
        let config = self.config.config()?;
        let file = config.pump(&self.name).map_err(Failure::of)?;
        let bench = Bench::new(file, self.driver.driver, &self.record.folder(&config)?)?;
        let mut session = bench.session()?;
        let stand = session.stand(&self.reason);
        let stand = noted(&mut session, stand)?;
        warn(&session.notes());
        if self.format.json() {
            return print_json(&(Status::of(&bench)?.json() + "\n"));
        }
        let name = &self.name;
        tell(&format!(
            "{} stands, and your reason is on record: {stand}\nit moves again after `dose safety clear {name} --reason \
             <TEXT>`\n",
            bench.file().pump.id
        ))
    }
}
