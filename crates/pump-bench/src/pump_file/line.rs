//! The line of `[inlet]` or `[outlet]`, given by its R, C and L or by its hose.

pub(super) mod outlet;
pub(super) mod reservoir;

use pump_model::{Fluid, Friction, Hose, Line, ModelError};
use serde::{Deserialize, Serialize};

use reservoir::Reservoir;

/// Line that stands in for one of which nothing is known. It follows the rollers within milliseconds and its pressure
/// stays that of its end, so that it adds nothing to what the rollers deliver: critically damped at 1000 rad/s,
/// R = 2 sqrt(L/C). No report states its pressures or its settling.
const STIFF: Line = Line {
    resistance_kpa_s_ml: 0.02,
    compliance_ml_kpa: 0.1,
    inertance_kpa_s2_ml: 1e-5,
    reservoir_kpa: 101.325,
};

/// The table `[inlet]`, and the line of `[outlet]`.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "LineKeys", into = "LineKeys")]
#[non_exhaustive]
pub struct LineTable {
    /// Source of the line's R, C and L.
    pub source: LineSource,
    /// Reservoir at the line's end.
    pub reservoir: Reservoir,
}

/// Source of a line's R, C and L.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub enum LineSource {
    /// Nothing is known of the line, as it may be of a bought head. Its pressures and its settling are not known.
    #[default]
    Unknown,
    /// R, C and L as the file gives them.
    Given {
        /// Resistance R, in kPa s/mL.
        resistance_kpa_s_ml: f64,
        /// Compliance C, in mL/kPa.
        compliance_ml_kpa: f64,
        /// Inertance L, in kPa s²/mL.
        inertance_kpa_s2_ml: f64,
    },
    /// Table `[inlet.hose]` or `[outlet.hose]`, from which R, C and L are estimated.
    Hose(HoseTable),
}

/// The table `[inlet.hose]` or `[outlet.hose]`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct HoseTable {
    /// Radius of the bore a, in mm.
    pub bore_radius_mm: f64,
    /// Outer radius b, in mm.
    pub outer_radius_mm: f64,
    /// Length l, in mm.
    pub length_mm: f64,
    /// Young's modulus E, in MPa.
    pub modulus_mpa: f64,
    /// Poisson's ratio nu, 0 to 0.5.
    pub poisson_ratio: f64,
    /// Loss of the fittings K, in velocity heads.
    pub minor_loss: f64,
    /// Flow at which R is taken, in mL/s, since the model's lines are linear. `None` takes the pump's default
    /// rate.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub resistance_at_ml_s: Option<f64>,
}

impl HoseTable {
    /// Returns the hose of the model.
    pub(crate) fn hose(&self) -> Hose {
        Hose {
            bore_radius_mm: self.bore_radius_mm,
            outer_radius_mm: self.outer_radius_mm,
            length_mm: self.length_mm,
            modulus_mpa: self.modulus_mpa,
            poisson_ratio: self.poisson_ratio,
            minor_loss: self.minor_loss,
        }
    }
}

impl LineTable {
    /// Line of which nothing is known, to a reservoir that is open to the air and as high as the pump.
    pub const UNKNOWN: Self = Self { source: LineSource::Unknown, reservoir: Reservoir::OPEN };

    /// Returns the line of a hose, to a reservoir at an absolute pressure in kPa.
    pub fn of_hose(reservoir_kpa: f64, hose: HoseTable) -> Self {
        Self { source: LineSource::Hose(hose), reservoir: Reservoir::Pressure(reservoir_kpa) }
    }

    /// Returns the line of a hose, to a reservoir at another height, in mm: see [`Reservoir::Lift`].
    pub fn of_hose_with_lift(lift_mm: f64, hose: HoseTable) -> Self {
        Self { source: LineSource::Hose(hose), reservoir: Reservoir::Lift(lift_mm) }
    }

    /// Returns the hose, or `None` for a line that is given by its R, C and L, or not known.
    pub fn hose(&self) -> Option<&HoseTable> {
        match &self.source {
            LineSource::Unknown | LineSource::Given { .. } => None,
            LineSource::Hose(hose) => Some(hose),
        }
    }

    /// Returns the line to a reservoir at `reservoir_kpa` for a pump whose default rate is `rate_ml_s`. A hose also
    /// needs the fluid. A line of which nothing is known follows the rollers ([`STIFF`]).
    ///
    /// # Errors
    /// Returns the [`ModelError`] of a fluid or a hose that is out of range.
    pub(crate) fn line(
        &self,
        fluid: impl FnOnce() -> Result<Fluid, ModelError>,
        rate_ml_s: f64,
        reservoir_kpa: f64,
    ) -> Result<Line, ModelError> {
        match self.source {
            LineSource::Unknown => Ok(Line { reservoir_kpa, ..STIFF }),
            LineSource::Given { resistance_kpa_s_ml, compliance_ml_kpa, inertance_kpa_s2_ml } => {
                Ok(Line { resistance_kpa_s_ml, compliance_ml_kpa, inertance_kpa_s2_ml, reservoir_kpa })
            }
            LineSource::Hose(hose) => {
                hose.hose().line(&fluid()?, reservoir_kpa, hose.resistance_at_ml_s.unwrap_or(rate_ml_s))
            }
        }
    }

