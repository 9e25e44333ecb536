//! A dose by weight before it moves.

use std::time::Duration;

use libm::fabs;
use pump_ctl::plan::{Cruise, Finish, Phase};

use super::begun::BegunByWeight;
use crate::bench::bench::Bench;
use crate::bench::session::Session;
use crate::calibration::{AgainstSpeed, Weighing};
use crate::dosing::{DoseError, DoseRequest, Prepared, Swept, unknown_angle};
use crate::pump_file::PumpFile;
use crate::record::{PumpState, WeighingTerms};
use crate::units::Amount;
use pump_model::units::rad_s;

/// Speed of the slow stretches, as a part of the dose's own.
const SLOWLY: f64 = 0.1;

/// Part of a dose that a plan of its rest has at least.
const LEAST_PLANNED: f64 = 0.1;

/// Usual longest wait for a balance to stand still.
const STILL: Duration = Duration::from_secs(60);

/// Order of a dose that a balance ends.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct OrderByWeight {
    /// Request of the dose, with the volume that the balance is to show.
    pub(crate) request: DoseRequest,
    /// Most volume by the model that the pump may turn for, in mL. `None` takes the volume of the request with its
    /// expanded uncertainty.
    pub(crate) most_ml: Option<f64>,
    /// Cruise of the slow stretches. `None` takes a tenth of the dose's own speed.
    pub(crate) slow: Option<Cruise>,
    /// Longest wait for the balance to stand still.
    pub(crate) longest: Duration,
}

impl OrderByWeight {
    /// Orders a dose with the usual ceiling, slow speed and patience.
    pub const fn new(request: DoseRequest) -> Self {
        Self { request, most_ml: None, slow: None, longest: STILL }
    }

    /// Returns the order with another ceiling, in mL by the model. `None` keeps the usual one.
    #[must_use]
    pub const fn with_most_ml(self, most_ml: Option<f64>) -> Self {
        Self { most_ml, ..self }
    }

    /// Returns the order with another cruise of the slow stretches. `None` keeps the usual one.
    #[must_use]
    pub const fn with_slow(self, slow: Option<Cruise>) -> Self {
        Self { slow, ..self }
    }

    /// Returns the order with another longest wait for the balance to stand still.
    #[must_use]
    pub const fn with_longest(self, longest: Duration) -> Self {
        Self { longest, ..self }
    }
}

/// Dose by weight that is planned and may run.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct PreparedByWeight {
    /// Order that the dose was planned for.
    pub(crate) order: OrderByWeight,
    /// Plan of the whole dose, or of the rest of one, as it would be made by volume.
    pub whole: Prepared,
    /// Part of the dose that an earlier command made. `None` for a dose that begins.
    pub(crate) begun: Option<BegunByWeight>,
    /// Expanded uncertainty of the model's volume, in mL.
    pub(crate) unsure_ml: f64,
    /// The part of it, in mL, that does not come from the angle of the rollers.
    pub(crate) pump_unsure_ml: f64,
    /// Most volume by the model that the pump turns for, in mL.
    pub most_ml: f64,
    /// Volume for each gram that the balance shows, in mL/g.
    pub(crate) z_ml_g: f64,
    /// Cruise of the slow stretches.
    pub(crate) slow: Cruise,
    /// Carry of earlier doses that is dropped, in mL.
    pub(crate) dropped_ml: f64,
}

impl PreparedByWeight {
    /// Returns the mass that the balance is to show for the dose, in g.
    pub fn target_g(&self) -> f64 {
        self.begun.map_or(self.order.request.volume_ml / self.z_ml_g, |begun| begun.target_g)
    }

    /// Returns the volume of the whole dose that was asked for, in mL.
    pub fn asked_ml(&self) -> f64 {
        self.order.request.volume_ml
    }

    /// Returns the volume that the balance is to show from now on, in mL.
    pub(super) fn left_ml(&self) -> f64 {
        self.begun.map_or(self.order.request.volume_ml, |begun| begun.left_g() * self.z_ml_g)
    }

    /// Returns the terms that the journal keeps. `read_g` is what the balance showed when this command began.
    pub(super) fn weighing_terms(&self, read_g: f64) -> WeighingTerms {
        let tare_g = self.begun.map_or(read_g, |begun| begun.tare_g);
        WeighingTerms { tare_g, target_g: self.target_g(), most_ml: self.most_ml }
    }
}

impl Session<'_> {
    /// Plans a dose that a balance ends. Moves nothing.
    ///
    /// # Errors
    ///
    /// [`DoseError`] if a dose is unfinished, the device cannot be used, or the dose cannot be planned.
    /// [`DoseError::NotByWeight`] if no balance can end the dose.
    pub fn prepare_by_weight(&mut self, order: &OrderByWeight) -> Result<PreparedByWeight, DoseError> {
        if self.cut_off.is_none() {
            self.finished()?;
        }
        self.check_confirmed()?;
        let bench = self.bench;
        self.connect_for(|file, state| bench.plan_by_weight(file, state, order, None, 0.0))?;
        let least_rad_s = self.speed_range_rad_s().0;
        let (mut found, slow) =
            self.bench.plan_by_weight(self.file(), self.state, order, None, least_rad_s)?;
        self.keep_safe(found.most_ml)?;
        found.whole = self.checked(found.whole)?;
        self.checked(slow)?;
        Ok(found)
    }
}

