//! A dose without a person from an angle that was disturbed.

use std::ops::ControlFlow;

use pump_model::units::degrees;

use crate::bench::homing::NOT_DELIVERED;
use crate::bench::session::Session;
use crate::dosing::{DoseError, disturbed};
use crate::drives::DriveError;
use crate::notice::Notice;
use crate::numbers::significant;
use crate::pump_file::HomePolicy;

impl Session<'_> {
    /// Refuses a motion without a person from an angle that was disturbed or is unknown, unless the pump file's
    /// `[safety] home` accepts it. A turn to the index sensor would be a motion before its time, so it is refused too.
    ///
    /// # Errors
    ///
    /// [`DoseError`] as for [`Session::follow_home_policy`].
    pub fn keep_home_policy(&mut self) -> Result<(), DoseError> {
        if self.bench.file().safety.home != Some(HomePolicy::Sensor) {
            return self.follow_home_policy(|_| ControlFlow::Continue(()));
        }
        self.check_stand()?;
        self.check_confirmed()?;
        self.connect()?;
        let (state, pitch_rad) = (self.stands(), self.bench.model().pitch_rad());
        let is_known = state.phase().is_known(pitch_rad);
        if state.disturbances == 0 && is_known {
            return Ok(());
        }
        let home = HomePolicy::Sensor;
        Err(DoseError::Disturbed { home, within_deg: is_known.then(|| degrees(state.half_width_rad)) })
    }

    /// Does as the pump file's `[safety] home` says before a dose without a person, or before the rest of an unfinished
    /// one, if the rollers' angle was disturbed since it was found, or is unknown. The next dose that is prepared tells
    /// what was done. An unfinished dose stays on record, and so does its carry.
    ///
    /// `watch` ends a turn to the index sensor, as in [`Session::seek_index`].
    ///
    /// # Errors
    ///
    /// [`DoseError::Disturbed`] if the pump file has such doses refused. [`DoseError::Stands`] if a safety limit is
    /// reached. Other [`DoseError`]s if the device cannot be used, or the sensor does not answer.
    pub fn follow_home_policy(&mut self, watch: impl FnMut(u64) -> ControlFlow<()>) -> Result<(), DoseError> {
        let Some(policy) = self.bench.file().safety.home else { return Ok(()) };
        self.check_stand()?;
        self.check_confirmed()?;
        self.connect()?;
        let (state, pitch_rad) = (self.stands(), self.bench.model().pitch_rad());
        let is_known = state.phase().is_known(pitch_rad);
        if state.disturbances == 0 && is_known {
            return Ok(());
        }
        let within_deg = is_known.then(|| degrees(state.half_width_rad));
        match policy {
            HomePolicy::Refuse => Err(DoseError::Disturbed { home: policy, within_deg }),
            HomePolicy::Accept => {
                let angle = disturbed(within_deg);
                let text = format!("the rollers' angle {angle}: [safety] home = \"accept\" doses from it");
                self.notes.push(Notice::from(text));
                Ok(())
            }
            HomePolicy::Sensor => {
                let worn_ml = state.wear.volume_ml;
                // The rest of an unfinished dose begins where the sensor finds the rotor.
                let may_home = std::mem::replace(&mut self.may_home_unfinished, true);
                let sought = self.turn_to_index(watch);
                self.may_home_unfinished = may_home;
                if sought?.is_none() {
                    return Err(DoseError::Connection(DriveError::Interrupted));
                }
                let was = if is_known { "disturbed since it was found" } else { "unknown" };
                let state = self.stands();
                let text = format!(
                    "the rollers' angle was {was}: the rotor turned to its index sensor first \
                     and pumped {} mL{}",
                    significant(state.wear.volume_ml - worn_ml, 3),
                    state.unfinished.map_or(String::new(), |_| format!(", which {NOT_DELIVERED}")),
                );
                self.notes.push(Notice::from(text));
                Ok(())
            }
        }
    }
}
