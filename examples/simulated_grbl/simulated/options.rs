//! What is simulated, and what is wrong with it.

use std::str::FromStr;
use std::time::Duration;

/// A simulated board.
#[derive(Debug, Clone)]
pub struct Options {
    /// How many times faster than a real board its motors run.
    pub time_scale: f64,
    /// Which firmware it says it has.
    pub firmware: Firmware,
    /// Whether opening the port resets it, as an Arduino is by its DTR line, unless DTR was left up by the last who had it open.
    pub resets_on_open: bool,
    /// From a reset to the banner.
    pub boot: Duration,
    /// Settings that differ from the usual ones.
    pub settings: Vec<(u16, f32)>,
    /// Where a sensor answers on the first axis.
    pub sensor: Option<Sensor>,
    /// What is wrong.
    pub defects: Defects,
}

/// Firmwares.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Firmware {
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

/// A sensor on the pump head.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sensor {
    /// First step of a revolution at which it answers.
    pub at: i64,
    /// For how many steps.
    pub width: i64,
    /// Steps of a revolution.
    pub every: i64,
}

impl Sensor {
    /// Whether it answers there.
    pub fn answers(&self, step: i64) -> bool {
        (step - self.at).rem_euclid(self.every) < self.width
    }
}

/// What is wrong with a board or its line. Places are steps that the motor has turned since it was switched on.
#[derive(Debug, Clone, Default)]
pub struct Defects {
    /// What is at random follows from this.
    pub seed: u64,
    /// Longest delay of the answer to a jog, and to what comes after one.
    pub late_ok: Duration,
    /// How many jog cancels are missed.
    pub lost_cancels: u32,
    /// An alarm of this number.
    pub alarm: Option<(u64, u16)>,
    /// Which jog is refused (1 for the first), and with which error.
    pub refuses: Option<(u32, u16)>,
    /// The processor is reset.
    pub resets: Option<u64>,
    /// The cable is pulled; the motor goes on with what the board has.
    pub unplugged: Option<u64>,
    /// Nothing more is said.
    pub silent: Option<u64>,
    /// The motor stands, and the board says that it jogs.
    pub stalls: Option<u64>,
    /// The board's counter jumps by so many steps.
    pub miscounts: Option<(u64, i64)>,
    /// Noise among the lines.
    pub noise: bool,
    /// Lines come in pieces, and several at once, and some run into each other.
    pub chopped: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            time_scale: 1.0,
            firmware: Firmware::Grbl,
            resets_on_open: false,
            boot: Duration::from_millis(60),
            settings: Vec::new(),
            sensor: None,
            defects: Defects::default(),
        }
    }
}

/// Numbers that look random (xorshift64*, Vigna 2016).
#[derive(Debug)]
pub struct Random(u64);

impl Random {
    /// The same for the same seed.
    pub fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1)
    }

    /// 0 to `end` - 1.
    pub fn below(&mut self, end: u64) -> u64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 33) % end.max(1)
    }
}
