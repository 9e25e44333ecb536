//! The end of a journal's file, line by line.

use std::str;

use pump_model::Pump;
use serde_json::Value;

use super::line;
use super::story::FORMAT;
use super::{Entry, Story};
use crate::record::{PumpState, Unfinished};

/// Length of bytes without the end of a line that is no journal's, in bytes.
const LONGEST_LINE: usize = 65_536;

/// Damage of a journal.
#[derive(Debug)]
pub(super) struct Damage {
    /// Place of the damaged line.
    pub(super) line: String,
    pub(super) message: String,
}

/// Reads the format of a journal from its first bytes. A first line without a number is that of format 1.
///
/// # Errors
///
/// The damage of the first line.
pub(super) fn format_of(head: &[u8]) -> Result<u32, String> {
    let end = head.iter().position(|byte| *byte == b'\n').ok_or("it has no end")?;
    let first = str::from_utf8(&head[..end]).map_err(|error| error.to_string())?;
    match line::decode_numbered::<Value>(first)? {
        (None, _) => Ok(1),
        (Some(_), entry) => entry["begins"]["format"]
            .as_u64()
            .and_then(|format| u32::try_from(format).ok())
            .ok_or_else(|| "it does not tell the journal's format".to_owned()),
    }
}

/// End of a journal's file.
#[derive(Debug, Clone, Copy)]
pub(super) struct Tail<'a> {
    pub(super) bytes: &'a [u8],
    /// Place of the bytes in the file.
    pub(super) start: u64,
    /// Format of the journal, or the damage of its first line.
    pub(super) format: &'a Result<u32, String>,
}

/// Entries since the last rest.
struct SinceRest {
    /// Last rest, and the state then. `None` if the journal has none.
    rest: Option<(Entry, PumpState)>,
    /// Entries after it, the last one first, each with the index of its line.
    entries: Vec<(usize, Entry)>,
    /// Number of the last line. `None` in format 1.
    last: Option<u64>,
}

impl<'a> Tail<'a> {
    /// Folds the entries since the last rest. Returns `None` if that rest lies before the bytes. Only the last
    /// line may be torn.
    pub(super) fn story(&self, pump: &Pump, fresh: PumpState) -> Result<Option<Story>, Damage> {
        let whole = self.bytes.iter().rposition(|byte| *byte == b'\n').map_or(0, |end| end + 1);
        let lines = self.lines(whole);
        if whole == 0 && (self.start == 0 || self.bytes.len() >= LONGEST_LINE) {
            let message = match self.bytes {
                [] => "the file is empty",
                [0, ..] => "the file has zeros in place of entries",
                _ => "the line has no end",
            };
            return Err(self.damage(&lines, 0, message));
        }
        let Some(SinceRest { rest, entries, last }) = self.since_rest(&lines, pump.pitch_rad())? else {
            return Ok(None);
        };
        let is_rest = entries.is_empty();
        let left = rest.as_ref().and_then(|(_, state)| state.unfinished);
        let mut other_volumes = left.and_then(|dose| dose.intent.other_volumes(pump));
        let mut under_way: Option<Unfinished> = None;
        for (n, entry) in entries.into_iter().rev() {
            match (entry, &mut under_way) {
                (Entry::Intent(intent), None) => {
                    let is_delivery = intent.purpose.is_delivery();
                    other_volumes = other_volumes.or(intent.other_volumes(pump).filter(|_| is_delivery));
                    under_way = Some(Unfinished::of(&intent.of_volumes(pump), 0, 0));
                }
                (Entry::Progress { made, may }, Some(dose)) if made <= may => {
                    (dose.made_least, dose.made_most) = (made as i64, may as i64);
                }
                _ => return Err(self.damage(&lines, n, "it does not follow from the lines before it")),
            }
        }
        let recorded = rest.as_ref().map(|(_, state)| *state);
        let other_head = recorded.is_some_and(|state| state.is_of_another_head(fresh.head));
        let mut state = recorded.map(|state| state.of_volumes(pump).of_head(fresh.head, pump));
        let cut_off = under_way.map(|part| (state.unwrap_or(fresh), part));
        if let Some((before, part)) = cut_off {
            let after = before.after(&part.intent, part.made_least, part.made_most, pump);
            let unfinished = if part.intent.purpose.is_delivery() { Some(part) } else { after.unfinished };
            state = Some(PumpState { unfinished, ..after });
        }
        Ok(Some(Story {
            state,
            other_head,
            other_steps: false,
            other_volumes,
            cut_off,
            torn: whole < self.bytes.len(),
            rest: rest.map(|(entry, _)| entry).filter(|_| is_rest),
            format: if last.is_some() { FORMAT } else { 1 },
            next: last.map_or(0, |last| last.wrapping_add(1)),
            length: self.start + whole as u64,
        }))
    }

