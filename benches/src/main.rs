//! The cost of the pump's model and planner in one table, beside other solvers of one case in one run.
//!
//! Run it with `cargo run --release -p pump-benches`. The argument `quick` makes fewer rounds, as a check
//! that the benchmarks run.

#![allow(clippy::print_stdout, reason = "a table is printed")]

mod bare;
mod case;
mod ours;
mod peers;
mod sensitivities;
mod solvers;
mod timing;
mod work;

use std::error::Error;

use case::Case;
use pump_model::{Fluid, Hose};
use solvers::{BARE, BDF, EXACT, EXACT_AT, EXPLICIT, GOALS_KPA, RADAU, RODAS5P};
use timing::{Effort, Row, Times};

/// Hose of McIntyre et al., as far as it is known: both ends and their bends are its minor loss.
const HOSE: Hose = Hose {
    bore_radius_mm: 5.0,
    outer_radius_mm: 7.0,
    length_mm: 331.0,
    modulus_mpa: 3.5,
    poisson_ratio: 0.5,
    minor_loss: 5.75,
};

/// Tightest tolerance of the integrator.
const TIGHTEST: f64 = 1e-13;

fn main() -> Result<(), Box<dyn Error>> {
    let quick = std::env::args().any(|argument| argument == "quick");
    let effort = if quick { Effort { rounds: 5, fill_s: 5e-4 } } else { Effort { rounds: 21, fill_s: 5e-3 } };
    let case = Case::new();
    let friction = HOSE.friction(&Fluid::water(25.0)?)?;
    let rubbed =
        Case::with_friction(friction).solved_by(|case, samples| ours::rubbed(case, TIGHTEST, samples))?;
    let roller_centric =
        Case::new().solved_by(|case, samples| ours::roller_centric(case, TIGHTEST, samples))?;
    let mut rows = solvers::rows(&case)?;
    let solvers = rows.len();
    rows.extend(sensitivities::rows(&case)?);
    let stiff = [(rows.len(), "with friction"), (rows.len() + 6, "of the roller-centric model")];
    rows.extend(solvers::rubbing_rows(&rubbed)?);
    rows.extend(solvers::roller_centric_rows(&roller_centric)?);
    let work = rows.len();
    rows.extend(work::rows(&case.pump)?);
    let times = Times::measure(&mut rows, effort)?;

    println!(
        "3 rollers, 100 r/min, 10 s from rest, both pressures every 1 ms; error against the exact solution."
    );
    println!("Medians of {} rounds; \"ours\" is Radau's method at the same goal.\n", effort.rounds);
    println!("| what | tolerance | error, kPa | ms | / exact | / ours | a second |");
    println!("| --- | --- | --- | --- | --- | --- | --- |");
    for (n, row) in rows.iter().enumerate() {
        print_row(row, n, n < solvers, &times);
    }
    println!();
    verdict("exact / bare loop", times.ratio(EXACT, BARE), "at most", 0.6);
    verdict("exact at given times / exact", times.ratio(EXACT_AT, EXACT), "at most", 2.0);
    let bdf = times.ratio(BDF + 1, RODAS5P + 1);
    verdict(&format!("diffsol BDF / RODAS5P at {:.0e} kPa", GOALS_KPA[1]), bdf, "at least", 4.0);
    let explicit = EXPLICIT.map(|row| times.ratio(RADAU + 1, row + 1)).into_iter().fold(0.0, f64::max);
    verdict(&format!("Radau / best explicit peer at {:.0e} kPa", GOALS_KPA[1]), explicit, "at most", 1.0);
    for (ours, variant) in stiff {
        stiff_verdicts(&times, ours, variant);
    }
    let of = |row: usize| solvers + row;
    let differences = times.ratio(of(sensitivities::DIFFERENCES), of(sensitivities::EXACT));
    verdict("central differences / exact sensitivities", differences, "at least", 1.0);
    let diffsol = times.ratio(of(sensitivities::DIFFSOL), of(sensitivities::EXACT));
    verdict("diffsol BDF by R, C and L / exact sensitivities", diffsol, "at least", 1.0);
    let in_time = [
        ("20,000 pressures with their sensitivities", of(sensitivities::EXACT), 0.3),
        ("likelihood of 1,000 samples", of(sensitivities::LIKELIHOOD), 0.1),
        ("likelihood of 1,000 samples at rounded times", of(sensitivities::LIKELIHOOD) + 1, 0.1),
        ("steady state with extremes", work + work::STEADY, 0.005),
        ("map of 100 pumps x 1,000 speeds", work + work::MAP, 500.0),
        ("plan 25 mL with predicted pressures", work + work::PREDICTED, 0.35),
    ];
    for (what, row, target_ms) in in_time {
        verdict(&format!("{what}, ms"), 1e3 * times.median_s(row), "at most", target_ms);
    }
    Ok(())
}

fn print_row(row: &Row<'_>, n: usize, solves: bool, times: &Times) {
    let number = |value: Option<f64>| value.map_or(String::new(), |value| format!("{value:.1e}"));
    let (per_exact, per_ours) = if solves {
        // Rows from `RODAS5P` on come in pairs, one row for each goal.
        let ours = (n >= RODAS5P).then(|| format!("{:.2}", times.ratio(n, RADAU + n % 2)));
        (format!("{:.2}", times.ratio(n, EXACT)), ours.unwrap_or_default())
    } else {
        (String::new(), String::new())
    };
    let seconds = times.median_s(n);
    let (count, noun) = row.makes;
    println!(
        "| {} | {} | {} | {:.4} | {per_exact} | {per_ours} | {:.2e} {noun} |",
        row.name,
        number(row.tolerance),
        number(row.error_kpa),
        1e3 * seconds,
        count / seconds,
    );
}

/// Compares the rows of a stiff variant, of which our integrator's is the first.
fn stiff_verdicts(times: &Times, ours: usize, variant: &str) {
    for (n, goal_kpa) in GOALS_KPA.into_iter().enumerate() {
        let peers = [2, 4].map(|peer| times.ratio(ours + peer + n, ours + n));
        let best = peers.into_iter().fold(f64::INFINITY, f64::min);
        verdict(&format!("best of diffsol / RODAS5P {variant} at {goal_kpa:.0e} kPa"), best, "at least", 1.0);
    }
}

fn verdict(what: &str, ratio: f64, bound: &str, target: f64) {
    let met = if bound == "at most" { ratio <= target } else { ratio >= target };
    println!("{what}: {ratio:.3} (target: {bound} {target}; {})", if met { "met" } else { "missed" });
}
