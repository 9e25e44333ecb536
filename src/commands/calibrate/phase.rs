//! `dose calibrate phase`: roller volume, engagement angle and zero from short doses.

use pump_bench::Bench;
use pump_bench::calibration::{Calibration, PhaseFit, Weighing, short_doses_of_csv};
use pump_bench::pump_file::RollerVolumeTable;
use serde_json::json;

use super::{FLUID, PhaseArgs, expected, in_table, read};
use crate::failure::{Failure, print};
use crate::options::Options;

pub(super) fn phase(args: &PhaseArgs, options: &Options) -> Result<(), Failure> {
    options.accept_only("dose calibrate phase", &[&FLUID[..], &["--driver", "--format"]].concat())?;
    let bench = options.bench()?;
    let doses = in_table(&args.from, short_doses_of_csv(&read(&args.from)?, &Weighing::of(bench.file())))?;
    let _held = bench.folder().lock()?;
    let before = bench.calibrations().active()?.map(|active| active.calibration);
    let expected = expected(&bench, &args.reading)?;
    let (mut calibration, found) =
        Calibration::of_short_doses(bench.file(), doses, &expected, before.as_ref())?;
    calibration.tube = args.reading.tube.clone().or(calibration.tube);
    calibration.note = args.reading.note.clone();
    let version = if args.uses { Some(bench.keep_calibration(calibration)?.version) } else { None };
    if options.json() {
        return print(&format!("{}\n", json!({ "schema": "phase/1", "found": found, "version": version })));
    }
    print(&text(&bench, &found, version))
}

fn text(bench: &Bench, found: &PhaseFit, version: Option<u32>) -> String {
    let PhaseFit { roller_volume_ml, engagement_deg, zero_deg, scatter_ml, degrees_of_freedom } = found;
    let used = version.map_or("`--use` has doses correct the zero by this\n".to_owned(), |version| {
        format!("doses correct the zero by this from now on: calibration {version}\n")
    });
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
        for_the_pump_file(bench, found),
    )
}

/// What to change in the pump file.
fn for_the_pump_file(bench: &Bench, found: &PhaseFit) -> String {
    let roller = bench.model().roller_volume();
    let angles = found.engagement_deg.value / roller.engagement_deg();
    let volumes = found.roller_volume_ml.value / roller.total_ml();
    let change = match &bench.file().roller_volume {
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
                "the drawing's angle times {angles:.5} and its volume times {volumes:.5} are these: check its dimensions\n"
            )
        }
    };
    format!("for the pump file, after which the displacement is to be calibrated again:\n{change}")
}
