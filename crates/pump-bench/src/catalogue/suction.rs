//! The warning of a suction at which the pump's tube may collapse.

use super::built_in::built_in;
use crate::numbers::significant;
use crate::pump_file::PumpFile;

/// Returns the warning of an inlet pressure of so many kPa below the air's, if the tube collapses there or may do so.
pub(crate) fn suction_warning(file: &PumpFile, below_kpa: f64) -> Option<String> {
    let stood_kpa = file.tube.collapse_below_ambient_kpa();
    // A tube of unknown dimensions or modulus may collapse where the silicone tube of McIntyre et al. does: 42.65 kPa.
    let doubtful_kpa = built_in("three-roller").and_then(|pump| pump.tube.collapse_below_ambient_kpa())?;
    if below_kpa <= stood_kpa.unwrap_or(doubtful_kpa) {
        return None;
    }
    let sucks = format!("the pump sucks with {} kPa below the air's pressure", significant(below_kpa, 3));
    Some(match stood_kpa {
        Some(kpa) => format!(
            "{sucks}, and its tube collapses at {} kPa below it (thin-wall estimate); raise the supply, or take a tube \
             with a thicker wall",
            significant(kpa, 3)
        ),
        None => format!(
            "{sucks}, and nobody knows at which suction its tube collapses (silicone of 10 x 14 mm does at \
             {doubtful_kpa:.0} kPa by an estimate); a tube that stays flat takes in less: raise the supply, or weigh a \
             dose from this height"
        ),
    })
}
