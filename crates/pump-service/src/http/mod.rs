//! The service over HTTP: for programs, for the page, and for the command on this machine.
//!
//! Everything below `/api/v1` takes and gives JSON, and `/openapi.json` describes it. `/events` tells what happens, as
//! server-sent events. The page is at `/`.

mod access;
mod api;
mod assets;
mod bodies;
mod command;
mod description;
mod events;
mod failure;
mod metrics;
mod reserve;
mod router;
mod serve;
mod session;
mod shared;

pub use self::access::{Access, AccessError};
pub use self::serve::{Limits, serve};
