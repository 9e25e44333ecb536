//! Settings of a driver, as the writes of its registers.

use super::current::Scale;
use super::error::TmcError;
use super::register::{
    CHOPCONF, COOLCONF, GCONF, GSTAT, IHOLD_IRUN, PWMCONF, PWMCONF_USUAL, Register, SLAVECONF, TCOOLTHRS,
    TPOWERDOWN, TPWMTHRS, VACTUAL, chopconf, gconf, gstat,
};
use crate::pump_file::WrongValue;
use crate::pump_file::tmc_range::{self, MICROSTEPS_MOST};

/// Delay of an answer: 3 times 8 bits. Several drivers on a wire need 2 at least, so that none takes the answer of
/// another for a request (chapter 5.1, SLAVECONF). The board waits for 64 bits (Klipper3d/klipper, `src/tmcuart.c`).
const ANSWER_DELAY: u32 = 2 << 8;

/// Clocks in units of 2^18 from the rest to the lower current, 5.6 s at the chip's 12 MHz: the longest (chapter 5.2).
///
/// A slow dose makes a step in some seconds, and each of them shall have the current of motion.
const POWER_DOWN: u32 = 255;

/// Clocks in units of 2^18 for each step down to the current at rest, 0.17 s at 12 MHz: no jerk moves the rotor.
const HOLD_DELAY: u32 = 8;

/// Way in which the chip makes the current.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(in crate::drives::klipper) enum Chopper {
    /// By voltage: silent.
    #[default]
    StealthChop,
    /// By current: more torque at speed, and audible.
    SpreadCycle,
}

impl From<WrongValue> for TmcError {
    fn from(wrong: WrongValue) -> Self {
        let (name, value, allowed) = wrong.parts();
        Self::Setting { name, value, allowed }
    }
}

/// Settings of a driver.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::drives::klipper) struct TmcSettings {
    address: u8,
    scale: Scale,
    microsteps: u16,
    chopper: Chopper,
}

impl TmcSettings {
    /// Makes the settings of the driver at an address: the motor's currents in motion and at rest in A (RMS), the sense
    /// resistor in Ohm, and the microsteps of a full step.
    ///
    /// # Errors
    ///
    /// [`TmcError::Setting`] if a value is outside its range.
    pub(in crate::drives::klipper) fn new(
        address: u8,
        (run_a, hold_a): (f64, f64),
        sense_ohm: f64,
        microsteps: u16,
        chopper: Chopper,
    ) -> Result<Self, TmcError> {
        tmc_range::check(address, sense_ohm, (run_a, hold_a))?;
        tmc_range::microsteps(microsteps.into(), 1)?;
        Ok(Self { address, scale: Scale::of(run_a, hold_a, sense_ohm), microsteps, chopper })
    }

    /// Returns the address of the driver.
    pub(super) fn address(&self) -> u8 {
        self.address
    }

    /// Returns the writes of registers in their order. The motor gets no current before the last of them, if its enable
    /// pin is off meanwhile.
    ///
    /// All registers are written on which the motor's way depends: another program may have left any of them otherwise,
    /// and a board that is reset does not reset its drivers.
    pub(in crate::drives::klipper) fn writes(&self) -> Vec<(Register, u32)> {
        let Scale { is_sensitive, run, hold } = self.scale;
        let chopper = if self.chopper == Chopper::SpreadCycle { gconf::EN_SPREADCYCLE } else { 0 };
        let chip = gconf::PDN_DISABLE | gconf::MSTEP_REG_SELECT | gconf::MULTISTEP_FILT;
        let resolution = (MICROSTEPS_MOST / u32::from(self.microsteps)).trailing_zeros();
        let sensitivity = if is_sensitive { chopconf::VSENSE } else { 0 };
        vec![
            (SLAVECONF, ANSWER_DELAY),
            // A reset from here on shows afterwards.
            (GSTAT, gstat::ALL),
            (VACTUAL, 0),
            (GCONF, chip | chopper),
            (IHOLD_IRUN, u32::from(hold) | u32::from(run) << 8 | HOLD_DELAY << 16),
            (TPOWERDOWN, POWER_DOWN),
            (TPWMTHRS, 0),
            (TCOOLTHRS, 0),
            (COOLCONF, 0),
            (PWMCONF, PWMCONF_USUAL),
            (CHOPCONF, chopconf::CHOPPER | chopconf::TBL | sensitivity | resolution << chopconf::MRES),
        ]
    }
}
