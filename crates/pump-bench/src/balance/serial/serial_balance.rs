//! A balance at a serial port.

use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use serialport::{DataBits, Parity, SerialPort};

use super::line::{Framing, SerialLine};
use super::protocol::{Answer, Protocol, other_protocol};
use crate::balance::words::shown_line;
use crate::balance::{Balance, BalanceError, BalanceReading};
use crate::drives::StopRequest;

/// Time between two questions.
const BETWEEN: Duration = Duration::from_millis(100);

/// Longest wait for the answer to a question before the balance is asked again.
const ANSWER: Duration = Duration::from_millis(1000);

/// Longest wait for the first answer that the protocol knows, where it answers at once.
const FIRST_ANSWER: Duration = Duration::from_secs(5);

/// Longest wait for bytes.
const LOOK: Duration = Duration::from_millis(50);

/// Longest line of a balance, in bytes. What is longer is no line.
const MOST_BYTES: usize = 256;

/// Balance at a serial port that no other process has.
#[derive(Debug)]
pub struct SerialBalance {
    path: PathBuf,
    serial: Box<dyn SerialPort>,
    protocol: Protocol,
    /// Bytes of a line that has not ended.
    begun: Vec<u8>,
    /// Unit of the last mass that stood still.
    unit: String,
}

impl SerialBalance {
    /// Opens the port of a balance. Nothing is asked yet.
    ///
    /// # Errors
    ///
    /// [`BalanceError::Port`] if the port cannot be opened, or another process has it.
    pub fn open(path: &Path, line: SerialLine, protocol: Protocol) -> Result<Self, BalanceError> {
        let (bits, parity) = match line.framing {
            Framing::EightNone => (DataBits::Eight, Parity::None),
            Framing::SevenOdd => (DataBits::Seven, Parity::Odd),
            Framing::SevenEven => (DataBits::Seven, Parity::Even),
        };
        let builder =
            serialport::new(path.to_string_lossy(), line.baud).data_bits(bits).parity(parity).timeout(LOOK);
        let serial = builder.open().map_err(|error| BalanceError::Port {
            action: "open",
            port: path.to_owned(),
            source: io::Error::other(error.to_string()),
        })?;
        Ok(Self { path: path.to_owned(), serial, protocol, begun: Vec::new(), unit: "g".to_owned() })
    }

    /// Returns the error of an action at the port.
    fn failed(&self, action: &'static str, source: io::Error) -> BalanceError {
        BalanceError::Port { action, port: self.path.clone(), source }
    }

    /// Forgets what the balance said before.
    fn ask(&mut self) -> Result<(), BalanceError> {
        self.begun.clear();
        let cleared = self.serial.clear(serialport::ClearBuffer::Input).map_err(io::Error::from);
        let asked = cleared.and_then(|()| self.serial.write_all(self.protocol.question()));
        asked.map_err(|source| self.failed("ask", source))
    }

    /// Returns the next whole line, or `None` if there is none within [`LOOK`].
    fn line(&mut self) -> Result<Option<String>, BalanceError> {
        if let Some(line) = self.whole_line() {
            return Ok(Some(line));
        }
        let mut buffer = [0; 64];
        match self.serial.read(&mut buffer) {
            Ok(count) => self.begun.extend(buffer.get(..count).unwrap_or_default()),
            Err(error) => match error.kind() {
                io::ErrorKind::TimedOut | io::ErrorKind::Interrupted | io::ErrorKind::WouldBlock => {}
                _ => return Err(self.failed("read", error)),
            },
        }
        if self.begun.len() > MOST_BYTES {
            let said = shown_line(&String::from_utf8_lossy(&self.begun));
            self.begun.clear();
            return Err(BalanceError::Unreadable { said });
        }
        Ok(self.whole_line())
    }

    fn whole_line(&mut self) -> Option<String> {
        let end = self.begun.iter().position(|byte| *byte == b'\n')?;
        let line: Vec<u8> = self.begun.drain(..=end).collect();
        Some(String::from_utf8_lossy(&line).into_owned())
    }
}

