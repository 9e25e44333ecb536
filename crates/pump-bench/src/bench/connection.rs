//! The connection of a session to its device, and how the rotor was met.

mod confirmation;

use std::time::{Duration, Instant};

use pump_ctl::plan::PlannedMotion;
use pump_model::Pump;
use pump_model::units::degrees;

use super::bench::Bench;
use super::device::{Device, as_allowed};
use super::session::Session;
use crate::dosing::DoseError;
#[cfg(feature = "klipper")]
use crate::drives::KlipperError;
#[cfg(feature = "node")]
use crate::drives::NodeError;
use crate::drives::{Disturbance, Drive, DriveError, Opening, registry};
use crate::notice::{Notice, Remedy};
use crate::pump_file::PumpFile;
use crate::record::{AngleLoss, JournalError, PumpState, Story, Unfinished, Why};

/// Returns the unfinished dose during which the device was lost, and the steps counted since its start.
/// `None` if the count does not fit or begins anew.
fn lost_and_found(stands: &PumpState, count: Option<i64>) -> Option<(Unfinished, i64)> {
    let part = stands.unfinished?;
    let now = count.filter(|now| *now != 0)?;
    let moved = now - part.count_before?;
    part.holds(moved).then_some((part, moved))
}

/// Returns the note that a device was moved by another program, or that its direction was turned round: it then counts
/// the steps on record with the other sign.
fn moved_elsewhere(before: i64, now: i64, find_angle: Remedy) -> Notice {
    let text = match now.checked_neg() == Some(before) {
        true => "the motor's direction was turned round, so nobody knows where the rollers stand".to_owned(),
        false => format!(
            "the device counts {now} steps, and {before} are on record: something else has moved it; the rollers' \
             angle is unknown"
        ),
    };
    Notice::from(text).with_remedy(find_angle)
}

/// Returns the way to the angle of a pump in `state`: while a dose is unfinished, one that keeps it.
pub(super) fn find_angle(state: &PumpState) -> Remedy {
    Remedy::finding_angle(state.unfinished.is_some())
}

/// Returns the state after an event that the rotor's angle may not have survived. A released rotor falls by `fall_rad`
/// at most.
pub(super) fn after_event(state: PumpState, event: Disturbance, fall_rad: f64, pump: &Pump) -> PumpState {
    match event {
        Disturbance::EmergencyStop => state.lost(AngleLoss::EmergencyStop, pump),
        Disturbance::TakenOver => state.lost(AngleLoss::TakenOver, pump),
        _ => state.disturbed(fall_rad, pump),
    }
}

impl Bench {
    /// Refuses a pump that nobody has confirmed as its file is now. Returns true if its last motion was cut off, so
    /// that its device may tell more of it than the record does.
    ///
    /// # Errors
    ///
    /// [`DoseError::Unconfirmed`], [`DoseError::TurnedOtherwise`], and [`DoseError::Journal`] if the record cannot be
    /// read.
    pub(crate) fn check_before_meeting(&self) -> Result<bool, DoseError> {
        let Story { cut_off, state, .. } = self.story()?;
        self.check_confirmed(state.as_ref())?;
        // A motion that another process makes has no end on record either.
        Ok(cut_off.is_some() && !self.is_held())
    }

    /// Returns a state on record as the next meeting will find it, as far as the records of the board tell.
    pub(crate) fn as_told(&self, state: PumpState) -> PumpState {
        let told = registry::told_by_record(self.drive(), self.opening()).filter(|_| !state.released);
        told.map_or(state, |event| after_event(state, event, self.fall_rad(), self.model()))
    }
}

impl<'a> Session<'a> {
    /// Connects the drive, unless it is connected, and compares its count with the record.
    ///
    /// # Errors
    ///
    /// [`DoseError::Connection`] if the device cannot be used. [`DoseError::Journal`] if its state cannot be
    /// recorded.
    pub fn connect(&mut self) -> Result<(), DoseError> {
        if self.device.is_some() {
            return Ok(());
        }
        let mut patience = std::mem::take(&mut self.patience);
        let connected = patience.try_until(&self.bench.opening().stop, || self.try_to_connect());
        self.patience = patience;
        connected
    }

