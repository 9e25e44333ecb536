//! The board's end of a line, whatever carries its bytes: the machine, and the defects of the line. It has no clock:
//! who carries the bytes says what time it is.

use std::collections::VecDeque;
use std::time::Duration;

use super::Truth;
use super::machine::{Machine, Output};
use super::options::Options;

/// Most bytes on their way out to which a board that talks by itself adds more.
const MOST_UNREAD: usize = 2048;

/// Machine at the end of a line.
#[derive(Debug)]
pub(crate) struct Line {
    pub machine: Machine,
    pub options: Options,
    /// Bytes on their way out.
    pub outgoing: VecDeque<u8>,
    /// True once the cable is pulled.
    pub is_pulled: bool,
    /// Numbers of questions for the position and of resets of the processor.
    asked: u64,
    resets: u32,
    /// Time at which the processor will have started, after a reset.
    starts_at: Option<Duration>,
    /// Late answers with the times at which they are due. Lines that follow them do not wait.
    late: VecDeque<(Duration, String)>,
    silent: bool,
    /// Time of the last report that nobody asked for.
    reported: Duration,
}

impl Line {
    /// Returns the end of the line of a board that is switched on.
    pub(crate) fn new(options: Options) -> Self {
        Self {
            machine: Machine::new(&options),
            options,
            outgoing: VecDeque::new(),
            is_pulled: false,
            asked: 0,
            resets: 0,
            starts_at: None,
            late: VecDeque::new(),
            silent: false,
            reported: Duration::ZERO,
        }
    }

    /// Writes the truth about the board into `truth`.
    pub(crate) fn publish(&mut self, truth: &mut Truth) {
        let motor = &self.machine.motor;
        truth.steps = self.machine.true_steps;
        truth.others = self.machine.others;
        truth.moving = !motor.is_done() && !self.machine.stalled;
        truth.peak_steps_s = motor.peak;
        truth.starts = motor.starts;
        (truth.asked, truth.resets) = (self.asked, self.resets);
        truth.lines.append(&mut self.machine.lines);
    }

    /// Takes bytes from the line. A board that starts hears nothing.
    pub(crate) fn receive(&mut self, bytes: &[u8]) {
        self.asked += bytes.iter().filter(|byte| **byte == b'?').count() as u64;
        if self.starts_at.is_none() {
            bytes.iter().for_each(|byte| self.machine.receive(*byte));
        }
    }

    /// Starts the processor anew.
    pub(crate) fn reset(&mut self, now: Duration) {
        self.machine.power_on();
        self.outgoing.clear();
        self.late.clear();
        self.starts_at = Some(now + self.options.boot);
        self.resets += 1;
    }

    /// Lets `time_s` pass on the board, which is `now` then, and puts what the board says on its way.
    pub(crate) fn pass(&mut self, now: Duration, time_s: f64) {
        match self.starts_at {
            Some(at) if now >= at => {
                self.starts_at = None;
                self.machine.banner();
            }
            Some(_) => {}
            None => {
                self.machine.advance(time_s);
                self.fail(now);
                self.machine.work();
                self.talk(now);
            }
        }
        self.speak(now);
    }

    /// Says what nobody asked for.
    fn talk(&mut self, now: Duration) {
        if self.outgoing.len() > MOST_UNREAD {
            return;
        }
        if self.options.auto_report.is_some_and(|every| now.saturating_sub(self.reported) >= every) {
            self.reported = now;
            self.machine.receive(b'?');
        }
        if self.options.chatters {
            self.machine.say("[MSG:Spindle at speed]");
        }
    }

    /// Lets each defect happen at its place.
    fn fail(&mut self, now: Duration) {
        self.machine.suffer();
        let turned = self.machine.turned;
        let due = |place: Option<u64>| place.is_some_and(|place| turned >= place);
        let defects = &mut self.machine.defects;
        if due(defects.resets) {
            defects.resets = None;
            self.reset(now);
        } else if due(defects.unplugged) {
            defects.unplugged = None;
            self.is_pulled = true;
        } else if due(defects.silent) {
            self.silent = true;
        }
    }

    /// Puts what the board says on its way.
    fn speak(&mut self, now: Duration) {
        for output in std::mem::take(&mut self.machine.output) {
            match output {
                Output::Line(text) => self.put(&text),
                Output::Answer(text) => {
                    let most_us = self.machine.defects.late_ok.as_micros() as u64;
                    let delay = if most_us == 0 || self.machine.jogs == 0 {
                        0
                    } else {
                        self.machine.random.below(most_us)
                    };
                    self.late.push_back((now + Duration::from_micros(delay), text));
                }
            }
        }
        while self.late.front().is_some_and(|(due, _)| *due <= now) {
            if let Some((_, text)) = self.late.pop_front() {
                self.put(&text);
            }
        }
        if self.silent {
            self.outgoing.clear();
        }
    }

    /// Returns the bytes that leave now. A board with this defect sends bytes in pieces, or all at once after a while.
    pub(crate) fn leaving(&mut self) -> Vec<u8> {
        let random = &mut self.machine.random;
        let most = match self.machine.defects.chopped {
            true if random.below(4) > 0 => 0,
            true if random.below(2) > 0 => random.below(9) as usize,
            _ => usize::MAX,
        };
        self.outgoing.iter().copied().take(most).collect()
    }

    /// Adds a line to the outgoing bytes, with the defects of the wire.
    fn put(&mut self, text: &str) {
        let (random, defects) = (&mut self.machine.random, &self.machine.defects);
        if defects.noise && random.below(4) == 0 {
            let noise = (0..random.below(12)).map(|_| random.below(256) as u8).filter(|byte| *byte != b'\n');
            let noise: Vec<u8> = noise.collect();
            self.outgoing.extend(noise);
            self.outgoing.extend(b"\r\n");
        }
        // The end of an answer's line is lost where a report follows.
        let merges = defects.chopped && text.starts_with('<') && random.below(3) == 0;
        if merges && self.outgoing.ends_with_ok() {
            self.outgoing.truncate(self.outgoing.len() - 2);
        }
        self.outgoing.extend(text.as_bytes());
        self.outgoing.extend(b"\r\n");
    }
}

/// End of a queue of bytes.
trait Ends {
    fn ends_with_ok(&self) -> bool;
}

impl Ends for VecDeque<u8> {
    fn ends_with_ok(&self) -> bool {
        self.iter().rev().take(4).eq(b"\n\rko")
    }
}
