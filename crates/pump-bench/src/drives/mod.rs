//! The drives that turn a motor.

mod abilities;
#[cfg(any(feature = "node", feature = "klipper"))]
#[cfg_attr(
    not(feature = "klipper"),
    allow(dead_code, unused_imports, unreachable_pub, reason = "a node needs a part of the clock")
)]
mod board_clock;
mod board_share;
mod borrowed;
mod common_begin;
mod drive;
mod error;
#[cfg(all(feature = "grbl", feature = "node"))]
mod find;
#[cfg(feature = "grbl")]
mod grbl;
pub(crate) mod grbl_speeds;
mod identity;
#[cfg(feature = "klipper")]
mod klipper;
#[cfg(any(feature = "grbl", feature = "node", feature = "klipper"))]
mod known_board;
#[cfg(feature = "node")]
mod node;
#[cfg(not(all(feature = "grbl", feature = "node", feature = "klipper")))]
mod not_built;
mod opening;
pub(crate) mod registry;
#[cfg(any(feature = "node", feature = "klipper"))]
mod sent_lead;
mod sim;
mod stepped;
mod stop_request;
#[doc(hidden)]
#[cfg(any(feature = "grbl", feature = "node", feature = "klipper"))]
pub mod wire;

pub use abilities::{Abilities, Together};
#[cfg(feature = "klipper")]
pub use board_clock::ClockError;
pub use board_share::BoardShare;
#[cfg(any(feature = "node", feature = "klipper"))]
use common_begin::BEGIN_LEAD;
pub(crate) use common_begin::BeginView;
#[cfg(any(feature = "node", feature = "klipper"))]
pub(crate) use common_begin::Met;
pub use common_begin::{BeginPlace, CommonBegin, CommonBeginError};
pub use drive::{Disturbance, Drive, DriveLimits, Gate, IndexSearch, Leave, Watch};
pub use error::{DriveError, DriveFault};
#[cfg(all(feature = "grbl", feature = "node"))]
pub use find::{FoundBoard, board_has_answered, find_board, find_boards};
#[doc(hidden)]
#[cfg(feature = "grbl")]
pub use grbl::reply as grbl_reply;
#[cfg(feature = "grbl")]
pub use grbl::{Grbl, GrblBoard, GrblError, ask_ports};
pub(crate) use identity::Identity;
#[cfg(all(feature = "grbl", feature = "node", feature = "klipper"))]
pub use klipper::BoardPins;
#[cfg(feature = "klipper")]
pub use klipper::{DictionaryError, Klipper, KlipperError, MessageError, RefitError, TmcError};
#[cfg(any(feature = "grbl", feature = "node", feature = "klipper"))]
pub use known_board::{BoardOnRecord, PlaceTaken};
#[cfg(feature = "node")]
pub use node::{AxisRun, Node, NodeAxes, NodeAxis, NodeBoard, NodeError};
#[cfg(all(feature = "grbl", feature = "node", not(feature = "klipper")))]
pub use not_built::BoardPins;
pub use opening::Opening;
pub(crate) use opening::SETTINGS_RECORD;
pub use sim::Sim;
pub use stepped::{MonotonicClock, Stepped, SteppedError};
pub use stop_request::StopRequest;
#[cfg(any(feature = "grbl", feature = "node", feature = "klipper"))]
pub(crate) use wire::port_name;
#[cfg(any(feature = "grbl", feature = "node", feature = "klipper"))]
pub use wire::{PortFault, serial_ports};
