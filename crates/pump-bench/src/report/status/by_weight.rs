//! The weighing of the last dose, if a balance ended it.

use libm::log10;
use serde::Serialize;

use crate::numbers::{microlitres, significant};
use crate::record::{DoseByWeight, PumpState};

/// The weighing of the last dose, which a balance ended.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[non_exhaustive]
pub struct LastByWeight {
    /// Mass that the balance was to show, g.
    pub target_g: f64,
    /// Mass that the balance showed at rest, g.
    pub mass_g: f64,
    /// Step of the balance's last digit, g.
    pub digit_g: f64,
    /// Volume of the mass that the balance showed, mL.
    pub volume_ml: f64,
    /// Volume that the pump turned for by the model, mL.
    pub turned_ml: f64,
    /// True if that volume is one from the angle on record. From an unknown angle the model's volume is one of many.
    pub from_known_angle: bool,
    /// Carry of earlier doses that was dropped, mL.
    pub dropped_ml: f64,
    /// Time at which the dose began, seconds since 1970 by the clock of that day.
    pub began_unix_s: u64,
}

impl LastByWeight {
    /// Returns the weighing on record, unless another dose has begun since.
    pub(super) fn of(state: &PumpState) -> Option<Self> {
        let dose = state.last.filter(|_| state.unfinished.is_none())?;
        let DoseByWeight { target_g, mass_g, digit_g, weighed_ml, turned_ml, dropped_ml } = dose.by_weight?;
        let (volume_ml, began_unix_s) = (weighed_ml, dose.unix_s);
        let from_known_angle = dose.start().is_stated();
        Some(Self {
            target_g,
            mass_g,
            digit_g,
            volume_ml,
            turned_ml,
            from_known_angle,
            dropped_ml,
            began_unix_s,
        })
    }

    /// Returns the volume of the weighing in words, for a row.
    pub(super) fn volume(&self) -> String {
        format!("last dose by weight: {} mL", significant(self.volume_ml, 5))
    }

    /// Returns the weighing in words.
    pub(in crate::report) fn text(&self) -> String {
        let decimals = (-log10(self.digit_g)).clamp(0.0, 6.0).round() as usize;
        let dropped = match self.dropped_ml {
            0.0 => String::new(),
            dropped_ml => format!(", and {} of earlier doses were dropped", microlitres(dropped_ml)),
        };
        // From an unknown angle the model's volume says nothing.
        let turned = match self.from_known_angle {
            true => format!("; the pump turned for {} mL by the model", significant(self.turned_ml, 5)),
            false => String::new(),
        };
        format!(
            "last dose by weight: {:.decimals$} g of {:.decimals$} g asked for, {} mL{turned}; it carries nothing to \
             the next dose{dropped}",
            self.mass_g,
            self.target_g,
            significant(self.volume_ml, 5),
        )
    }
}
