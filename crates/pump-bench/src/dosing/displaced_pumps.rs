//! The pumps by whose displacement a motion holds its limits, where the model alone gives its steps.

use pump_ctl::plan::{Limits, Margin, Margins, Plan, PlanError, Prediction};
use pump_model::units::rpm;
use pump_model::{BackFlow, Pump};

use super::error::DoseError;
use crate::calibration::{AgainstSpeed, CalibrationError, Stored};
use crate::displacement::{Correction, SpeedDependentPump};
use crate::pump_file::PumpFile;

/// Pumps by whose displacement a motion holds its limits. The steps of a run to be weighed, and of a turn of
/// the rotor, follow from the model alone. Their pressures follow from what the pump displaces.
///
/// The calibration in use is the best knowledge of that, or else the pump file's law. A speed that it does
/// not cover has two pumps: that of the nearest speed that it covers, and the model. The truth at such a
/// speed is not known, so a motion must hold its limits by both.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct DisplacedPumps {
    known: Pump,
    model: Option<Pump>,
}

impl DisplacedPumps {
    /// Returns the pumps of a motion of `base`, the pump of `file` without calibration and law, at a cruise
    /// speed in rad/s. The speed is negative in reverse. `stored` is the calibration in use. A calibration of
    /// another pump does not count.
    ///
    /// # Errors
    ///
    /// [`DoseError::Plan`] or [`DoseError::Calibration`] if the pump with its law or its calibration cannot
    /// be modelled.
    pub(crate) fn at(
        file: &PumpFile,
        base: &Pump,
        stored: Option<&Stored>,
        speed_rad_s: f64,
    ) -> Result<Self, DoseError> {
        let law = file.displacement_law().map_err(PlanError::from)?;
        let pump = SpeedDependentPump::new(*base, law);
        let calibration = stored.filter(|stored| stored.is_of(base)).map(|stored| &stored.calibration);
        let shape = calibration.map_or(Correction::NONE, |calibration| calibration.shape());
        let corrected = |factor| Correction { factor, ..shape }.of(base).map_err(CalibrationError::from);
        let displacement = calibration.and_then(|calibration| calibration.displacement.as_ref());
        let Some(against) = AgainstSpeed::of(displacement, &pump) else {
            return Ok(Self { known: corrected(1.0)?, model: None });
        };
        let speed_rpm = rpm(speed_rad_s).abs();
        let covers = against.covers(speed_rpm);
        let nearest_rpm = match against.range_rpm().filter(|_| !covers) {
            Some((least_rpm, most_rpm)) => speed_rpm.clamp(least_rpm, most_rpm),
            None => speed_rpm,
        };
        let factor = against.factor_at(nearest_rpm.copysign(speed_rad_s)).map_err(CalibrationError::from)?;
        let model = if covers { None } else { Some(corrected(1.0)?) };
        Ok(Self { known: corrected(factor)?, model })
    }

    /// Returns a pump whose displacement is known.
    pub(crate) fn only(pump: Pump) -> Self {
        Self { known: pump, model: None }
    }

    /// Predicts a plan on each of the pumps. The prediction has the widest pressures and the longest settling.
    ///
    /// # Errors
    ///
    /// [`PlanError`] as for [`Plan::predict`].
    pub(crate) fn predict(&self, plan: &Plan) -> Result<Prediction, PlanError> {
        let mut widest = plan.predict(&self.known)?;
        if let Some(pump) = &self.model {
            let Prediction { inlet, outlet, step_kpa, settle_s, .. } = plan.predict(pump)?;
            widest.inlet = widest.inlet.and(inlet);
            widest.outlet = widest.outlet.and(outlet);
            widest.step_kpa = widest.step_kpa.max(step_kpa);
            widest.settle_s = widest.settle_s.max(settle_s);
        }
        Ok(widest)
    }

    /// Predicts the back flow of a plan on each of the pumps, and returns the larger one.
    ///
    /// # Errors
    ///
    /// [`PlanError`] as for [`Plan::back_flow`].
    pub(crate) fn back_flow(&self, plan: &Plan) -> Result<BackFlow, PlanError> {
        let mut larger = plan.back_flow(&self.known)?;
        if let Some(pump) = &self.model {
            let BackFlow { backflow_ml, reverse_flow_ml } = plan.back_flow(pump)?;
            larger.backflow_ml = larger.backflow_ml.max(backflow_ml);
            larger.reverse_flow_ml = larger.reverse_flow_ml.max(reverse_flow_ml);
        }
        Ok(larger)
    }

    /// Returns the margins of a plan. Each is that of the pump that uses more of the limit.
    pub(crate) fn margins(&self, plan: &Plan, limits: &Limits) -> Margins {
        let nearer = |one: Option<Margin>, other: Option<Margin>| {
            one.into_iter().chain(other).max_by(|one, other| one.used.total_cmp(&other.used))
        };
        let mut margins = limits.margins(&self.known, plan);
        if let Some(pump) = &self.model {
            let Margins { outlet, inlet, outlet_suction, torque, .. } = limits.margins(pump, plan);
            margins.outlet = nearer(margins.outlet, outlet);
            margins.inlet = nearer(margins.inlet, inlet);
            margins.outlet_suction = nearer(margins.outlet_suction, outlet_suction);
            margins.torque = nearer(margins.torque, torque);
        }
        margins
    }

    /// Returns `plan` at the fastest cruise that holds its limits on each of the pumps.
    ///
    /// # Errors
    ///
    /// [`PlanError`] of a limit that no cruise holds.
    pub(crate) fn fastest(&self, plan: &Plan, limits: &Limits) -> Result<Plan, PlanError> {
        let known = plan.fastest_on(&self.known, limits)?;
        let Some(model) = &self.model else { return Ok(known) };
        let model = plan.fastest_on(model, limits)?;
        let is_slower = model.profile().cruise_rad_s() < known.profile().cruise_rad_s();
        Ok(if is_slower { model } else { known })
    }

    /// Refuses a plan that breaks a limit on any of the pumps.
    ///
    /// # Errors
    ///
    /// [`PlanError`] of the limit that is broken. It names the nearest speed that holds every limit.
    pub(crate) fn check(&self, plan: &Plan, limits: &Limits) -> Result<(), PlanError> {
        plan.check_on(&self.known, limits)?;
        self.model.map_or(Ok(()), |model| plan.check_on(&model, limits))
    }
}