impl Bench {
    /// Plans a dose that a balance ends from the record. Moves and writes nothing, and asks neither the device nor the
    /// balance.
    ///
    /// # Errors
    ///
    /// [`DoseError`] as in [`Session::prepare_by_weight`].
    pub fn prepare_by_weight(&self, order: &OrderByWeight) -> Result<PreparedByWeight, DoseError> {
        let state = self.state_to_plan_from()?;
        let (mut found, _) = self.plan_by_weight(&self.file_for_dry_run()?, state, order, None, 0.0)?;
        self.would_be_safe(state.as_ref(), found.most_ml)?;
        found.whole.warnings.extend(self.device_not_asked());
        Ok(found)
    }

    /// Plans the dose, and what it would be if it were slow from its beginning: speeds are refused before anything
    /// moves.
    pub(super) fn plan_by_weight(
        &self,
        file: &PumpFile,
        state: Option<PumpState>,
        order: &OrderByWeight,
        begun: Option<BegunByWeight>,
        least_rad_s: f64,
    ) -> Result<(PreparedByWeight, Prepared), DoseError> {
        let request = order.request;
        let volume_ml = request.volume_ml;
        let refused = |why: &str| Err(DoseError::NotByWeight { why: why.to_owned(), volume_ml });
        if volume_ml <= 0.0 {
            return refused("runs forward, into the vessel");
        }
        if request.smooth || request.retract_ml.is_some() || request.finish == Some(Finish::LowFlow) {
            return refused("has no smooth flow, no retraction and no end at low flow");
        }
        if request.start_angle_rad.is_some() {
            return refused("begins at the angle on record");
        }
        if matches!(request.cruise, Some(Cruise::Within { .. })) {
            return refused("has no time in which it ends");
        }
        if order.most_ml.is_some_and(|most_ml| most_ml < volume_ml) {
            return refused("turns the pump for its own volume at least");
        }
        // The balance shows what arrives, so that nothing of earlier doses is repaid.
        let dropped_ml = state.map_or(0.0, |state| state.carry_ml);
        let z_ml_g = Weighing::of(file).amount_ml(Amount::Mass(1.0))?;
        // Nothing may be left of a dose that was begun. Its speeds are checked all the same.
        let planned_ml = begun
            .map_or(volume_ml, |begun| (begun.left_g() * z_ml_g).clamp(LEAST_PLANNED * volume_ml, volume_ml));
        let planned = DoseRequest { volume_ml: planned_ml, ..request };
        let mut whole = self.prepare_from(file, state.map(PumpState::without_carry), planned, None)?;
        if !whole.plan.start().is_known(whole.model.pitch_rad()) {
            let by_volume = unknown_angle::warnings(&whole.model, &whole.plan, request.purpose);
            whole.warnings.retain(|warning| !by_volume.contains(warning));
            whole.warnings.insert(0, unknown_angle::by_weight());
        }
        let swept = Swept::whole(&whole.model, &whole.plan);
        let unsure_ml = whole.budget(file, &swept, whole.back_flow.backflow_ml).expanded_ml();
        let left_ml = begun.map_or(volume_ml, |begun| begun.left_g() * z_ml_g);
        let pump_unsure_ml = known_unsure_ml(file, &whole) * left_ml / planned_ml;
        let usual_ml = begun.map_or(volume_ml + unsure_ml, |begun| begun.most_ml);
        let most_ml = order.most_ml.unwrap_or(usual_ml);
        let slow = match order.slow {
            Some(slow) => slow,
            None => self.slowly(file, &whole, least_rad_s)?,
        };
        let state = state.map(PumpState::without_carry);
        let slow_dose = self.plan_from(file, state, DoseRequest { cruise: Some(slow), ..planned }, None)?;
        let found = PreparedByWeight {
            order: *order,
            whole,
            begun,
            unsure_ml,
            pump_unsure_ml,
            most_ml,
            z_ml_g,
            slow,
            dropped_ml,
        };
        Ok((found, slow_dose))
    }

    /// Returns a tenth of the speed of a dose, or the slowest that device and calibration allow.
    fn slowly(&self, file: &PumpFile, whole: &Prepared, least_rad_s: f64) -> Result<Cruise, DoseError> {
        let stored = self.calibrations().active()?;
        let found = stored.as_ref().and_then(|stored| stored.calibration.displacement.as_ref());
        let pump = file.speed_dependent_pump().map_err(pump_ctl::plan::PlanError::from)?;
        let known = AgainstSpeed::of(found, &pump).and_then(|against| against.range_rpm());
        let least_known_rad_s = known.map_or(0.0, |(least_rpm, _)| rad_s(least_rpm));
        let cruise_rad_s = fabs(whole.plan.profile().cruise_rad_s());
        let slow_rad_s = (SLOWLY * cruise_rad_s).max(1.01 * least_rad_s).max(least_known_rad_s);
        Ok(Cruise::Speed { rad_s: slow_rad_s.min(cruise_rad_s) })
    }
}

/// Returns the expanded uncertainty of a plan, in mL, without the part that comes from the angle of the rollers.
pub(super) fn known_unsure_ml(file: &PumpFile, planned: &Prepared) -> f64 {
    let swept = Swept::whole(&planned.model, &planned.plan);
    let known = Swept { start: Phase::known(swept.start.angle_rad()), ..swept };
    planned.budget(file, &known, planned.back_flow.backflow_ml).expanded_ml()
}