    /// Returns the friction of the hose at every flow, or `None` for a line that is given by its R, or not known.
    ///
    /// # Errors
    /// Returns the [`ModelError`] of a fluid or a hose that is out of range.
    pub(crate) fn friction(
        &self,
        fluid: impl FnOnce() -> Result<Fluid, ModelError>,
    ) -> Result<Option<Friction>, ModelError> {
        match self.hose() {
            None => Ok(None),
            Some(hose) => hose.hose().friction(&fluid()?).map(Some),
        }
    }

    /// Returns true if nothing is known of the line.
    pub(crate) fn is_unknown(&self) -> bool {
        self.source == LineSource::Unknown
    }

    /// Returns true if a pump file says nothing of the line and its reservoir.
    pub(super) fn is_absent(&self) -> bool {
        *self == Self::UNKNOWN
    }

    /// Returns true if the line is estimated from a hose and not measured.
    pub(crate) fn is_estimated(&self) -> bool {
        self.hose().is_some()
    }
}

impl From<Line> for LineTable {
    fn from(line: Line) -> Self {
        let Line { resistance_kpa_s_ml, compliance_ml_kpa, inertance_kpa_s2_ml, reservoir_kpa } = line;
        Self {
            source: LineSource::Given { resistance_kpa_s_ml, compliance_ml_kpa, inertance_kpa_s2_ml },
            reservoir: Reservoir::Pressure(reservoir_kpa),
        }
    }
}

/// Keys of the table, whether it gives a line or a hose, a pressure or a lift.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct LineKeys {
    #[serde(skip_serializing_if = "Option::is_none")]
    resistance_kpa_s_ml: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    compliance_ml_kpa: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    inertance_kpa_s2_ml: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    reservoir_kpa: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    lift_mm: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    hose: Option<HoseTable>,
}

impl TryFrom<LineKeys> for LineTable {
    type Error = String;

    fn try_from(keys: LineKeys) -> Result<Self, String> {
        let LineKeys { resistance_kpa_s_ml, compliance_ml_kpa, inertance_kpa_s2_ml, .. } = keys;
        let reservoir = Reservoir::of_keys(keys.reservoir_kpa, keys.lift_mm)?;
        let given = [
            ("resistance_kpa_s_ml", resistance_kpa_s_ml),
            ("compliance_ml_kpa", compliance_ml_kpa),
            ("inertance_kpa_s2_ml", inertance_kpa_s2_ml),
        ];
        if keys.hose.is_none() && given.iter().all(|(_, value)| value.is_none()) {
            return Ok(Self { source: LineSource::Unknown, reservoir: reservoir.unwrap_or_default() });
        }
        let reservoir = reservoir.ok_or("missing field `reservoir_kpa` (or a `lift_mm`)")?;
        let Some(hose) = keys.hose else {
            let [resistance, compliance, inertance] =
                given.map(|(key, value)| value.ok_or_else(|| format!("missing field `{key}` (or a `hose`)")));
            let source = LineSource::Given {
                resistance_kpa_s_ml: resistance?,
                compliance_ml_kpa: compliance?,
                inertance_kpa_s2_ml: inertance?,
            };
            return Ok(Self { source, reservoir });
        };
        match given.iter().find(|(_, value)| value.is_some()) {
            Some((key, _)) => Err(format!("`{key}` and `hose` exclude each other: a hose gives R, C and L")),
            None => Ok(Self { source: LineSource::Hose(hose), reservoir }),
        }
    }
}

impl From<LineTable> for LineKeys {
    fn from(table: LineTable) -> Self {
        let (reservoir_kpa, lift_mm) = table.reservoir.keys();
        let (reservoir_kpa, lift_mm) =
            if table.is_absent() { (None, None) } else { (reservoir_kpa, lift_mm) };
        match table.source {
            LineSource::Unknown => Self {
                resistance_kpa_s_ml: None,
                compliance_ml_kpa: None,
                inertance_kpa_s2_ml: None,
                reservoir_kpa,
                lift_mm,
                hose: None,
            },
            LineSource::Given { resistance_kpa_s_ml, compliance_ml_kpa, inertance_kpa_s2_ml } => Self {
                resistance_kpa_s_ml: Some(resistance_kpa_s_ml),
                compliance_ml_kpa: Some(compliance_ml_kpa),
                inertance_kpa_s2_ml: Some(inertance_kpa_s2_ml),
                reservoir_kpa,
                lift_mm,
                hose: None,
            },
            LineSource::Hose(hose) => Self {
                resistance_kpa_s_ml: None,
                compliance_ml_kpa: None,
                inertance_kpa_s2_ml: None,
                reservoir_kpa,
                lift_mm,
                hose: Some(hose),
            },
        }
    }
}
