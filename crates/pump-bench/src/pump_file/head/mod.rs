//! The pump head: `[tube]`, `[rollers]`, `[backplate]` and `[roller_volume]`.

mod backplate;
mod roller_volume;
mod rollers;
mod tube;

pub use backplate::BackplateTable;
pub use roller_volume::{CurveFit, RollerVolumeTable};
pub use rollers::RollersTable;
pub use tube::TubeTable;
