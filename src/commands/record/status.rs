//! `dose status`: what is on record.

use std::path::Path;

use clap::Args;
use pump_bench::Bench;
use pump_bench::config::Config;
use pump_bench::rack::RackFile;
use pump_bench::report::{Explain, Status, StatusRow};

use crate::advice;
use crate::failure::Failure;
use crate::options::bench::RecordOptions;
use crate::options::limits::TubeLimit;
use crate::options::motor::PortOption;
use crate::options::report::FormatOption;
use crate::terminal::{print_json, tell};
use crate::told_commands::{completed, meaning, setup_that_was_left, shell_word};

#[derive(Debug, Args)]
pub(crate) struct StatusArgs {
    #[command(flatten)]
    record: RecordOptions,
    /// Say it of every pump that the configuration names, a row each
    #[arg(long, conflicts_with_all = ["port", "tube_limit"])]
    all: bool,
    /// Say it of every pump of a rack, a row each
    #[arg(long, value_name = "RACK", conflicts_with_all = ["all", "port", "tube_limit"])]
    rack: Option<String>,
    #[command(flatten)]
    port: PortOption,
    #[command(flatten)]
    tube_limit: TubeLimit,
    /// Read the record of this computer, also where the configuration names a service by its url
    #[arg(long, hide_short_help = true)]
    no_service: bool,
    #[command(flatten)]
    format: FormatOption,
}

impl StatusArgs {
    pub(crate) fn run(&self) -> Result<(), Failure> {
        if self.all {
            return self.tell_all();
        }
        if let Some(name) = &self.rack {
            return self.tell_rack(name);
        }
        let mut file = self.record.pump.file()?;
        self.tube_limit.change(&mut file);
        let status = Status::of(&self.record.bench_of(file, Some(&self.port))?)?;
        if self.format.json() {
            print_json(&(status.json() + "\n"))
        } else {
            let left = setup_that_was_left(&status.pump).map_or(String::new(), |left| left + "\n");
            tell(&format!("{}{left}", status.text(advice::words)))
        }
    }

    /// Tells a row of each pump.
    fn tell_all(&self) -> Result<(), Failure> {
        self.tell_rows(&rows_of_all(&self.record)?)
    }

    /// Tells a row of each pump of a rack.
    fn tell_rack(&self, name: &str) -> Result<(), Failure> {
        let config = self.record.pump.config()?;
        let path = config.find_rack(name).map_err(Failure::of)?;
        let rack = RackFile::read(&path).map_err(Failure::of)?;
        let state_dir = self.record.folder()?;
        let named = rack.pump_names().zip(rack.pump_places());
        let rows = named.map(|(name, place)| NamedRow::read(name, place, &config, &self.record, &state_dir));
        self.tell_rows(&rows.collect::<Vec<_>>())
    }

    fn tell_rows(&self, rows: &[NamedRow]) -> Result<(), Failure> {
        let told = tell_rows(rows, self.format.json(), StatusRow::text);
        let is_left = |status: &Status| status.unfinished.is_some() && status.in_use_by.is_none();
        let left = rows.iter().filter(|named| named.row.status.as_ref().is_some_and(is_left));
        let ways = left.map(|NamedRow { place, row }| {
            let pump = shell_word(place);
            format!(
                "{}: `dose resume --pump {pump}` makes the rest, `dose accept --pump {pump}` leaves it\n",
                row.name
            )
        });
        if !self.format.json() {
            tell(&ways.collect::<String>())?;
        }
        told
    }
}

/// The record of one of several pumps.
pub(crate) struct NamedRow {
    /// Pump as a user types it.
    place: String,
    row: StatusRow,
}

impl NamedRow {
    /// Reads the record of a pump. One that cannot be read has a row too, and hides none of the others.
    fn read(name: &str, place: String, config: &Config, record: &RecordOptions, state_dir: &Path) -> Self {
        let status = || {
            let file = config.pump(&place).map_err(|error| error.told(advice::words))?;
            let bench = Bench::new(file, record.driver(), state_dir);
            bench.and_then(|bench| Status::of(&bench)).map_err(|error| error.told(advice::words))
        };
        let status = status().map_err(|error| meaning(&place, || completed(&error).into_owned()));
        Self { row: StatusRow::new(name, status), place }
    }
}

/// The record of each pump that the configuration names.
pub(crate) fn rows_of_all(record: &RecordOptions) -> Result<Vec<NamedRow>, Failure> {
    let config = record.pump.config()?;
    if config.pumps().is_empty() {
        return Err(Failure::refused(
            "the configuration names no pumps; name them in [pumps] of the file that `dose config path` prints",
        ));
    }
    let state_dir = record.folder()?;
    let names = config.pumps().keys();
    Ok(names.map(|name| NamedRow::read(name, name.clone(), &config, record, &state_dir)).collect())
}

/// Tells rows, in words that are padded to a width, and then fails if a pump cannot be read.
pub(crate) fn tell_rows(
    rows: &[NamedRow],
    json: bool,
    text: impl Fn(&StatusRow, usize) -> String,
) -> Result<(), Failure> {
    if json {
        print_json(&rows.iter().map(|named| named.row.json() + "\n").collect::<String>())?;
    } else {
        let width = rows.iter().map(|named| named.row.name.chars().count()).max().unwrap_or(0);
        let line = |NamedRow { place, row }: &NamedRow| {
            meaning(place, || completed(&text(row, width)).into_owned()) + "\n"
        };
        tell(&rows.iter().map(line).collect::<String>())?;
    }
    let unread = rows.iter().map(|named| &named.row).filter(|row| row.error.is_some());
    let unread: Vec<&str> = unread.map(|row| row.name.as_str()).collect();
    if unread.is_empty() {
        return Ok(());
    }
    Err(Failure::refused(format!(
        "{} of {} pumps cannot be read: {}",
        unread.len(),
        rows.len(),
        unread.join(", ")
    )))
}
