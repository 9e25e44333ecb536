//! The life of a tube and the part of it that is used up.

use crate::dosing::DoseError;
use crate::notice::{Notice, Remedy};

/// Part of its life from which on a tube is warned of.
const WARNED_FROM: f64 = 0.9;

/// Tube with a planned dose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct TubeLife {
    /// Life of the tube, in mL.
    pub(crate) life_ml: f64,
    /// Volume that the tube has pumped in either direction, in mL.
    pub(crate) pumped_ml: f64,
    /// Volume of the planned dose in either direction, in mL.
    pub(crate) planned_ml: f64,
}

impl TubeLife {
    /// Returns the volume that the tube will have pumped after the dose, in mL.
    fn after_ml(&self) -> f64 {
        self.pumped_ml + self.planned_ml
    }

    /// Refuses a dose that uses up the tube.
    pub(crate) fn check(&self) -> Result<(), DoseError> {
        let Self { life_ml, pumped_ml, planned_ml } = *self;
        if self.after_ml() < life_ml {
            Ok(())
        } else {
            Err(DoseError::TubeWorn { life_ml, pumped_ml, planned_ml })
        }
    }

    /// Warns of a tube that is almost used up.
    pub(crate) fn warning(&self) -> Option<Notice> {
        let Self { life_ml, .. } = *self;
        let after_ml = self.after_ml();
        (after_ml >= WARNED_FROM * life_ml).then(|| {
            let text = format!(
                "with this dose the tube will have pumped {after_ml:.1} mL of the {life_ml} mL that it \
                 lasts, {:.1} mL are left",
                (life_ml - after_ml).max(0.0)
            );
            Notice::from(text).with_remedy(Remedy::NoteNewTube)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tube(pumped_ml: f64, planned_ml: f64) -> TubeLife {
        TubeLife { life_ml: 1000.0, pumped_ml, planned_ml }
    }

    #[test]
    fn the_planned_dose_counts_for_the_warning_and_for_the_refusal() {
        assert_eq!(tube(0.0, 899.0).warning(), None);
        let warning = tube(890.0, 20.0).warning().unwrap();
        assert!(
            warning.text().contains("910.0 mL of the 1000 mL") && warning.text().contains("90.0 mL are left"),
            "{warning}"
        );
        assert!(tube(890.0, 109.0).check().is_ok());
        for (pumped_ml, planned_ml) in [(890.0, 110.0), (1000.0, 0.1), (0.0, 2000.0)] {
            let error = tube(pumped_ml, planned_ml).check().unwrap_err().to_string();
            assert!(error.contains("the 1000 mL that it lasts"), "{error}");
        }
    }
}
