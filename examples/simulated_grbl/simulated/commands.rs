//! The lines that a simulated board understands.

use super::machine::{Machine, State};
use super::motor::OTHERS;
use super::number::read;
use super::options::Firmware;

/// Time for which a board is deaf while it stores a setting, s.
const STORING_S: f64 = 0.004;

/// Slowest feed of the planner, mm/min.
const LEAST_FEED_MM_MIN: f32 = 1.0;

/// An inch, mm.
const INCH_MM: f32 = 25.4;

/// Words of a line of G-code.
#[derive(Debug, Default)]
struct Words {
    codes: Vec<String>,
    target: Option<f32>,
    /// Targets of the axes that go along with the first.
    others: [Option<f32>; OTHERS],
    feed: Option<f32>,
}

impl Machine {
    /// Executes a line and answers, now or once the line is done.
    pub(super) fn execute(&mut self, line: &str) {
        let answer = match line.strip_prefix('$') {
            None if line.is_empty() => Ok(()),
            None => match self.g_code(line) {
                Ok(true) => return,
                Ok(false) => Ok(()),
                Err(code) => Err(code),
            },
            Some(command) => match command.strip_prefix("J=") {
                Some(words) => match self.jog(words) {
                    Ok(true) => return,
                    Ok(false) => Ok(()),
                    Err(code) => Err(code),
                },
                None => match self.command(command) {
                    // The answer comes once the setting is stored.
                    Ok(()) if self.storing_s > 0.0 => return,
                    answer => answer,
                },
            },
        };
        self.answer(answer);
    }

    fn command(&mut self, command: &str) -> Result<(), u16> {
        if matches!(self.state, State::Jog | State::Run | State::Hold) {
            return Err(8);
        }
        if self.state == State::Sleep {
            return Err(8);
        }
        match command {
            "$" => {
                self.lists += 1;
                for line in self.settings.lines() {
                    let (key, _) = line.split_once('=').unwrap_or_default();
                    let misread = self
                        .defects
                        .misreads
                        .filter(|(list, number, _)| *list == self.lists && key == format!("${number}"));
                    let told = misread.map(|(_, _, value)| format!("{key}={value:.3}"));
                    self.say(&told.unwrap_or(line));
                }
            }
            "I" => self.say_version(),
            "G" => {
                let unit = if self.inches { "G20" } else { "G21" };
                let distance = if self.relative { "G91" } else { "G90" };
                let motion = self.motion;
                self.say(&format!("[GC:{motion} G54 G17 {unit} {distance} G94 M5 M9 T0 F0 S0]"));
            }
            "X" => {
                if self.state == State::Alarm {
                    self.say("[MSG:Caution: Unlocked]");
                    self.state = State::Idle;
                }
            }
            "SLP" => {
                self.state = State::Sleep;
                self.say("[MSG:Sleeping]");
            }
            "MD" if self.firmware == Firmware::FluidNc => {}
            _ => return self.setting(command),
        }
        Ok(())
    }

    fn say_version(&mut self) {
        let version = match self.firmware {
            Firmware::Grbl => "VER:1.1h.20190830",
            Firmware::Grbl09 => "0.9j.20160303",
            Firmware::GrblHal => "VER:1.1f.20240205",
            Firmware::FluidNc => "VER:3.7 FluidNC v3.7.8",
        };
        self.say(&format!("[{version}:{}]", self.text));
        self.say("[OPT:V,15,128]");
        if self.firmware == Firmware::GrblHal {
            self.say("[FIRMWARE:grblHAL]");
        }
    }

    fn setting(&mut self, command: &str) -> Result<(), u16> {
        if let Some(path) = command.strip_prefix('/') {
            let item =
                self.settings.item(&path.to_lowercase()).filter(|_| self.firmware == Firmware::FluidNc);
            self.say(&item.ok_or(3_u16)?);
            return Ok(());
        }
        let (number, value) = command.split_once('=').ok_or(3_u16)?;
        let number = number.parse().map_err(|_| 3_u16)?;
        let (value, rest) = read(value).ok_or(2_u16)?;
        if !rest.is_empty() {
            return Err(2);
        }
        self.settings.set(number, value)?;
        self.apply();
        self.storing_s = STORING_S;
        Ok(())
    }

    /// Queues a jog. Returns true if the jog has to wait for room.
    pub(super) fn jog(&mut self, words: &str) -> Result<bool, u16> {
        if !matches!(self.state, State::Idle | State::Jog) {
            return Err(8);
        }
        self.jogs += 1;
        if let Some((which, code)) = self.defects.refuses
            && which == self.jogs
        {
            return Err(code);
        }
        let words = match self.defects.garbles {
            Some((which, digit)) if which == self.jogs => parse(&garbled(words, digit))?,
            _ => parse(words)?,
        };
        let has = |code: &str| words.codes.iter().any(|word| word == code);
        if words.codes.iter().any(|code| !["G20", "G21", "G53", "G90", "G91"].contains(&code.as_str())) {
            return Err(16);
        }
        let inches = (self.inches || has("G20")) && !has("G21");
        let unit_mm = if inches { INCH_MM } else { 1.0 };
        if words.target.is_none() && words.others == [None; OTHERS] {
            return Err(26);
        }
        let feed = words.feed.ok_or(22_u16)? * unit_mm;
        let relative = (self.relative || has("G91")) && !has("G90");
        let mm = match words.target.map(|target| target * unit_mm) {
            None => self.planned_mm(),
            Some(target) if relative => target + self.planned_mm(),
            Some(target) if has("G53") => target,
            Some(target) => target + self.offset_mm,
        };
        if self.settings.get(20) != 0.0 && !(-self.settings.get(130)..=0.0).contains(&mm) {
            return Err(15);
        }
        let farther = if self.defects.stretches == Some(self.jogs) { mm - self.planned_mm() } else { 0.0 };
        let others = words.others.map(|other| other.map(|place| place * unit_mm));
        let waits = self.way(mm + farther, feed, others)?;
        self.state = State::Jog;
        Ok(waits)
    }

