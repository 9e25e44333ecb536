//! The reasons for which no pump serves a duty.

use std::fmt;

use pump_ctl::plan::SetBy;
use pump_model::ModelError;
use thiserror::Error;

use crate::displacement::DisplacementError;
use crate::numbers::significant;
use crate::pump_file::FluidError;

/// A duty that no pump serves, or not this one.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum SizingError {
    /// No head of the catalogue gives the flow.
    #[error(
        "no head of the catalogue gives {} within the speeds that its document states: they give {} ({smallest}) to {} \
         ({largest})",
        flow(*flow_ml_s), flow(*least_ml_s), flow(*most_ml_s)
    )]
    NoHead {
        /// Flow that was asked for, in mL/s.
        flow_ml_s: f64,
        /// Smallest flow of the catalogue, in mL/s.
        least_ml_s: f64,
        /// Head of the smallest flow.
        smallest: String,
        /// Largest flow of the catalogue, in mL/s.
        most_ml_s: f64,
        /// Head of the largest flow.
        largest: String,
    },
    /// The pump turns too slowly or too fast for the flow.
    #[error(
        "{pump} would give {} at {needed_rpm:.4} r/min; allowed: {} r/min, which give {}",
        flow(*flow_ml_s), range(*least_rpm, *most_rpm), flow_range(*least_rpm, *most_rpm, *most_ml_s)
    )]
    Speed {
        /// Pump or head.
        pump: String,
        /// Flow that was asked for, in mL/s.
        flow_ml_s: f64,
        /// Speed at which the pump would give the flow, in r/min.
        needed_rpm: f64,
        /// Slowest speed of the pump, in r/min.
        least_rpm: f64,
        /// Fastest speed of the pump, in r/min.
        most_rpm: f64,
        /// Flow at the fastest speed, in mL/s.
        most_ml_s: f64,
    },
    /// Nothing is known of a line, so that no pressure follows.
    #[error("nothing is known of the line at the {side}; allowed: a hose, as 6x10mm,1m")]
    NoLine {
        /// Side of the pump.
        side: &'static str,
    },
    /// The air has no pressure that any place has.
    #[error(
        "no place has this air: its pressure or the altitude is out of range; allowed: 1 to 10000 kPa, or an altitude \
         of -500 to 9000 m"
    )]
    Air {
        /// Pressure, in kPa absolute. It is NaN where the altitude has none.
        kpa: f64,
    },
    /// A pressure falls below what fluid and tube stand.
    #[error("{0}")]
    Suction(Box<Shortfall>),
    /// The pressure at the outlet rises above what is allowed.
    #[error("{0}")]
    Discharge(Box<Shortfall>),
    /// The fluid is not known.
    #[error(transparent)]
    Fluid(#[from] FluidError),
    /// The model refuses the pump or a line.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// The speed law gives no speed for the flow.
    #[error(transparent)]
    Displacement(#[from] DisplacementError),
}

/// A pressure beyond its limit, what makes it up, and what would do.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Shortfall {
    /// Port at which the limit is broken.
    pub port: &'static str,
    /// Pressure that is reached, in kPa absolute.
    pub reached_kpa: f64,
    /// Limit of the pressure, in kPa absolute.
    pub limit_kpa: f64,
    /// Origin of the limit, in words.
    pub set_by: String,
    /// Height of the column on this side, in mm. `None` where the reservoir has a pressure.
    pub lift_mm: Option<f64>,
    /// Pressure of this column, in kPa.
    pub lift_kpa: f64,
    /// Friction in the line, in kPa.
    pub friction_kpa: f64,
    /// Part of the pulse, in kPa. `None` where the mean pressure breaks the limit already.
    pub pulse_kpa: Option<f64>,
    /// Changes that would do.
    pub would_do: WouldDo,
}

/// Changes after which a duty can be served, each by itself.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub struct WouldDo {
    /// Largest lift, in mm.
    pub most_lift_mm: Option<f64>,
    /// Smallest bore of the hose, in mm.
    pub least_bore_mm: Option<f64>,
}

impl Shortfall {
    /// Returns true if the pressure falls below its limit. Otherwise it rises above.
    fn is_low(&self) -> bool {
        self.reached_kpa < self.limit_kpa
    }
}

impl fmt::Display for Shortfall {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { port, reached_kpa, limit_kpa, set_by, lift_kpa, friction_kpa, .. } = self;
        let margin_kpa = if self.is_low() { reached_kpa - limit_kpa } else { limit_kpa - reached_kpa };
        let (name, moves, side) = match (self.is_low(), *port) {
            (true, "inlet") => ("suction margin", "falls", "suction"),
            (true, _) => ("margin at the outlet", "falls", "discharge"),
            (false, _) => ("pressure margin at the outlet", "rises", "discharge"),
        };
        write!(
            to,
            "the {name} is {margin_kpa:.2} kPa: the {port} pressure {moves} to {reached_kpa:.2} kPa absolute, and its \
             limit is {limit_kpa:.2} kPa{set_by}; "
        )?;
        if let Some(lift_mm) = self.lift_mm.filter(|lift_mm| *lift_mm != 0.0) {
            write!(
                to,
                "the {side} lift of {} m makes {lift_kpa:.2} kPa of it, ",
                significant(1e-3 * lift_mm, 4)
            )?;
        }
        write!(to, "the friction in the line {friction_kpa:.2} kPa")?;
        if let Some(pulse_kpa) = self.pulse_kpa {
            write!(to, ", the pulse {pulse_kpa:.2} kPa")?;
        }
        let WouldDo { most_lift_mm, least_bore_mm } = self.would_do;
        let lift = most_lift_mm.map(|mm| format!("a {side} lift of {} m at most", significant(1e-3 * mm, 4)));
        let bore = least_bore_mm.map(|mm| format!("a hose of {mm} mm bore at least"));
        let ways: Vec<String> = lift.into_iter().chain(bore).collect();
        match ways.is_empty() {
            true => write!(to, "; a smaller flow or a shorter hose leaves more"),
            false => write!(to, "; try {}", ways.join(" or ")),
        }
    }
}

/// Returns the words that follow a pressure limit at the suction side.
pub(super) fn origin(set_by: Option<SetBy>) -> String {
    match set_by {
        Some(SetBy::Given) => ", as given".to_owned(),
        Some(set_by) => set_by.to_string(),
        None => ", as no liquid is below".to_owned(),
    }
}

/// Words a flow in mL/s as mL/min beside it.
pub(super) fn flow(ml_s: f64) -> String {
    format!("{} mL/min", significant(60.0 * ml_s, 4))
}

/// Words a range of speeds.
fn range(least_rpm: f64, most_rpm: f64) -> String {
    format!("{least_rpm} to {most_rpm}")
}

/// Words the flows at both ends of a range of speeds.
fn flow_range(least_rpm: f64, most_rpm: f64, most_ml_s: f64) -> String {
    format!("{} to {}", flow(most_ml_s * least_rpm / most_rpm), flow(most_ml_s))
}
