//! The configuration of an axis, with what follows from it.

use pump_ctl::step::{Brake, TickRate};
use pump_link::message::AxisConfig;
use pump_link::timing::ns_in_ticks;

/// The configuration of an axis, with what follows from it. The thread computes it, because divisions take long and the
/// interrupt is kept off while an axis is configured.
#[derive(Debug)]
pub(crate) struct Setup {
    pub(super) config: AxisConfig,
    pub(super) times: Times,
    pub(super) brake: Brake,
}

/// Times that a stepper driver needs, ticks.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Times {
    /// Time for which the step pin is active.
    pub(super) high: u64,
    /// Time for which the step pin is inactive.
    pub(super) low: u64,
    /// Shortest interval of steps.
    pub(super) pulse: u64,
    /// Time from the current to the first step.
    pub(super) enable: u64,
    /// Time after which a motor that rests is let go. It is 0 if the motor is not let go.
    pub(super) idle: u64,
}

impl Setup {
    pub(crate) fn new(config: AxisConfig, brake: Brake, tick_rate: TickRate) -> Self {
        let [high, low] = config.pulse_ticks(tick_rate.hz());
        let times = Times {
            high,
            low,
            pulse: config.least_interval(tick_rate.hz()),
            enable: ns_in_ticks(config.enable_setup_ns, tick_rate.hz()),
            idle: u64::from(config.idle_release_ms) * u64::from(tick_rate.hz()) / 1000,
        };
        Self { config, times, brake }
    }
}
