//! Registers of a TMC2209 and their bits (datasheet, chapter 5).

/// Register of a TMC2209.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::drives::klipper) struct Register {
    /// Number of the register.
    pub(super) number: u8,
    /// Name of the register in the datasheet.
    pub(super) name: &'static str,
    /// True if the register tells what was written to it.
    pub(super) is_readable: bool,
}

const fn readable(number: u8, name: &'static str) -> Register {
    Register { number, name, is_readable: true }
}

const fn write_only(number: u8, name: &'static str) -> Register {
    Register { number, name, is_readable: false }
}

/// Configuration of the chip as a whole.
pub(super) const GCONF: Register = readable(0x00, "GCONF");

/// Events since they were cleared. A written 1 clears its bit, so the register does not tell what was written.
pub(super) const GSTAT: Register = write_only(0x01, "GSTAT");

/// Number of writes that came undamaged, modulo 256.
pub(super) const IFCNT: Register = readable(0x02, "IFCNT");

/// Delay of answers.
pub(super) const SLAVECONF: Register = write_only(0x03, "SLAVECONF");

/// Levels of the pins, and the version of the chip in the highest byte.
pub(super) const IOIN: Register = readable(0x06, "IOIN");

/// Bit of IOIN: the level of the pin ENN, which takes the motor's current away where it is high.
pub(super) const ENN: u32 = 1;

/// Currents in motion and at rest.
pub(super) const IHOLD_IRUN: Register = write_only(0x10, "IHOLD_IRUN");

/// Time from the last step to the current at rest.
pub(super) const TPOWERDOWN: Register = write_only(0x11, "TPOWERDOWN");

/// Speed above which the chip leaves StealthChop. 0 never does.
pub(super) const TPWMTHRS: Register = write_only(0x13, "TPWMTHRS");

/// Speed above which the chip adapts the current to the load. 0 never does.
pub(super) const TCOOLTHRS: Register = write_only(0x14, "TCOOLTHRS");

/// Speed of a motor that turns by itself. 0 gives the motor to the step pin.
pub(super) const VACTUAL: Register = write_only(0x22, "VACTUAL");

/// Adaptation of the current to the load. 0 switches it off.
pub(super) const COOLCONF: Register = write_only(0x42, "COOLCONF");

/// Chopper, microsteps and sensitivity.
pub(super) const CHOPCONF: Register = readable(0x6c, "CHOPCONF");

/// Faults, warnings and the current now.
pub(super) const DRV_STATUS: Register = readable(0x6f, "DRV_STATUS");

/// Chopper of StealthChop.
pub(super) const PWMCONF: Register = readable(0x70, "PWMCONF");

/// Version of a TMC2209 in the highest byte of IOIN.
pub(super) const VERSION: u8 = 0x21;

/// Bits of GCONF. Those that are not here stay 0: the current is measured by resistors (`internal_Rsense`) against the
/// chip's own reference (`I_scale_analog`), and the direction pin is not turned round (`shaft`).
pub(super) mod gconf {
    /// SpreadCycle in place of StealthChop.
    pub(in super::super) const EN_SPREADCYCLE: u32 = 1 << 2;
    /// The pin PDN_UART is a wire alone, and does not lower the current.
    pub(in super::super) const PDN_DISABLE: u32 = 1 << 6;
    /// Microsteps by CHOPCONF, and not by pins that are the address.
    pub(in super::super) const MSTEP_REG_SELECT: u32 = 1 << 7;
    /// Filter of the step pulse's speed, as at power-up.
    pub(in super::super) const MULTISTEP_FILT: u32 = 1 << 8;
}

/// Fields of CHOPCONF. Interpolation (bit 28) and steps at both edges (bit 29) stay 0.
pub(super) mod chopconf {
    /// Slow decay of 3, hysteresis of 5 and 0, as at power-up. 0 would switch the motor off.
    pub(in super::super) const CHOPPER: u32 = 0x53;
    /// Blank time of 32 clocks, as at power-up by the field `otp_TBL`.
    pub(in super::super) const TBL: u32 = 2 << 15;
    /// Sensitive measurement of the current.
    pub(in super::super) const VSENSE: u32 = 1 << 17;
    /// Place of the microsteps: 0 for 256, 8 for full steps.
    pub(in super::super) const MRES: u32 = 24;
}

/// Value of PWMCONF at power-up, which tunes itself (`pwm_autoscale`, `pwm_autograd`).
pub(super) const PWMCONF_USUAL: u32 = 0xc10d_0024;

/// Bits of GSTAT: the chip was reset, it switched its motor off, its charge pump had too little voltage.
pub(super) mod gstat {
    /// The chip was reset, so its registers are those of power-up.
    pub(in super::super) const RESET: u32 = 1 << 0;
    /// The chip switched its motor off.
    pub(in super::super) const DRV_ERR: u32 = 1 << 1;
    /// The charge pump has too little voltage, and the motor is off meanwhile.
    pub(in super::super) const UV_CP: u32 = 1 << 2;
    /// All of them.
    pub(in super::super) const ALL: u32 = RESET | DRV_ERR | UV_CP;
}
