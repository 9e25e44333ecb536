//! Claims about the types themselves: their sizes, and that threads may share and move them.

use pump_model::{Extremes, FlowCurve, Geometry, Leg, Line, LineState, ModelError, Port, Pump, RollerVolume};
use pump_model::{IntegrationError, SteadyState};

/// Sizes on a host with 64 bits, bytes. Those of a Cortex-M are in docs/embedding.md, held by `make embedded`.
#[cfg(target_pointer_width = "64")]
#[test]
fn the_types_are_as_large_as_they_were() {
    assert_eq!(size_of::<Pump>(), 7624, "Pump");
    assert_eq!(size_of::<FlowCurve>(), 3064, "FlowCurve");
    assert_eq!(size_of::<RollerVolume>(), 1376, "RollerVolume");
    assert_eq!(size_of::<Leg>(), 40, "Leg");
    assert_eq!(size_of::<LineState>(), 16, "LineState");
}

const fn shared<T: Send + Sync + Unpin + 'static>() {}

#[test]
fn threads_may_share_and_move_them() {
    shared::<(Pump, FlowCurve, RollerVolume, Geometry, Line, LineState, Leg, Port, Extremes, SteadyState)>();
    shared::<(ModelError, IntegrationError)>();
    #[cfg(feature = "integrator")]
    shared::<(
        pump_model::integrator::Rodas5p<3>,
        pump_model::integrator::Radau<3>,
        pump_model::integrator::DenseStep<3>,
    )>();
    #[cfg(feature = "integrator")]
    shared::<pump_model::PortRun<'static, core::array::IntoIter<Leg, 1>, 3>>();
    shared::<pump_model::ExactRun<'static, core::array::IntoIter<Leg, 1>>>();
}
