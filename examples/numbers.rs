//! Prints numbers of doses and runs as the crates compute them, as JSON: `cargo run --example numbers`. The
//! Python tests hold the module and the command against them, to the last bit.

use std::error::Error;
use std::io::Write;
use std::ops::ControlFlow;

use pump_bench::record::PhaseSource;
use pump_bench::simulation::{Simulation, SteadyReport};
use pump_bench::{Bench, DoseRequest, Prepared, built_in};
use pump_ctl::plan::{Cruise, Phase};
use pump_model::units::rad_s;
use serde_json::{Map, Value, json};

fn main() -> Result<(), Box<dyn Error>> {
    let mut all = Map::new();
    for name in ["three-roller", "two-roller"] {
        all.insert(name.to_owned(), numbers(name)?);
    }
    writeln!(std::io::stdout(), "{}", Value::Object(all))?;
    Ok(())
}

fn numbers(name: &str) -> Result<Value, Box<dyn Error>> {
    let file = built_in(name).ok_or("it is built in")?;
    let model = file.model()?;
    let request = DoseRequest::dose(25.0).with_cruise(Cruise::Flow { ml_s: 10.0 });
    let Prepared { plan, prediction, .. } =
        Prepared::new(&file, &model, request, Phase::known(0.0), PhaseSource::Given, 0.0)?;
    let speed_rad_s = rad_s(100.0);
    let steady = SteadyReport::from(model.steady_state(speed_rad_s)?);
    let last =
        Simulation::new(speed_rad_s, 2.0, 1e-3).samples(&model)?.last().ok_or("a run has samples")??;

    let state = tempfile::tempdir()?;
    let bench = Bench::new(file, None, state.path())?;
    let mut session = bench.session()?;
    let request = DoseRequest::dose(7.0).with_cruise(Cruise::Within { time_s: 4.0 });
    let prepared = session.prepare(request)?;
    let delivered = session.run(&prepared, |_steps| ControlFlow::Continue(()))?;
    Ok(json!({
        "dose": {
            "planned_ml": plan.planned_ml(),
            "steps": plan.steps(),
            "motion_s": plan.profile().duration_s(),
            "settle_s": prediction.settle_s,
            "inlet_min_kpa": prediction.inlet.min_kpa,
            "outlet_max_kpa": prediction.outlet.max_kpa,
        },
        "steady": steady,
        "last": {
            "angle_rad": last.angle_rad,
            "q_in_ml_s": last.q_in_ml_s,
            "q_out_ml_s": last.q_out_ml_s,
            "p_in_kpa": last.p_in_kpa,
            "p_out_kpa": last.p_out_kpa,
            "delivered_ml": last.delivered_ml,
        },
        "delivered_ml": delivered.volume_ml,
    }))
}
