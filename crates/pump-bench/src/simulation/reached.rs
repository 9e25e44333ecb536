//! The pressures that a run at constant speed reaches, start-up included.

use pump_model::{ExactRun, Extremes, Leg, Port, Pump};

/// Decays of the slowest mode after which nothing is left of start-up: e^-40.
const DECAYS: f64 = 40.0;

/// Longest time that is followed where next to nothing damps, in s.
const MOST_S: f64 = 600.0;

/// The pressures that a run from lines at rest reaches, by the exact solution that a dose is planned with.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Reached {
    /// Range of the inlet pressure, in kPa absolute.
    pub(crate) inlet: Extremes,
    /// Range of the outlet pressure, in kPa absolute.
    pub(crate) outlet: Extremes,
}

impl Reached {
    /// Returns the pressures of a run of `duration_s` at `speed_rad_s`, negative in reverse. A run that goes on for
    /// ever reaches no more once start-up is over and the rollers have turned a pitch.
    pub(crate) fn of(pump: &Pump, speed_rad_s: f64, duration_s: f64) -> Self {
        let period_s = pump.pitch_rad() / speed_rad_s.abs();
        let range = |port| {
            let started_s = DECAYS / pump.line(port).slowest_decay_per_s() + period_s;
            let legs = [Leg::constant_speed(0.0, speed_rad_s)];
            let end_s = duration_s.min(started_s).min(MOST_S.max(period_s));
            ExactRun::from_rest(pump, port, legs).extremes(end_s)
        };
        Self { inlet: range(Port::Inlet), outlet: range(Port::Outlet) }
    }
}
