//! The replies of a board, read from bytes. Its lines may come in pieces, run into each other or be damaged.

/// Longest line that is read, in bytes. A longer one is noise. FluidNC's longest messages have some 200
/// bytes.
const LONGEST_LINE: usize = 512;

/// Reply of a board.
#[derive(Debug, Clone, PartialEq)]
pub enum Reply {
    /// The last line was taken.
    Ok,
    /// The last line was refused, by grbl's code of the error.
    Error(u16),
    /// The board has stopped and locked itself, by grbl's code of the alarm.
    Alarm(u16),
    /// A status report: state and position.
    Status(BoardStatus),
    /// A setting, as in `$100=250.000`.
    Setting {
        /// Number of the setting, as in 100.
        number: u16,
        /// Value of the setting, as in 250.
        value: f64,
    },
    /// An item of FluidNC's configuration, as in `$/axes/x/steps_per_mm=80`.
    Item {
        /// Path of the item, as in `axes/x/steps_per_mm`.
        path: String,
        /// Text after the `=`.
        text: String,
    },
    /// The banner of a board that has started: it was reset.
    Banner(String),
    /// The version, after `[VER:`.
    Version(String),
    /// The modes of the G-code parser, after `[GC:`.
    Modes(String),
    /// The result of a probing move, as in `[PRB:1.000,0.000,0.000:1]`.
    Probe {
        /// Position at which the sensor answered, by axis, in the unit of reports.
        position: Vec<f64>,
        /// True if the sensor answered.
        found: bool,
    },
    /// Any other line in brackets, or a start-up line.
    Message(String),
    /// A line that grbl's protocol does not have.
    Unknown(String),
}

/// Status report of a board.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct BoardStatus {
    /// State of the board.
    pub state: BoardState,
    /// Machine position `MPos`, by axis.
    pub machine: Option<Vec<f64>>,
    /// Work position `WPos`, by axis: the machine position less `WCO`.
    pub work: Option<Vec<f64>>,
    /// Offset `WCO`, by axis. Only some of the reports have it.
    pub offset: Option<Vec<f64>>,
}

/// State of a board.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum BoardState {
    /// The board waits.
    Idle,
    /// G-code moves an axis.
    Run,
    /// A jog moves an axis.
    Jog,
    /// The board was told to wait in motion.
    Hold {
        /// True if the motor stands.
        still: bool,
    },
    /// The board is locked.
    Alarm,
    /// The board runs a homing cycle.
    Home,
    /// A safety door is open.
    Door,
    /// The board checks G-code without moving.
    Check,
    /// Only a reset wakes it.
    Sleep,
    /// Any other word of a board.
    Other(String),
}

impl BoardState {
    /// Reads a state such as `Idle` or `Hold:1`.
    fn of(text: &str) -> Self {
        let (word, detail) = text.split_once(':').unwrap_or((text, ""));
        match word {
            "Idle" => Self::Idle,
            "Run" => Self::Run,
            "Jog" => Self::Jog,
            "Hold" => Self::Hold { still: detail != "1" },
            "Alarm" => Self::Alarm,
            "Home" => Self::Home,
            "Door" => Self::Door,
            "Check" => Self::Check,
            "Sleep" => Self::Sleep,
            other => Self::Other(other.to_owned()),
        }
    }

    /// Returns the word of a board for the state, such as `Idle`.
    pub(super) fn word(&self) -> String {
        match self {
            Self::Hold { .. } => "Hold".to_owned(),
            Self::Other(word) => word.clone(),
            state => format!("{state:?}"),
        }
    }
}

/// Reader that joins bytes to lines and lines to replies. However the bytes are divided, the replies are the
/// same.
#[derive(Debug, Default)]
pub struct Replies {
    line: String,
    overlong: bool,
}

impl Replies {
    /// Appends the replies that `bytes` complete to `replies`.
    pub fn feed(&mut self, bytes: &[u8], replies: &mut Vec<Reply>) {
        for byte in bytes {
            match byte {
                b'\n' | b'\r' => {
                    let line = std::mem::take(&mut self.line);
                    if !std::mem::take(&mut self.overlong) {
                        read_line(&line, replies);
                    }
                }
                b' '..=b'~' if self.line.len() < LONGEST_LINE => self.line.push(char::from(*byte)),
                b' '..=b'~' => self.overlong = true,
                // Noise on the wire, and remains of a byte after a reset.
                _ => {}
            }
        }
    }
}

/// Reads a line, in which a status report may have run into its neighbours.
fn read_line(line: &str, replies: &mut Vec<Reply>) {
    let mut rest = line;
    while let Some((before, report, after)) = divide(rest) {
        read_part(before, replies);
        replies.push(status(report).map_or_else(|| Reply::Unknown(report.to_owned()), Reply::Status));
        rest = after;
    }
    read_part(rest, replies);
}

