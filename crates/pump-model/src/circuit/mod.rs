//! The flow-centric model of one port as a differential equation, and its integration (McIntyre et al.).

mod line_model;
pub(crate) mod line_run;
pub(crate) mod lumped;
mod ode;
pub(crate) mod periodic;
pub(crate) mod port_run;
pub(crate) mod resistance;
mod solver;
pub(crate) mod tally;

pub use line_model::LineModel;
pub use line_run::LineRun;
pub use lumped::Lumped;
pub use ode::{Circuit, Forcing, NoFlow, options};
pub use periodic::PeriodicLine;
pub use resistance::{Linear, Loss, Resistance};
