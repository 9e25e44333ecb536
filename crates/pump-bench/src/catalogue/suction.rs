//! The warning of a suction at which the pump's tube may collapse.

use super::built_in::built_in;
use crate::numbers::significant;
use crate::pump_file::PumpFile;

/// First words of the warning.
pub(crate) const SUCKS: &str = "the pump sucks with";

/// Returns by how many kPa an inlet pressure of so many kPa below the air's lies beyond what the tube is known to
/// stand. `None` if the tube stands it.
///
/// A tube of unknown dimensions or modulus may collapse where the silicone tube of McIntyre et al. does: 42.65 kPa.
pub(crate) fn beyond_known_kpa(file: &PumpFile, below_kpa: f64) -> Option<f64> {
    let known_kpa = file.tube.collapse_below_ambient_kpa().or_else(doubtful_kpa)?;
    Some(below_kpa - known_kpa).filter(|kpa| *kpa > 0.0)
}

fn doubtful_kpa() -> Option<f64> {
    built_in("three-roller")?.tube.collapse_below_ambient_kpa()
}

/// Returns the warning of an inlet pressure of so many kPa below the air's, if the tube collapses there or may do so.
pub(crate) fn suction_warning(file: &PumpFile, below_kpa: f64) -> Option<String> {
    beyond_known_kpa(file, below_kpa)?;
    let sucks = format!("{SUCKS} {} kPa below the air's pressure", significant(below_kpa, 3));
    Some(match file.tube.collapse_below_ambient_kpa() {
        Some(kpa) => format!(
            "{sucks}, and its tube collapses at {} kPa below it (thin-wall estimate); raise the supply, or take a tube \
             with a thicker wall",
            significant(kpa, 3)
        ),
        None => format!(
            "{sucks}, and nobody knows at which suction its tube collapses (silicone of 10 x 14 mm does at \
             {:.0} kPa by an estimate); a tube that stays flat takes in less: raise the supply, dose more slowly, or \
             weigh a dose from this height",
            doubtful_kpa()?
        ),
    })
}