/// Splits a line into the parts before, in and after its first whole status report.
fn divide(line: &str) -> Option<(&str, &str, &str)> {
    let (_, from) = line.split_once('<')?;
    let (through, after) = from.split_once('>')?;
    let report = through.rsplit('<').next().unwrap_or(through);
    let ahead = line.len() - after.len() - 2 - report.len();
    Some((line.get(..ahead)?, report, after))
}

fn read_part(part: &str, replies: &mut Vec<Reply>) {
    let part = part.trim();
    if part.is_empty() {
        return;
    }
    let number = |text: &str| text.trim().parse::<u16>().ok();
    let known = if part == "ok" {
        Some(Reply::Ok)
    } else if let Some(code) = part.strip_prefix("error:") {
        number(code).map(Reply::Error)
    } else if let Some(code) = part.strip_prefix("ALARM:") {
        number(code).map(Reply::Alarm)
    } else if let Some(inner) = part.strip_prefix('[') {
        inner.strip_suffix(']').map(message)
    } else if let Some(setting) = part.strip_prefix('$') {
        read_setting(setting)
    } else if part.starts_with('>') {
        Some(Reply::Message(part.to_owned()))
    } else {
        is_banner(part).then(|| Reply::Banner(part.to_owned()))
    };
    replies.push(known.unwrap_or_else(|| Reply::Unknown(part.to_owned())));
}

fn message(inner: &str) -> Reply {
    if let Some(version) = inner.strip_prefix("VER:") {
        return Reply::Version(version.to_owned());
    }
    if let Some(modes) = inner.strip_prefix("GC:") {
        return Reply::Modes(modes.to_owned());
    }
    let probe = inner.strip_prefix("PRB:").and_then(|probe| {
        let (position, found) = probe.rsplit_once(':')?;
        Some(Reply::Probe { position: numbers(position)?, found: found == "1" })
    });
    probe.unwrap_or_else(|| Reply::Message(inner.to_owned()))
}

/// Reads a setting such as `100=250.000`, with or without a description after it, or
/// `/axes/x/steps_per_mm=80`.
fn read_setting(setting: &str) -> Option<Reply> {
    let (key, text) = setting.split_once('=')?;
    if let Some(path) = key.strip_prefix('/') {
        return Some(Reply::Item { path: path.to_owned(), text: text.trim().to_owned() });
    }
    let value = text.split([' ', '(', '\t']).next().and_then(number)?;
    Some(Reply::Setting { number: key.parse().ok()?, value })
}

/// Returns true for a banner such as `Grbl 1.1h ['$' for help]`, perhaps after noise from the reset.
fn is_banner(part: &str) -> bool {
    version_of(part).is_some()
}

/// Returns the major and minor version after the name in a banner.
pub(super) fn version_of(banner: &str) -> Option<(u32, u32)> {
    let at = ["GrblHAL ", "grblHAL ", "Grbl "].iter().find_map(|name| banner.split_once(name))?;
    leading_version(at.1)
}

/// Returns the leading major and minor version: `1.1h.20190830` is 1 and 1.
pub(super) fn leading_version(text: &str) -> Option<(u32, u32)> {
    let (major, rest) = text.split_once('.')?;
    let digits = rest.find(|c: char| !c.is_ascii_digit()).unwrap_or(rest.len());
    Some((major.trim().parse().ok()?, rest.get(..digits)?.parse().ok()?))
}

fn status(report: &str) -> Option<BoardStatus> {
    let mut fields = report.split('|');
    let text = fields.next()?;
    let word = text.split(':').next()?;
    if word.is_empty() || !word.chars().all(|c| c.is_ascii_alphabetic()) {
        return None;
    }
    let mut status = BoardStatus { state: BoardState::of(text), machine: None, work: None, offset: None };
    for field in fields {
        let Some((name, values)) = field.split_once(':') else { continue };
        let place = match name {
            "MPos" => &mut status.machine,
            "WPos" => &mut status.work,
            "WCO" => &mut status.offset,
            _ => continue,
        };
        *place = Some(numbers(values)?);
    }
    Some(status)
}

fn numbers(list: &str) -> Option<Vec<f64>> {
    list.split(',').map(number).collect()
}

/// Reads a decimal number as grbl prints it: no exponent, no infinity.
fn number(text: &str) -> Option<f64> {
    let plain = text.chars().all(|c| c.is_ascii_digit() || matches!(c, '.' | '-'));
    text.parse().ok().filter(|_| plain && text.len() <= 16)
}
