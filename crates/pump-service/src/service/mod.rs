//! The pumps of one configuration, and the orders that are carried out now.

mod begin;
mod carrying;
mod error;
mod event;
mod hung;
mod live;
mod placing;
mod pump;
mod refresh;
mod service;
mod still;
mod taken_over;
mod view;
mod whole;

pub use self::error::ServiceError;
pub use self::event::Event;
pub use self::placing::{Placed, Refusal};
pub use self::pump::Pump;
pub use self::service::{Service, Setup};
pub(crate) use self::still::Stillness;
pub use self::view::PumpView;
pub use self::whole::WholeDose;
pub(crate) use crate::worker::error_report;