impl SerialBalance {
    /// Asks until `is_wanted` takes an answer. A question that is refused is repeated once.
    ///
    /// The time is that for which the balance was listened to: a wait counts for no more than it was to last. A
    /// computer that is busy with other things waits longer, and the balance is not blamed for it.
    fn read(
        &mut self,
        longest: Duration,
        between: Duration,
        stop: &StopRequest,
        is_wanted: impl Fn(Answer) -> Option<BalanceReading>,
    ) -> Result<BalanceReading, BalanceError> {
        let (mut waited, mut is_repeated) = (Duration::ZERO, false);
        let (mut last, mut strange): (Option<String>, Option<String>) = (None, None);
        let first = longest.min(FIRST_ANSWER);
        let patience = |is_known: bool, is_strange: bool, protocol: Protocol| {
            if !is_known && (is_strange || protocol.answers_at_once()) { first } else { longest }
        };
        while waited < patience(last.is_some(), strange.is_some(), self.protocol) {
            self.ask()?;
            let asked = waited;
            let mut looked = Instant::now();
            while waited - asked < ANSWER && waited < longest {
                if stop.is_made() {
                    return Err(BalanceError::Stopped);
                }
                let line = self.line()?;
                // The time between two lines counts too: a balance may send lines without end.
                let now = Instant::now();
                waited += (now - looked).min(LOOK);
                looked = now;
                let Some(line) = line else { continue };
                if line.trim().is_empty() {
                    continue;
                }
                let answer = match self.protocol.answer(&line, &self.unit) {
                    // Another program may have left a part of a line there, which spoils the first question.
                    Err(BalanceError::Refused { .. }) if !is_repeated => {
                        is_repeated = true;
                        break;
                    }
                    answer => answer?,
                };
                let said = if answer == Answer::Other { &mut strange } else { &mut last };
                *said = Some(shown_line(&line));
                if matches!(answer, Answer::Still(_)) {
                    self.unit = unit_of(&line).to_owned();
                }
                match (is_wanted(answer), answer) {
                    (Some(reading), _) => return Ok(reading),
                    (None, Answer::Other) => {}
                    (None, _) => break,
                }
            }
            // A whole line tells more than a part of one.
            if strange.is_none() && !self.begun.is_empty() {
                strange = Some(shown_line(&self.begun.escape_ascii().to_string()));
            }
            std::thread::sleep(between);
            waited += between;
        }
        let within = patience(last.is_some(), strange.is_some(), self.protocol);
        let protocol = self.protocol.as_str();
        if let Some(last) = last {
            return Err(BalanceError::NotStill { within, last });
        }
        if let Some(said) = strange {
            return Err(BalanceError::Unintelligible { within, protocol, said });
        }
        if waited >= FIRST_ANSWER && self.protocol == Protocol::MtSics {
            self.refuse_sbi(stop)?;
        }
        Err(BalanceError::Unanswered { within, protocol })
    }

    /// Refuses a balance that is silent when it is asked in MT-SICS, and answers a question of SBI.
    fn refuse_sbi(&mut self, stop: &StopRequest) -> Result<(), BalanceError> {
        let asked = std::mem::replace(&mut self.protocol, Protocol::Sbi);
        let question = self.ask();
        self.protocol = asked;
        question?;
        let begins = Instant::now();
        while begins.elapsed() < ANSWER {
            if stop.is_made() {
                return Err(BalanceError::Stopped);
            }
            let Some(line) = self.line()? else { continue };
            if let Ok(Answer::Still(_) | Answer::Moving(Some(_))) = Protocol::Sbi.answer(&line, &self.unit) {
                return Err(other_protocol(asked, Protocol::Sbi, &line));
            }
        }
        Ok(())
    }
}

/// Returns the unit at the end of a line.
fn unit_of(line: &str) -> &str {
    let line = line.trim();
    let start = line.rfind(|c: char| !c.is_ascii_alphabetic()).map_or(0, |at| at + 1);
    line.get(start..).unwrap_or_default()
}

impl Balance for SerialBalance {
    fn read_still(&mut self, longest: Duration, stop: &StopRequest) -> Result<BalanceReading, BalanceError> {
        self.read(longest, BETWEEN, stop, |answer| match answer {
            Answer::Still(reading) => Some(reading),
            Answer::Moving(_) | Answer::Other => None,
        })
    }

    fn read_now(&mut self, longest: Duration, stop: &StopRequest) -> Result<BalanceReading, BalanceError> {
        self.read(longest, Duration::ZERO, stop, |answer| match answer {
            Answer::Still(reading) => Some(reading),
            Answer::Moving(reading) => reading,
            Answer::Other => None,
        })
    }
}
