//! What a board says, from bytes: lines that may come in pieces, run into each other or be damaged.

/// Longest line that is read; what is longer is noise. FluidNC's longest messages have some 200 bytes.
const LONGEST_LINE: usize = 512;

/// Something that a board said.
#[derive(Debug, Clone, PartialEq)]
pub enum Reply {
    /// The last line was taken.
    Ok,
    /// The last line was refused, by grbl's number of the reason.
    Error(u16),
    /// The board has stopped and locked itself, by grbl's number of the reason.
    Alarm(u16),
    /// State and position.
    Status(Status),
    /// `$100=250.000`.
    Setting {
        /// 100.
        number: u16,
        /// 250.
        value: f64,
    },
    /// `$/axes/x/steps_per_mm=80`: an item of FluidNC's configuration.
    Item {
        /// `axes/x/steps_per_mm`.
        path: String,
        /// What follows the `=`.
        text: String,
    },
    /// What a board says once it has started: it was reset.
    Banner(String),
    /// What follows `[VER:`.
    Version(String),
    /// What follows `[GC:`, modes of the G-code parser.
    Modes(String),
    /// `[PRB:1.000,0.000,0.000:1]`.
    Probe {
        /// Where the sensor answered, by axis, in the unit of reports.
        position: Vec<f64>,
        /// Whether it did.
        found: bool,
    },
    /// Any other line in brackets, and start-up lines.
    Message(String),
    /// A line that grbl's protocol does not have.
    Unknown(String),
}

/// A status report.
#[derive(Debug, Clone, PartialEq)]
pub struct Status {
    /// What the board does.
    pub state: State,
    /// `MPos`: where the machine stands, by axis.
    pub machine: Option<Vec<f64>>,
    /// `WPos`: the same less `WCO`.
    pub work: Option<Vec<f64>>,
    /// `WCO`, which is only in some of the reports.
    pub offset: Option<Vec<f64>>,
}

/// What a board does.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum State {
    /// It waits.
    Idle,
    /// G-code moves an axis.
    Run,
    /// A jog moves an axis.
    Jog,
    /// It was told to wait in motion.
    Hold {
        /// Whether it stands.
        still: bool,
    },
    /// It is locked.
    Alarm,
    /// It runs a homing cycle.
    Home,
    /// A safety door is open.
    Door,
    /// It checks G-code without moving.
    Check,
    /// Only a reset wakes it.
    Sleep,
    /// Any other word.
    Other(String),
}

impl State {
    /// Of `Idle` or `Hold:1`.
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
}

/// Puts bytes together to lines and lines to replies. However the bytes are divided, the replies are the same.
#[derive(Debug, Default)]
pub struct Replies {
    line: String,
    overlong: bool,
}

impl Replies {
    /// Appends to `replies` what `bytes` complete.
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
                // Noise on the wire, and what a reset leaves of a byte.
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

/// What is before the first whole status report, in it, and after it.
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

/// `100=250.000`, with or without a description after it, or `/axes/x/steps_per_mm=80`.
fn read_setting(setting: &str) -> Option<Reply> {
    let (key, text) = setting.split_once('=')?;
    if let Some(path) = key.strip_prefix('/') {
        return Some(Reply::Item { path: path.to_owned(), text: text.trim().to_owned() });
    }
    let value = text.split([' ', '(', '\t']).next().and_then(number)?;
    Some(Reply::Setting { number: key.parse().ok()?, value })
}

/// `Grbl 1.1h ['$' for help]`, perhaps after what the wire made of the reset.
fn is_banner(part: &str) -> bool {
    version_of(part).is_some()
}

/// Major and minor number after the name in a banner.
pub(super) fn version_of(banner: &str) -> Option<(u32, u32)> {
    let at = ["GrblHAL ", "grblHAL ", "Grbl "].iter().find_map(|name| banner.split_once(name))?;
    leading_version(at.1)
}

/// `1.1h.20190830` is 1 and 1.
pub(super) fn leading_version(text: &str) -> Option<(u32, u32)> {
    let (major, rest) = text.split_once('.')?;
    let digits = rest.find(|c: char| !c.is_ascii_digit()).unwrap_or(rest.len());
    Some((major.trim().parse().ok()?, rest.get(..digits)?.parse().ok()?))
}

fn status(report: &str) -> Option<Status> {
    let mut fields = report.split('|');
    let text = fields.next()?;
    let word = text.split(':').next()?;
    if word.is_empty() || !word.chars().all(|c| c.is_ascii_alphabetic()) {
        return None;
    }
    let mut status = Status { state: State::of(text), machine: None, work: None, offset: None };
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

/// A decimal number as grbl prints it: no exponent, no infinity.
fn number(text: &str) -> Option<f64> {
    let plain = text.chars().all(|c| c.is_ascii_digit() || matches!(c, '.' | '-'));
    text.parse().ok().filter(|_| plain && text.len() <= 16)
}
