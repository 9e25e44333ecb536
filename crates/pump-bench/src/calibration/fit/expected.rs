//! Uncertainty that runs are expected to have before they are looked at.

use libm::sqrt;
use pump_model::Pump;

/// Revolutions of a dose whose scatter a pump file states, unless it names their volume: those of McIntyre et al.
const STATED_REVOLUTIONS: f64 = 10.0;

/// Uncertainty that is expected of a run.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Expected {
    /// Standard deviation of repeated runs of [`Self::repeatability_at_ml`], as a part of the volume.
    pub(crate) repeatability: f64,
    /// Volume of the runs that scatter so, in mL. Smaller runs scatter by a larger part, as if their pitches were
    /// independent. With 0 the part is that of every run, and with `None` that of ten revolutions of the pump.
    pub(crate) repeatability_at_ml: Option<f64>,
    /// Standard uncertainty of a reading of the scale or the vessel, in mL. It may be the same in every run,
    /// so no mean reduces it.
    pub(crate) reading_ml: f64,
    /// Standard deviation of the drop at the nozzle, in mL: it hangs there before and after a run, each time as large
    /// as it may be.
    pub(crate) drop_ml: f64,
}

impl Expected {
    /// Makes the uncertainty of runs that scatter by the part `repeatability` of any volume.
    pub const fn new(repeatability: f64, reading_ml: f64) -> Self {
        Self { repeatability, repeatability_at_ml: Some(0.0), reading_ml, drop_ml: 0.0 }
    }

    /// Returns this with the standard deviation of the drop at the nozzle, in mL.
    #[must_use]
    pub(crate) const fn with_drop_ml(self, drop_ml: f64) -> Self {
        Self { drop_ml, ..self }
    }

    /// Returns the standard deviation of repeated runs of `volume_ml` of `pump`, as a part of the volume.
    pub(super) fn repeatability_of(&self, pump: &Pump, volume_ml: f64) -> f64 {
        let scatter_ml = scatter_ml(pump, self.repeatability, self.repeatability_at_ml, volume_ml);
        sqrt(scatter_ml * scatter_ml + self.drop_ml * self.drop_ml) / volume_ml
    }
}

/// Returns the standard deviation, in mL, of repeated doses of `volume_ml`, of a pump whose doses of `at_ml` scatter
/// by `part` of it. `None` stands for ten revolutions.
///
/// Errors that all pitches of a dose share grow with the volume: s V/V_m. Errors of independent pitches grow with its
/// root: s sqrt(V/V_m), the larger of both below V_m. Above it the first is the larger one. The larger counts, as the
/// scatter does not tell them apart.
pub(crate) fn scatter_ml(pump: &Pump, part: f64, at_ml: Option<f64>, volume_ml: f64) -> f64 {
    let at_ml = at_ml.unwrap_or_else(|| STATED_REVOLUTIONS * pump.revolution_ml());
    part * sqrt(volume_ml * volume_ml.max(at_ml))
}
