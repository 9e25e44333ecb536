//! Errors of a TMC2209.

use thiserror::Error;

/// Error of a TMC2209 on a board's wire.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum TmcError {
    /// A setting is outside its range.
    #[error("{name} is {value}; allowed: {allowed}")]
    Setting {
        /// Key of the setting in the pump file.
        name: &'static str,
        /// Value of the setting.
        value: String,
        /// Values that are allowed, as the message words them.
        allowed: String,
    },
    /// The driver says nothing.
    #[error(
        "no TMC2209 answers at address {address} of its wire, asked {tries} times; switch on the motor supply, which \
         the chip needs to answer, and check the pins of its wire and its address"
    )]
    Silent {
        /// Address of the driver.
        address: u8,
        /// Number of questions.
        tries: u32,
    },
    /// The driver has answered, and does so no more in the middle of a motion.
    #[error(
        "the TMC2209 at address {address} of its wire answers no more, asked {tries} times, and it has answered \
         before: its motor supply was cut, as by an emergency stop, or its wire came off"
    )]
    FellSilent {
        /// Address of the driver.
        address: u8,
        /// Number of questions.
        tries: u32,
    },
    /// The answers are damaged.
    #[error(
        "the answers of the TMC2209 at address {address} are damaged ({damaged} of {tries} tries); check its wire, and \
         that no other driver on that wire has this address"
    )]
    Damaged {
        /// Address of the driver.
        address: u8,
        /// Number of damaged answers.
        damaged: u32,
        /// Number of questions.
        tries: u32,
    },
    /// Another chip is at the address.
    #[error(
        "the chip at address {address} tells version {version:#04x}, and a TMC2209 has {wanted:#04x}; name the wire \
         and the address of a TMC2209"
    )]
    OtherChip {
        /// Address of the chip.
        address: u8,
        /// Version that the chip tells.
        version: u8,
        /// Version of a TMC2209.
        wanted: u8,
    },
    /// The driver has not counted a write.
    #[error(
        "the TMC2209 at address {address} answers, and has not taken {register}, sent {tries} times; check its wire \
         and the resistor in it"
    )]
    NotCounted {
        /// Address of the driver.
        address: u8,
        /// Name of the register.
        register: &'static str,
        /// Number of writes.
        tries: u32,
    },
    /// The driver counts other writes than those that were sent.
    #[error(
        "the TMC2209 at address {address} counts {after} writes, and {before} before {register} was sent: it was \
         reset, or another program writes to it; look at the motor supply, and end the other program"
    )]
    Miscounted {
        /// Address of the driver.
        address: u8,
        /// Name of the register.
        register: &'static str,
        /// Count before the write.
        before: u8,
        /// Count after the write.
        after: u8,
    },
    /// The driver has another value than the one that was written.
    #[error(
        "the TMC2209 at address {address} has {register} = {found:#010x}, and {wanted:#010x} was written; check that \
         no other driver on that wire has this address"
    )]
    NotKept {
        /// Address of the driver.
        address: u8,
        /// Name of the register.
        register: &'static str,
        /// Value that was written.
        wanted: u32,
        /// Value that the driver tells.
        found: u32,
    },
    /// The driver was reset, so its motor was without current and its settings are lost.
    #[error(
        "the TMC2209 at address {address} was reset, so its motor was without current for a moment; look at the motor \
         supply"
    )]
    Reset {
        /// Address of the driver.
        address: u8,
    },
    /// The driver has switched its motor off.
    #[error("the TMC2209 at address {address} has switched its motor off: {faults}")]
    Off {
        /// Address of the driver.
        address: u8,
        /// Faults, as the message words them.
        faults: String,
    },
    /// The driver's enable input is off while the board gives the motor current.
    #[error(
        "the TMC2209 at address {address} tells that its enable input is off, so its motor has no current; check the \
         pin `enable` of the pump file and its `!`, that `address` is that of this motor's own TMC2209, and that no \
         emergency stop holds that line"
    )]
    Disabled {
        /// Address of the driver.
        address: u8,
    },
    /// The driver's enable input is on while the board takes the motor's current away.
    #[error(
        "the TMC2209 at address {address} tells that its enable input is on while the board switches the pin `enable` \
         off, so its motor keeps its current; switch the motor supply off before you touch the rotor, and check that \
         pin of the pump file, its `!`, and that `address` is that of this motor's own TMC2209"
    )]
    Enabled {
        /// Address of the driver.
        address: u8,
    },
}

impl TmcError {
    /// Returns the error of a driver that was asked `tries` times, and whose answers were damaged or did not come.
    pub(super) fn unanswered(address: u8, damaged: u32, tries: u32) -> Self {
        match damaged {
            0 => Self::Silent { address, tries },
            damaged => Self::Damaged { address, damaged, tries },
        }
    }
}
