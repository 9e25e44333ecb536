//! A flow over time under way.

use std::ops::ControlFlow;

use pump_model::units::degrees;

use super::prepared::PreparedProfile;
use crate::bench::delivery::Delivered;
use crate::bench::recorded_motion::RecordedMotion;
use crate::bench::session::Session;
use crate::dosing::DoseError;
use crate::record::{DoseTerms, Purpose};

impl Session<'_> {
    /// Runs a flow over time that this session prepared, and records its end.
    ///
    /// `watch` is called now and then with the number of steps made. When it breaks, the motor decelerates and holds,
    /// and the run has ended: its times have passed, so no rest is left to make. A simulated motor takes no time.
    ///
    /// # Errors
    ///
    /// [`DoseError::Stale`] if the rotor has moved since the run was prepared. Other [`DoseError`]s if the device
    /// cannot be used or fails, or the run cannot be recorded.
    pub fn run_profile(
        &mut self,
        prepared: &PreparedProfile,
        mut watch: impl FnMut(u64) -> ControlFlow<()>,
    ) -> Result<Delivered, DoseError> {
        let (whole, flow) = (&prepared.whole, prepared.motion());
        let given = whole.request.start_angle_rad.is_some();
        let stands = self.stands().phase();
        if !given && flow.start() != stands {
            let [planned_deg, stands_deg] = [flow.start(), stands].map(|phase| degrees(phase.angle_rad()));
            return Err(DoseError::Stale { planned_deg, stands_deg });
        }
        let motion = RecordedMotion {
            plan: (&flow).into(),
            announced: None,
            prepared: Some(whole),
            model: &whole.model,
            correction: whole.correction(),
            purpose: Purpose::Run,
            carry_out_ml: whole.carry_out_ml,
            given,
            retract_ml: None,
            whole: None,
            terms: DoseTerms { profile: true, ..whole.terms(self.file()) },
            settle_s: Some(whole.prediction.settle_s),
            seeks: false,
            may_pause: false,
        };
        let moved = self.perform(&motion, &mut watch)?;
        let completed = moved.made == flow.steps().unsigned_abs();
        if completed {
            let late = self.lateness(whole, (&flow).into(), &moved);
            self.notes.extend(late);
        }
        Ok(Delivered {
            volume_ml: moved.volume_ml,
            made: moved.made,
            began: moved.began,
            end_angle_rad: flow.angle_after(moved.made),
            completed,
            unfinished: self.stands().unfinished.is_some(),
            retracted_ml: 0.0,
            sucked_back: true,
            carry_ml: self.stands().carry_ml,
            carry_half_width_ml: self.stands().carry_within_ml(self.bench.model()),
            measured_s: moved.measured_s,
            ran_out: None,
            stand: None,
            warnings: std::mem::take(&mut self.notes),
        })
    }
}