    /// Connects the drive for a motion that `plan` plans by a pump file and a state. A device that may be reset as it
    /// is met is not met for a motion that is refused by the record alone.
    pub(super) fn connect_for<T>(
        &mut self,
        plan: impl FnOnce(&PumpFile, Option<PumpState>) -> Result<T, DoseError>,
    ) -> Result<(), DoseError> {
        let device_knows_more = self.cut_off.is_some()
            || self.state.and_then(|state| state.unfinished).is_some_and(|dose| dose.count_before.is_some());
        if self.device.is_none() && self.bench.identity().abilities.resets_as_met && !device_knows_more {
            plan(&self.bench.file_for_dry_run()?, self.state)?;
        }
        self.connect()
    }

    fn try_to_connect(&mut self) -> Result<(), DoseError> {
        let bench = self.bench;
        let drive = match self.given().map_err(DoseError::Connection)? {
            Some(drive) => Ok(drive),
            None => {
                let opening = Opening { records_later: self.is_fresh, ..bench.opening().clone() };
                registry::open(bench.drive(), bench.file(), bench.model(), &opening)
            }
        };
        match drive {
            Ok(drive) => self.take(drive),
            Err(error) => {
                self.note_event(&error)?;
                Err(DoseError::Connection(error))
            }
        }
    }

    /// Puts on record what a device that refuses to be used tells of the rotor: it may have forgotten it the next time.
    /// A motion that was cut off waits for the device's count, and is left as it is.
    fn note_event(&mut self, error: &DriveError) -> Result<(), DoseError> {
        let (stands, model) = (self.stands(), self.bench.model());
        let Some(event) = told_event(error).filter(|_| self.cut_off.is_none() && self.state.is_some()) else {
            return Ok(());
        };
        if !stands.phase().is_known(model.pitch_rad()) {
            return Ok(());
        }
        Ok(self.rest(Why::Met, after_event(stands, event, self.bench.fall_rad(), model))?)
    }

    /// Takes `drive` into use and compares its count with the record.
    fn take(&mut self, mut drive: Box<dyn Drive + 'a>) -> Result<(), DoseError> {
        let bench = self.bench;
        if let Err(error) = drive.connect() {
            self.put_away(drive);
            self.note_event(&error)?;
            return Err(DoseError::Connection(error));
        }
        let limits = drive.limits();
        let mut notes = drive.notes();
        let begun = self.stands().unfinished;
        let met = self.meet(drive.as_mut(), &mut notes);
        self.notes.append(&mut notes);
        let file = as_allowed(bench.file(), limits);
        self.device = Some(Device { drive, file, limits, holds_since: Instant::now() });
        let changed = met != self.stands() || (self.state.is_none() && met.count.is_some());
        let recorded = if changed { self.met(met) } else { Ok(()) };
        if let (false, true, Some(device)) = (changed, self.written, &mut self.device) {
            device.drive.recorded();
        }
        self.finished_by_device = begun.filter(|_| met.unfinished.is_none());
        Ok(recorded?)
    }

    /// Takes over the state in which a device was met. It is on record at once, and that of a fresh pump later: a first
    /// motion that is refused leaves no record of the board.
    fn met(&mut self, state: PumpState) -> Result<(), JournalError> {
        if !self.is_fresh {
            return self.rest(Why::Met, state);
        }
        (self.state, self.written) = (Some(state), false);
        Ok(())
    }

    /// Puts the board and the state in which it was met on record, unless they are. Something is to happen now.
    pub(super) fn record_meeting(&mut self) -> Result<(), DoseError> {
        if let Some(device) = &mut self.device {
            device.drive.put_on_record().map_err(DoseError::Connection)?;
        }
        let Some(state) = self.state.filter(|_| !self.written) else { return Ok(()) };
        let why = if self.is_fresh { Why::Met } else { Why::CutOff };
        Ok(self.rest(why, state)?)
    }

    /// Returns the pump file as the device allows it, or as it is while no device is connected.
    pub(super) fn file(&self) -> &PumpFile {
        self.device.as_ref().map_or(self.bench.file(), |device| &device.file)
    }

    /// Returns the slowest and the fastest speed of the pump head, in rad/s, as pump file and connected device
    /// allow. The slowest is 0 where neither has one.
    pub fn speed_range_rad_s(&self) -> (f64, f64) {
        let least_rad_s = self.device.as_ref().map_or(0.0, Device::least_rad_s);
        (least_rad_s, self.file().limits().motor.max_speed_rad_s)
    }

