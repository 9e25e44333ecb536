//! One dose, delivered: its motion and that of its retraction.

use std::ops::ControlFlow;

use pump_model::math::degrees;

use super::recorded_motion::RecordedMotion;
use super::session::Session;
use crate::dosing::{DoseError, Prepared};
use crate::record::{Purpose, Terms};

/// Result of a dose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Delivered {
    /// Volume that the vessel received, in mL. If nobody can read it, the model volume of the steps made.
    pub volume_ml: f64,
    /// Number of steps made, without their sign.
    pub made: u64,
    /// Angle at which the rotor stands, in rad, counted on from the start.
    pub end_angle_rad: f64,
    /// True if the whole dose was delivered.
    pub completed: bool,
    /// Volume sucked back afterwards, in mL, positive. Zero without a retraction.
    pub retracted_ml: f64,
    /// True if the whole retraction was made.
    pub sucked_back: bool,
}

impl Session<'_> {
    /// Runs a dose that this session prepared, and records its end.
    ///
    /// `watch` is called now and then with the number of steps made. When it breaks, the motor decelerates
    /// and holds.
    ///
    /// # Errors
    ///
    /// [`DoseError::Stale`] if the rotor has moved since the dose was prepared. Other [`DoseError`]s if the
    /// device cannot be used or fails, or the dose cannot be recorded.
    pub fn run(
        &mut self,
        prepared: &Prepared,
        mut watch: impl FnMut(u64) -> ControlFlow<()>,
    ) -> Result<Delivered, DoseError> {
        let plan = &prepared.plan;
        let given = prepared.request.start_angle_rad.is_some();
        let stands = self.stands().phase();
        if !given && plan.start != stands {
            let [planned_deg, stands_deg] = [plan.start, stands].map(|phase| degrees(phase.angle_rad));
            return Err(DoseError::Stale { planned_deg, stands_deg });
        }
        let motion = RecordedMotion {
            plan,
            model: &prepared.model,
            correction: prepared.correction(),
            purpose: prepared.request.purpose,
            carry_out_ml: prepared.carry_out_ml,
            given,
            retract_ml: prepared.request.retract_ml,
            terms: prepared.terms(),
            settle_s: prepared.prediction.settle_s,
            seeks: false,
        };
        let moved = self.perform(&motion, &mut watch)?;
        let mut delivered = Delivered {
            volume_ml: moved.volume_ml,
            made: moved.made,
            end_angle_rad: plan.angle_after(moved.made),
            completed: moved.made == plan.steps.unsigned_abs(),
            retracted_ml: 0.0,
            sucked_back: prepared.retraction.is_none(),
        };
        if let Some(retraction) = prepared.retraction.as_ref().filter(|_| delivered.completed) {
            let plan = &retraction.plan;
            let motion = RecordedMotion {
                plan,
                model: &prepared.model,
                correction: prepared.correction(),
                purpose: Purpose::Retract,
                carry_out_ml: retraction.carry_out_ml,
                given: false,
                retract_ml: None,
                terms: Terms::default(),
                settle_s: retraction.prediction.settle_s,
                seeks: false,
            };
            // The dose is delivered and on record whatever becomes of the retraction.
            let back = self.perform(&motion, &mut watch);
            let delivered_ml = delivered.volume_ml;
            let back =
                back.map_err(|source| DoseError::Retraction { delivered_ml, source: Box::new(source) })?;
            delivered.sucked_back = back.made == plan.steps.unsigned_abs();
            delivered.end_angle_rad = plan.angle_after(back.made);
            delivered.retracted_ml = -plan.delivered_ml(&prepared.model, back.made);
        }
        Ok(delivered)
    }
}
