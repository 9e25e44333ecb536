//! `dose pumps remove NAME`: a pump of the configuration is given up.

use std::fmt::Write;

use clap::Args;
use pump_bench::Bench;
use pump_bench::config::Config;
use pump_bench::report::{ErrorKind, Status};
use pump_bench::setup::{SetupError, SetupFolder};

use crate::failure::Failure;
use crate::options::pump::{ConfigOption, RecordOption};
use crate::terminal::tell;

#[derive(Debug, Args)]
pub(crate) struct RemoveArgs {
    /// Name of the pump in the configuration
    #[arg(value_name = "NAME")]
    name: String,
    /// Remove it even if it is the default pump, or a dose of it is unfinished
    #[arg(long)]
    anyway: bool,
    #[command(flatten)]
    config: ConfigOption,
    #[command(flatten)]
    record: RecordOption,
}

impl RemoveArgs {
    pub(super) fn run(&self) -> Result<(), Failure> {
        let (name, config) = (&self.name, self.config.config()?);
        let path = self.config.path().ok_or(SetupError::NoPlace)?;
        self.refuse_unknown(&config)?;
        let is_default = config.default_pump() == *name;
        if is_default && !self.anyway {
            return Err(Failure::refused(format!(
                "`{name}` is the default pump of {}; name another in default_pump, or remove it with --anyway",
                path.display()
            ))
            .kind(ErrorKind::Config)
            .value(name));
        }
        let state_dir = self.record.folder(&config)?;
        let mut held = None;
        let mut text = String::new();
        let bench =
            config.pump(name).map_err(Failure::of).and_then(|file| Ok(Bench::new(file, None, &state_dir)?));
        let records = match &bench {
            Ok(bench) => {
                self.refuse_unfinished(bench)?;
                if bench.folder().path().exists() {
                    // Nobody may begin a dose while the file goes.
                    held = Some(bench.folder().lock()?);
                }
                state_dir.join(&bench.file().pump.id)
            }
            Err(_) if self.anyway => state_dir.join(name),
            Err(failure) => {
                return Err(Failure::refused(format!(
                    "nobody can tell whether a dose of `{name}` is unfinished, since its pump file cannot be used: {}; \
                     mend it, or remove the pump with --anyway",
                    failure.message()
                ))
                .kind(ErrorKind::PumpFile));
            }
        };
        let removed = SetupFolder::of(&path).remove_pump(name, records.exists())?;
        drop(held);
        let file = removed.file.display();
        let _ = writeln!(text, "`{name}` is no pump of {} any more", path.display());
        let _ = match removed.deleted {
            true => writeln!(text, "{file} is deleted"),
            false => writeln!(text, "{file} stays: delete it if nobody needs it"),
        };
        if records.exists() {
            let _ = writeln!(text, "the record of its doses and calibrations stays in {}", records.display());
        }
        if removed.answers.is_some() {
            let _ =
                writeln!(text, "`dose setup {name}` writes the pump file again, from the answers on record");
        }
        if is_default {
            let usual = Config::of_user(Some(&path)).map(|config| config.default_pump().to_owned());
            let _ = writeln!(text, "a bare `dose` takes {} now", usual.map_err(Failure::of)?);
        }
        tell(&text)
    }

    fn refuse_unknown(&self, config: &Config) -> Result<(), Failure> {
        if config.pumps().contains_key(&self.name) {
            return Ok(());
        }
        let names: Vec<&str> = config.pumps().keys().map(String::as_str).collect();
        let names = if names.is_empty() { "none".to_owned() } else { names.join(", ") };
        Err(Failure::refused(format!("the configuration has no pump `{}`; its pumps: {names}", self.name))
            .kind(ErrorKind::Config)
            .value(&self.name)
            .allowed(names))
    }

    /// Refuses a pump with an unfinished dose: without its file nobody can resume it.
    fn refuse_unfinished(&self, bench: &Bench) -> Result<(), Failure> {
        let name = &self.name;
        if self.anyway || Status::of(bench)?.unfinished.is_none() {
            return Ok(());
        }
        Err(Failure::refused(format!(
            "a dose of `{name}` is unfinished; `dose resume --pump {name}` finishes it, `dose accept --pump {name}` \
             accepts it, or remove the pump with --anyway"
        ))
        .kind(ErrorKind::Unfinished)
        .value(name))
    }
}
