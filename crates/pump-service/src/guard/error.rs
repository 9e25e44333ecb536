//! Words to the guard that it does not take.

use thiserror::Error;

/// Word to the guard that it does not take. Nothing has changed.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum GuardError {
    /// The configuration has no such input.
    #[error("there is no input `{}`; the configuration names {known}", name.escape_debug())]
    UnknownInput {
        /// Name that was given.
        name: String,
        /// Names of the configuration.
        known: String,
    },
    /// The input has a command, which alone speaks for it.
    #[error(
        "input {0} has a `command`, which alone speaks for it; take that out of the configuration to tell it"
    )]
    OfCommand(String),
    /// The input has a topic of MQTT, which alone speaks for it.
    #[error(
        "input {0} has a `topic`, which alone speaks for it; send its words there, or take that out of the \
         configuration"
    )]
    OfTopic(String),
}