    /// Coordinate at which the planner's queue ends, mm.
    fn planned_mm(&self) -> f32 {
        (self.motor.planned() + self.miscounted) as f32 / self.settings.get(100)
    }

    /// Queues a way to `mm` at `feed` mm/min along it, with the other axes that have a target. Returns true if there is
    /// no room.
    fn way(&mut self, mm: f32, feed: f32, targets: [Option<f32>; OTHERS]) -> Result<bool, u16> {
        let end = f64::from(mm * self.settings.get(100)).round() as i64 - self.miscounted;
        let mut others = self.motor.planned_others();
        let mut way_mm = Vec::new();
        if end != self.motor.planned() {
            way_mm.push((0, f64::from(mm - self.planned_mm()).abs()));
        }
        for (axis, (place, target)) in (1..).zip(others.iter_mut().zip(targets)) {
            let steps_per_mm = self.settings.get(100 + axis);
            if let Some(target) = target {
                let before = *place;
                *place = f64::from(target * steps_per_mm).round() as i64;
                if *place != before {
                    way_mm.push((axis, f64::from(target - before as f32 / steps_per_mm).abs()));
                }
            }
        }
        // The queue's way is that of the first axis that moves.
        let Some(&(first, first_mm)) = way_mm.first() else { return Ok(false) };
        let length_mm = way_mm.iter().map(|(_, mm)| mm * mm).sum::<f64>().sqrt();
        let share = |way_mm: f64| if length_mm > 0.0 { way_mm / length_mm } else { 1.0 };
        let allowed = way_mm.iter().map(|(axis, mm)| f64::from(self.settings.get(110 + axis)) / share(*mm));
        let feed =
            f64::from(feed).min(allowed.fold(f64::INFINITY, f64::min)).max(f64::from(LEAST_FEED_MM_MIN));
        let steps_s = feed * share(first_mm) * f64::from(self.settings.get(100 + first)) / 60.0;
        if self.motor.is_full() {
            self.pending = Some((end, steps_s, others));
            return Ok(true);
        }
        self.motor.push(end, steps_s, others);
        Ok(false)
    }

    /// Sets modes, and probes. Returns true if the answer comes at the end of the motion.
    fn g_code(&mut self, line: &str) -> Result<bool, u16> {
        if matches!(self.state, State::Alarm | State::Jog | State::Sleep) {
            return Err(9);
        }
        let words = parse(line)?;
        let mut probes = false;
        for code in &words.codes {
            match code.as_str() {
                "G20" => self.inches = true,
                "G21" => self.inches = false,
                "G90" => self.relative = false,
                "G91" => self.relative = true,
                "G94" => {}
                "G0" => self.motion = "G0",
                "G1" => self.motion = "G1",
                "G80" => self.motion = "G80",
                "G38.2" => {
                    self.motion = "G38.2";
                    probes = true;
                }
                _ => return Err(20),
            }
        }
        if !probes {
            return if words.target.is_some() { Err(31) } else { Ok(false) };
        }
        let feed = words.feed.ok_or(22_u16)?;
        let target = words.target.ok_or(26_u16)?;
        if self.touches() {
            self.say("ALARM:4");
            self.state = State::Alarm;
            return Ok(false);
        }
        let mm = if self.relative { target + self.planned_mm() } else { target + self.offset_mm };
        self.way(mm, feed, [None; OTHERS])?;
        self.state = State::Run;
        Ok(true)
    }
}

/// Reads letters with their numbers.
fn parse(line: &str) -> Result<Words, u16> {
    let mut words = Words::default();
    let mut rest = line;
    while let Some(letter) = rest.chars().next() {
        if !letter.is_ascii_uppercase() {
            return Err(1);
        }
        let (value, after) = read(&rest[1..]).ok_or(2_u16)?;
        let text = &rest[..rest.len() - after.len()];
        match letter {
            'G' => words.codes.push(text.to_owned()),
            'X' if words.target.replace(value).is_some() => return Err(25),
            'F' if words.feed.replace(value).is_some() => return Err(25),
            'X' | 'F' => {}
            'Y' if words.others[0].replace(value).is_some() => return Err(25),
            'Z' if words.others[1].replace(value).is_some() => return Err(25),
            'Y' | 'Z' => {}
            _ => return Err(20),
        }
        rest = after;
    }
    Ok(words)
}

/// Returns the words of a jog with another first digit of its target.
fn garbled(words: &str, digit: char) -> String {
    let mut in_target = false;
    let mut done = false;
    let change = |letter: char| {
        in_target = in_target || letter == 'X';
        if in_target && !done && letter.is_ascii_digit() {
            done = true;
            return digit;
        }
        letter
    };
    words.chars().map(change).collect()
}
