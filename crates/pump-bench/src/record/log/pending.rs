//! The doses that a journal has and the log does not.

use std::fs::File;
use std::io::{self, BufRead, BufReader, ErrorKind};
use std::path::Path;
use std::str;

use super::{LogEntry, LogPlace};
use crate::files::open_plain;
use crate::record::journal::{Entry, decode, parts};

/// Tells the entries of the journal at `path` with places after `after`, oldest first, one at a time. The older parts
/// of the journal are read as far back as they are needed. A line that nobody can read is passed over.
///
/// # Errors
///
/// The [`io::Error`] of the file system or of `tell`.
pub(crate) fn pending(
    path: &Path,
    after: LogPlace,
    mut tell: impl FnMut(LogEntry) -> io::Result<()>,
) -> io::Result<()> {
    let parts = parts(path)?;
    let is_start = |part: &&std::path::PathBuf| first_doses(part).is_ok_and(|doses| doses <= after.number);
    let from = parts.iter().rev().position(|part| is_start(&part)).map_or(0, |back| parts.len() - 1 - back);
    let mut last = after;
    for part in parts.iter().skip(from) {
        each(part, |entry| {
            // A journal begins with a copy of the last rest before it.
            if let Entry::Rest { dose: Some(dose), .. } = entry
                && dose.place() > last
            {
                last = dose.place();
                tell(dose)?;
            }
            Ok(true)
        })?;
    }
    Ok(())
}

/// Returns the number of doses at the first rest of a part. 0 where a part has none.
fn first_doses(part: &Path) -> io::Result<u64> {
    let mut first = 0;
    each(part, |entry| match entry {
        Entry::Rest { state, dose, .. } => {
            // The dose of the first rest itself is still to be told if the log lacks it.
            first = dose.map_or(state.doses, |dose| dose.number - 1);
            Ok(false)
        }
        _ => Ok(true),
    })?;
    Ok(first)
}

/// Reads the entries of a part until `read` returns false.
fn each(part: &Path, mut read: impl FnMut(Entry) -> io::Result<bool>) -> io::Result<()> {
    let mut reader = match open_plain(part, File::options().read(true)) {
        Ok(file) => BufReader::new(file),
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(()),
        Err(error) => return Err(error),
    };
    let mut bytes = Vec::new();
    loop {
        bytes.clear();
        if reader.read_until(b'\n', &mut bytes)? == 0 {
            return Ok(());
        }
        let entry = str::from_utf8(&bytes).ok().and_then(|line| decode(line.trim_end()).ok());
        if let Some(entry) = entry
            && !read(entry)?
        {
            return Ok(());
        }
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use pump_ctl::plan::Phase;
    use pump_model::Pump;

    use super::super::file::{Log, LogTail};
    use super::*;
    use crate::record::{Intent, Journal, PhaseSource, PumpState, Why};

    fn dose(number: u64) -> LogEntry {
        LogEntry::example(number, 1_000 * number)
    }

    fn fresh() -> PumpState {
        PumpState::fresh(Phase::known(0.0), PhaseSource::Home)
    }

    /// A journal that begins a new part every few doses, and has doses of the numbers 1 to 40.
    fn journal(path: &Path) {
        let (mut journal, _) = Journal::open(path, &Pump::three_roller(), fresh()).unwrap();
        journal.keep_at(2000);
        let intent: Intent = serde_json::from_value(serde_json::json!({
            "unix_s": 0, "purpose": "dose", "requested_ml": 1.0, "carry_in_ml": 0.0, "planned_ml": 1.0,
            "carry_out_ml": 0.0, "start_angle_rad": 0.0, "half_width_rad": 0.0, "steps": 1000, "step_rad": 0.001,
            "motion_s": 1.0,
        }))
        .unwrap();
        for number in 1..=40 {
            journal.append(&Entry::Intent(intent)).unwrap();
            let state = PumpState { doses: number, ..fresh() };
            let dose = Some(dose(number));
            journal
                .append(&Entry::Rest { unix_s: number, why: Why::Done, state, dose, reason: None })
                .unwrap();
        }
    }

    #[test]
    fn doses_are_found_in_every_part_of_the_journal_each_once() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("journal.jsonl");
        journal(&path);
        assert!(parts(&path).unwrap().len() > 5, "the journal is in many parts");
        for after in 0..=40 {
            let mut found = Vec::new();
            let place = LogPlace { number: after, ..LogPlace::default() };
            pending(&path, place, |dose| {
                found.push(dose.number);
                Ok(())
            })
            .unwrap();
            assert_eq!(found, (after + 1..=40).collect::<Vec<_>>(), "after {after}");
        }
    }

    #[test]
    fn a_log_that_is_cut_anywhere_is_mended_to_the_last_byte() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("journal.jsonl");
        journal(&path);
        let log = Log::new(folder.path().join("log.jsonl"));
        let mend = |log: &Log| {
            let mut tail = log.tail().unwrap();
            let after = tail.place;
            let append = |dose| {
                tail = log.append(tail, &dose).unwrap();
                Ok(())
            };
            pending(&path, after, append).unwrap();
            fs::read(log.path()).unwrap()
        };
        let whole = mend(&log);
        assert_eq!(log.tail().unwrap().place.number, 40);
        let seven = whole.iter().enumerate().filter(|(_, byte)| **byte == b'\n').nth(6).unwrap().0 + 1;
        for length in (0..whole.len()).step_by(97) {
            for rest in [&b""[..], &[0; 300], b"{\"crc32\":\"00000000\",\"entry\":{}}\n"] {
                fs::write(log.path(), [&whole[..length], rest].concat()).unwrap();
                assert_eq!(mend(&log), whole, "{length}");
            }
        }
        // A damaged line in the midst is told, and nothing is copied twice.
        let mut damaged = whole.clone();
        damaged[seven + 40] ^= 1;
        fs::write(log.path(), &damaged).unwrap();
        assert_eq!(mend(&log), damaged);
        let lines: Vec<_> = log.lines().unwrap().map(Result::unwrap).collect();
        assert!(matches!(lines[7], super::super::LogLine::Damaged { line: 8, .. }) && lines.len() == 40);
        // Nothing is appended a second time.
        let tail = log.tail().unwrap();
        assert_eq!(log.append(tail, &dose(40)).unwrap(), tail);
        assert_eq!(log.append(LogTail::default(), &dose(0)).unwrap(), LogTail::default());
    }
}
