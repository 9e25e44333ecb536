//! The pump of McIntyre et al., with three and with two rollers.

use crate::error::ModelError;
use crate::head::geometry::Geometry;
use crate::head::paper;
use crate::head::roller_volume::RollerVolume;
use crate::line::line::Line;
use crate::units::radians;

use super::pump::Pump;

/// Choice among the paper's contradicting figures for a preset.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Variant {
    /// Dimensions of Table 1 and the measured roller volume (V_r 2.1055 mL).
    #[default]
    Measured,
    /// Dimensions of Table 1 and its V_r of 2.06 mL, to which the measured curve is scaled.
    Published,
    /// Dimensions of the authors' published code, and all else as `Measured`.
    AsBuilt,
}

impl Geometry {
    /// Returns the dimensions of the pump of McIntyre et al., by Table 1 or as built.
    pub fn published(rollers: u32, variant: Variant) -> Self {
        let table = Self {
            rollers,
            bore_radius_mm: paper::BORE_RADIUS_MM,
            tube_outer_radius_mm: paper::TUBE_OUTER_RADIUS_MM,
            backplate_radius_mm: paper::BACKPLATE_RADIUS_MM,
            contact_angle_rad: radians(paper::CONTACT_ANGLE_DEG),
            roller_radius_mm: paper::ROLLER_RADIUS_MM,
            roller_offset_mm: paper::ROLLER_OFFSET_MM,
        };
        match variant {
            Variant::Measured | Variant::Published => table,
            Variant::AsBuilt => Self {
                backplate_radius_mm: paper::AS_BUILT_BACKPLATE_RADIUS_MM,
                roller_radius_mm: paper::AS_BUILT_ROLLER_RADIUS_MM,
                roller_offset_mm: paper::AS_BUILT_ROLLER_OFFSET_MM,
                ..table
            },
        }
    }
}

impl Pump {
    /// Returns the pump of McIntyre et al. with three rollers.
    ///
    /// ```
    /// assert!((pump_model::Pump::three_roller().revolution_ml() - 21.3185).abs() < 1e-4);
    /// ```
    pub fn three_roller() -> Self {
        Self::measured(3)
    }

    /// Returns the pump of McIntyre et al. with two rollers.
    ///
    /// ```
    /// assert!((pump_model::Pump::two_roller().revolution_ml() - 23.4240).abs() < 1e-4);
    /// ```
    pub fn two_roller() -> Self {
        Self::measured(2)
    }

    /// Returns the pump of McIntyre et al. with any number of rollers that it can work with.
    ///
    /// # Errors
    ///
    /// Refuses a number of rollers with which the pump does not seal or its flow per radian is not positive.
    pub fn preset(rollers: u32, variant: Variant) -> Result<Self, ModelError> {
        let measured = RollerVolume::measured()?;
        let roller_volume = match variant {
            Variant::Published => measured.scaled_to(paper::ROLLER_VOLUME_ML)?,
            Variant::Measured | Variant::AsBuilt => measured,
        };
        let geometry = Geometry::published(rollers, variant);
        Self::new(geometry, roller_volume, Line::PUBLISHED, Line::PUBLISHED)
    }

    /// Returns a preset that is known to be valid.
    fn measured(rollers: u32) -> Self {
        let roller_volume = RollerVolume::of_valid(paper::VOLUME_COEFFICIENTS_DEG, paper::ENGAGEMENT_DEG);
        let geometry = Geometry::published(rollers, Variant::Measured);
        Self::of_valid(geometry, roller_volume, Line::PUBLISHED, Line::PUBLISHED)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_presets_that_are_not_checked_are_valid() {
        assert_eq!(Ok(Pump::two_roller()), Pump::preset(2, Variant::Measured));
        assert_eq!(Ok(Pump::three_roller()), Pump::preset(3, Variant::Measured));
    }
}
