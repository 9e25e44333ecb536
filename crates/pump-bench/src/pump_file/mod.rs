//! Pump files: a TOML file describes one pump, and each key names the unit of its number.

mod ambient;
mod check;
mod dose_limits;
mod drive;
mod error;
mod file;
mod fluid;
mod head;
mod limits;
mod line;
mod motor;
mod pump;
mod range;
mod speed_law;
mod uncertainty;

pub use ambient::{AmbientSource, AmbientTable};
pub use dose_limits::UncheckedLimit;
pub(crate) use drive::tmc_range;
pub use drive::{
    Axis, DriveTable, DriverFault, DriverName, KlipperPin, KlipperPinError, KlipperTable, Pace, PinPull,
    Pins, PinsTable, TmcTable,
};
pub use error::PumpFileError;
pub use file::PumpFile;
pub(crate) use file::SCHEMA;
pub use fluid::{FluidError, FluidTable};
pub(crate) use fluid::{SAME_TEMPERATURE_DEGC, THICK_MPA_S};
pub use head::{BackplateTable, CurveFit, HeadTable, RollerVolumeTable, RollersTable, TubeTable};
pub use limits::LimitsTable;
pub use limits::safety::{HomePolicy, SafetyTable};
pub use line::outlet::{OutletEnd, OutletTable};
pub use line::reservoir::Reservoir;
pub(crate) use line::reservoir::most_lift_mm;
pub use line::{HoseTable, LineSource, LineTable};
pub use motor::MotorTable;
pub use pump::PumpTable;
#[cfg(feature = "klipper")]
pub(crate) use range::WrongValue;
pub use speed_law::SpeedLawTable;
pub use uncertainty::UncertaintyTable;
pub(crate) use uncertainty::Unweighed;
