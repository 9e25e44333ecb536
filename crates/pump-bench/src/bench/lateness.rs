//! The lateness of a dose: its motion took longer than its plan.

use pump_ctl::plan::{Cruise, PlannedMotion, PressureLimits};

use super::recorded_motion::Moved;
use super::session::Session;
use crate::dosing::{DoseRequest, Prepared};
use crate::notice::{Notice, Remedy};
use crate::numbers::significant;
use crate::pump_file::DriverName;

/// Part of the planned time by which a motion may take longer.
const PART: f64 = 0.02;

/// Time to which a motion is measured, in s. Boards tell their position every 50 ms.
const RESOLUTION_S: f64 = 0.1;

/// Returns true if a dose must not pause: its time or its flow is asked for, or its pressures were checked for a motion
/// without pauses.
pub(super) fn is_critical(request: &DoseRequest) -> bool {
    let is_limited = request.pressures != PressureLimits::NONE;
    request.smooth || is_limited || matches!(request.cruise, Some(Cruise::Within { .. }))
}

/// Returns true if a motion took `measured_s`, more than the `planned_s` of its plan.
pub(in crate::bench) fn is_late(planned_s: f64, measured_s: f64) -> bool {
    measured_s - planned_s > RESOLUTION_S.max(PART * planned_s)
}

impl Session<'_> {
    /// Returns the warning of a whole motion that paused or took longer than its `plan`.
    pub(in crate::bench) fn lateness(
        &self,
        prepared: &Prepared,
        plan: PlannedMotion<'_>,
        moved: &Moved,
    ) -> Option<Notice> {
        let &Moved { measured_s, disk_times, .. } = moved;
        let planned_s = match plan {
            PlannedMotion::Dose(plan) => plan.profile().duration_s(),
            PlannedMotion::Flow(flow) => flow.duration_s(),
        };
        if !is_late(planned_s, measured_s) && disk_times.pauses == 0 {
            return None;
        }
        let [took, plan_s, slowest] =
            [measured_s, planned_s, disk_times.slowest.as_secs_f64()].map(|time_s| significant(time_s, 3));
        let makes_each_step = [DriverName::Node, DriverName::Klipper]
            .iter()
            .any(|driver| driver.as_str() == self.bench.drive_id());
        let mut text = match makes_each_step && disk_times.pauses == 0 {
            true => {
                let late_s = significant(measured_s - planned_s, 3);
                format!("the end of the motion was heard {late_s} s late, {took} s after its begin: ")
            }
            false => format!("the motion took {took} s, and {plan_s} s by its plan: "),
        };
        if disk_times.pauses > 0 {
            let times = if disk_times.pauses == 1 {
                "once".to_owned()
            } else {
                format!("{} times", disk_times.pauses)
            };
            text += &format!(
                "the disk took up to {slowest} s to record the next steps in {}, and the motor paused {times}",
                self.journal.path().display()
            );
        } else if makes_each_step {
            text += "the board made each step at its time, and other programs held this computer up, or its line \
                     to the board was late";
        } else if self.bench.identity().abilities.step_times {
            text += "other programs held this computer up, or its line to the motor was late";
        } else {
            text += "the board was slower than its settings say, or other programs held this computer up";
        }
        if let Some(Cruise::Within { time_s }) = prepared.request.cruise
            && measured_s + prepared.prediction.settle_s > time_s
        {
            text += &format!(
                "; the {} s that the dose was to be done within were not kept",
                significant(time_s, 4)
            );
        }
        if let PlannedMotion::Flow(_) = plan {
            text += "; the volume was kept, and the flow was not at every moment";
        }
        let notice = Notice::from(text);
        Some(if disk_times.pauses > 0 { notice.with_remedy(Remedy::FasterDisk) } else { notice })
    }
}
