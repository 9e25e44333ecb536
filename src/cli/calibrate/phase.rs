//! `dose calibrate phase`: roller volume, engagement angle and zero from short doses.

use pump_dose::Bench;
use pump_dose::calibration::{
    Calibration, PhaseFit, Revolution, ShortDose, Source, Stored, Weighing, short_doses_of_csv,
};
use pump_dose::pump_file::RollerVolumeTable;
use serde_json::json;

use super::super::args::Options;
use super::super::{Failure, print};
use super::{FLUID, PhaseArgs, expected, in_table, read};

pub(super) fn phase(args: &PhaseArgs, options: &Options) -> Result<(), Failure> {
    options.accept_only("dose calibrate phase", &[&FLUID[..], &["--driver", "--format"]].concat())?;
    let bench = options.bench()?;
    let doses = in_table(&args.from, short_doses_of_csv(&read(&args.from)?, &Weighing::of(bench.file())))?;
    let _held = bench.folder().lock()?;
    let active = bench.calibrations().active()?;
    let displacement = active.as_ref().and_then(|active| active.calibration.displacement.as_ref());
    let model_standard = bench.file().uncertainty.model_percent / 100.0;
    let revolution = Revolution { displacement, model_standard };
    let found = PhaseFit::of(bench.model(), revolution, &doses, &expected(&bench, &args.reading)?)?;
    let version = if args.uses { Some(keep(&bench, active, doses, &found, args)?) } else { None };
    if options.json() {
        return print(&format!("{}\n", json!({ "schema": "phase/1", "found": found, "version": version })));
    }
    print(&text(&bench, &found, version))
}

/// Has doses use the zero that was found, beside the displacement that they use already.
fn keep(
    bench: &Bench,
    active: Option<Stored>,
    doses: Vec<ShortDose>,
    found: &PhaseFit,
    args: &PhaseArgs,
) -> Result<u32, Failure> {
    let empty = Calibration::empty(bench.file(), Source::Phase)?;
    let before = active.map_or(empty.clone(), |active| active.calibration);
    let calibration = Calibration {
        date: empty.date,
        source: Source::Phase,
        tube: args.reading.tube.clone().or(before.tube.clone()),
        note: args.reading.note.clone(),
        zero_deg: found.zero_deg.value,
        zero_standard_deg: found.zero_deg.standard,
        short_doses: doses,
        ..before
    };
    let calibrations = bench.calibrations();
    let version = calibrations.add(&calibration)?;
    bench.use_calibration(Some(version))?;
    Ok(version)
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