    /// Returns the state of the pump by a device that was just connected.
    fn meet(&self, drive: &mut dyn Drive, notes: &mut Vec<Notice>) -> PumpState {
        let (model, stands) = (self.bench.model(), self.stands());
        // The drive reports disturbances first: it may hear of a reset that changes the count.
        let (told, halted) = match drive.disturbed() {
            Some(Disturbance::Halted { slip_steps, without_current }) => {
                // To give a motor current whose loss is on record is no disturbance.
                (None, Some((slip_steps, without_current && !stands.released)))
            }
            told => (told, None),
        };
        let count = drive.count();
        let mut met = stands;
        // A device whose resets are not told and that counts from zero again was switched off and on unheard. So its
        // count of zero proves nothing of a motion that was cut off.
        let cut_off = self.cut_off.is_some_and(|(_, part)| part.made_least < part.made_most);
        let is_unheard = !drive.abilities().tells_resets && count == Some(0);
        let starts_anew = is_unheard && stands.count.is_some_and(|before| before != 0 || cut_off);
        let event = told.or(starts_anew.then_some(Disturbance::Reset));
        let counts_anyhow = matches!(
            event,
            Some(Disturbance::OtherAxis | Disturbance::EmergencyStop | Disturbance::TakenOver)
        );
        if stands.released && !counts_anyhow {
            met = self.meet_released(count, notes);
        } else if let Some(event) = event {
            met = self.meet_disturbed(event, count, notes);
        } else if let Some((part, moved)) = lost_and_found(&stands, count) {
            let made = moved * part.intent.steps.signum();
            met = stands.recounted(&part, made, self.bench.fall_rad(), model);
        } else if let (Some(before), Some(now)) = (stands.count, count) {
            let moved = now - before;
            met = match self.cut_off {
                // The board made and counted more of the motion than the process that ended could record.
                Some((before, part)) if part.holds(moved) => {
                    let made = moved * part.intent.steps.signum();
                    before.after(&part.intent, made, made, model)
                }
                None if moved == 0 => stands,
                _ => {
                    notes.push(moved_elsewhere(before, now, find_angle(&stands)));
                    stands.lost(AngleLoss::OtherCount, model)
                }
            };
        }
        // The board made the plan's own ramp if it made all of its steps.
        let made_all = self.cut_off.is_some_and(|(_, part)| self.moved(count) == Some(part.intent.steps));
        let halted = halted.map(|(slip_steps, is_off)| (if made_all { 0 } else { slip_steps }, is_off));
        if let Some((slip_steps, without_current)) = halted.filter(|halted| *halted != (0, false)) {
            // The count is that of the steps all the same, so the halt comes on top.
            let (halted, note) = self.after_halt(met, slip_steps, without_current);
            let note = match stands.phase().is_known(model.pitch_rad()) {
                true => note.with_remedy(find_angle(&stands)),
                false => note,
            };
            met = halted;
            notes.push(note);
        }
        // A motion that was cut off and counted since was of the steps of its own day.
        let met = met.of_steps(self.bench.way_rad(), model);
        PumpState { count, released: false, ..met }
    }

    /// Returns the state of a rotor whose motor was stopped without a ramp in `state`, with a note of it. It may have
    /// slipped by so many steps, and have fallen as well if it was without current.
    pub(super) fn after_halt(
        &self,
        state: PumpState,
        slip_steps: u32,
        without_current: bool,
    ) -> (PumpState, Notice) {
        let model = self.bench.model();
        let halted = state.halted(slip_steps, self.bench.halt_rad(slip_steps, without_current), model);
        let is_known = |state: &PumpState| state.phase().is_known(model.pitch_rad());
        let event = Disturbance::Halted { slip_steps, without_current };
        let text = match (is_known(&state), is_known(&halted)) {
            (false, _) => event.to_string(),
            (true, true) => format!("{event}: the rollers' angle is known less well"),
            (true, false) => format!("{event}: the rollers' angle is unknown"),
        };
        (halted, Notice::from(text))
    }