    /// Returns the whole lines. Bytes from the midst of a file may begin within a line.
    fn lines(&self, whole: usize) -> Vec<&'a [u8]> {
        let partial = usize::from(self.start > 0);
        let lines = self.bytes.get(..whole).unwrap_or_default();
        lines.split_inclusive(|byte| *byte == b'\n').skip(partial).collect()
    }

    /// Reads lines from the last one back to the last rest. Returns `None` if it lies before the bytes.
    fn since_rest(&self, lines: &[&[u8]], pitch_rad: f64) -> Result<Option<SinceRest>, Damage> {
        let mut found = SinceRest { rest: None, entries: Vec::new(), last: None };
        let mut after: Option<u64> = None;
        for (n, line) in lines.iter().enumerate().rev() {
            let (number, entry) = decode(line).map_err(|message| self.damage(lines, n, &message))?;
            if n + 1 == lines.len() {
                found.last = number;
                self.check_format(number).map_err(|message| self.damage(lines, 0, &message))?;
            } else if number.map(|number| number.wrapping_add(1)) != after {
                return Err(self.damage(lines, n + 1, "the line before it is missing"));
            }
            after = number;
            match entry {
                Entry::Rest { state, .. } => {
                    found.rest = Some((entry, state.as_recorded(pitch_rad)));
                    self.check_before(lines, n, number)?;
                    return Ok(Some(found));
                }
                Entry::Begins { .. } if self.start == 0 && n == 0 => return Ok(Some(found)),
                Entry::Begins { .. } => return Err(self.damage(lines, n, "it is a first line")),
                entry => found.entries.push((n, entry)),
            }
        }
        Ok((self.start == 0).then_some(found))
    }

    /// Checks that the lines are numbered as the first line says.
    fn check_format(&self, number: Option<u64>) -> Result<(), String> {
        match (self.format, number) {
            (Ok(1), None) | (Ok(FORMAT), Some(_)) => Ok(()),
            // The first line of a journal of format 1 counts for nothing but itself.
            (Err(_), None) => Ok(()),
            (Err(message), Some(_)) => Err(message.clone()),
            (Ok(format), _) => Err(format!("the journal's lines are not those of its format {format}")),
        }
    }

    /// Checks that no line is missing before that of the last rest. An unreadable one counts for nothing.
    fn check_before(&self, lines: &[&[u8]], n: usize, number: Option<u64>) -> Result<(), Damage> {
        let before = n.checked_sub(1).and_then(|before| lines.get(before)).and_then(|line| decode(line).ok());
        match (before, number) {
            (Some((Some(before), _)), Some(number)) if before.wrapping_add(1) != number => {
                Err(self.damage(lines, n, "the line before it is missing"))
            }
            _ => Ok(()),
        }
    }

    /// Returns the damage of line `n` of `lines`.
    fn damage(&self, lines: &[&[u8]], n: usize, message: &str) -> Damage {
        // The number of a line in a long file would be known only once the whole file is read.
        let line = match lines.len().saturating_sub(n) {
            _ if self.start == 0 => format!("line {}", n + 1),
            0 | 1 => "the last line".to_owned(),
            back => format!("line {back} from the end"),
        };
        Damage { line, message: message.to_owned() }
    }
}

/// Decodes a line with its newline: its number, if it has one, and its entry.
fn decode(line: &[u8]) -> Result<(Option<u64>, Entry), String> {
    let text = str::from_utf8(line).map_err(|error| error.to_string())?;
    line::decode_numbered(text.trim_end())
}
