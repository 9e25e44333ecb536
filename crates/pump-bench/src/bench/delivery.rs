//! One dose, delivered: its motion and that of its retraction.

use std::ops::ControlFlow;

use pump_model::units::degrees;

use super::bench::Bench;
use super::lateness;
use super::recorded_motion::RecordedMotion;
use super::session::Session;
use crate::dosing::{DoseError, DoseRequest, Prepared, Retraction, RunBound, RunEnd};
use crate::notice::Notice;
use crate::record::{DoseTerms, Purpose, Stamp};
use crate::safety::Stand;

/// Part of a run until it is stopped that a safety limit leaves at its end, at most: its plan goes to 99 % of the
/// limit.
const NEARLY: f64 = 0.02;

/// Result of a dose.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Delivered {
    /// Volume that the vessel received, in mL. If nobody can read it, the model volume of the steps made.
    pub volume_ml: f64,
    /// Time at which the dose began.
    pub began: Stamp,
    /// Number of steps made, without their sign.
    pub made: u64,
    /// Angle at which the rotor stands, in rad, counted on from the start.
    pub end_angle_rad: f64,
    /// True if the whole dose was delivered.
    pub completed: bool,
    /// True if a rest is left to make. A run until it is stopped leaves none.
    pub unfinished: bool,
    /// Volume sucked back afterwards, in mL, positive. Zero without a retraction.
    pub retracted_ml: f64,
    /// True if the whole retraction was made.
    pub sucked_back: bool,
    /// Carry on record afterwards, in mL. An unfinished dose leaves the carry of before it.
    pub carry_ml: f64,
    /// Half width of the range around that carry that holds the true carry, in mL.
    pub carry_half_width_ml: f64,
    /// Time that the motion of the dose took, in s. A simulated motion takes the time of its plan.
    pub measured_s: f64,
    /// Bound at which a run until it was stopped ended by itself. `None` otherwise.
    pub ran_out: Option<RunBound>,
    /// Stand of the pump after a run until it was stopped that a safety limit ended. `None` otherwise.
    pub stand: Option<Stand>,
    /// Warnings for the user that came up in motion or after it.
    pub warnings: Vec<Notice>,
}

impl Bench {
    /// Returns the error of a run until it was stopped that ended by itself: its flow was to go on. `None` for any
    /// other motion.
    #[must_use]
    pub fn ended_early(&self, delivered: &Delivered) -> Option<DoseError> {
        match (delivered.stand, delivered.ran_out) {
            (Some(stand), _) => Some(self.refusal(stand, true, 0)),
            (None, Some(bound)) => Some(DoseError::RanOut { bound, delivered_ml: delivered.volume_ml }),
            (None, None) => None,
        }
    }
}

impl Session<'_> {
    /// Runs a dose that this session prepared, and records its end.
    ///
    /// `watch` is called now and then with the number of steps made. When it breaks, the motor decelerates
    /// and holds. A run until it is stopped keeps real time on a simulated motor. Any other motion takes none there,
    /// unless the drive table's `pace` is real.
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
        if !given && plan.start() != stands {
            let [planned_deg, stands_deg] = [plan.start(), stands].map(|phase| degrees(phase.angle_rad()));
            return Err(DoseError::Stale { planned_deg, stands_deg });
        }
        let motion = RecordedMotion {
            plan: plan.into(),
            announced: None,
            prepared: Some(prepared),
            model: &prepared.model,
            correction: prepared.correction(),
            purpose: prepared.request.purpose,
            carry_out_ml: prepared.carry_out_ml,
            given,
            retract_ml: prepared.request.retract_ml,
            whole: self.whole_of_rest(prepared),
            terms: prepared.terms(self.file()),
            settle_s: Some(prepared.prediction.settle_s),
            seeks: false,
            may_pause: !lateness::is_critical(&prepared.request),
        };
        let moved = self.perform(&motion, &mut watch)?;
        let mut delivered = Delivered {
            volume_ml: moved.volume_ml,
            made: moved.made,
            began: moved.began,
            end_angle_rad: plan.angle_after(moved.made),
            completed: moved.made == plan.steps().unsigned_abs(),
            unfinished: self.stands().unfinished.is_some(),
            retracted_ml: 0.0,
            sucked_back: prepared.retraction.is_none(),
            carry_ml: self.stands().carry_ml,
            carry_half_width_ml: self.stands().carry_within_ml(self.bench.model()),
            measured_s: moved.measured_s,
            ran_out: None,
            stand: None,
            warnings: Vec::new(),
        };
        if delivered.completed {
            let late = self.lateness(prepared, plan.into(), &moved);
            self.notes.extend(late);
        }
        if let Some(retraction) = prepared.retraction.as_ref().filter(|_| delivered.completed) {
            self.suck_back(prepared, retraction, &mut delivered, &mut watch)?;
        }
        if delivered.completed {
            delivered.ran_out = self.bound_of(prepared);
        }
        if let Some(RunBound::Safety(limit)) = delivered.ran_out {
            delivered.stand = self.stand_after_run(limit);
        }
        delivered.warnings.append(&mut self.notes);
        Ok(delivered)
    }

    /// Returns the bound at which a run until it is stopped has ended by itself. The rest of one that was cut off ends
    /// where the whole run was to end, by the limits of then. `None` for a motion with an end.
    fn bound_of(&self, prepared: &Prepared) -> Option<RunBound> {
        let DoseRequest { end, whole_ml, volume_ml, .. } = prepared.request;
        if end != RunEnd::Stop || prepared.ends_at.is_some() {
            return prepared.ends_at;
        }
        let nearest = self.nearest_limit(volume_ml < 0.0);
        let is_near =
            |stand: &Stand| whole_ml.is_some_and(|whole_ml| stand.left_ml() <= NEARLY * whole_ml.abs());
        Some(nearest.filter(is_near).map_or(RunBound::Rest, |stand| RunBound::Safety(stand.limit)))
    }

    /// Makes the retraction after a dose. The dose is delivered and on record whatever becomes of it.
    fn suck_back(
        &mut self,
        prepared: &Prepared,
        retraction: &Retraction,
        delivered: &mut Delivered,
        watch: &mut impl FnMut(u64) -> ControlFlow<()>,
    ) -> Result<(), DoseError> {
        let plan = &retraction.plan;
        let motion = RecordedMotion {
            plan: plan.into(),
            announced: None,
            prepared: None,
            model: &prepared.model,
            correction: prepared.correction(),
            purpose: Purpose::Retract,
            carry_out_ml: retraction.carry_out_ml,
            given: false,
            retract_ml: None,
            whole: None,
            terms: DoseTerms::default(),
            settle_s: Some(retraction.prediction.settle_s),
            seeks: false,
            may_pause: true,
        };
        let back = match self.perform(&motion, watch) {
            // Nothing was sucked back.
            Err(error) if error.is_stop() => return Ok(()),
            Err(error) => {
                let delivered_ml = delivered.volume_ml;
                return Err(DoseError::Retraction { delivered_ml, source: Box::new(error) });
            }
            Ok(back) => back,
        };
        delivered.sucked_back = back.made == plan.steps().unsigned_abs();
        delivered.end_angle_rad = plan.angle_after(back.made);
        delivered.retracted_ml = -plan.delivered_ml(&prepared.model, back.made);
        delivered.carry_ml = self.stands().carry_ml;
        delivered.carry_half_width_ml = self.stands().carry_within_ml(self.bench.model());
        Ok(())
    }
}
