//! The motion of a plan without the pitches that only repeat.

use libm::{ceil, floor};
use pump_model::{ExactRun, Extremes, Leg, LineState, Port, Pump};

use crate::plan::Plan;
use crate::plan::profile::{Course, Profile};

/// Power of 1/e to which a line's swing from the start falls before pitches are left out. It leaves 1e-11 of
/// the swing.
const FORGOTTEN: f64 = 25.0;

/// The motion of a plan without the pitches that only repeat, and the lines that it moves.
///
/// Once the line's swing from the start has died away, every pitch at the cruise speed repeats the last.
/// Whole pitches beyond that are left out, so a dose of litres costs no more than a dose of some pitches.
/// Pressures equal those of the whole dose to 1e-11 of their swing.
pub(in crate::plan) struct ShortenedMotion {
    profile: Profile,
    /// States of inlet and outlet line at the start.
    states: [LineState; 2],
    /// Offset of the rollers from the plan's start angle, rad.
    off_rad: f64,
    /// Number of pitches that are left out, and the time of one, s.
    surplus: f64,
    pitch_s: f64,
}

impl ShortenedMotion {
    /// Makes the motion of `plan` where the rollers stand `off_rad` beside the middle of their range.
    pub(in crate::plan) fn new(plan: &Plan, pump: &Pump, off_rad: f64) -> Self {
        let states = plan.lines.states(pump, off_rad);
        let profile = plan.profile;
        let decay_per_s = pump.inlet().slowest_decay_per_s().min(pump.outlet().slowest_decay_per_s());
        let pitch_rad = pump.pitch_rad();
        let [reached_rad, left_rad] = profile.corners_rad;
        let pitch_s = pitch_rad / profile.cruise_rad_s();
        let kept = ceil(FORGOTTEN / (decay_per_s * pitch_s)) + 1.0;
        let surplus = floor((left_rad - reached_rad) / pitch_rad) - kept;
        if !(profile.reaches_limit() && surplus >= 1.0) {
            return Self { profile, states, off_rad, surplus: 0.0, pitch_s };
        }
        let turn_rad = profile.course.turn_rad - surplus * pitch_rad;
        let course = Course { turn_rad, ..profile.course };
        Self { profile: Profile::new(course, pump.outlet_curve()), states, off_rad, surplus, pitch_s }
    }

    /// Returns the legs of the motion, at the rollers' own angles.
    pub(in crate::plan) fn legs(&self) -> impl Iterator<Item = Leg> + Clone {
        let off_rad = self.off_rad;
        self.profile.legs().map(move |leg| leg.beside(off_rad))
    }

    /// Returns the number of pitches that are left out.
    pub(super) fn surplus(&self) -> f64 {
        self.surplus
    }

    /// Returns the start and the end of the last pitch before the motor slows down, s. `None` if no pitches
    /// are left out.
    pub(super) fn last_pitch_s(&self) -> Option<(f64, f64)> {
        let end_s = self.profile.time_of(self.profile.corners_rad[1]);
        (self.surplus > 0.0).then_some((end_s - self.pitch_s, end_s))
    }

    /// Returns the time from start to rest, s.
    pub(in crate::plan) fn duration_s(&self) -> f64 {
        self.profile.duration_s()
    }

    /// Returns the direction: 1 forward, -1 in reverse.
    pub(in crate::plan) fn direction(&self) -> f64 {
        f64::from(self.profile.course.direction)
    }

    /// Runs a port's line through the motion.
    pub(in crate::plan) fn run<'a>(
        &'a self,
        pump: &'a Pump,
        port: Port,
    ) -> ExactRun<'a, impl Iterator<Item = Leg>> {
        let [inlet, outlet] = self.states;
        let state = if port == Port::Inlet { inlet } else { outlet };
        ExactRun::new(pump, port, self.legs(), state)
    }

    /// Returns the range of a port's pressure from the start of the motion on.
    pub(in crate::plan) fn extremes(&self, pump: &Pump, port: Port) -> Extremes {
        self.run(pump, port).extremes_to_rest(self.duration_s())
    }
}
