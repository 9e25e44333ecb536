//! Messages that cannot be written or read.

use thiserror::Error;

/// Message that cannot be written for a board, or read from one.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum MessageError {
    /// The content of a block ends within a message.
    #[error("a message of the board ends within a value")]
    CutOff,
    /// A number goes on for too long.
    #[error("a number has more than {most} bytes")]
    LongNumber {
        /// Most bytes of a number.
        most: usize,
    },
    /// The board sent a message that its dictionary lacks.
    #[error("the board sent message {id}, which its dictionary lacks; load its firmware anew")]
    Unknown {
        /// Number of the message.
        id: i32,
    },
    /// A message of the board lacks a value.
    #[error("the board's message `{message}` has no {kind} `{parameter}`; load its firmware anew")]
    Missing {
        /// Name of the message.
        message: String,
        /// Kind of value that was looked for.
        kind: &'static str,
        /// Name of the value that was looked for.
        parameter: String,
    },
    /// A value does not fit its parameter.
    #[error("`{command}` takes {least} to {most} as `{parameter}`, and {value} was given")]
    Range {
        /// Name of the command.
        command: String,
        /// Name of the parameter.
        parameter: String,
        /// Value that was given.
        value: i64,
        /// Least value.
        least: i64,
        /// Most value.
        most: i64,
    },
    /// The values do not fit the parameters.
    #[error("`{format}` takes other values than the {given} that were given")]
    Values {
        /// Format of the command.
        format: String,
        /// Number of values that were given.
        given: usize,
    },
    /// A command is too long for a block.
    #[error("`{command}` has {bytes} bytes, and a block takes {most} at most")]
    Long {
        /// Name of the command.
        command: String,
        /// Bytes of the command.
        bytes: usize,
        /// Most bytes of a block's content.
        most: usize,
    },
}
