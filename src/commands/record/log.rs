//! `dose log`: every dose that is on record.

use std::collections::VecDeque;
use std::io::{self, BufWriter, ErrorKind, Write};

use clap::{Args, ValueEnum};
use pump_bench::Bench;
use pump_bench::record::{Clock, LogEntry, LogLine, SystemClock, moment};
use pump_bench::report::{LOG_CSV_HEADER, LogPlace, LogSpan, LogTotals, log_csv, log_json, log_text};

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
    /// List only the last N of these doses; the totals count all of them
    #[arg(
        short = 'n',
        long,
        value_name = "N",
        value_parser = clap::value_parser!(u32).range(1..),
        conflicts_with = "totals"
    )]
    last: Option<u32>,
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

impl LogArgs {
    pub(crate) fn run(&self) -> Result<(), Failure> {
        let now = SystemClock::default().now();
        // A minus of the command line passes the parser as U+2212.
        let read = |text: &Option<String>| {
            let text = text.as_deref().map(|text| text.replace('\u{2212}', "-"));
            text.map(|text| moment(&text, now)).transpose().map_err(Failure::of)
        };
        let (since, until) = (read(&self.since)?.unwrap_or(0), read(&self.until)?.unwrap_or(u64::MAX));
        if let Some((from, to)) = self.since.as_ref().zip(self.until.as_ref()).filter(|_| until <= since) {
            let message = format!(
                "--until {to} is not after --since {from}, so that no dose lies between; exchange the two, or give a \
                 later --until"
            );
            return Err(Failure::refused(message).value(to));
        }
        let bench = self.record.bench()?;
        let lines = bench.log().map_err(Failure::of)?;
        let span = LogSpan::new(since, until, now.unix_s);
        let mut out = Listing::new(&bench, self.format.unwrap_or_default(), self.totals, span);
        out.most = self.last.map(|last| usize::try_from(last).unwrap_or(usize::MAX));
        let mut to = BufWriter::new(io::stdout().lock());
        let mut listed = out.begin(&mut to);
        for line in lines {
            if listed.is_err() {
                break;
            }
            match line.map_err(Failure::of)? {
                LogLine::Dose(entry) => listed = out.dose(&mut to, &entry),
                LogLine::Damaged { line, message } => {
                    say(&format!("warning: line {line} of the log is damaged and left out: {message}\n"));
                }
                _ => {}
            }
        }
        if let Some(left_out) = out.span.left_out() {
            say(&format!("warning: {}\n", left_out.told("--since")));
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

/// The list under way. It keeps the totals, and no doses but the last ones that were asked for.
struct Listing<'a> {
    bench: &'a Bench,
    format: LogFormat,
    only_totals: bool,
    totals: LogTotals,
    /// The span of the doses that are listed.
    span: LogSpan,
    listed: u64,
    /// Number of doses that are listed at most. `None` for all.
    most: Option<usize>,
    /// Lines of the last doses, if only some are listed.
    last: VecDeque<String>,
    /// Number of doses in the log, those outside the span among them.
    logged: u64,
}

impl<'a> Listing<'a> {
    fn new(bench: &'a Bench, format: LogFormat, only_totals: bool, span: LogSpan) -> Self {
        Self {
            bench,
            format,
            only_totals,
            totals: LogTotals::default(),
            span,
            listed: 0,
            most: None,
            last: VecDeque::new(),
            logged: 0,
        }
    }

    fn begin(&self, to: &mut dyn Write) -> io::Result<()> {
        if self.format == LogFormat::Csv && !self.only_totals {
            writeln!(to, "{LOG_CSV_HEADER}")
        } else {
            Ok(())
        }
    }

    fn dose(&mut self, to: &mut dyn Write, entry: &LogEntry) -> io::Result<()> {
        self.logged += 1;
        let LogPlace { is_within, went_back, .. } = self.span.look(entry);
        if !is_within {
            return Ok(());
        }
        if self.only_totals || self.format == LogFormat::Text {
            self.totals.add(entry, went_back);
        }
        self.listed += 1;
        if self.only_totals {
            return Ok(());
        }
        let (pump, driver) = (self.bench.file().pump.id.as_str(), self.bench.drive_id());
        let line = match self.format {
            LogFormat::Text => shown(&log_text(&self.bench.file().fluid, entry, went_back)).to_string(),
            LogFormat::Csv => log_csv(pump, driver, entry, went_back),
            LogFormat::Json => log_json(pump, driver, entry, went_back),
        };
        let Some(most) = self.most else { return writeln!(to, "{line}") };
        if self.last.len() >= most {
            self.last.pop_front();
        }
        self.last.push_back(line);
        Ok(())
    }

    fn end(&self, to: &mut dyn Write) -> io::Result<()> {
        self.last.iter().try_for_each(|line| writeln!(to, "{line}"))?;
        let text = match self.format {
            LogFormat::Text if self.listed == 0 => {
                let (pump, driver) = (&self.bench.file().pump.id, self.bench.drive_id());
                match self.logged {
                    0 => format!("no dose of {pump} is in the log of the drive {driver}\n"),
                    1 => {
                        format!("no dose of {pump} in that time; the log of the drive {driver} has 1 dose\n")
                    }
                    doses => {
                        format!(
                            "no dose of {pump} in that time; the log of the drive {driver} has {doses} doses\n"
                        )
                    }
                }
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
