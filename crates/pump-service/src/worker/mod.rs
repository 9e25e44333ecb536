//! A process of the command that carries out one order.
//!
//! Each motion is a process of its own, with the same words, lock, journal and exit codes as at a terminal. One that
//! fails takes no other pump with it. Its standard input ends with the service, whatever ends that: the motor then
//! decelerates, stands, and the journal has what was delivered.

mod line;
mod output;
mod program;
mod report;
mod watch;
mod worker;

pub use self::line::Line;
pub(crate) use self::output::{LogFormat, log_words, output};
pub use self::program::Program;
pub(crate) use self::report::{error_report, message_of, silent};
pub(crate) use self::watch::{ANSWERS_WITHIN, SILENT_AFTER, Sign};
pub use self::worker::{Ended, Seat, Stop, Worker};
