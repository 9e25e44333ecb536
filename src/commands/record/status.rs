//! `dose status`: what is on record.

use clap::Args;
use pump_bench::rack::RackFile;
use pump_bench::report::{Explain, Status, StatusRow};
use pump_bench::{Bench, PumpFile};

use crate::advice;
use crate::failure::Failure;
use crate::options::bench::RecordOptions;
use crate::options::limits::TubeLimit;
use crate::options::motor::PortOption;
use crate::options::report::FormatOption;
use crate::terminal::{print_json, tell};

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
            tell(&status.text(advice::words))
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
        let (files, state_dir) = (rack.pump_files(&config).map_err(Failure::of)?, self.record.folder()?);
        let row = |(name, file): (&str, PumpFile)| {
            let bench = Bench::new(file, self.record.driver(), &state_dir);
            let status = bench.and_then(|bench| Status::of(&bench));
            StatusRow::new(name, status.map_err(|error| error.told(advice::words)))
        };
        self.tell_rows(&rack.pump_names().zip(files).map(row).collect::<Vec<_>>())
    }

    fn tell_rows(&self, rows: &[StatusRow]) -> Result<(), Failure> {
        tell_rows(rows, self.format.json(), StatusRow::text)
    }
}

/// The record of each pump that the configuration names. A pump that cannot be read has a row too, and hides none of
/// the others.
pub(crate) fn rows_of_all(record: &RecordOptions) -> Result<Vec<StatusRow>, Failure> {
    let config = record.pump.config()?;
    if config.pumps().is_empty() {
        return Err(Failure::refused(
            "the configuration names no pumps; name them in [pumps] of the file that `dose config path` prints",
        ));
    }
    let state_dir = record.folder()?;
    let read = |name: &str| {
        let file = config.pump(name).map_err(|error| error.told(advice::words))?;
        let bench = Bench::new(file, record.driver(), &state_dir);
        bench.and_then(|bench| Status::of(&bench)).map_err(|error| error.told(advice::words))
    };
    Ok(config.pumps().keys().map(|name| StatusRow::new(name, read(name))).collect())
}

/// Tells rows, in words that are padded to a width, and then fails if a pump cannot be read.
pub(crate) fn tell_rows(
    rows: &[StatusRow],
    json: bool,
    text: impl Fn(&StatusRow, usize) -> String,
) -> Result<(), Failure> {
    if json {
        print_json(&rows.iter().map(|row| row.json() + "\n").collect::<String>())?;
    } else {
        let width = rows.iter().map(|row| row.name.chars().count()).max().unwrap_or(0);
        tell(&rows.iter().map(|row| text(row, width) + "\n").collect::<String>())?;
    }
    let unread: Vec<&str> =
        rows.iter().filter(|row| row.error.is_some()).map(|row| row.name.as_str()).collect();
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
