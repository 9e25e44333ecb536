//! Uncertainty that runs are expected to have before they are looked at.

use libm::{hypot, sqrt};

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
    /// Standard deviation that the tolerance of the start angle makes in the volume of a run by the model, in mL.
    pub angle_ml: f64,
    /// Standard uncertainty of the volume of a gram, as a part of it: density of the fluid and buoyancy. It is the same
    /// in every run.
    pub density: f64,
    /// True if the repeatability is a prior of few degrees of freedom and not a figure to rely on.
    pub(in crate::calibration) is_prior: bool,
}

impl Expected {
    /// Makes the uncertainty of runs that scatter by the part `repeatability` of any volume.
    pub const fn new(repeatability: f64, reading_ml: f64) -> Self {
        Self {
            repeatability,
            repeatability_at_ml: Some(0.0),
            reading_ml,
            drop_ml: 0.0,
            angle_ml: 0.0,
            density: 0.0,
            is_prior: false,
        }
    }

    /// Returns this with the standard deviation of the drop at the nozzle, in mL.
    #[must_use]
    pub(crate) const fn with_drop_ml(self, drop_ml: f64) -> Self {
        Self { drop_ml, ..self }
    }

    /// Returns this with the standard deviation that the tolerance of the start angle makes, in mL.
    #[must_use]
    pub const fn with_angle_ml(self, angle_ml: f64) -> Self {
        Self { angle_ml, ..self }
    }

    /// Returns this with the standard uncertainty of the volume of a gram, as a part of it.
    #[must_use]
    pub const fn with_density(self, density: f64) -> Self {
        Self { density, ..self }
    }

    /// Returns this with the repeatability as a prior, which a few runs show too little to replace. A repeatability
    /// whose volume is named was measured, and stays.
    #[must_use]
    pub(crate) const fn with_prior(self) -> Self {
        Self { is_prior: self.repeatability_at_ml.is_none(), ..self }
    }

    /// Returns the standard deviation that the pump itself makes in repeated runs of `volume_ml`, as a part of it. A
    /// revolution of the pump delivers `revolution_ml`.
    pub(super) fn repeatability_of(&self, revolution_ml: f64, volume_ml: f64) -> f64 {
        scatter_ml(revolution_ml, self.repeatability, self.repeatability_at_ml, volume_ml) / volume_ml
    }

    /// Returns the standard uncertainty of a single run of `volume_ml` about its mean, with that of its reading, as a
    /// part of it. A revolution of the pump delivers `revolution_ml`, `ratio` times the model's.
    pub(in crate::calibration) fn standard_of(&self, revolution_ml: f64, ratio: f64, volume_ml: f64) -> f64 {
        let pump = hypot(self.repeatability_of(revolution_ml, volume_ml), self.known_of(ratio, volume_ml));
        hypot(pump, hypot(self.reading_ml / volume_ml, self.density))
    }

    /// Returns the standard deviation that drop and start angle make in repeated runs of `volume_ml`, as a part of it.
    /// The pump delivers `ratio` times the volume of its model, from any angle.
    pub(super) fn known_of(&self, ratio: f64, volume_ml: f64) -> f64 {
        hypot(self.drop_ml, ratio * self.angle_ml) / volume_ml
    }
}

/// Returns the standard deviation, in mL, of repeated doses of `volume_ml`, of a pump whose doses of `at_ml` scatter
/// by `part` of it. `None` stands for ten revolutions, each of `revolution_ml`.
///
/// Errors that all pitches of a dose share grow with the volume: s V/V_m. Errors of independent pitches grow with its
/// root: s sqrt(V/V_m), the larger of both below V_m. Above it the first is the larger one. The larger counts, as the
/// scatter does not tell them apart.
pub(crate) fn scatter_ml(revolution_ml: f64, part: f64, at_ml: Option<f64>, volume_ml: f64) -> f64 {
    let at_ml = at_ml.unwrap_or(STATED_REVOLUTIONS * revolution_ml);
    part * sqrt(volume_ml * volume_ml.max(at_ml))
}
