//! The policy for an interrupted dose that is found on record.

use crate::words::words;

/// Choice of what becomes of an interrupted dose on record before another dose.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum UnfinishedPolicy {
    /// A person is asked: the other dose is refused.
    #[default]
    Ask,
    /// The rest of the interrupted dose is made first.
    Resume,
    /// The interrupted dose is accepted as it is.
    Accept,
}

words!(UnfinishedPolicy { Ask = "ask", Resume = "resume", Accept = "accept" });