    /// Returns the steps by which a device that counts `count` now has moved since its count on record.
    fn moved(&self, count: Option<i64>) -> Option<i64> {
        count.zip(self.stands().count).map(|(now, before)| now - before)
    }

    /// Returns the state of a pump after an event that the rotor's angle may not have survived, by a device that
    /// counts `count` now.
    fn meet_disturbed(&self, event: Disturbance, count: Option<i64>, notes: &mut Vec<Notice>) -> PumpState {
        let (model, stands) = (self.bench.model(), self.stands());
        let in_motion = self.cut_off.filter(|_| event == Disturbance::CurrentLost);
        let met = match in_motion {
            Some((before, part)) => {
                let moved = self.moved(count).filter(|moved| part.holds(*moved));
                let most = moved.map_or(part.made_most, |moved| moved * part.intent.steps.signum());
                before.without_current(&part.intent, most, model)
            }
            None => after_event(stands, event, self.bench.fall_rad(), model),
        };
        let pitch_rad = model.pitch_rad();
        if stands.phase().is_known(pitch_rad) {
            let now = match event {
                _ if in_motion.is_some() => "unknown, because nobody knows which steps the motor has made",
                _ if met.phase().is_known(pitch_rad) => "known less well, by two full steps of the motor",
                Disturbance::TakenOver => "unknown, because it may have turned the rotor meanwhile",
                Disturbance::EmergencyStop => "unknown, because people may have turned the rotor meanwhile",
                _ if met.disturbances > 1 => "unknown: that was the second time since it was found",
                _ => "unknown: two full steps of the motor more, and it may be any angle of a pitch",
            };
            let text = format!("{event}: the rollers' angle is {now}");
            notes.push(Notice::from(text).with_remedy(find_angle(&stands)));
        }
        let is_unsure = stands.unfinished.is_some_and(|dose| dose.made_least < dose.made_most);
        if is_unsure && matches!(event, Disturbance::OtherAxis | Disturbance::TakenOver) {
            let text =
                "what it counts tells nothing of the unfinished dose, whose steps stay within their bounds";
            notes.push(Notice::from(format!("{event}: {text}")));
        }
        met
    }

    /// Returns the state of a pump whose rotor was released, by a device that counts `count` now.
    ///
    /// The release is on record as a disturbance, and waking the device is none. But a released rotor does
    /// not move the count: another program does, and a device that counts anew may have moved unheard.
    fn meet_released(&self, count: Option<i64>, notes: &mut Vec<Notice>) -> PumpState {
        let (stands, model) = (self.stands(), self.bench.model());
        match (stands.count, count) {
            (Some(before), Some(0)) if before != 0 => {
                let text = "the device was reset while the motor was released, and counts from zero: the rollers' \
                            angle may be any";
                notes.push(Notice::from(text).with_remedy(find_angle(&stands)));
                stands.disturbed(self.bench.fall_rad(), model)
            }
            (Some(before), Some(now)) if before != now => {
                notes.push(moved_elsewhere(before, now, find_angle(&stands)));
                stands.lost(AngleLoss::OtherCount, model)
            }
            _ => stands,
        }
    }

    /// Refuses a plan that the device cannot run, and one for a rotor that has moved since. The state in which the
    /// device was met is on record.
    pub(super) fn check(&mut self, plan: PlannedMotion<'_>) -> Result<(), DoseError> {
        let Some(mut device) = self.device.take() else { return Ok(()) };
        let checked = match plan {
            PlannedMotion::Dose(plan) => device.drive.check(plan),
            PlannedMotion::Flow(flow) => device.drive.check_flow(flow),
        };
        let has_moved =
            self.stands().count.zip(device.drive.count()).is_some_and(|(before, now)| before != now);
        if checked.is_ok() && !has_moved {
            self.device = Some(device);
            return Ok(());
        }
        let mut notes = Vec::new();
        let met = self.meet(device.drive.as_mut(), &mut notes);
        let met = PumpState { released: device.drive.is_without_current(), ..met };
        self.notes.append(&mut notes);
        let met_is_recorded = if met == self.stands() { Ok(()) } else { self.met(met) };
        if met_is_recorded.is_ok() && self.written {
            device.drive.recorded();
        }
        self.put_away(device.drive);
        met_is_recorded?;
        checked.map_err(DoseError::Connection)?;
        let [planned_deg, stands_deg] = [plan.start().angle_rad(), met.angle_rad].map(degrees);
        Err(DoseError::Stale { planned_deg, stands_deg })
    }

