//! Cost of planning a dose with its predicted pressures, and of running it on the simulated drive.

#![allow(missing_docs, clippy::unwrap_used, reason = "criterion's macros; a bench may panic")]

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use pump_ctl::plan::{Cruise, Phase, Plan, Request, plan};
use pump_dose::{Sim, built_in};
use pump_model::Pump;

fn planned(pump: &Pump) -> Plan {
    let limits = built_in("three-roller").unwrap().limits();
    let request = Request::new(black_box(25.0), Cruise::Flow { ml_s: 5.0 });
    plan(pump, Phase::known(0.3), &request, &limits).unwrap()
}

fn benches(criterion: &mut Criterion) {
    let pump = Pump::three_roller();
    criterion.bench_function("plan 25 mL: steps and profile", |bench| bench.iter(|| planned(&pump)));
    criterion.bench_function("plan 25 mL with predicted pressures", |bench| {
        bench.iter(|| planned(&pump).predict(&pump).unwrap());
    });
    criterion.bench_function("simulated drive, 25 mL step by step", |bench| {
        let plan = planned(&pump);
        bench.iter(|| Sim::new(&pump).run(&plan, |_| {}).unwrap());
    });
}

criterion_group!(plans, benches);
criterion_main!(plans);
