//! Doses that a balance ends, on a motor in real time with drops that fall and a balance that lags.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod doses;
mod faults;
mod plant;
mod shares;

use std::ops::ControlFlow;
use std::path::Path;

use plant::{Defect, Plant, Truth};
use pump_bench::calibration::Weighing;
use pump_bench::pump_file::{OutletEnd, PumpFile};
use pump_bench::units::Amount;
use pump_bench::{Bench, DeliveredByWeight, DoseError, OrderByWeight, PreparedByWeight, Session, built_in};
use pump_ctl::plan::Phase;

/// Pump with a nozzle of this bore in air.
fn file(bore_mm: f64, density_kg_m3: f64) -> PumpFile {
    let mut file = built_in("three-roller").unwrap();
    file.outlet.end = Some(OutletEnd::Air);
    file.outlet.nozzle_bore_mm = Some(bore_mm);
    file.fluid.name = "something".to_owned();
    file.fluid.density_kg_m3 = density_kg_m3;
    file.fluid.surface_tension_mn_m = Some(60.0);
    // The owner's own figures: a built-in pump on a real motor would be a copy that nobody weighed.
    file.motor.confirmed = Some(true);
    file
}

fn g_ml(file: &PumpFile) -> f64 {
    1.0 / Weighing::of(file).amount_ml(Amount::Mass(1.0)).unwrap()
}

/// Plant with a plain truth.
fn truth(file: &PumpFile) -> Truth {
    Truth {
        factor: 1.0,
        start_rad: 0.3,
        g_ml: g_ml(file),
        drop_ml: 0.03,
        hangs_ml: 0.01,
        fall_s: 0.15,
        lag_s: 0.3,
        digit_g: 0.001,
        defect: Defect::None,
        defect_from_ml: 0.0,
    }
}

fn bench(file: PumpFile, plant: &Plant, folder: &Path) -> Bench {
    let model = file.model().unwrap();
    let bench = Bench::new(file, None, folder).unwrap().driven_by(&plant.motor(model)).unwrap();
    bench.confirming_pump(true)
}

fn session<'a>(bench: &'a Bench, plant: &Plant) -> Session<'a> {
    Session::with_drive(bench, Box::new(plant.motor(*bench.model()))).unwrap()
}

/// Doses by weight from a known angle.
fn dose(
    bench: &Bench,
    plant: &Plant,
    order: &OrderByWeight,
) -> (PreparedByWeight, Result<DeliveredByWeight, DoseError>) {
    let mut session = session(bench, plant);
    if session.state().is_none() {
        session.set_angle(Some(Phase::known(0.3))).unwrap();
    }
    drop(session);
    dose_as_recorded(bench, plant, order)
}

/// Doses by weight from the angle on record, which nobody knows at first.
fn dose_as_recorded(
    bench: &Bench,
    plant: &Plant,
    order: &OrderByWeight,
) -> (PreparedByWeight, Result<DeliveredByWeight, DoseError>) {
    let mut session = session(bench, plant);
    let prepared = session.prepare_by_weight(order).unwrap();
    let made = session.run_by_weight(&prepared, &mut plant.balance(), |_| ControlFlow::Continue(()));
    (prepared, made)
}
