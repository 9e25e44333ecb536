//! The rows that solve the benchmark case.

use std::cell::RefCell;
use std::error::Error;
use std::hint::black_box;

use crate::bare::Bare;
use crate::case::{Case, SAMPLES, Samples, room, sample_s};
use crate::ours;
use crate::peers::{explicit, implicit, roller_centric};
use crate::timing::{Outcome, Row};

/// Errors to reach, kPa.
pub(crate) const GOALS_KPA: [f64; 2] = [1e-2, 1e-6];

const MAKES: (f64, &str) = (2.0 * SAMPLES as f64, "samples");

type Solve = fn(&Case, f64, &mut Samples) -> Outcome;

const SOLVERS: [(&str, Solve); 6] = [
    ("integrator, RODAS5P", |case, tolerance, samples| {
        Ok(ours::integrated(case, ours::Method::Rodas5p, tolerance, samples)?)
    }),
    ("integrator, Radau", |case, tolerance, samples| {
        Ok(ours::integrated(case, ours::Method::Radau, tolerance, samples)?)
    }),
    ("diffsol BDF", |case, tolerance, samples| {
        Ok(implicit::run(case, implicit::Method::Bdf, tolerance, samples)?)
    }),
    ("diffsol ESDIRK34", |case, tolerance, samples| {
        Ok(implicit::run(case, implicit::Method::Esdirk34, tolerance, samples)?)
    }),
    ("ivp DOPRI5", |case, tolerance, samples| {
        Ok(explicit::run(case, explicit::Method::Dopri5, tolerance, samples)?)
    }),
    ("ivp DOP853", |case, tolerance, samples| {
        Ok(explicit::run(case, explicit::Method::Dop853, tolerance, samples)?)
    }),
];

/// Row of the exact solution, with which other rows are compared.
pub(crate) const EXACT: usize = 0;
/// Row of the bare loop.
pub(crate) const BARE: usize = 1;
/// Row of the exact solution at given times.
pub(crate) const EXACT_AT: usize = 2;
/// Row of RODAS5P at the first goal. At the second goal it stands a row later, and so do those that follow.
pub(crate) const RODAS5P: usize = 3;
/// Row of Radau's method at the first goal.
pub(crate) const RADAU: usize = 5;
/// Row of diffsol's BDF at the first goal.
pub(crate) const BDF: usize = 7;
/// Rows of the explicit peers at the first goal.
pub(crate) const EXPLICIT: [usize; 2] = [11, 13];

/// Returns every row: the exact solution, the bare loop, our integrators, then the peers.
pub(crate) fn rows(case: &Case) -> Result<Vec<Row<'_>>, Box<dyn Error>> {
    let bare = Bare::new(case);
    let times_s: Vec<f64> = (0..SAMPLES).map(sample_s).collect();
    let mut rows = vec![
        row("exact", case, None, move |samples| {
            ours::exact(case, samples);
            Ok(())
        })?,
        row("bare loop", case, None, move |samples| {
            bare.run(samples);
            Ok(())
        })?,
        row("exact, at given times", case, None, move |samples| {
            ours::exact_at(case, &times_s, samples);
            Ok(())
        })?,
    ];
    rows.extend(rows_of(&SOLVERS, case)?);
    Ok(rows)
}

/// Rows of the case with a hose's friction: our integrator at each goal, then diffsol's BDF and ESDIRK34.
const RUBBING: [(&str, Solve); 3] = [
    ("with friction: integrator, RODAS5P", |case, tolerance, samples| {
        Ok(ours::rubbed(case, tolerance, samples)?)
    }),
    ("with friction: diffsol BDF", |case, tolerance, samples| {
        Ok(implicit::run(case, implicit::Method::Bdf, tolerance, samples)?)
    }),
    ("with friction: diffsol ESDIRK34", |case, tolerance, samples| {
        Ok(implicit::run(case, implicit::Method::Esdirk34, tolerance, samples)?)
    }),
];

/// Rows of the roller-centric model: our integrator at each goal, then diffsol's BDF and ESDIRK34.
const ROLLER_CENTRIC: [(&str, Solve); 3] = [
    ("roller-centric: integrator, RODAS5P", |case, tolerance, samples| {
        Ok(ours::roller_centric(case, tolerance, samples)?)
    }),
    ("roller-centric: diffsol BDF", |case, tolerance, samples| {
        Ok(roller_centric::run(case, implicit::Method::Bdf, tolerance, samples)?)
    }),
    ("roller-centric: diffsol ESDIRK34", |case, tolerance, samples| {
        Ok(roller_centric::run(case, implicit::Method::Esdirk34, tolerance, samples)?)
    }),
];

/// Returns the rows of the case with a hose's friction, a pair for each solver, as many as there are [`GOALS_KPA`].
pub(crate) fn rubbing_rows(case: &Case) -> Result<Vec<Row<'_>>, Box<dyn Error>> {
    rows_of(&RUBBING, case)
}

/// Returns the rows of the roller-centric model as [`rubbing_rows`] does.
pub(crate) fn roller_centric_rows(case: &Case) -> Result<Vec<Row<'_>>, Box<dyn Error>> {
    rows_of(&ROLLER_CENTRIC, case)
}

/// Returns a row of each solver for each goal, at the loosest tolerance that reaches it.
fn rows_of<'a>(solvers: &[(&str, Solve)], case: &'a Case) -> Result<Vec<Row<'a>>, Box<dyn Error>> {
    let mut rows = Vec::new();
    for &(name, solve) in solvers {
        for goal_kpa in GOALS_KPA {
            let mut samples = room();
            let suffices = |tolerance: &f64| {
                solve(case, *tolerance, &mut samples).is_ok() && case.error_kpa(&samples) <= goal_kpa
            };
            let tolerance = loosest(suffices)
                .ok_or_else(|| format!("{name} does not reach {goal_kpa:e} kPa at any tolerance"))?;
            rows.push(row(name, case, Some(tolerance), move |samples| solve(case, tolerance, samples))?);
        }
    }
    Ok(rows)
}

fn row<'a>(
    name: &str,
    case: &Case,
    tolerance: Option<f64>,
    solve: impl Fn(&mut Samples) -> Outcome + 'a,
) -> Result<Row<'a>, Box<dyn Error>> {
    let mut samples = room();
    solve(&mut samples)?;
    let error_kpa = Some(case.error_kpa(&samples));
    let samples = RefCell::new(samples);
    let run = Box::new(move || solve(black_box(&mut samples.borrow_mut())));
    Ok(Row { name: name.into(), tolerance, error_kpa, makes: MAKES, run })
}

/// Finds the loosest of ten tolerances a decade that suffices. A solver may fail at a loose tolerance.
pub(crate) fn loosest(suffices: impl FnMut(&f64) -> bool) -> Option<f64> {
    (10..=120).map(|tenths| 10_f64.powf(-0.1 * f64::from(tenths))).find(suffices)
}
