//! The options of a simulated board, and its defects.

use std::str::FromStr;
use std::time::Duration;

/// Options of a simulated board.
#[derive(Debug, Clone)]
pub(crate) struct Options {
    /// Factor by which its motors run faster than a real board's.
    pub time_scale: f64,
    /// Firmware that the board says it has.
    pub firmware: Firmware,
    /// Text that somebody gave the board with `$I=`.
    pub text: &'static str,
    /// True if opening the port resets the board, as the DTR line does to an Arduino. A DTR that the last
    /// user of the port left up resets nothing.
    pub resets_on_open: bool,
    /// Time from a reset to the banner.
    pub boot: Duration,
    /// Settings that differ from the usual ones.
    pub settings: Vec<(u16, f32)>,
    /// Number of axes that the board reports. grbl 1.1 has three, and the first alone has a motor here.
    pub axes: usize,
    /// Sensor on the first axis, if there is one.
    pub sensor: Option<Sensor>,
    /// Time between status reports that nobody asked for, as grblHAL's `$481` sets it.
    pub auto_report: Option<Duration>,
    /// True if the board sends messages without end.
    pub chatters: bool,
    /// True if time stands still on the board while nothing is heard from its user, so that a busy machine
    /// keeps up with it.
    pub patient: bool,
    /// Defects of the board and its line.
    pub defects: Defects,
}

/// Firmware of a board.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Firmware {
    /// grbl 1.1h.
    Grbl,
    /// grbl 0.9j, which has no jogs.
    Grbl09,
    /// grblHAL.
    GrblHal,
    /// FluidNC as of 2022, which lists few settings and has the others as items of its configuration.
    FluidNc,
}

impl FromStr for Firmware {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        match name {
            "grbl" => Ok(Self::Grbl),
            "grbl09" => Ok(Self::Grbl09),
            "grblhal" => Ok(Self::GrblHal),
            "fluidnc" => Ok(Self::FluidNc),
            other => Err(format!("no firmware {other}: grbl, grbl09, grblhal or fluidnc")),
        }
    }
}

/// Sensor on the pump head.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Sensor {
    /// First step of a revolution at which the sensor answers.
    pub at: i64,
    /// Number of steps for which the sensor answers.
    pub width: i64,
    /// Number of steps of a revolution.
    pub every: i64,
}

impl Sensor {
    /// Returns true if the sensor answers at `step`.
    pub(crate) fn answers(&self, step: i64) -> bool {
        (step - self.at).rem_euclid(self.every) < self.width
    }
}

/// Defects of a board or its line. Places are steps that the motor has turned since it was switched on.
#[derive(Debug, Clone, Default)]
pub(crate) struct Defects {
    /// Seed of everything random.
    pub seed: u64,
    /// Longest delay of the answer to a jog, and to what comes after one.
    pub late_ok: Duration,
    /// Number of jog cancels that the board misses.
    pub lost_cancels: u32,
    /// Place and number of an alarm.
    pub alarm: Option<(u64, u16)>,
    /// Number of the jog that is refused (1 for the first), and its error.
    pub refuses: Option<(u32, u16)>,
    /// Place at which the processor is reset.
    pub resets: Option<u64>,
    /// Place at which the cable is pulled. The motor goes on with the jogs that the board has.
    pub unplugged: Option<u64>,
    /// Place from which the board says nothing more.
    pub silent: Option<u64>,
    /// Place from which the board answers no question for its position.
    pub deaf: Option<u64>,
    /// Place from which the motor stands while the board says that it jogs.
    pub stalls: Option<u64>,
    /// Place at which the board's counter jumps, and the number of steps by which it jumps.
    pub miscounts: Option<(u64, i64)>,
    /// Place at which somebody else sends a byte: `!` is a hold button, 0x85 a jog cancel.
    pub pressed: Option<(u64, u8)>,
    /// Place at which somebody else jogs, and the way, mm.
    pub foreign: Option<(u64, f32)>,
    /// Number of the jog that is damaged on the wire (1 for the first), and the first digit that arrives.
    pub garbles: Option<(u32, char)>,
    /// Number of the jog that goes twice as far as it says (1 for the first).
    pub stretches: Option<u32>,
    /// Place at which the motor misses steps, their number, and the place at which the counter learns of them.
    pub misses: Option<(u64, i64, u64)>,
    /// Number of the list of settings with a flipped bit (1 for the first), its setting, and the value there.
    pub misreads: Option<(u32, u16, f32)>,
    /// True if there is noise among the lines.
    pub noise: bool,
    /// True if lines come in pieces or several at once, and some run into each other.
    pub chopped: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            time_scale: 1.0,
            firmware: Firmware::Grbl,
            text: "",
            resets_on_open: false,
            boot: Duration::from_millis(60),
            settings: Vec::new(),
            axes: 3,
            sensor: None,
            auto_report: None,
            chatters: false,
            patient: false,
            defects: Defects::default(),
        }
    }
}

/// Generator of numbers that look random (xorshift64*, Vigna 2016).
#[derive(Debug)]
pub(crate) struct Random(u64);

impl Random {
    /// Returns a generator that gives equal numbers for equal seeds.
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1)
    }

    /// Returns a number from 0 to `end` - 1.
    pub(crate) fn below(&mut self, end: u64) -> u64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 33) % end.max(1)
    }
}
