//! Makes the page and its pictures.

use std::error::Error;

use pump_ctl::plan::Ramps;

use crate::back_flow::BackFlows;
use crate::dose_error::{DoseError, largest, mean};
use crate::trial::Trial;
use crate::{front, pictures};

/// Number of start angles of the tables and of the pictures over the angle.
const ANGLES: u32 = 120;
/// Number of start angles of a point over the volume.
const COARSE: u32 = 24;

/// Doses whose back flow is tabled: volume in mL, rate in mL/s.
const DOSES: [(f64, f64); 6] = [(1.0, 5.0), (3.0, 15.0), (25.0, 5.0), (0.05, 5.0), (0.1, 5.0), (0.2, 5.0)];

/// Volumes whose error is tabled, mL.
const VOLUMES_ML: [f64; 6] = [0.5, 1.0, 3.0, 10.0, 25.0, 100.0];

/// Returns the page and its pictures, each as its name below docs/ and its contents.
pub(crate) fn files() -> Result<Vec<(String, String)>, Box<dyn Error>> {
    let trial = Trial::new()?;
    let mut flows = Vec::new();
    for dose in DOSES {
        flows.push((
            dose,
            BackFlows::new(&trial, dose, Ramps::Fastest, ANGLES)?,
            BackFlows::new(&trial, dose, Ramps::LineAware, ANGLES)?,
        ));
    }
    let page = format!(
        "{INTRODUCTION}\n{}\n{AT_THE_ROLLERS}\n{BACK_FLOW}\n{}\n{HOW_RAMPS}\n{}\n{LIMITS}",
        errors_table(&trial)?,
        back_flow_table(&flows),
        least_back_flow(&flows)
    );
    let [small, medium, ..] = flows.as_slice() else { return Err("two doses are drawn".into()) };
    let pictures = [
        (
            "error-over-angle",
            pictures::error_over_angle(
                &DoseError::new(&trial, 1.0, ANGLES)?,
                &DoseError::new(&trial, 25.0, ANGLES)?,
            )?,
        ),
        ("error-over-volume", error_over_volume(&trial)?),
        (
            "back-flow-over-angle",
            pictures::back_flow_over_angle([
                ("1 mL at 5 mL/s, µL", &small.1, &small.2),
                ("3 mL at 15 mL/s, µL", &medium.1, &medium.2),
            ])?,
        ),
        ("back-flow-over-volume", back_flow_over_volume(&trial)?),
        ("small-dose", front::error_of_a_small_dose(&trial)?),
        ("smooth", front::smooth_beside_pulsating()?),
    ];
    let pictures = pictures.into_iter().map(|(name, svg)| (format!("accuracy/{name}.svg"), svg));
    Ok([("accuracy.md".to_owned(), page)].into_iter().chain(pictures).collect())
}

/// Returns the table of errors over the volume.
fn errors_table(trial: &Trial) -> Result<String, Box<dyn Error>> {
    let mut table = "| dose, mL | one constant | planned from the angle | planned, pump and angle depart |\n\
                     | --- | --- | --- | --- |\n"
        .to_owned();
    for volume_ml in VOLUMES_ML {
        let errors = DoseError::new(trial, volume_ml, ANGLES)?;
        let cell = |points| {
            let error_ml = largest(points);
            format!("{:.4} mL, {:.2} %", error_ml, 100.0 * error_ml / volume_ml)
        };
        table += &format!(
            "| {volume_ml} | {} | {} | {} |\n",
            cell(&errors.one_constant),
            cell(&errors.planned),
            cell(&errors.departing)
        );
    }
    Ok(table)
}

/// Returns the table of back flows.
fn back_flow_table(flows: &[((f64, f64), BackFlows, BackFlows)]) -> String {
    let mut table =
        "| dose | ramps | back flow, µL | C 20 % less, µL | C 20 % more, µL | taken back on the way, \
                     µL | motion and settling, s |\n| --- | --- | --- | --- | --- | --- | --- |\n"
            .to_owned();
    for ((volume_ml, rate_ml_s), fastest, aware) in flows {
        for (ramps, all) in [(Ramps::Fastest, fastest), (Ramps::LineAware, aware)] {
            table += &format!(
                "| {volume_ml} mL at {rate_ml_s} mL/s | `{ramps}` | {:.1} | {:.1} | {:.1} | {:.0} | {:.2} |\n",
                largest(&all.nominal_ul),
                largest(&all.stiffer_ul),
                largest(&all.softer_ul),
                largest(&all.reverse_ul),
                mean(&all.time_s),
            );
        }
    }
    table
}

/// Says what line-aware ramps keep the back flow to, with the largest back flows of the table.
fn least_back_flow(flows: &[((f64, f64), BackFlows, BackFlows)]) -> String {
    let most = |of: &dyn Fn(&BackFlows) -> f64| flows.iter().fold(0.0, |most: f64, all| most.max(of(&all.2)));
    let off = |all: &BackFlows| largest(&all.stiffer_ul).max(largest(&all.softer_ul));
    format!(
        "Line-aware ramps are to keep the back flow to 2 µL. A dose below 200 µL may take a hundredth of its\n\
         volume back, but never less than half a mean motor step, 0.83 µL. Where no ramps keep to that, as at a fast\n\
         rate, the ramps with the least back flow win. The largest back flow of `line` ramps in the table is\n\
         {:.1} µL, and {:.1} µL where C is 20 % off.\n",
        most(&|all| largest(&all.nominal_ul)),
        most(&off)
    )
}

