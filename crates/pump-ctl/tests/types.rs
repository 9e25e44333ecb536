//! Claims about the types themselves: their sizes, and that threads may share and move them.

use pump_ctl::drive::{Actuator, Fault, NoPin, PinFault, StepDir, Timing};
use pump_ctl::plan::{
    Doser, Handover, Limits, Margins, Phase, Plan, PlanError, Prediction, Profile, Request, Retarget,
    Segments,
};
use pump_ctl::step::{Action, Brake, BrakeError, Direction, Feed, Junction, PushError, Segment, StartError};
use pump_ctl::step::{Stepper, StopPlan, TickRate, Ticks};

/// Sizes on a host with 64 bits, bytes. Those of a Cortex-M are in docs/embedding.md, held by `make embedded`.
#[cfg(target_pointer_width = "64")]
#[test]
fn the_types_are_as_large_as_they_were() {
    assert_eq!(size_of::<Plan>(), 1600, "Plan");
    assert_eq!(size_of::<Segments>(), 1424, "Segments");
    assert_eq!(size_of::<Segment>(), 24, "Segment");
    assert_eq!(size_of::<Brake>(), 1288, "Brake");
    assert_eq!(size_of::<Stepper<64>>() - size_of::<Stepper<63>>(), 48, "a place in the queue");
    assert_eq!(size_of::<Direction>(), 1, "Direction");
    assert_eq!(size_of::<Option<TickRate>>(), 4, "TickRate");
}

const fn shared<T: Send + Sync + Unpin + 'static>() {}

#[test]
fn threads_may_share_and_move_them() {
    shared::<(Plan, Segments, Limits, Request, Phase, Profile, Prediction, Margins, Handover, PlanError)>();
    shared::<(Doser<'static>, Retarget)>();
    shared::<(Stepper<8>, Brake, Segment, Feed<Segments>, TickRate, Ticks, Direction, Action)>();
    shared::<(Junction, StopPlan, PushError, StartError, BrakeError)>();
    shared::<(Actuator<StepDir<NoPin, NoPin, NoPin, NoPin>, 8>, Fault<PinFault>, Timing)>();
}
