//! A board in memory that answers by a script of arbitrary bytes once a motion is under way.
//!
//! Before the first motion the board is honest. Its clock is simulated: it goes on where the drive waits.

use std::collections::VecDeque;
use std::io;
use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use pump_bench::built_in;
use pump_bench::drives::wire::Wire;
use pump_bench::drives::{Drive, Grbl, Leave, Opening};
use pump_bench::pump_file::{DriveTable, DriverName};
use pump_ctl::plan::{Cruise, Doser, Phase, Request};

/// Steps per unit of the board.
const STEPS_PER_UNIT: f64 = 250.0;

/// Simulated time within which any motion ends, s: a dose of half a second, a stop and its repetition, a hold, a
/// reset, and the waits for an answer.
const LONGEST_S: f64 = 240.0;

/// Time between two lines of a board that says one thing for ever.
const LAST_WORDS_EVERY: Duration = Duration::from_millis(300);

/// Settings that suit the built-in pump.
const SETTINGS: [&str; 7] =
    ["$1=255", "$3=0", "$10=1", "$13=0", "$100=250.000", "$110=6000.000", "$120=400.000"];

/// Lines of boards that matter in a motion. `@` stands for the position.
const LINES: [&str; 16] = [
    "ok",
    "error:9",
    "error:15",
    "ALARM:1",
    "ALARM:2",
    "ALARM:5",
    "Grbl 1.1h ['$' for help]",
    "[MSG:Caution: Unlocked]",
    "[PRB:@,0.000,0.000:1]",
    "<Idle|MPos:@,0.000,0.000|FS:0,0>",
    "<Jog|MPos:@,0.000,0.000|FS:600,0>",
    "<Run|MPos:@,0.000,0.000|FS:600,0>",
    "<Hold:0|MPos:@,0.000,0.000|FS:0,0>",
    "<Door:0|MPos:@,0.000,0.000|FS:0,0>",
    "<Alarm|MPos:@,0.000,0.000|FS:0,0>",
    "<Sleep|WPos:@,0.000,0.000|WCO:0.000,0.000,0.000>",
];

/// Board in memory.
#[derive(Debug)]
struct ScriptedBoard {
    script: VecDeque<u8>,
    /// Line that the board says without end once its script is over.
    last_words: Option<&'static str>,
    /// True once a motion was begun.
    scripted: bool,
    outgoing: VecDeque<u8>,
    line: String,
    /// Position, and the target of the last jog, mm.
    at: f64,
    target: f64,
    /// Simulated time, us.
    clock_us: Arc<AtomicU64>,
}

impl ScriptedBoard {
    fn pass(&self, time: Duration) {
        self.clock_us.fetch_add(time.as_micros().max(200) as u64, Ordering::Relaxed);
    }

    fn say(&mut self, text: &str) {
        let text = text.replace('@', &format!("{:.3}", self.at));
        self.outgoing.extend(text.bytes().chain(*b"\r\n"));
    }

    fn next(&mut self) -> u8 {
        self.script.pop_front().unwrap_or(0)
    }

    /// Does what the next bytes of the script say. Returns false if time passes without a byte.
    fn act(&mut self) -> io::Result<bool> {
        let Some(action) = self.script.pop_front() else {
            if let Some(line) = self.last_words {
                self.pass(LAST_WORDS_EVERY);
                self.say(line);
            }
            return Ok(false);
        };
        match action % 6 {
            0 => {
                let part = f64::from(self.next()) / 255.0;
                self.at += part * (self.target - self.at);
                self.at = (self.at * STEPS_PER_UNIT).round() / STEPS_PER_UNIT;
                self.say("<Jog|MPos:@,0.000,0.000|FS:600,0>");
            }
            1 => self.say("ok"),
            2 => {
                let line = LINES[usize::from(self.next()) % LINES.len()];
                self.say(line);
            }
            3 => {
                let count = self.next() % 48;
                let bytes: Vec<u8> = (0..count).map(|_| self.next()).collect();
                self.outgoing.extend(bytes);
            }
            4 => {
                let time = Duration::from_millis(u64::from(self.next()) * 10);
                self.pass(time);
                return Ok(false);
            }
            _ => match self.next() {
                0 => return Err(io::ErrorKind::BrokenPipe.into()),
                by => self.at += f64::from(by as i8),
            },
        }
        Ok(true)
    }

