//! Orders to a pump in the words of the command: what is to be done, and the options with their values as typed.
//!
//! An [`Order`] becomes the words of one command line. The command itself reads and checks the values, so a volume, a
//! rate or an angle means the same to everybody. Options that name files, devices or other commands are refused: who
//! reaches the service by the network shall not reach the computer.

mod error;
mod id;
mod options;
mod order;
mod origin;
mod task;

pub use self::error::OrderError;
pub use self::id::OrderId;
pub(crate) use self::id::random_hex;
pub use self::options::{Choice, Options};
pub(crate) use self::options::{option, read_options, switch};
pub use self::order::Order;
pub use self::origin::Origin;
pub use self::task::Task;
pub(crate) use self::task::{name as plain_name, text as plain_text};
