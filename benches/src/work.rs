//! The rows that have no peer: steady states, plans, step times, the simulated drive.

use std::error::Error;
use std::f64::consts::TAU;
use std::hint::black_box;
use std::thread;

use pump_bench::built_in;
use pump_bench::drives::Sim;
use pump_ctl::plan::{Cruise, Doser, Limits, Phase, Plan, PlanError, Request};
use pump_model::{Line, ModelError, Pump, RollerVolume, Variant};

use crate::timing::{Outcome, Row};

const SPEEDS: usize = 1_000;
const PUMPS: usize = 100;
const STEPS: usize = 1_000_000;

/// Rows in the order of [`rows`].
pub(crate) const STEADY: usize = 0;
pub(crate) const MAP: usize = 2;
pub(crate) const PREDICTED: usize = 4;

pub(crate) fn rows(pump: &Pump) -> Result<Vec<Row<'_>>, Box<dyn Error>> {
    let pumps = (0..PUMPS).map(with_other_outlet).collect::<Result<Vec<_>, _>>()?;
    let threads = thread::available_parallelism()?.get();
    let limits = built_in("three-roller").ok_or("the built-in pump is missing")?.limits();
    let dose = planned(pump, &limits, 25.0)?;
    let long = planned(pump, &limits, 2_000.0)?;
    assert!(long.steps() > STEPS as i64, "the long dose has too few steps");
    Ok(vec![
        row("steady state with extremes", (1.0, "states"), move || {
            black_box(pump.steady_state(black_box(10.0))?);
            Ok(())
        }),
        row("map of 1,000 speeds, 1 thread", (SPEEDS as f64, "states"), move || {
            black_box(highest_kpa(pump)?);
            Ok(())
        }),
        row(
            &format!("map of 100 pumps x 1,000 speeds, {threads} threads"),
            ((PUMPS * SPEEDS) as f64, "states"),
            move || map(&pumps, threads),
        ),
        row("plan 25 mL: steps and profile", (1.0, "plans"), move || {
            black_box(planned(pump, &limits, black_box(25.0))?);
            Ok(())
        }),
        row("plan 25 mL with predicted pressures", (1.0, "plans"), move || {
            black_box(planned(pump, &limits, black_box(25.0))?.predict(pump)?);
            Ok(())
        }),
        row("a million step times", (STEPS as f64, "steps"), move || {
            black_box(black_box(&long).each_step().take(STEPS).map(|step| step.time_s).sum::<f64>());
            Ok(())
        }),
        row("simulated drive, 25 mL", (dose.steps() as f64, "steps"), move || {
            let mut sim = Sim::new(pump);
            sim.make(black_box(&dose));
            black_box(sim.received_ml());
            Ok(())
        }),
    ])
}

fn row<'a>(name: &str, makes: (f64, &'static str), run: impl FnMut() -> Outcome + 'a) -> Row<'a> {
    Row { name: name.into(), tolerance: None, error_kpa: None, makes, run: Box::new(run) }
}

fn planned(pump: &Pump, limits: &Limits, volume_ml: f64) -> Result<Plan, PlanError> {
    Doser::new(pump, *limits)
        .and_then(|doser| doser.plan(Phase::known(0.3), &Request::new(volume_ml, Cruise::Flow { ml_s: 5.0 })))
}

/// Returns the three-roller pump with the n-th outlet line. Lines go from stiff and short to soft and long.
fn with_other_outlet(n: usize) -> Result<Pump, ModelError> {
    let share = n as f64 / PUMPS as f64;
    let published = Line::PUBLISHED;
    let outlet = Line {
        resistance_kpa_s_ml: published.resistance_kpa_s_ml * (0.5 + share),
        compliance_ml_kpa: published.compliance_ml_kpa * (0.5 + 3.0 * share),
        inertance_kpa_s2_ml: published.inertance_kpa_s2_ml * (2.0 - share),
        ..published
    };
    let pump = Pump::preset(3, Variant::Measured)?;
    Pump::new(*pump.geometry(), RollerVolume::measured()?, *pump.inlet(), outlet)
}

/// Returns the highest outlet pressure over the speeds from 0.2 to 200 r/min.
fn highest_kpa(pump: &Pump) -> Result<f64, ModelError> {
    let states = pump.steady_states();
    (1..=SPEEDS).try_fold(0.0, |highest: f64, n| {
        let state = states.at(0.2 * n as f64 * TAU / 60.0)?;
        Ok(highest.max(state.outlet.max_kpa))
    })
}

/// Computes the highest outlet pressure of every pump, on every core.
fn map(pumps: &[Pump], threads: usize) -> Outcome {
    let share = pumps.len().div_ceil(threads);
    let highest = |pumps: &[Pump]| pumps.iter().map(highest_kpa).collect::<Result<Vec<_>, _>>();
    thread::scope(|scope| {
        let workers: Vec<_> = pumps.chunks(share).map(|part| scope.spawn(move || highest(part))).collect();
        workers.into_iter().try_for_each(|worker| {
            black_box(worker.join().map_err(|_| "a worker panicked")??);
            Ok(())
        })
    })
}
