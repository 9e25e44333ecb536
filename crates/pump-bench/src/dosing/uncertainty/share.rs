//! One share of the uncertainty budget: its source, its size and what makes it smaller.

use serde::Serialize;

use crate::calibration::ScatterPrior;
use crate::notice::{Notice, Remedy};
use crate::words::words_of_reports;

/// One share of the uncertainty budget.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Share {
    /// Source of the share.
    pub source: ShareSource,
    /// Standard uncertainty, in mL.
    pub standard_ml: f64,
    /// Part of the budget's variance, in percent.
    pub variance_percent: f64,
    /// Cheapest way to reduce the share.
    pub remedy: Notice,
    /// Prior that the share rests on. `None` for a share that was measured, or that is known otherwise.
    pub prior: Option<SharePrior>,
}

/// Prior of the pump's scatter that a share rests on, as weighed doses are too few to show it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[non_exhaustive]
pub struct SharePrior {
    /// Number of doses that were weighed.
    pub weighed: u32,
    /// Standard deviation of a dose of this volume by the prior, in mL.
    pub standard_ml: f64,
    /// Standard deviation of the prior over that of the pump file.
    pub over_pump_file: f64,
    /// Degrees of freedom of the prior: it is known to 1/sqrt(2 nu) of itself.
    pub degrees_of_freedom: u32,
}

/// Source of a share of the uncertainty.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ShareSource {
    /// Model of a pump that is not calibrated.
    Model,
    /// Scatter of doses of one volume.
    Repeatability,
    /// Volume that a roller displaces.
    RollerVolume,
    /// Resolution of a whole motor step.
    Step,
    /// Roller volume, engagement angle and zero that short doses found.
    Pulse,
    /// Start angle that is known between wide bounds only, and its zero.
    Phase,
    /// Calibration of the displacement.
    Calibration,
    /// Dependence of the displacement on the speed, as a calibration or a speed law leaves it open.
    SpeedDependence,
    /// Dependence of the displacement on the speed of a pump that nobody weighed.
    Speed,
    /// Temperature of the tube that differs from that of its calibration.
    Temperature,
    /// Drop that hangs at the nozzle before the dose and after it.
    Drop,
    /// Back flow that a nozzle in air loses.
    Backflow,
    /// Carry of earlier doses.
    Carry,
    /// Tolerance of a start angle that is known to less than 2 deg.
    Angle,
    /// Readings of the balance that ended the dose.
    Balance,
    /// Density of the fluid that was weighed, and of the air around it.
    Density,
}

words_of_reports!(ShareSource {
    Model = "model",
    Repeatability = "repeatability",
    RollerVolume = "roller_volume",
    Pulse = "pulse",
    Step = "step",
    Phase = "phase",
    Calibration = "calibration",
    SpeedDependence = "speed_law",
    Speed = "speed",
    Temperature = "temperature",
    Drop = "drop",
    Backflow = "backflow",
    Carry = "carry",
    Angle = "angle",
    Balance = "balance",
    Density = "density",
});

impl Share {
    /// Makes the share of a source, in mL, before the others of its budget are known.
    pub(super) fn new(source: ShareSource, standard_ml: f64) -> Self {
        Self { source, standard_ml, variance_percent: 0.0, remedy: source.remedy(), prior: None }
    }

    /// Returns the share as one that rests on `prior`, whose standard deviation of this dose is `standard_ml`. One more
    /// weighed dose then makes it smaller, while they are few.
    #[must_use]
    pub(super) fn resting_on(self, prior: &ScatterPrior, standard_ml: f64) -> Self {
        let stated = SharePrior {
            weighed: prior.weighed,
            standard_ml,
            over_pump_file: prior.over_expected,
            degrees_of_freedom: prior.degrees_of_freedom,
        };
        let remedy = if prior.rests_on_few() { one_more() } else { self.remedy };
        Self { prior: Some(stated), remedy, ..self }
    }
}

/// Returns the way from a few weighed doses to a surer scatter.
pub(crate) fn one_more() -> Notice {
    Notice::from("weigh one more dose").with_remedy(Remedy::WeighOneMore)
}

impl ShareSource {
    /// Returns the cheapest way to reduce a share of this source.
    fn remedy(self) -> Notice {
        let remedy = match self {
            Self::Model => "weigh what it delivers",
            Self::Repeatability => "measure it, and put CV and volume into the pump file",
            Self::RollerVolume => "dose whole pitches, or find the roller volume",
            Self::Step => "use more microsteps",
            Self::Pulse => "weigh more short doses",
            Self::Phase => "say where the rollers stand, or dose whole pitches",
            Self::Calibration => "weigh more runs, or longer ones, on a better scale",
            Self::SpeedDependence => "calibrate at three speeds or more, this one among them",
            Self::Speed => "weigh what it delivers at this speed",
            Self::Temperature => "calibrate at the temperature at which you dose",
            Self::Drop => {
                "immerse the nozzle's end or use a narrower one, and say so: `end`, `nozzle_bore_mm` in [outlet]"
            }
            Self::Backflow => "dose slower, end at low flow, or immerse the nozzle's end",
            Self::Carry => "calibrate, so that the carry from earlier doses is surer",
            Self::Balance => "use a balance with more digits, and say how sure it is",
            Self::Density => "put the fluid's density at its temperature into the pump file",
            Self::Angle => "home by a sensor or a mark, or state the angle with a smaller tolerance",
        };
        self.way().into_iter().fold(remedy.into(), Notice::with_remedy)
    }

    /// Returns what a front end can do for the remedy. `None` where the remedy is done by hand.
    fn way(self) -> Option<Remedy> {
        match self {
            Self::Model | Self::Speed => Some(Remedy::CalibrateRuns),
            Self::Repeatability => Some(Remedy::Verify),
            Self::RollerVolume => Some(Remedy::FindPhase),
            Self::Pulse => Some(Remedy::UseShortDoses),
            Self::Phase => Some(Remedy::SetAngle),
            Self::Backflow => Some(Remedy::EndAtLowFlow),
            Self::Angle => Some(Remedy::HomeBySensorOrMark),
            Self::Step
            | Self::Calibration
            | Self::SpeedDependence
            | Self::Temperature
            | Self::Drop
            | Self::Balance
            | Self::Density
            | Self::Carry => None,
        }
    }
}
