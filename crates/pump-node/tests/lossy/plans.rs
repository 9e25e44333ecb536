//! Small plans of real pumps, with their segments.

use std::sync::LazyLock;

use pump_ctl::plan::{Cruise, Doser, Limits, Motor, Phase, Plan, Request};
use pump_ctl::step::{Brake, Segment, TickRate};
use pump_model::Pump;

use crate::world::QUEUE;

pub(crate) const TICK_HZ: u32 = 1_000_000;
pub(crate) const TICK_RATE: TickRate = TickRate::from_hz(TICK_HZ).unwrap();

pub(crate) struct PlanData {
    pub(crate) segments: Vec<Segment>,
    pub(crate) steps: i64,
    pub(crate) brake: Brake,
    pub(crate) shortest_interval: u32,
    pub(crate) plan: Plan,
    pub(crate) motor: Motor,
    pub(crate) volume_ml: f64,
    pub(crate) ml_s: f64,
}

/// Returns true if a full queue never lasts less than 120 ms.
pub(crate) fn lasts_long_enough(segments: &[Segment]) -> bool {
    let lasts = |part: &[Segment]| part.iter().map(|segment| segment.duration().whole).sum::<u64>();
    segments.windows(QUEUE).all(|part| lasts(part) >= 120_000)
}

/// Returns the shortest interval of segments. Rounding to the link's grain makes an interval shorter by less than a
/// tick.
pub(crate) fn shortest_interval(segments: &[Segment]) -> u32 {
    let ends = segments.iter().flat_map(|s| [s.interval_before(1), s.interval_before(s.steps())]);
    u32::try_from(ends.map(|ticks| ticks.whole).min().unwrap() - 1).unwrap()
}

/// Pump of the plans.
pub(crate) static PUMP: LazyLock<Pump> = LazyLock::new(Pump::three_roller);

impl std::fmt::Debug for PlanData {
    fn fmt(&self, to: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(to, "{} steps in {} segments", self.steps, self.segments.len())
    }
}

/// Plans of some hundred steps: smooth and even, forward and reverse, on a quick motor and on a sluggish one.
pub(crate) static PLANS: LazyLock<Vec<PlanData>> = LazyLock::new(|| {
    let pump = *PUMP;
    let mut plans = Vec::new();
    for acceleration in [500.0, 20.0] {
        let motor = Motor::new(3_200.0, 17.8, acceleration);
        let doser = Doser::new(&pump, Limits::new(motor)).unwrap();
        for (volume_ml, ml_s, smooth) in [
            (0.4, 1.0, true),
            (2.0, 4.0, true),
            (3.0, 8.0, true),
            (-1.5, 4.0, true),
            (2.0, 6.0, false),
            (-0.3, 1.0, false),
        ] {
            let request = Request::new(volume_ml, Cruise::Flow { ml_s }).with_smooth(smooth);
            let plan = doser.plan(Phase::known(0.3), &request).unwrap();
            let segments: Vec<_> = plan.segments(TICK_RATE).collect();
            if !lasts_long_enough(&segments) {
                continue;
            }
            plans.push(PlanData {
                steps: plan.steps(),
                brake: motor.brake(TICK_RATE).unwrap(),
                shortest_interval: shortest_interval(&segments),
                segments,
                plan,
                motor,
                volume_ml,
                ml_s,
            });
        }
    }
    assert!(
        plans.len() >= 8 && plans.iter().filter(|plan| plan.segments.len() > QUEUE).count() >= 4,
        "{plans:?}"
    );
    plans
});
