//! Dictionaries that cannot be used.

use thiserror::Error;

/// Dictionary of a board that cannot be read, or lacks what is needed.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum DictionaryError {
    /// The dictionary is too large.
    #[error("the board's dictionary has more than {most} {form} bytes; load its firmware anew")]
    Large {
        /// Form in which it was counted, as the message words it.
        form: &'static str,
        /// Most bytes of that form.
        most: usize,
    },
    /// The dictionary is not compressed as it should be.
    #[error("the board's dictionary of {bytes} bytes is cut off or damaged; load its firmware anew")]
    Damaged {
        /// Bytes of the dictionary.
        bytes: usize,
    },
    /// The dictionary is no JSON of the documented form.
    #[error("the board's dictionary cannot be read ({reason}); load its firmware anew")]
    Unreadable {
        /// Cause, as the parser tells it.
        reason: String,
    },
    /// An entry of the dictionary cannot be understood.
    #[error(
        "the board's dictionary has the {entry} `{text}`, which this program cannot read; load other firmware"
    )]
    Entry {
        /// Kind of the entry, as the message words it.
        entry: &'static str,
        /// Text of the entry.
        text: String,
    },
    /// Two entries of the dictionary contradict each other.
    #[error("the board's dictionary has {entry} `{text}` twice; load its firmware anew")]
    Twice {
        /// Kind of the entry, as the message words it.
        entry: &'static str,
        /// Text of the entry.
        text: String,
    },
    /// The firmware lacks a command or a message that is needed.
    #[error("the board's firmware ({version}) lacks the {entry} `{wanted}`; load firmware that has it")]
    Lacks {
        /// Version of the firmware.
        version: String,
        /// Kind of the entry, as the message words it.
        entry: &'static str,
        /// Entry that is needed.
        wanted: String,
    },
    /// The firmware has a command or a message with other parameters.
    #[error(
        "the board's firmware ({version}) has `{found}`, and this program knows it as `{wanted}`; load firmware of \
         another version"
    )]
    Differs {
        /// Version of the firmware.
        version: String,
        /// Entry of the dictionary.
        found: String,
        /// Entry that is needed.
        wanted: String,
    },
    /// A constant has a value that cannot be used.
    #[error("the board's firmware says {name} = {value}, and it must be {allowed}; load its firmware anew")]
    Constant {
        /// Name of the constant.
        name: String,
        /// Value of the constant.
        value: String,
        /// Values that are allowed, as the message words them.
        allowed: String,
    },
    /// The board has no pin of this name.
    #[error("the board ({mcu}) has no pin `{pin}`; its pins are {pins}")]
    Pin {
        /// Name of the pin.
        pin: String,
        /// Microcontroller of the board.
        mcu: String,
        /// Pins of the board, as the message words them.
        pins: String,
    },
    /// The firmware itself uses the pin.
    #[error("the board's firmware uses the pin `{pin}` as {used_as}; name another pin")]
    Reserved {
        /// Name of the pin.
        pin: String,
        /// Use of the pin, by the name of the constant that reserves it.
        used_as: String,
    },
    /// A name of a choice is unknown to the firmware.
    #[error("the board has no {choice} `{name}`; it has {allowed}")]
    Choice {
        /// Kind of choice, as `spi_bus`.
        choice: String,
        /// Name that was looked for.
        name: String,
        /// Names that there are, as the message words them.
        allowed: String,
    },
}
