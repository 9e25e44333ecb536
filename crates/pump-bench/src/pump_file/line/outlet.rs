//! `[outlet]`: the line from the pump to the vessel, and the nozzle at its end.

use pump_model::Line;
use serde::{Deserialize, Serialize};

use super::{HoseTable, LineKeys, LineTable};
use crate::pump_file::range::{WrongValue, within_if_given};
use crate::words::words;

/// Bore of a nozzle of which nothing is known, in mm.
const UNKNOWN_BORE_MM: f64 = 4.0;

/// The table `[outlet]`.
///
/// ```
/// use pump_bench::pump_file::{OutletEnd, OutletTable};
///
/// let mut outlet = OutletTable::from(pump_model::Line::PUBLISHED);
/// assert_eq!((outlet.is_in_air(), outlet.nozzle_mm()), (true, 4.0));
/// outlet.end = Some(OutletEnd::Immersed);
/// assert!(!outlet.is_in_air());
/// ```
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "OutletKeys", into = "OutletKeys")]
#[non_exhaustive]
pub struct OutletTable {
    /// Line from the pump to the outlet's reservoir.
    pub line: LineTable,
    /// Place of the nozzle's end. `None` if it is not known, which counts as air.
    pub end: Option<OutletEnd>,
    /// Diameter of the edge from which a drop hangs, in mm: the bore, or the outer diameter of a nozzle whose
    /// face the fluid wets. `None` if it is not known.
    pub nozzle_bore_mm: Option<f64>,
}

/// A place of a nozzle's end.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum OutletEnd {
    /// End in air: drops hang from it and fall, and it takes in air where the flow turns back.
    Air,
    /// End below the surface of the fluid in the vessel.
    Immersed,
}

words!(OutletEnd { Air = "air", Immersed = "immersed" });

impl OutletTable {
    /// Returns true if a pump file says nothing of line and nozzle.
    pub(in crate::pump_file) fn is_absent(&self) -> bool {
        *self == Self::default()
    }

    /// Returns true if the nozzle's end is in air, or may be.
    pub fn is_in_air(&self) -> bool {
        self.end != Some(OutletEnd::Immersed)
    }

    /// Returns the diameter from which a drop hangs, in mm: that of the nozzle, or else the bore of the outlet's
    /// hose, or else 4 mm.
    pub fn nozzle_mm(&self) -> f64 {
        let hose_mm = self.line.hose().map_or(UNKNOWN_BORE_MM, |hose| 2.0 * hose.bore_radius_mm);
        self.nozzle_bore_mm.unwrap_or(hose_mm)
    }

    /// Refuses a bore outside 0.05 to 20 mm. Wider ones do not hold water: its surface in a round opening is
    /// stable up to a radius of 3.83 sqrt(gamma/(rho g)), 10.4 mm (Maxwell, "Capillary action").
    pub(in crate::pump_file) fn check(&self) -> Result<(), WrongValue> {
        within_if_given("[outlet] nozzle_bore_mm", self.nozzle_bore_mm, 0.05..=20.0)
    }
}

impl From<LineTable> for OutletTable {
    fn from(line: LineTable) -> Self {
        Self { line, end: None, nozzle_bore_mm: None }
    }
}

impl From<Line> for OutletTable {
    fn from(line: Line) -> Self {
        LineTable::from(line).into()
    }
}

/// Keys of the table: those of a line, and those of the nozzle.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct OutletKeys {
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
    end: Option<OutletEnd>,
    #[serde(skip_serializing_if = "Option::is_none")]
    nozzle_bore_mm: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    hose: Option<HoseTable>,
}

impl TryFrom<OutletKeys> for OutletTable {
    type Error = String;

