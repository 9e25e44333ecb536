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
        "Line-aware ramps aim at a back flow of 2 µL at most. A dose below 200 µL may take back a hundredth of its\n\
         volume, or half a mean motor step (0.83 µL) if that is more. Where no ramps achieve this, as at a fast rate,\n\
         the planner takes the ramps with the least back flow. The largest back flow of `line` ramps in the table is\n\
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
# Accuracy: what reaches the vessel, and how certain it is

`make accuracy` writes this page, and a test checks that the code computes every figure on it. All figures are for the
built-in pump with three rollers and its motor of 12,800 steps a revolution. The model computes them: nobody has
measured a real pump. `dose calibrate verify` measures yours.

A dose can be wrong in two places. At the rollers, the volume depends on the angle at which they start. In the vessel,
it also depends on the line, which keeps swinging after the motor has stopped.

## At the rollers

A pump of three rollers delivers less while a roller leaves the tube. A controller that knows only one constant, the
mean volume of a revolution, ignores this, so its error depends on the start angle. `dose` knows the angle and plans
the whole number of steps whose volume is nearest to the request.

The table gives the largest error over 120 start angles:

- *One constant* makes the steps that the mean volume of a revolution gives.
- *Planned from the angle* is exact to half a step.
- *Planned, pump and angle depart* plans in the same way, but the pump differs from its file. Its rollers hold 0.026 mL
  more or less, the standard uncertainty of the paper's figure. They stand 1 degree ahead of or behind the angle that
  was read.

The volume of a revolution is the same for all three, as after a calibration.
";

const AT_THE_ROLLERS: &str = "\
![Error of 1 mL and of 25 mL over the start angle](accuracy/error-over-angle.svg)

![Largest error over the volume of the dose](accuracy/error-over-volume.svg)

One constant is wrong by up to 1.25 mL, however large the dose is. Its error vanishes for whole pitches, the dips of
the second picture. An angle that is one degree off costs 0.07 mL at most.
";

const BACK_FLOW: &str = "\
## In the vessel

The rollers stop within milliseconds, but the liquid in the line does not. The paper's outlet line swings at 12.75 Hz.
It first pushes too much into the vessel, then takes it back. A nozzle in air loses the liquid that is taken back, and
air enters. *Back flow* is the largest delivered volume minus the final one.

The table gives the largest back flow over 120 start angles. It also gives the back flow where the line's compliance C
is 20 % off, which the plan does not know. *Taken back on the way* is the sum of all liquid that the outlet takes
back, in mid-dose too. The time is the mean over the angles. It ends when less than 1 µL is still to come from the
line.
";

const HOW_RAMPS: &str = "\
![Back flow of two doses over the start angle](accuracy/back-flow-over-angle.svg)

![Largest back flow over the volume of the dose](accuracy/back-flow-over-volume.svg)

Line-aware ramps are the default. The planner chooses them for each dose from the exact solution of the line
([DESIGN.md](../DESIGN.md)). `dose 3mL --ramps fastest` starts and stops as fast as the motor allows. A stop by a
person, a limit or a fault always does.
";

const LIMITS: &str = "\
## How certain a stated volume is

The report of each dose states an uncertainty, as in \"25.0 mL ± 1.4 mL\". The interval covers about 95 % of such doses.
`-v` and the JSON (`uncertainty_budget`) list the shares of the uncertainty, each with the cheapest remedy.

Tests draw 2,000 random pumps for each of several cases. The pumps depart from their files as the budget states, and
the tests count how often the interval covers the dose. So the budget adds up. It does not prove that a real pump
departs by no more than its file states.

This page cannot tell you how close your pump is to its file. Weigh some doses with `dose calibrate verify`:
[calibration.md](calibration.md).
";