    fn obey(&mut self, line: &str) {
        if let Some(jog) = line.strip_prefix("$J=G53G90G21X").or_else(|| line.strip_prefix("G91G21G94G38.2X"))
        {
            self.scripted = true;
            let target = jog.split('F').next().and_then(|target| target.parse().ok());
            self.target = target.unwrap_or(self.target);
            return;
        }
        if self.scripted {
            return;
        }
        match line {
            "$I" => self.say("[VER:1.1h.20190830:]"),
            "$G" => self.say("[GC:G0 G54 G17 G21 G90 G94 M5 M9 T0 F0 S0]"),
            "$$" => SETTINGS.iter().for_each(|setting| self.say(setting)),
            _ => {}
        }
        self.say("ok");
    }
}

impl Wire for ScriptedBoard {
    fn read(&mut self, buffer: &mut [u8], wait: Duration) -> io::Result<usize> {
        if self.outgoing.is_empty() && (!self.scripted || !self.act()?) {
            self.pass(wait);
            return Ok(0);
        }
        self.pass(Duration::from_millis(1));
        let count = buffer.len().min(self.outgoing.len());
        for (byte, from) in buffer.iter_mut().zip(self.outgoing.drain(..count)) {
            *byte = from;
        }
        Ok(count)
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        for byte in bytes {
            match byte {
                b'?' if !self.scripted => self.say("<Idle|MPos:@,0.000,0.000|FS:0,0>"),
                b'?' | b'!' | 0x18 | 0x80.. => {}
                b'\n' => {
                    let line = std::mem::take(&mut self.line);
                    self.obey(&line);
                }
                byte => self.line.push(char::from(*byte)),
            }
        }
        Ok(())
    }

    fn now(&mut self) -> Duration {
        Duration::from_micros(self.clock_us.load(Ordering::Relaxed))
    }

    fn sleep(&mut self, time: Duration) {
        self.pass(time);
    }
}

/// Runs a motion on a board that answers by `script`. Panics unless the motion ends in bounded time with bounds
/// in order.
pub(crate) fn run_scripted(script: &[u8]) {
    let [kind, script @ ..] = script else { return };
    let clock_us = Arc::new(AtomicU64::new(0));
    let time_s = || Duration::from_micros(clock_us.load(Ordering::Relaxed)).as_secs_f64();
    let board = ScriptedBoard {
        script: script.iter().copied().collect(),
        last_words: (kind & 8 != 0).then(|| LINES[usize::from(kind >> 4)]),
        scripted: false,
        outgoing: VecDeque::new(),
        line: String::new(),
        at: 0.0,
        target: 0.0,
        clock_us: Arc::clone(&clock_us),
    };
    let file = built_in("three-roller").expect("a built-in pump");
    let table = DriveTable::of(DriverName::Grbl);
    let opened = Grbl::over(Box::new(board), &table, &file.motor, &Opening::default());
    let mut grbl = opened.expect("the board is honest before a motion");
    let mut limits = file.limits();
    let allowed = grbl.limits().and_then(|limits| limits.acceleration_rad_s2);
    limits.motor.max_acceleration_rad_s2 = allowed.expect("a board has ramps of its own");
    let volume_ml = if kind & 1 == 0 { 1.5 } else { -1.5 };
    let request = Request::new(volume_ml, Cruise::Flow { ml_s: 4.0 });
    let model = file.model().expect("a model");
    let plan =
        Doser::new(&model, limits).and_then(|doser| doser.plan(Phase::known(0.4), &request)).expect("a plan");
    // Some doses are stopped on the way.
    let stops_at = if kind & 2 == 0 { u64::MAX } else { u64::from(*kind) * 8 };
    let mut gate = |made: u64, about_to: u64| {
        assert!(made <= about_to && about_to <= plan.steps().unsigned_abs());
        if made >= stops_at { Leave::Stop } else { Leave::Go }
    };
    let begun_s = time_s();
    let made = if kind & 4 == 0 {
        grbl.run(&plan, &mut gate)
    } else {
        grbl.seek(&plan, &mut gate).map(|sought| {
            assert!(sought.beyond.is_none_or(|beyond| beyond <= sought.made));
            sought.made
        })
    };
    let took_s = time_s() - begun_s;
    assert!(took_s < LONGEST_S, "a motion took {took_s} s");
    match made {
        Ok(made) => assert!(made <= plan.steps().unsigned_abs(), "{made} steps made"),
        Err(fault) => assert!(fault.made_least <= fault.made_most, "{fault:?}"),
    }
    let begun_s = time_s();
    let _ = (grbl.disturbed(), grbl.count(), grbl.check(&plan).is_ok());
    let _ = (grbl.settle(1.0, &mut || ControlFlow::Continue(())).is_ok(), grbl.release().is_ok());
    let took_s = time_s() - begun_s;
    assert!(took_s < LONGEST_S, "the end took {took_s} s");
}
