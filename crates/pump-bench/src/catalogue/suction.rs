//! The warning of a suction at which the pump's tube may collapse.

use crate::numbers::significant;
use crate::pump_file::PumpFile;

/// Suction from which on a tube of which nothing is known may collapse, in kPa below the air: that of the silicone tube
/// of McIntyre et al., 10 x 14 mm, by E/(4 (1 - nu^2)) (t/r_m)^3 with E = 3.5 MPa and nu = 0.49 (thin-wall estimate).
const DOUBTFUL_KPA: f64 = 42.65;

/// Returns the warning of an inlet pressure of so many kPa below the air's, if the tube collapses there or may do so.
pub(crate) fn suction_warning(file: &PumpFile, below_kpa: f64) -> Option<String> {
    let stood_kpa = file.tube.collapse_below_ambient_kpa();
    if below_kpa <= stood_kpa.unwrap_or(DOUBTFUL_KPA) {
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
             {DOUBTFUL_KPA:.0} kPa by an estimate); a tube that stays flat takes in less: raise the supply, or weigh a \
             dose from this height"
        ),
    })
}