fn error_over_volume(trial: &Trial) -> Result<String, Box<dyn Error>> {
    let (mut naive, mut departing) = (Vec::new(), Vec::new());
    for n in 1..=120 {
        let volume_ml = 0.25 * f64::from(n);
        let errors = DoseError::new(trial, volume_ml, COARSE)?;
        naive.push((volume_ml, 100.0 * largest(&errors.one_constant) / volume_ml));
        departing.push((volume_ml, 100.0 * largest(&errors.departing) / volume_ml));
    }
    pictures::error_over_volume(&naive, &departing)
}

fn back_flow_over_volume(trial: &Trial) -> Result<String, Box<dyn Error>> {
    let over_volume = |rate_ml_s, ramps| {
        let point = |n| {
            let volume_ml = 0.25 * f64::from(n);
            let all = BackFlows::new(trial, (volume_ml, rate_ml_s), ramps, COARSE)?;
            Ok((volume_ml, largest(&all.nominal_ul)))
        };
        (1..=40).map(point).collect::<Result<Vec<_>, Box<dyn Error>>>()
    };
    let mut pairs = Vec::new();
    for rate_ml_s in [5.0, 15.0] {
        pairs.push((over_volume(rate_ml_s, Ramps::Fastest)?, over_volume(rate_ml_s, Ramps::LineAware)?));
    }
    pictures::back_flow_over_volume([
        ("at 5 mL/s, µL", &pairs[0].0, &pairs[0].1),
        ("at 15 mL/s, µL", &pairs[1].0, &pairs[1].1),
    ])
}

const INTRODUCTION: &str = "\
# Accuracy: what reaches the vessel, and how sure it is

`make accuracy` writes this page. A test checks that the code computes every figure on it. All figures are of the
built-in pump with three rollers, on its motor of 12,800 steps a revolution. They are computed from the model, and
are not measurements of a real pump. Only `dose calibrate verify` measures yours.

A dose can be wrong in two places. At the rollers the volume depends on the angle at which they start. In the vessel
it also depends on the line, which swings on after the motor has stopped.

## At the rollers

A pump of three rollers delivers less while a roller leaves the tube. A controller that knows one constant, the mean
volume of a revolution, does not see this. Its error depends on the start angle. `dose` knows the angle and plans the
whole number of steps whose volume is nearest.

The table gives the largest error over 120 start angles. *One constant* makes the steps that the mean volume of a
revolution gives. *Planned from the angle* is exact to half a step. The last column plans in the same way, but for a
pump that departs from its file. Its rollers hold 0.026 mL more or less, which is the standard uncertainty of the
paper's figure, and they stand 1 degree before or behind the angle that was read. The volume of a revolution is the
same for all pumps here, as after a calibration.
";

const AT_THE_ROLLERS: &str = "\
![Error of 1 mL and of 25 mL over the start angle](accuracy/error-over-angle.svg)

![Largest error over the volume of the dose](accuracy/error-over-volume.svg)

The error of one constant is up to 1.25 mL, however large the dose is. It vanishes for whole pitches, which are the
dips of the second picture. An angle that is one degree off costs 0.07 mL at most.
";

const BACK_FLOW: &str = "\
## In the vessel

The rollers stop in milliseconds, but the liquid in the line does not. The published outlet line swings at 12.75 Hz.
It first pushes too much into the vessel and then takes it back. A nozzle in air loses what is taken back, and air
enters. *Back flow* is the largest delivered volume less the final one.

The table gives the largest back flow over 120 start angles, also where the line's compliance C is 20 % off, which the
plan does not know. *Taken back on the way* adds up everything that the outlet takes back, also in mid-dose. The time
is the mean over the angles. It ends when the volume that is still in the line stays below 1 µL.
";

const HOW_RAMPS: &str = "\
![Back flow of two doses over the start angle](accuracy/back-flow-over-angle.svg)

![Largest back flow over the volume of the dose](accuracy/back-flow-over-volume.svg)

Line-aware ramps are the default. They are chosen for each dose from the exact solution of the line, as
[DESIGN.md](../DESIGN.md) tells. `dose 3mL --ramps fastest` starts and stops as fast as the motor allows. A stop that a
person, a limit or a fault asks for always does.
";

const LIMITS: &str = "\
## How sure a stated volume is

The report of each dose states an uncertainty, as in \"25.0 mL ± 1.4 mL\", that covers about 95 % of such doses.
`-v` and the JSON (`uncertainty_budget`) list its shares, each with the cheapest remedy. Tests draw 2,000 random pumps
for each of several cases. The budget's statements are true of these pumps, and the tests count how often the interval
covers the dose. So the budget adds up. It is no evidence that a real pump departs by no more than its file states.

This page cannot tell you how near your pump is to its file. Weigh some doses with `dose calibrate verify`:
[calibration.md](calibration.md).
";
