//! `dose safety clear`: a person lets a pump go on that stands.

use clap::Args;
use pump_bench::Bench;
use pump_bench::report::Status;
use pump_bench::safety::SafetyLimit;

use crate::failure::Failure;
use crate::options::motor::DriverOption;
use crate::options::pump::{ConfigOption, RecordOption};
use crate::options::report::FormatOption;
use crate::terminal::{noted, print_json, tell, warn};
use crate::user_name::user_name;

#[derive(Debug, Args)]
pub(crate) struct ClearArgs {
    /// Pump to clear, by its name: a name of the configuration, a built-in pump or a pump file
    #[arg(value_name = "NAME")]
    name: String,
    /// Reason why the pump may go on; it is kept on record
    #[arg(long, value_name = "TEXT", required = true)]
    reason: String,
    /// Name of whoever clears it, kept behind the reason; the login name without it
    #[arg(long, value_name = "NAME")]
    by: Option<String>,
    #[command(flatten)]
    config: ConfigOption,
    #[command(flatten)]
    record: RecordOption,
    #[command(flatten)]
    driver: DriverOption,
    /// Clear the pump by the record of this computer, also while `dose serve` has it
    #[arg(long, hide_short_help = true)]
    no_service: bool,
    #[command(flatten)]
    format: FormatOption,
}

impl ClearArgs {
    pub(crate) fn run(&self) -> Result<(), Failure> {
        if self.reason.trim().is_empty() {
            return Err(Failure::refused("--reason is empty; say why the pump may go on").value("\"\""));
        }
        if self.by.as_ref().is_some_and(|by| by.trim().is_empty()) {
            return Err(Failure::refused("--by is empty; say who clears the pump").value("\"\""));
        }
        let by = self.by.as_ref().map_or_else(user_name, |by| Some(by.trim().to_owned()));
        let Some(by) = by else {
            return Err(Failure::refused("nobody knows your login name; say with --by who clears the pump"));
        };
        let config = self.config.config()?;
        let file = config.pump(&self.name).map_err(Failure::of)?;
        let bench = Bench::new(file, self.driver.driver, &self.record.folder(&config)?)?;
        let mut session = bench.session()?;
        let cleared = session.clear_safety(&format!("{} (by {by})", self.reason.trim()));
        let cleared = noted(&mut session, cleared)?;
        warn(&session.notes());
        if self.format.json() {
            return print_json(&(Status::of(&bench)?.json() + "\n"));
        }
        let pump = &bench.file().pump.id;
        let forgotten = match cleared.stand.limit {
            SafetyLimit::Day if cleared.forgotten_ml > 0.0 => {
                format!("the {:.4} mL of the last 24 h count no more\n", cleared.forgotten_ml)
            }
            _ => String::new(),
        };
        let full = match cleared.stand.limit {
            SafetyLimit::Vessel if cleared.vessel_ml > 0.0 => format!(
                "the vessel has received {:.4} mL since it was emptied; once it is empty, run `dose vessel emptied`\n",
                cleared.vessel_ml
            ),
            _ => String::new(),
        };
        tell(&format!(
            "{pump} may go on, and your reason is on record; it stood because {}\n{forgotten}{full}",
            cleared.stand
        ))
    }
}
