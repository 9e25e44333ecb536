//! Reads and confirmed writes of a driver's registers.

use super::datagram::{self, ANSWER_BYTES};
use super::error::TmcError;
use super::frames::{pack, packed_len, unpack};
use super::register::{DRV_STATUS, ENN, GSTAT, IFCNT, IOIN, Register, VERSION};
use super::settings::TmcSettings;
use super::status::TmcStatus;

/// Tries of a read or a write. Motor cables disturb single bits.
pub(super) const TRIES: u32 = 3;

/// Most writes that the count may have gone on by after one: a command of the board's may have been carried out again.
const COUNTED_MOST: u8 = 8;

/// Rate of the wire in bits/s, and of a board with a slow clock. A TMC2209 takes 9,600 to 500,000 (datasheet, chapter
/// 4). The board makes each bit by an interrupt, and keeps time for the steps so.
const RATE: u32 = 40_000;
const SLOW_RATE: u32 = 10_000;

/// Clock in Hz below which a board is slow, as those with an AVR are (16 or 20 MHz).
const SLOW_BELOW_HZ: u32 = 32_000_000;

/// Returns the ticks of a bit on the wire, for the board's `config_tmcuart`.
pub(in crate::drives::klipper) fn bit_ticks(clock_hz: u32) -> u32 {
    clock_hz / if clock_hz < SLOW_BELOW_HZ { SLOW_RATE } else { RATE }
}

/// Wire to drivers: the board's `tmcuart_send` and its `tmcuart_response`.
pub(in crate::drives::klipper) trait TmcLine {
    /// Error of the line, which takes up those of a driver.
    type Error: From<TmcError>;

    /// Sends bits, and returns those of an answer of `answer` bytes. No byte is an answer that did not come.
    ///
    /// The line has a deadline of its own, and never returns the answer to an earlier exchange.
    ///
    /// # Errors
    ///
    /// The line's error if the board does not tell how the exchange ended.
    fn exchange(&mut self, bits: &[u8], answer: usize) -> Result<Vec<u8>, Self::Error>;
}

/// Returns the bits that ask the driver at an address for a register.
pub(super) fn question(address: u8, register: Register) -> Vec<u8> {
    pack(&datagram::read(address, register.number))
}

/// Returns the value of a register that the bits of an answer tell. `None` if they are damaged.
pub(super) fn value_of(bits: &[u8], register: Register) -> Option<u32> {
    unpack(bits, ANSWER_BYTES).and_then(|bytes| datagram::answer(&bytes, register.number))
}

/// TMC2209 on a line.
#[derive(Debug)]
pub(in crate::drives::klipper) struct Tmc<'a, L> {
    line: &'a mut L,
    address: u8,
}

impl<'a, L: TmcLine> Tmc<'a, L> {
    /// Makes the driver at an address of a line. Nothing is sent yet.
    pub(in crate::drives::klipper) fn new(line: &'a mut L, address: u8) -> Self {
        Self { line, address }
    }

    /// Writes the settings of a driver, each confirmed, and returns its state afterwards.
    ///
    /// The motor's enable pin is off meanwhile. The delay of answers comes first, and unconfirmed: until each driver of
    /// a wire has it, one may take the answer of another for a request.
    ///
    /// # Errors
    ///
    /// The line's error, or a [`TmcError`] if the driver does not answer, is another chip or does not take a setting.
    pub(in crate::drives::klipper) fn configure(
        line: &'a mut L,
        settings: &TmcSettings,
    ) -> Result<TmcStatus, L::Error> {
        let mut driver = Self::new(line, settings.address());
        let writes = settings.writes();
        if let Some((first, value)) = writes.first() {
            driver.send(*first, *value)?;
        }
        let version = driver.read(IOIN)?.to_be_bytes()[0];
        if version != VERSION {
            let address = driver.address;
            return Err(TmcError::OtherChip { address, version, wanted: VERSION }.into());
        }
        for (register, value) in &writes {
            driver.write(*register, *value)?;
        }
        driver.check()
    }