    fn try_from(keys: OutletKeys) -> Result<Self, String> {
        let OutletKeys {
            resistance_kpa_s_ml,
            compliance_ml_kpa,
            inertance_kpa_s2_ml,
            reservoir_kpa,
            lift_mm,
            end,
            nozzle_bore_mm,
            hose,
        } = keys;
        let line = LineKeys {
            resistance_kpa_s_ml,
            compliance_ml_kpa,
            inertance_kpa_s2_ml,
            reservoir_kpa,
            lift_mm,
            hose,
        };
        Ok(Self { line: line.try_into()?, end, nozzle_bore_mm })
    }
}

impl From<OutletTable> for OutletKeys {
    fn from(table: OutletTable) -> Self {
        let OutletTable { line, end, nozzle_bore_mm } = table;
        let LineKeys {
            resistance_kpa_s_ml,
            compliance_ml_kpa,
            inertance_kpa_s2_ml,
            reservoir_kpa,
            lift_mm,
            hose,
        } = line.into();
        Self {
            resistance_kpa_s_ml,
            compliance_ml_kpa,
            inertance_kpa_s2_ml,
            reservoir_kpa,
            lift_mm,
            end,
            nozzle_bore_mm,
            hose,
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::pump_file::PumpFile;

    use super::*;

    /// Parses the three-roller pump with these keys in `[outlet]`, and perhaps a hose there.
    fn parsed(keys: &str) -> Result<PumpFile, String> {
        let text = crate::catalogue::built_in("three-roller").unwrap().to_toml();
        let (before, after) = text.split_once("[outlet]\n").unwrap();
        let text = format!("{before}[outlet]\n{keys}\n{after}");
        PumpFile::parse(&text, "a file").map_err(|error| error.to_string())
    }

    #[test]
    fn a_nozzle_is_read_and_written() {
        let file = parsed("end = \"immersed\"\nnozzle_bore_mm = 1.6").unwrap();
        assert_eq!((file.outlet.end, file.outlet.nozzle_mm()), (Some(OutletEnd::Immersed), 1.6));
        assert!(!file.outlet.is_in_air());
        assert_eq!(PumpFile::parse(&file.to_toml(), "the same").unwrap(), file);
        assert!(parsed("end = \"air\"").unwrap().outlet.is_in_air());
    }

    #[test]
    fn an_unknown_end_is_in_air_and_an_unknown_nozzle_is_the_hose_or_4_mm() {
        let outlet = parsed("").unwrap().outlet;
        assert!(outlet.is_in_air() && outlet.nozzle_mm() == 4.0);
        let hose = HoseTable {
            bore_radius_mm: 5.0,
            outer_radius_mm: 7.0,
            length_mm: 331.0,
            modulus_mpa: 3.5,
            poisson_ratio: 0.5,
            minor_loss: 5.75,
            resistance_at_ml_s: None,
        };
        let mut outlet = OutletTable::from(LineTable::of_hose(88.637, hose));
        assert_eq!(outlet.nozzle_mm(), 10.0);
        outlet.nozzle_bore_mm = Some(0.8);
        assert_eq!(outlet.nozzle_mm(), 0.8);
    }

    #[test]
    fn nozzles_that_cannot_be_are_refused_with_their_range() {
        for (keys, part) in [
            ("nozzle_bore_mm = 0.0", "[outlet] nozzle_bore_mm is 0; allowed: 0.05 to 20"),
            ("nozzle_bore_mm = 25.0", "[outlet] nozzle_bore_mm is 25; allowed: 0.05 to 20"),
            ("nozzle_bore_mm = nan", "[outlet] nozzle_bore_mm is NaN"),
            ("end = \"water\"", "`air` or `immersed`"),
            ("nozzle_mm = 2.0", "unknown field `nozzle_mm`"),
        ] {
            let error = parsed(keys).unwrap_err();
            assert!(error.contains(part), "{part}: {error}");
        }
        let text = crate::catalogue::built_in("three-roller").unwrap().to_toml();
        let text = text.replace("[inlet]\n", "[inlet]\nend = \"air\"\n");
        assert!(PumpFile::parse(&text, "a file").is_err(), "an inlet has no nozzle");
    }
}
