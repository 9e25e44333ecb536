//! The roller volume, the engagement angle and the zero that short doses show, in words and as JSON.

use serde_json::json;

use crate::bench::Bench;
use crate::calibration::PhaseFit;
use crate::notice::{Remedy, Wording};
use crate::pump_file::RollerVolumeTable;

/// One line of JSON, `phase/1`. `version` is the calibration that doses use from now on; null if nothing was kept.
pub fn phase_json(found: &PhaseFit, version: Option<u32>) -> String {
    format!("{}\n", json!({ "schema": "phase/1", "found": found, "version": version }))
}

/// Says what short doses show, and what to change in the pump file. `version` is the calibration that doses use from
/// now on; none if nothing was kept. A front end words how to use them.
pub fn phase_text(bench: &Bench, found: &PhaseFit, version: Option<u32>, words: Wording) -> String {
    let PhaseFit { roller_volume_ml, engagement_deg, zero_deg, scatter_ml, degrees_of_freedom, .. } = found;
    let used = version.map_or_else(
        || format!("{}\n", words(Remedy::UsePhase)),
        |version| format!("doses use all three from now on: calibration {version}\n"),
    );
    format!(
        "{} degrees of freedom, doses scatter by {scatter_ml:.4} mL; ± is k = 2\n  \
         roller volume     {:.4} ± {:.4} mL\n  \
         engagement angle  {:.2}° ± {:.2}°\n  \
         zero              {:.2}° ± {:.2}°: the model's angle where the record says 0°\n\
         {used}{}",
        degrees_of_freedom,
        roller_volume_ml.value,
        2.0 * roller_volume_ml.standard,
        engagement_deg.value,
        2.0 * engagement_deg.standard,
        zero_deg.value,
        2.0 * zero_deg.standard,
        // A pump file that says the same has another volume of a revolution, and no use for this calibration.
        if version.is_none() { for_the_pump_file(bench, found) } else { String::new() },
    )
}

/// The keys of the pump file to be changed.
fn for_the_pump_file(bench: &Bench, found: &PhaseFit) -> String {
    let roller = bench.model().roller_volume();
    let angles = found.engagement_deg.value / roller.engagement_deg();
    let volumes = found.roller_volume_ml.value / roller.total_ml();
    let Some(table) = &bench.file().roller_volume else {
        // A head that is known by its volume alone has no table for them.
        return String::new();
    };
    let change = match table {
        RollerVolumeTable::Polynomial { engagement_angle_deg, polynomial_ml_deg, .. } => {
            // V(x) is the polynomial of x over the ratio of the angles.
            let mut order = polynomial_ml_deg.len() as i32;
            let polynomial = polynomial_ml_deg.map(|coefficient| {
                order -= 1;
                coefficient / angles.powi(order)
            });
            format!(
                "[roller_volume]\nengagement_angle_deg = {:?}\npolynomial_ml_deg = {polynomial:?}\ntotal_ml = {:?}\n",
                angles * engagement_angle_deg,
                found.roller_volume_ml.value,
            )
        }
        RollerVolumeTable::Measured { .. } => {
            format!("multiply the angles of points_deg_ml by {angles:.5} and their volumes by {volumes:.5}\n")
        }
        RollerVolumeTable::Drawing => {
            format!(
                "the drawing's angle times {angles:.5} and its volume times {volumes:.5} are these: check its \
                 dimensions\n"
            )
        }
    };
    format!("or for the pump file, after which the displacement is to be calibrated again:\n{change}")
}
