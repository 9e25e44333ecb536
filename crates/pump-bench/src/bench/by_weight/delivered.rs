//! A dose by weight after it was made.

use libm::sqrt;

use super::prepared::PreparedByWeight;
use super::tolerance::ToleranceBy;
use crate::dosing::Swept;
use crate::notice::Notice;
use crate::pump_file::PumpFile;
use crate::record::{AfterStop, Stamp};
use crate::units::Amount;

/// Result of a dose by weight.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct DeliveredByWeight {
    /// Time at which the dose began. `None` before its end is told.
    pub began: Option<Stamp>,
    /// Mass that the balance shows for the dose, in g, at rest, the part of an earlier command included.
    pub mass_g: f64,
    /// Step of the balance's last digit, in g.
    pub digit_g: f64,
    /// Volume of that mass, in mL.
    pub volume_ml: f64,
    /// Part of that volume that an earlier command had made before this one, in mL. 0 for a dose that one command made.
    pub before_ml: f64,
    /// Volume that the pump turned for by the model, in mL, the part of an earlier command included.
    pub turned_ml: f64,
    /// Least and most volume by the model, in mL, over the angles at which the rollers may have stood.
    pub turned_range_ml: (f64, f64),
    /// Number of stretches, each weighed at rest.
    pub stretches: u32,
    /// Number of stretches that the balance stopped before the end of their plan.
    pub stopped_by_balance: u32,
    /// Motor steps made.
    pub made: u64,
    /// Angle at which the rotor stands, in rad, counted on from the start.
    pub end_angle_rad: f64,
    /// Time for which the motor turned, in s.
    pub measured_s: f64,
    /// Time from the first step to the last reading, in s, the weighing between the stretches included. `None` where
    /// the motor is simulated, which takes no time.
    pub took_s: Option<f64>,
    /// Mass by which the dose may lack when it is done, in g.
    pub tolerance_g: f64,
    /// Reason of that tolerance.
    pub tolerance_by: ToleranceBy,
    /// True if the balance shows what was asked for. False if the user stopped the dose, which is unfinished then.
    pub completed: bool,
    /// Flow that still arrived after the stops, with those of earlier doses. `None` if no reading in motion told it.
    pub after_stop: Option<AfterStop>,
    /// Time by which this dose began to reckon with the flow after a stop, in s, and whether it was learned. Otherwise
    /// it is the model's. `None` where the motor is simulated, which no reading follows.
    pub reckoned_s: Option<(f64, bool)>,
    /// Carry of earlier doses that was dropped, in mL.
    pub dropped_ml: f64,
    /// Warnings for the user that came up in motion or after it.
    pub warnings: Vec<Notice>,
}

impl DeliveredByWeight {
    /// Returns the turn that this command made of the dose.
    pub(crate) fn swept(&self, prepared: &PreparedByWeight) -> Swept {
        let (whole, before_ml) = (&prepared.whole, prepared.begun.map_or(0.0, |begun| begun.turned_ml));
        let (least_ml, most_ml) = self.turned_range_ml;
        let end_ml_rad = whole.model.outlet_curve().flow_ml_rad(self.end_angle_rad);
        Swept {
            start: whole.plan.start(),
            end_rad: self.end_angle_rad,
            volume_ml: self.turned_ml - before_ml,
            range_ml: (least_ml - before_ml, most_ml - before_ml),
            end_step_ml: end_ml_rad.abs() * whole.plan.step_rad(),
            carry_in_ml: 0.0,
        }
    }

    /// Returns the standard uncertainty of the difference of two readings, in g. `scale` is that of one reading, and a
    /// volume is one of the fluid of `file`. Without it the last digit tells it: each reading is rounded (GUM,
    /// F.2.2.1).
    pub fn difference_standard_g(&self, scale: Option<Amount>, file: &PumpFile) -> f64 {
        match scale {
            Some(Amount::Mass(mass_g)) => sqrt(2.0) * mass_g,
            Some(Amount::Volume(volume_ml)) => sqrt(2.0) * volume_ml * file.fluid.density_kg_m3 / 1e3,
            None => self.digit_g * sqrt(2.0 / 12.0),
        }
    }
}
