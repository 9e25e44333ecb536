//! The line of `[inlet]` or `[outlet]`, given by its R, C and L or by its hose.

pub(super) mod outlet;

use pump_model::{Fluid, Friction, Hose, Line, ModelError};
use serde::{Deserialize, Serialize};

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
pub enum LineTable {
    /// Line of which nothing is known, as it may be of a bought head. Its pressures and its settling are not known.
    #[default]
    Unknown,
    /// Line with its R, C, L and reservoir.
    Given(Line),
    /// Hose, from which R, C and L are estimated.
    Hose {
        /// Pressure of the reservoir P_res, in kPa absolute.
        reservoir_kpa: f64,
        /// Table `[inlet.hose]` or `[outlet.hose]`.
        hose: HoseTable,
    },
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
    /// Returns the line for a pump whose default rate is `rate_ml_s`. A hose also needs the fluid. A line of which
    /// nothing is known stands in ambient pressure and follows the rollers ([`STIFF`]).
    ///
    /// # Errors
    /// Returns the [`ModelError`] of a fluid or a hose that is out of range.
    pub(crate) fn line(
        &self,
        fluid: impl FnOnce() -> Result<Fluid, ModelError>,
        rate_ml_s: f64,
        ambient_kpa: f64,
    ) -> Result<Line, ModelError> {
        match self {
            Self::Unknown => Ok(Line { reservoir_kpa: ambient_kpa, ..STIFF }),
            Self::Given(line) => Ok(*line),
            Self::Hose { reservoir_kpa, hose } => {
                hose.hose().line(&fluid()?, *reservoir_kpa, hose.resistance_at_ml_s.unwrap_or(rate_ml_s))
            }
        }
    }

    /// Returns the friction of the hose at every flow, or `None` for a line that is given by its R.
    ///
    /// # Errors
    /// Returns the [`ModelError`] of a fluid or a hose that is out of range.
    pub(crate) fn friction(
        &self,
        fluid: impl FnOnce() -> Result<Fluid, ModelError>,
    ) -> Result<Option<Friction>, ModelError> {
        match self {
            Self::Unknown | Self::Given(_) => Ok(None),
            Self::Hose { hose, .. } => hose.hose().friction(&fluid()?).map(Some),
        }
    }

    /// Returns true if nothing is known of the line.
    pub fn is_unknown(&self) -> bool {
        *self == Self::Unknown
    }

    /// Returns true if the line is estimated from a hose and not measured.
    pub(crate) fn is_estimated(&self) -> bool {
        matches!(self, Self::Hose { .. })
    }
}

impl From<Line> for LineTable {
    fn from(line: Line) -> Self {
        Self::Given(line)
    }
}

/// Keys of the table, whether it gives a line or a hose.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct LineKeys {
    #[serde(skip_serializing_if = "Option::is_none")]
    resistance_kpa_s_ml: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    compliance_ml_kpa: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    inertance_kpa_s2_ml: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    reservoir_kpa: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    hose: Option<HoseTable>,
}

impl TryFrom<LineKeys> for LineTable {
    type Error = String;

    fn try_from(keys: LineKeys) -> Result<Self, String> {
        let LineKeys { resistance_kpa_s_ml, compliance_ml_kpa, inertance_kpa_s2_ml, reservoir_kpa, hose } =
            keys;
        let given = [
            ("resistance_kpa_s_ml", resistance_kpa_s_ml),
            ("compliance_ml_kpa", compliance_ml_kpa),
            ("inertance_kpa_s2_ml", inertance_kpa_s2_ml),
        ];
        if reservoir_kpa.is_none() && hose.is_none() && given.iter().all(|(_, value)| value.is_none()) {
            return Ok(Self::Unknown);
        }
        let reservoir_kpa = reservoir_kpa.ok_or("missing field `reservoir_kpa`")?;
        let Some(hose) = hose else {
            let [resistance, compliance, inertance] =
                given.map(|(key, value)| value.ok_or_else(|| format!("missing field `{key}` (or a `hose`)")));
            return Ok(Self::Given(Line {
                resistance_kpa_s_ml: resistance?,
                compliance_ml_kpa: compliance?,
                inertance_kpa_s2_ml: inertance?,
                reservoir_kpa,
            }));
        };
        match given.iter().find(|(_, value)| value.is_some()) {
            Some((key, _)) => Err(format!("`{key}` and `hose` exclude each other: a hose gives R, C and L")),
            None => Ok(Self::Hose { reservoir_kpa, hose }),
        }
    }
}

impl From<LineTable> for LineKeys {
    fn from(table: LineTable) -> Self {
        match table {
            LineTable::Unknown => Self {
                resistance_kpa_s_ml: None,
                compliance_ml_kpa: None,
                inertance_kpa_s2_ml: None,
                reservoir_kpa: None,
                hose: None,
            },
            LineTable::Given(line) => Self {
                resistance_kpa_s_ml: Some(line.resistance_kpa_s_ml),
                compliance_ml_kpa: Some(line.compliance_ml_kpa),
                inertance_kpa_s2_ml: Some(line.inertance_kpa_s2_ml),
                reservoir_kpa: Some(line.reservoir_kpa),
                hose: None,
            },
            LineTable::Hose { reservoir_kpa, hose } => Self {
                resistance_kpa_s_ml: None,
                compliance_ml_kpa: None,
                inertance_kpa_s2_ml: None,
                reservoir_kpa: Some(reservoir_kpa),
                hose: Some(hose),
            },
        }
    }
}
