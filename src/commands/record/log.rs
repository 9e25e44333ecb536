//! `dose log`: every dose that is on record.

use std::io::{self, BufWriter, ErrorKind, Write};

use clap::{Args, ValueEnum};
use pump_bench::Bench;
use pump_bench::record::{Clock, LogEntry, LogLine, SystemClock, moment};
use pump_bench::report::{LOG_CSV_HEADER, LogTotals, log_csv, log_json, log_text};

use crate::failure::Failure;
use crate::options::bench::RecordOptions;
use crate::shown::shown;
use crate::terminal::say;

#[derive(Debug, Args)]
pub(crate) struct LogArgs {
    #[command(flatten)]
    record: RecordOptions,
    /// List doses that began then or later: 90min, 12h, 2d, 1w ago, 2026-11-23, "2026-11-23 08:00"
    #[arg(long, value_name = "TIME")]
    since: Option<String>,
    /// List doses that began before then, written as for --since
    #[arg(long, value_name = "TIME")]
    until: Option<String>,
    /// Print only the totals by day and by tube
    #[arg(long)]
    totals: bool,
    /// List for people, spreadsheets or programs [default: text]
    #[arg(
        long,
        value_name = "text|csv|json",
        value_enum,
        hide_possible_values = true,
        help_heading = "Output"
    )]
    format: Option<LogFormat>,
}

/// Format of the list.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
enum LogFormat {
    /// Lines for people, and totals.
    #[default]
    Text,
    /// A table with a header.
    Csv,
    /// A JSON object a dose.
    Json,
}

/// Doses that began within these times, in seconds since 1970.
struct Span {
    since: u64,
    until: u64,
}

impl LogArgs {
    pub(crate) fn run(&self) -> Result<(), Failure> {
        let now = SystemClock::default().now();
        let read = |text: &Option<String>| {
            text.as_deref().map(|text| moment(text, now)).transpose().map_err(Failure::of)
        };
        let (since, until) = (read(&self.since)?.unwrap_or(0), read(&self.until)?.unwrap_or(u64::MAX));
        let bench = self.record.bench()?;
        let lines = bench.log().map_err(Failure::of)?;
        let mut out = Listing::new(&bench, self.format.unwrap_or_default(), self.totals);
        let mut to = BufWriter::new(io::stdout().lock());
        let mut listed = out.begin(&mut to);
        for line in lines {
            if listed.is_err() {
                break;
            }
            match line.map_err(Failure::of)? {
                LogLine::Dose(entry) => listed = out.dose(&mut to, &entry, &Span { since, until }),
                LogLine::Damaged { line, message } => {
                    say(&format!("warning: line {line} of the log is damaged and left out: {message}\n"));
                }
                _ => {}
            }
        }
        if let Some(told) = out.left_out() {
            say(&told);
        }
        match listed.and_then(|()| out.end(&mut to)).and_then(|()| to.flush()) {
            Err(error) if error.kind() != ErrorKind::BrokenPipe => {
                let refused = Failure::refused(format!("the log could not be printed: {error}"));
                Err(refused.kind(pump_bench::report::ErrorKind::Output))
            }
            _ => Ok(()),
        }
    }
}

/// The list under way. It keeps the totals and the time of the last dose, and no doses.
struct Listing<'a> {
    bench: &'a Bench,
    format: LogFormat,
    only_totals: bool,
    totals: LogTotals,
    /// Time of the dose before, in seconds since 1970.
    before: u64,
    /// Latest time of a dose, in seconds since 1970.
    latest: u64,
    listed: u64,
    /// Number of doses that are left out since their time is before the span, though they came after a dose within it.
    behind: u64,
}

impl<'a> Listing<'a> {
    fn new(bench: &'a Bench, format: LogFormat, only_totals: bool) -> Self {
        let totals = LogTotals::default();
        Self { bench, format, only_totals, totals, before: 0, latest: 0, listed: 0, behind: 0 }
    }

    fn begin(&self, to: &mut dyn Write) -> io::Result<()> {
        if self.format == LogFormat::Csv && !self.only_totals {
            writeln!(to, "{LOG_CSV_HEADER}")
        } else {
            Ok(())
        }
    }

    fn dose(&mut self, to: &mut dyn Write, entry: &LogEntry, span: &Span) -> io::Result<()> {
        let unix_s = entry.time.unix_s;
        let went_back = unix_s < std::mem::replace(&mut self.before, unix_s);
        self.latest = self.latest.max(unix_s);
        if !(span.since..span.until).contains(&unix_s) {
            // A dose after one of the span belongs to it by its place in the record.
            self.behind += u64::from(unix_s < span.since && self.latest >= span.since);
            return Ok(());
        }
        self.totals.add(entry, went_back);
        self.listed += 1;
        if self.only_totals {
            return Ok(());
        }
        let (pump, driver) = (self.bench.file().pump.id.as_str(), self.bench.drive_id());
        match self.format {
            LogFormat::Text => {
                writeln!(to, "{}", shown(&log_text(entry, went_back)))
            }
            LogFormat::Csv => writeln!(to, "{}", log_csv(pump, driver, entry, went_back)),
            LogFormat::Json => writeln!(to, "{}", log_json(pump, driver, entry, went_back)),
        }
    }

    /// The warning of doses that are left out though they were made within the span; none if there are none.
    fn left_out(&self) -> Option<String> {
        let were = match self.behind {
            0 => return None,
            1 => "1 dose is left out: its time is".to_owned(),
            count => format!("{count} doses are left out: their times are"),
        };
        Some(format!(
            "warning: {were} before --since, since the clock had gone back; without --since every dose is listed\n"
        ))
    }

    fn end(&self, to: &mut dyn Write) -> io::Result<()> {
        let text = match self.format {
            LogFormat::Text if self.listed == 0 => {
                format!(
                    "no dose of {} is in the log of the drive {}\n",
                    self.bench.file().pump.id,
                    self.bench.drive_id()
                )
            }
            LogFormat::Text => self.totals.text(),
            LogFormat::Csv if self.only_totals => self.totals.csv(),
            LogFormat::Json if self.only_totals => {
                self.totals.json(&self.bench.file().pump.id, self.bench.drive_id())
            }
            LogFormat::Csv | LogFormat::Json => String::new(),
        };
        to.write_all(text.as_bytes())?;
        let unfinished = self.bench.story().ok().and_then(|story| story.cut_off);
        if self.format == LogFormat::Text && unfinished.is_some() {
            writeln!(
                to,
                "a motion is under way or was cut off; its dose is in the log once the next command has met it"
            )?;
        }
        Ok(())
    }
}
