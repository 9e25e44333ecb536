//! The flow-centric model of one port as a differential equation, and its integration (McIntyre et al.).

pub(crate) mod ode;
pub(crate) mod periodic;
pub(crate) mod port_run;
mod resistance;
pub(crate) mod tally;

pub use ode::{Circuit, Forcing, NoFlow, options};
pub use resistance::{Linear, Loss, Resistance, Rough};
