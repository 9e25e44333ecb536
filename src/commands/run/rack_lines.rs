//! The lines of a rack to a supervising program: the plan of the rack and of each step of its pumps, the waits, and the
//! motions.

use std::collections::BTreeMap;
use std::time::{Duration, Instant};

use pump_bench::rack::{Rack, RackDose, RackProgress};

use crate::progress::supervised::{self, Lines, Reached};

/// The lines of a rack's pumps, by their names in the rack.
pub(super) struct RackLines {
    begun: Instant,
    pumps: BTreeMap<String, PumpLines>,
}

/// The lines of one pump.
struct PumpLines {
    /// Id of the pump.
    id: String,
    /// Steps that were planned, in their order.
    steps: Vec<RackDose>,
    /// Lines of the step that goes on, and its number.
    going: Option<(usize, Lines)>,
}

impl RackLines {
    /// Tells the plan of the rack, and then for each pump that of its first step and the wait for it. A rack that
    /// cannot be planned from the records alone tells its motions without; or it says why it cannot be run when it is.
    pub(super) fn begin(rack: &Rack) -> Self {
        let plan = rack.rehearse().ok();
        plan.iter().for_each(supervised::rack_begun);
        let mut planned: BTreeMap<String, Vec<RackDose>> =
            plan.into_iter().flat_map(|plan| plan.pumps).map(|row| (row.name, row.doses)).collect();
        let pumps = rack.members().iter().map(|member| {
            let steps = planned.remove(&member.name).unwrap_or_default();
            let pump = PumpLines { id: member.bench.file().pump.id.clone(), steps, going: None };
            pump.tell_step(0, Duration::ZERO);
            (member.name.clone(), pump)
        });
        Self { pumps: pumps.collect(), begun: Instant::now() }
    }

    /// Tells the progress of a pump, and after a step the plan of its next one.
    pub(super) fn show(&mut self, progress: &RackProgress<'_>) {
        let Some(pump) = self.pumps.get_mut(progress.pump) else { return };
        if pump.going.as_ref().is_none_or(|(step, _)| *step != progress.step) {
            let lines = Lines::of(&pump.id, progress.steps, progress.whole_ml);
            pump.going = lines.map(|lines| (progress.step, lines));
        }
        let reached = || Reached { delivered_ml: progress.volume_ml, angle_rad: progress.angle_rad };
        pump.going.iter().for_each(|(_, lines)| lines.made(progress.made, reached));
        let place = pump.steps.iter().position(|planned| planned.step == progress.step);
        if let Some(place) = place.filter(|_| progress.made == progress.steps) {
            pump.tell_step(place + 1, self.begun.elapsed());
        }
    }
}

impl PumpLines {
    /// Tells the plan of a step, and the wait for it where that is not over yet.
    fn tell_step(&self, place: usize, since_begin: Duration) {
        let Some(planned) = self.steps.get(place) else { return };
        supervised::begun(|| planned.dose.clone());
        let begin = Duration::try_from_secs_f64(planned.begin_s).unwrap_or_default();
        let left = begin.saturating_sub(since_begin);
        if !left.is_zero() {
            supervised::waits(&self.id, left, place as u64 + 1, self.steps.len() as u64);
        }
    }
}
