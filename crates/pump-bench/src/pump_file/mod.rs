//! Pump files: one TOML file that says everything about a pump, each number with its unit in its key.

mod drive;
mod file;
mod fluid;
mod limits;
mod line;
mod motor;
mod roller_volume;
mod speed_law;
mod tube;

pub use drive::{Axis, DriveTable, DriverName};
pub use file::{
    AmbientTable, BackplateTable, PumpFile, PumpFileError, PumpTable, RollersTable, SCHEMA, UncertaintyTable,
};
pub(crate) use fluid::SAME_TEMPERATURE_DEGC;
pub use fluid::{FluidError, FluidTable};
pub use limits::{LimitsTable, UncheckedLimit};
pub use line::{HoseTable, LineTable};
pub use motor::MotorTable;
pub use roller_volume::{Fit, RollerVolumeTable};
pub use speed_law::SpeedLawTable;
pub use tube::TubeTable;
