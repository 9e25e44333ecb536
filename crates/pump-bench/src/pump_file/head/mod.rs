//! The pump head: `[tube]`, `[rollers]`, `[backplate]` and `[roller_volume]`, or `[head]` in their place.

mod backplate;
mod bought;
mod catalogued;
mod roller_volume;
mod rollers;
mod tube;

pub use backplate::BackplateTable;
pub use bought::HeadTable;
pub use roller_volume::{CurveFit, RollerVolumeTable};
pub use rollers::RollersTable;
pub use tube::TubeTable;
