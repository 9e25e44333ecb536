//! An oscilloscope at the pins of the emulated board: it reads QEMU's log of the board's registers.
//!
//! QEMU models no GPIO on this board, and logs each write as one to a device that is not there. The firmware reads its
//! clock after each write, and QEMU logs what it read. So count and order of the edges do not rest on what the firmware
//! says of them.

/// Time of a count of the board's timers, at 25 MHz (firmware/emulated), in ns.
const COUNT_NS: f64 = 40.0;

/// Words in QEMU's lines: a write to the pins, a read and a write of a timer.
const PIN_WRITE: &str = "unimplemented device write";
const TIMER_READ: &str = "timer read:";
const TIMER_WRITE: &str = "timer write:";

/// Registers of a timer (ARM DDI 0479, section 4.4) and of the pins (section 4.1).
const CONTROL: u32 = 0x0;
const VALUE: u32 = 0x4;
const MAKE_OUTPUTS: u32 = 0x10;
const MAKE_INPUTS: u32 = 0x14;
const LOW_BYTE: u32 = 0x400;
const HIGH_BYTE: u32 = 0x800;
const END: u32 = 0xc00;

/// Change of a pin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Edge {
    /// Time since the board was made, in ns.
    pub(crate) at_ns: f64,
    /// Number of the pin, which is one of GPIO 0.
    pub(crate) pin: u8,
    /// Level of the pin, or `None` while the board does not drive it.
    pub(crate) level: Option<bool>,
}

/// Oscilloscope at the pins.
#[derive(Debug, Default)]
pub(crate) struct Scope {
    /// Levels that the pins have or would have, and pins that are outputs, as bits.
    levels: u32,
    outputs: u32,
    /// Counts of the clock since the last reset, and its last value.
    counts: u64,
    last: u32,
    /// Time of the last reset, in ns.
    reset_ns: f64,
    /// Edges of the pins. The last `fresh` of them have no time yet.
    edges: Vec<Edge>,
    fresh: usize,
}

impl Scope {
    /// Takes the edges since the last call.
    pub(crate) fn take(&mut self) -> Vec<Edge> {
        self.fresh = 0;
        std::mem::take(&mut self.edges)
    }

    /// Begins anew at a reset of the board, whose time goes on.
    pub(crate) fn reset(&mut self, now_ns: f64) {
        self.reset_ns = now_ns;
    }

    /// Reads a line of the log. Returns true if the board has stopped its clock.
    pub(crate) fn read(&mut self, line: &str) -> bool {
        if line.contains(PIN_WRITE) {
            if let Some((offset, value)) = hex(line, "offset ").zip(hex(line, "value ")) {
                self.write_pins(offset, value);
            }
        } else if line.contains(TIMER_READ) {
            if let Some((VALUE, value)) = hex(line, "offset ").zip(hex(line, "data ")) {
                self.read_clock(!value);
            }
        } else if line.contains(TIMER_WRITE) {
            match hex(line, "offset ").zip(hex(line, "data ")) {
                // The clock begins. The alarm is never set that far.
                Some((VALUE, u32::MAX)) => (self.counts, self.last) = (0, 0),
                // The alarm is switched off by another bit.
                Some((CONTROL, 0)) => return true,
                _ => {}
            }
        }
        false
    }

    /// Takes a value of the clock, which gives the pins that have changed before it their time.
    fn read_clock(&mut self, count: u32) {
        self.counts += u64::from(count.wrapping_sub(self.last));
        self.last = count;
        let at_ns = self.reset_ns + COUNT_NS * self.counts as f64;
        for edge in self.edges.iter_mut().rev().take(self.fresh) {
            edge.at_ns = at_ns;
        }
        self.fresh = 0;
    }

    fn write_pins(&mut self, offset: u32, value: u32) {
        let before = (self.levels, self.outputs);
        match offset {
            MAKE_OUTPUTS => self.outputs |= value,
            MAKE_INPUTS => self.outputs &= !value,
            LOW_BYTE..HIGH_BYTE => self.write_levels((offset - LOW_BYTE) / 4, value),
            HIGH_BYTE..END => self.write_levels(((offset - HIGH_BYTE) / 4) << 8, value),
            _ => {}
        }
        for pin in 0..16 {
            let seen =
                |(levels, outputs): (u32, u32)| (outputs >> pin & 1 == 1).then_some(levels >> pin & 1 == 1);
            let level = seen((self.levels, self.outputs));
            if level != seen(before) {
                self.edges.push(Edge { at_ns: self.reset_ns, pin, level });
                self.fresh += 1;
            }
        }
    }

    /// Sets the levels of the pins in `mask`.
    fn write_levels(&mut self, mask: u32, value: u32) {
        self.levels = self.levels & !mask | value & mask;
    }
}

/// Returns the hexadecimal number that follows a word.
fn hex(line: &str, word: &str) -> Option<u32> {
    let (_, rest) = line.split_once(word)?;
    let digits = rest.strip_prefix("0x")?;
    let end = digits.find(|c: char| !c.is_ascii_hexdigit()).unwrap_or(digits.len());
    u32::from_str_radix(&digits[..end], 16).ok()
}