    /// Returns the value of a register.
    ///
    /// # Errors
    ///
    /// The line's error; [`TmcError::Silent`] or [`TmcError::Damaged`] if no try brought an answer.
    pub(in crate::drives::klipper) fn read(&mut self, register: Register) -> Result<u32, L::Error> {
        let request = question(self.address, register);
        let mut damaged = 0;
        for _ in 0..TRIES {
            let bits = self.line.exchange(&request, packed_len(ANSWER_BYTES))?;
            if bits.is_empty() {
                continue;
            }
            match value_of(&bits, register) {
                Some(value) => return Ok(value),
                None => damaged += 1,
            }
        }
        Err(TmcError::unanswered(self.address, damaged, TRIES).into())
    }

    /// Writes a register, and has the driver's count and the register itself confirm it, as far as it can be read.
    ///
    /// # Errors
    ///
    /// The line's error; a [`TmcError`] if the driver does not answer, does not count the write, or has another value.
    pub(in crate::drives::klipper) fn write(
        &mut self,
        register: Register,
        value: u32,
    ) -> Result<(), L::Error> {
        let before = self.count()?;
        let (address, name) = (self.address, register.name);
        for _ in 0..TRIES {
            self.send(register, value)?;
            let after = self.count()?;
            match after.wrapping_sub(before) {
                0 => {}
                1..=COUNTED_MOST => return self.verify(register, value),
                _ => return Err(TmcError::Miscounted { address, register: name, before, after }.into()),
            }
        }
        Err(TmcError::NotCounted { address, register: name, tries: TRIES }.into())
    }

    /// Refuses to go on if a register that can be read has another value.
    ///
    /// # Errors
    ///
    /// The line's error; [`TmcError::NotKept`] if the value is another one.
    pub(in crate::drives::klipper) fn verify(
        &mut self,
        register: Register,
        wanted: u32,
    ) -> Result<(), L::Error> {
        if !register.is_readable {
            return Ok(());
        }
        let found = self.read(register)?;
        if found == wanted {
            return Ok(());
        }
        Err(TmcError::NotKept { address: self.address, register: register.name, wanted, found }.into())
    }

    /// Returns the state of the driver, which has its settings and no fault.
    ///
    /// # Errors
    ///
    /// The line's error; [`TmcError::Reset`] or [`TmcError::Off`] if the motor has lost its current.
    pub(in crate::drives::klipper) fn check(&mut self) -> Result<TmcStatus, L::Error> {
        let status = TmcStatus { events: self.read(GSTAT)?, flags: self.read(DRV_STATUS)? };
        Ok(status.checked(self.address)?)
    }

    /// Refuses to go on if the driver's enable input is not on, or not off, as the board's pin is to have it.
    ///
    /// # Errors
    ///
    /// The line's error; [`TmcError::Disabled`] or [`TmcError::Enabled`] if the input is otherwise.
    pub(in crate::drives::klipper) fn check_enable(&mut self, is_on: bool) -> Result<(), L::Error> {
        let address = self.address;
        match (is_on, self.read(IOIN)? & ENN) {
            (true, 0) | (false, ENN) => Ok(()),
            (true, _) => Err(TmcError::Disabled { address }.into()),
            (false, _) => Err(TmcError::Enabled { address }.into()),
        }
    }

    /// Returns the number of writes that the driver has counted, modulo 256.
    fn count(&mut self) -> Result<u8, L::Error> {
        Ok(self.read(IFCNT)?.to_be_bytes()[3])
    }

    /// Sends a write, to which a driver answers nothing.
    fn send(&mut self, register: Register, value: u32) -> Result<(), L::Error> {
        let request = pack(&datagram::write(self.address, register.number, value));
        self.line.exchange(&request, 0)?;
        Ok(())
    }
}
