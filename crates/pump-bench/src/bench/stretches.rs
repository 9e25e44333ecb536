//! The stretches of a motion that the journal announces ahead of the motor.

use libm::ceil;
use pump_ctl::plan::PlannedMotion;
use pump_model::Pump;

/// Time of a motor's motion that is announced ahead of it, in s.
///
/// The disk may take 0.3 s for each announcement. A stretch may be asked for just after the disk began with
/// the one before, so twice that time counts. The rest is for the jogs of a board: it decelerates unless the
/// next jog comes in time, and it tells its position every 50 ms.
const AHEAD_S: f64 = 1.0;

/// Time of a motor's motion after which the announcement is renewed, in s. Each renewal is a sync of the disk.
const RENEWED_S: f64 = 0.25;

/// Longest stretch of a simulated motion, in s of that motion. The simulation waits for the disk.
const STRETCH_S: f64 = 0.5;

/// Largest stretch of a simulated motion, in mL. The shorter of the two limits counts.
const STRETCH_ML: f64 = 0.5;

/// Stretch of a motion that the journal announces.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Stretch {
    /// Last step that the drive may set out for.
    pub(super) end: u64,
    /// Last step that may be made: a stop at the end of the stretch counts.
    pub(super) may: u64,
}

/// AnnouncedStretches of a plan.
#[derive(Debug)]
pub(super) struct AnnouncedStretches<'a> {
    plan: PlannedMotion<'a>,
    /// True if the motion takes its time. A simulated motion takes none.
    pub(super) real: bool,
    /// Most steps that give [`STRETCH_ML`].
    steps: u64,
    /// Steps of a stop from the fastest speed.
    pub(super) stop: u64,
}

impl<'a> AnnouncedStretches<'a> {
    /// Divides `plan` into stretches, for a motor in real time or for a simulation.
    pub(super) fn new(plan: PlannedMotion<'a>, model: &Pump, real: bool) -> Self {
        let (_, most_ml_rad) = model.outlet_curve().flow_range_ml_rad();
        let peak_rad_s = plan.peak_rad_s();
        let stop_rad = peak_rad_s * peak_rad_s / (2.0 * plan.acceleration_rad_s2());
        Self {
            plan,
            real,
            steps: ((STRETCH_ML / (most_ml_rad * plan.step_rad())) as u64).max(1),
            stop: ceil(stop_rad / plan.step_rad()) as u64 + 1,
        }
    }

    /// Returns the stretch to announce once `made` steps are made and the drive asks for those up to
    /// `about_to`. Returns `None` while the stretch up to `end`, which is announced, is enough.
    pub(super) fn due(&self, made: u64, about_to: u64, end: u64) -> Option<Stretch> {
        let all = self.plan.steps().unsigned_abs();
        if !self.real {
            return (about_to > end).then(|| self.to(self.reached(about_to, STRETCH_S, self.steps)));
        }
        if end >= all {
            return None;
        }
        let next = (self.reached(made, AHEAD_S, all) + self.stop).clamp(about_to, all);
        let is_due = about_to > end || next == all || self.time_s(next) - self.time_s(end) >= RENEWED_S;
        (is_due && next > end).then(|| self.to(next))
    }

    fn to(&self, end: u64) -> Stretch {
        Stretch { end, may: (end + self.stop).min(self.plan.steps().unsigned_abs()) }
    }

    /// Returns the last step that the plan makes within `time_s` from step `first` on, `most` steps on at most.
    fn reached(&self, first: u64, time_s: f64, most: u64) -> u64 {
        let latest_s = self.time_s(first) + time_s;
        let all = self.plan.steps().unsigned_abs();
        let (mut within, mut beyond) = (first, (first + most).min(all + 1));
        while beyond - within > 1 {
            let middle = within + (beyond - within) / 2;
            if self.time_s(middle) <= latest_s {
                within = middle;
            } else {
                beyond = middle;
            }
        }
        within
    }

    fn time_s(&self, step: u64) -> f64 {
        self.plan.time_of(step)
    }
}