    /// Releases the rotor. Its angle is known less well afterwards.
    ///
    /// # Errors
    ///
    /// [`DoseError`] if the device cannot be used or cannot let go of its motor, or its state cannot be recorded.
    pub fn release(&mut self) -> Result<PumpState, DoseError> {
        self.connect()?;
        // A motor that its drive cannot let go of holds on, so its angle is known as before.
        if let Some(device) = self.device.as_ref().filter(|device| !device.drive.abilities().release) {
            return Err(DoseError::Connection(DriveError::no_release(device.drive.id())));
        }
        self.record_meeting()?;
        let state = self.stands().disturbed(self.bench.fall_rad(), self.bench.model());
        let state = PumpState { released: true, ..state };
        // The release is on record first, so the record never claims a better angle than there is.
        let before = (self.state, self.written, self.cut_off, self.finished_by_device);
        if let Err(error) = self.rest(Why::Released, state) {
            // The motor holds, so the rotor stands as before. It is not released before another timeout.
            (self.state, self.written, self.cut_off, self.finished_by_device) = before;
            if let Some(device) = &mut self.device {
                device.holds_since = Instant::now();
            }
            return Err(error.into());
        }
        // The device is met anew before it moves again.
        let Some(mut device) = self.device.take() else { return Ok(state) };
        let released = device.drive.release();
        self.put_away(device.drive);
        released.map_err(DoseError::Connection).map(|()| state)
    }

    /// Releases a rotor that has held for the pump file's `hold_timeout_s`. A caller that waits in a session
    /// calls this now and then. A drive that cannot let go of its motor holds on. So does a drive that has failed,
    /// until it is met anew: the record then says that its motor holds.
    ///
    /// # Errors
    ///
    /// [`DoseError`] as in [`Self::release`].
    pub fn release_when_due(&mut self) -> Result<(), DoseError> {
        let can = self.device.as_ref().is_some_and(|device| device.drive.abilities().release);
        let timeout_s = self.bench.drive().hold_timeout_s.filter(|_| can);
        let held = self.device.as_ref().map_or(Duration::ZERO, |device| device.holds_since.elapsed());
        match timeout_s {
            Some(timeout_s) if held.as_secs_f64() >= timeout_s => self.release().map(drop),
            _ => Ok(()),
        }
    }

    /// Returns the notes that the next motion's report shows.
    pub fn pending_notes(&self) -> &[Notice] {
        &self.notes
    }

    /// Returns the notes for the user that were not shown yet.
    pub fn notes(&mut self) -> Vec<Notice> {
        std::mem::take(&mut self.notes)
    }

    /// Refuses a drive without an index sensor.
    pub(super) fn need_index(&self) -> Result<(), DoseError> {
        let has = self.device.as_ref().is_some_and(|device| device.drive.abilities().index);
        if has {
            return Ok(());
        }
        Err(DoseError::Connection(DriveError::no_index(self.bench.drive_id())))
    }
}

/// Returns the event that a device which refuses to be used tells of the rotor. `None` if it tells none.
fn told_event(error: &DriveError) -> Option<Disturbance> {
    match error {
        #[cfg(feature = "node")]
        DriveError::Device(told) if matches!(told.downcast_ref(), Some(NodeError::Estop)) => {
            Some(Disturbance::EmergencyStop)
        }
        _ => None,
    }
}

/// Returns the cause for which the angle is unknown after a fault in motion.
pub(super) fn lost_by(error: &DriveError) -> AngleLoss {
    match error {
        #[cfg(feature = "node")]
        DriveError::Device(told) if matches!(told.downcast_ref(), Some(NodeError::Driver)) => {
            AngleLoss::CurrentLost
        }
        #[cfg(feature = "klipper")]
        DriveError::Device(told) if matches!(told.downcast_ref(), Some(KlipperError::Driver(_))) => {
            AngleLoss::CurrentLost
        }
        _ if told_event(error) == Some(Disturbance::EmergencyStop) => AngleLoss::EmergencyStop,
        _ => AngleLoss::OtherCount,
    }
}
