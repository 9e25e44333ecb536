//! The connection of a session to its device, and how the rotor was met.

use std::time::{Duration, Instant};

use pump_ctl::plan::Plan;
use pump_model::math::rpm;

use super::device::Device;
use super::session::Session;
use crate::dosing::DoseError;
use crate::drives::{Disturbance, Drive, DriveError, DriveLimits, registry};
use crate::pump_file::PumpFile;
use crate::record::{State, Unfinished, Why};

/// Returns the pump file with the motor's limits as the device sets them: never faster than the file, and
/// with the device's acceleration.
fn as_allowed(file: &PumpFile, limits: Option<DriveLimits>) -> PumpFile {
    let mut file = file.clone();
    if let Some(limits) = limits {
        file.motor.max_speed_rpm = file.motor.max_speed_rpm.min(rpm(limits.max_speed_rad_s));
        file.motor.max_acceleration_rad_s2 = limits.acceleration_rad_s2;
    }
    file
}

/// Returns the unfinished dose during which the device was lost, and the steps counted since its start.
/// `None` if the count does not fit or begins anew.
fn lost_and_found(stands: &State, count: Option<i64>) -> Option<(Unfinished, i64)> {
    let part = stands.unfinished?;
    let now = count.filter(|now| *now != 0)?;
    let moved = now - part.count_before?;
    part.holds(moved).then_some((part, moved))
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
        let bench = self.bench;
        let opened = registry::open(bench.drive(), bench.file(), bench.model(), bench.may_configure());
        let mut drive = opened.map_err(DoseError::Connection)?;
        let limits = drive.limits();
        let mut notes = drive.notes();
        let met = self.meet(drive.as_mut(), &mut notes);
        let file = as_allowed(bench.file(), limits);
        self.device = Some(Device { drive, file, limits, notes, holds_since: Instant::now() });
        if met != self.stands() || (self.state.is_none() && met.count.is_some()) {
            self.rest(Why::Met, met)?;
        }
        Ok(())
    }

    /// Returns the pump file as the device allows it, or as it is while no device is connected.
    pub(super) fn file(&self) -> &PumpFile {
        self.device.as_ref().map_or(self.bench.file(), |device| &device.file)
    }

    /// Returns the state of the pump by a device that was just connected.
    fn meet(&self, drive: &mut dyn Drive, notes: &mut Vec<String>) -> State {
        let (model, stands) = (self.bench.model(), self.stands());
        let (was_known, pitch_rad) = (stands.phase().is_known(model.pitch_rad()), model.pitch_rad());
        // The drive reports disturbances first: it may hear of a reset that changes the count.
        let told = drive.disturbed();
        let count = drive.count();
        let mut met = stands;
        // A device that counts from zero again was switched off and on unheard. So a count of zero proves
        // nothing of a motion that was cut off.
        let cut_off = self.cut_off.is_some_and(|(_, part)| part.made_least < part.made_most);
        let starts_anew = count == Some(0) && stands.count.is_some_and(|before| before != 0 || cut_off);
        let event = told.or(starts_anew.then_some(Disturbance::Reset));
        if let Some(event) = event.filter(|_| !stands.released) {
            met = stands.disturbed(self.bench.fall_rad(), pitch_rad);
            if was_known {
                let now = if met.phase().is_known(pitch_rad) {
                    "known less well, by two full steps of the motor"
                } else {
                    "unknown: that was the second time since it was found"
                };
                notes.push(format!("{event}: the rollers' angle is {now}; `dose home` finds it"));
            }
        } else if let (Some((part, moved)), false) = (lost_and_found(&stands, count), stands.released) {
            met = stands.recounted(&part, moved.unsigned_abs());
        } else if let (Some(before), Some(now), false) = (stands.count, count, stands.released) {
            let moved = now - before;
            met = match self.cut_off {
                // The board made and counted more of the motion than the process that ended could record.
                Some((before, part)) if part.holds(moved) => {
                    let made = moved.unsigned_abs();
                    before.after(&part.intent, made, made, model)
                }
                None if moved == 0 => stands,
                _ => {
                    notes.push(format!(
                        "the device counts {now} steps, and {before} are on record: something else has \
                         moved it; the rollers' angle is unknown, and `dose home` finds it"
                    ));
                    stands.lost(pitch_rad)
                }
            };
        }
        State { count, released: false, ..met }
    }

    /// Refuses a plan that the device cannot run. The state in which the device was met is on record.
    pub(super) fn check(&mut self, plan: &Plan) -> Result<(), DoseError> {
        let Some(mut device) = self.device.take() else { return Ok(()) };
        let Err(error) = device.drive.check(plan) else {
            self.device = Some(device);
            return Ok(());
        };
        let met = self.meet(device.drive.as_mut(), &mut device.notes);
        if met != self.stands() {
            self.rest(Why::Met, met)?;
        }
        Err(DoseError::Connection(error))
    }

    /// Releases the rotor. Its angle is known less well afterwards.
    ///
    /// # Errors
    ///
    /// [`DoseError`] if the device cannot be used, or its state cannot be recorded.
    pub fn release(&mut self) -> Result<State, DoseError> {
        self.connect()?;
        let state = self.stands().disturbed(self.bench.fall_rad(), self.bench.model().pitch_rad());
        let state = State { released: true, ..state };
        // The release is on record first, so the record never claims a better angle than there is.
        self.rest(Why::Released, state)?;
        // The device is met anew before it moves again.
        match self.device.take() {
            Some(mut device) => device.drive.release().map_err(DoseError::Connection).map(|()| state),
            None => Ok(state),
        }
    }

    /// Releases a rotor that has held for the pump file's `hold_timeout_s`. A caller that waits in a session
    /// calls this now and then.
    ///
    /// # Errors
    ///
    /// [`DoseError`] as in [`Self::release`].
    pub fn release_when_due(&mut self) -> Result<(), DoseError> {
        let timeout_s = self.bench.drive().hold_timeout_s.filter(|_| self.device.is_some());
        let held = self.device.as_ref().map_or(Duration::ZERO, |device| device.holds_since.elapsed());
        match timeout_s {
            Some(timeout_s) if held.as_secs_f64() >= timeout_s => self.release().map(drop),
            _ => Ok(()),
        }
    }

    /// Returns the notes of the device that were not shown yet.
    pub fn notes(&mut self) -> Vec<String> {
        self.device.as_mut().map_or_else(Vec::new, |device| std::mem::take(&mut device.notes))
    }

    /// Refuses a drive without an index sensor.
    pub(super) fn need_index(&self) -> Result<(), DoseError> {
        let has = self.device.as_ref().is_some_and(|device| device.drive.abilities().index);
        if has {
            return Ok(());
        }
        Err(DoseError::Connection(DriveError::Unable {
            driver: self.bench.driver().as_str(),
            ability: "index sensor",
            instead: "say where the rollers stand with `dose home --set <ANGLE>`, or turn them to a mark \
                      with `dose home --mark`",
        }))
    }
}
