//! Reasons why an order is refused before any command sees it.

use thiserror::Error;

/// Order that is refused. Nothing has moved.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum OrderError {
    /// The option does not exist for this task, or is not for orders.
    #[error("--{option} is no option of this order; allowed: {allowed}")]
    Option {
        /// Name of the option, without dashes.
        option: String,
        /// Options that the task has.
        allowed: String,
    },
    /// The option needs a value, or takes none.
    #[error("--{option} {wrong}; {instead}")]
    Value {
        /// Name of the option, without dashes.
        option: String,
        /// Fault, in words.
        wrong: &'static str,
        /// Way out, in words.
        instead: &'static str,
    },
    /// A text cannot be a word of a command line.
    #[error("{what} is `{value}`; {allowed}")]
    Text {
        /// Name of the text.
        what: &'static str,
        /// The text, with control characters escaped.
        value: String,
        /// Texts that are allowed.
        allowed: &'static str,
    },
}
