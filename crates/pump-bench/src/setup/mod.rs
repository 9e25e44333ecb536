//! The first run of a pump: the answers of its owner, the files that they make, and what is still to do.
//!
//! A front end asks the questions and moves the motor. This room keeps the answers, finds those that contradict one
//! another, and writes the pump file.

mod answers;
mod check;
mod error;
mod explain;
mod folder;
mod motor_socket;
mod neighbours;
mod outlook;
mod printer_board;
mod pump;
mod removal;
mod stepper_driver;
mod topic;
mod turn;

pub use answers::{Answers, Done, HeadAnswer};
pub use check::check_suction_lift;
pub use error::SetupError;
pub use folder::SetupFolder;
pub use motor_socket::{MotorSocket, SocketError};
pub use neighbours::Neighbour;
pub use outlook::{Outlook, SurerStep};
pub use printer_board::PrinterBoard;
pub use pump::USUAL_FULL_STEPS;
pub use removal::RemovedPump;
pub use topic::Topic;
pub use turn::{CorrectedSteps, turns};
