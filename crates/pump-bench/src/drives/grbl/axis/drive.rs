//! An axis of a grbl board as a drive.

use std::time::Duration;

use pump_ctl::plan::Plan;

use super::{Grbl, overheard};
use crate::drives::drive::wait_of;
use crate::drives::grbl::board::POLL;
use crate::drives::grbl::error::GrblError;
use crate::drives::grbl::settings::{self, Flavour};
use crate::drives::{
    Abilities, BeginPlace, Disturbance, Drive, DriveError, DriveFault, DriveLimits, Gate, IndexSearch, Watch,
};
use crate::notice::{Notice, Remedy};
use crate::pump_file::DriverName;

impl Drive for Grbl {
    fn id(&self) -> &str {
        DriverName::Grbl.as_str()
    }

    fn abilities(&self) -> Abilities {
        Abilities::GRBL
    }

    fn limits(&self) -> Option<DriveLimits> {
        Some(DriveLimits {
            min_speed_rad_s: self.least_steps_s * self.step_rad,
            max_speed_rad_s: self.most_steps_s * self.step_rad,
            acceleration_rad_s2: Some(self.steps_s2 * self.step_rad),
        })
    }

    fn count(&self) -> Option<i64> {
        self.stands
    }

    fn farthest_count(&self) -> Option<i64> {
        Some(self.scale.most_count())
    }

    fn disturbed(&mut self) -> Option<Disturbance> {
        // A board that another axis has all the time tells of its resets later.
        let resets = self.board.lock_if_idle().map(|mut board| {
            // A connection that broke at rest is the next motion's fault.
            let _ = overheard(&mut board, Duration::ZERO, true);
            board.resets()
        });
        self.note_resets(resets.unwrap_or(self.resets));
        let told = self.disturbed.take();
        self.unrecorded |= told.is_some();
        told
    }

    fn recorded(&mut self) {
        self.unrecorded = false;
    }

    fn put_on_record(&mut self) -> Result<(), DriveError> {
        if let Some((board, opening)) = &self.unknown_board {
            board.put_on_record(opening).map_err(GrblError::from)?;
            settings::put_on_record(&self.settings, opening)?;
            self.unknown_board = None;
        }
        Ok(())
    }

    fn holds_at_rest(&self) -> bool {
        self.settings.holds() == Some(true)
    }

    fn rests(&self) -> u32 {
        self.rests
    }

    fn check(&mut self, plan: &Plan) -> Result<(), DriveError> {
        if plan.is_smooth() {
            return Err(DriveError::Unable {
                driver: self.id().to_owned(),
                ability: "speed that follows the rollers' angle",
                instead: Remedy::LeaveSmoothOut,
            });
        }
        let checked = self.task(plan);
        if let Err(GrblError::Reset) = checked {
            self.disturbed = Some(Disturbance::Reset);
        }
        Ok(checked.map(drop)?)
    }

    fn begin_with(&mut self, place: BeginPlace) -> Result<(), DriveError> {
        if place.is_of_boards() {
            return Err(DriveError::no_common_begin(self.id()));
        }
        self.place = Some(place);
        Ok(())
    }

    fn run(&mut self, plan: &Plan, gate: &mut Gate<'_>) -> Result<u64, DriveFault> {
        if let Some(place) = self.place.take() {
            return self.travel_in_line(plan, place, gate);
        }
        let made = self.travel(plan, |motion| motion.run(gate))?;
        Ok(made.map_or(0, |((), made)| made))
    }

    fn seek(&mut self, plan: &Plan, gate: &mut Gate<'_>) -> Result<IndexSearch, DriveFault> {
        let found = self.travel(plan, |motion| motion.search(gate))?;
        Ok(found.map_or(IndexSearch { made: 0, beyond: None }, |(found, _)| found))
    }

    fn settle(&mut self, settle_s: f64, watch: &mut Watch<'_>) -> Result<Option<f64>, DriveError> {
        let Ok(until) = self.board.lock().map(|mut board| board.now().saturating_add(wait_of(settle_s)))
        else {
            return Ok(None);
        };
        loop {
            let Ok(left) = self.board.lock().map(|mut board| until.saturating_sub(board.now())) else {
                return Ok(None);
            };
            // The steps are made and counted. A user who asks to stop need not wait for the line.
            if left.is_zero() || watch().is_break() || self.board.is_stopped() {
                return Ok(None);
            }
            let slice = left.min(POLL);
            // A connection that broke at rest is the next motion's fault: the steps made are known.
            if self.overhear(slice, false).is_err()
                && let Ok(mut board) = self.board.lock()
            {
                board.sleep(slice);
            }
            self.board.yield_to_others();
        }
    }

    fn notes(&mut self) -> Vec<Notice> {
        std::mem::take(&mut self.notes)
    }

    fn release(&mut self) -> Result<(), DriveError> {
        let line = if self.settings.flavour == Flavour::FluidNc { "$MD" } else { "$SLP" };
        self.board.lock()?.command(line)?;
        self.disturbed = Some(Disturbance::Disabled);
        Ok(())
    }
}
