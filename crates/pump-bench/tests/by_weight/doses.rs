//! Claims about doses that arrive.

use std::sync::Mutex;
use std::thread::scope;

use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};
use pump_bench::{DoseRequest, OrderByWeight};
use pump_ctl::plan::Cruise;

use crate::plant::{Plant, Truth};
use crate::{bench, dose, dose_as_recorded, file, g_ml, truth};

#[test]
fn a_dose_by_weight_arrives_whatever_the_pump_displaces_and_learns_what_still_falls() {
    let folder = tempfile::tempdir().unwrap();
    let file = file(1.6, 1000.0);
    let plant = Plant::new(Truth { factor: 1.04, lag_s: 0.5, ..truth(&file) });
    let bench = bench(file, &plant, folder.path());
    // Slow enough for the flow to stand longer than the balance lags.
    let request = DoseRequest::dose(6.0).with_cruise(Cruise::Flow { ml_s: 1.5 });
    let order = OrderByWeight::new(request);
    let (prepared, made) = dose(&bench, &plant, &order);
    let made = made.unwrap();
    assert!(made.completed && made.stretches >= 2, "{made:?}");
    assert!((made.mass_g - prepared.target_g()).abs() < 0.035, "{made:?}");
    assert!((made.mass_g - plant.landed_g()).abs() < 0.003, "{made:?}: {}", plant.landed_g());
    // Fall and filter: 0.15 s and 0.5 s of flow, and half the time between two readings.
    let learned = made.after_stop.unwrap();
    assert!((learned.mean_s - 0.66).abs() < 0.15, "{learned:?}");
    assert_eq!(made.reckoned_s.map(|(_, learned)| learned), Some(false), "the first value is the model's");
    let before_g = plant.landed_g();
    let (_, again) = dose(&bench, &plant, &order);
    let again = again.unwrap();
    assert_eq!(again.reckoned_s.map(|(_, learned)| learned), Some(true));
    assert!((again.mass_g - (plant.landed_g() - before_g)).abs() < 0.003);
    assert!(again.after_stop.unwrap().stops > learned.stops);
    let state = bench.story().unwrap().state.unwrap();
    assert!(state.unfinished.is_none() && state.carry_ml == 0.0, "{state:?}");
}

#[test]
fn a_pump_that_delivers_far_more_than_its_file_says_is_stopped_by_the_balance() {
    let folder = tempfile::tempdir().unwrap();
    let file = file(1.6, 1000.0);
    // 10 % more, where the file is sure to 6 %.
    let plant = Plant::new(Truth { factor: 1.10, lag_s: 0.2, ..truth(&file) });
    let bench = bench(file, &plant, folder.path());
    let order = OrderByWeight::new(DoseRequest::dose(12.0));
    let (prepared, made) = dose(&bench, &plant, &order);
    let made = made.unwrap();
    assert!(made.stopped_by_balance >= 1, "{made:?}");
    assert!((made.mass_g - prepared.target_g()).abs() < 0.05, "{made:?}");
}

/// Draws doses of every kind: density, drop, fall, lag, digits, displacement and volume.
fn draw(n: usize) -> Vec<(f64, f64, f64, Truth)> {
    let rng = TestRng::from_seed(RngAlgorithm::ChaCha, &[7; 32]);
    let mut runner = TestRunner::new_with_rng(Config::default(), rng);
    let kinds = (
        1.0..3.0_f64,
        780.0..1260.0_f64,
        1.5..8.0_f64,
        (0.95..1.05_f64, 0.020..0.050_f64, 0.0..1.0_f64),
        (0.05..0.3_f64, 0.1..1.0_f64, prop::sample::select(vec![0.001, 0.002, 0.005, 0.01])),
    );
    let mut one = || {
        let (bore_mm, density_kg_m3, volume_ml, (factor, drop_ml, hangs), (fall_s, lag_s, digit_g)) =
            kinds.new_tree(&mut runner).unwrap().current();
        let plain = truth(&file(bore_mm, density_kg_m3));
        let hangs_ml = hangs * drop_ml;
        let truth = Truth { factor, drop_ml, hangs_ml, fall_s, lag_s, digit_g, ..plain };
        (bore_mm, density_kg_m3, volume_ml, truth)
    };
    (0..n).map(|_| one()).collect()
}

/// Runs doses twenty at a time. More would wait for the computer and not for their motors.
fn in_twenties<T: Send>(doses: Vec<T>, run: impl Fn(T) + Sync) {
    let doses = Mutex::new(doses.into_iter());
    let next = || doses.lock().unwrap().next();
    scope(|scope| {
        for _ in 0..20 {
            scope.spawn(|| {
                while let Some(dose) = next() {
                    run(dose);
                }
            });
        }
    });
}

#[test]
fn forty_random_doses_end_within_a_drop_and_never_above_the_ceiling() {
    in_twenties(draw(40), |(bore_mm, density_kg_m3, volume_ml, truth)| {
        let folder = tempfile::tempdir().unwrap();
        let file = file(bore_mm, density_kg_m3);
        let g_ml = g_ml(&file);
        let plant = Plant::new(truth);
        let bench = bench(file, &plant, folder.path());
        let order = OrderByWeight::new(DoseRequest::dose(volume_ml));
        let (prepared, made) = dose(&bench, &plant, &order);
        let made = made.unwrap_or_else(|error| panic!("{volume_ml} mL: {truth:?}: {error:?}"));
        let landed_ml = plant.landed_g() / g_ml;
        // The balance tells what is in the vessel to two roundings, and a filter that has not quite settled.
        let reported_ml = made.mass_g / g_ml;
        assert!((reported_ml - landed_ml).abs() * g_ml <= 2.0 * truth.digit_g, "{truth:?}: {made:?}");
        let off_ml = landed_ml - volume_ml;
        let allowed_ml = truth.drop_ml.max(0.5 * prepared.whole.drop_ml) + 2.0 * truth.digit_g / g_ml + 0.002;
        assert!(off_ml.abs() <= allowed_ml, "{off_ml} mL off: {truth:?}: {made:?}");
        assert!(plant.left_ml() <= truth.factor * prepared.most_ml, "{truth:?}: {made:?}");
        assert!(landed_ml <= prepared.most_ml, "{truth:?}: {made:?}");
    });
}

#[test]
fn doses_from_an_unknown_angle_end_within_a_drop_at_the_default_rate() {
    let numbered: Vec<_> = draw(24).into_iter().enumerate().collect();
    in_twenties(numbered, |(number, (bore_mm, density_kg_m3, volume_ml, drawn))| {
        let folder = tempfile::tempdir().unwrap();
        let file = file(bore_mm, density_kg_m3);
        let g_ml = g_ml(&file);
        let pitch_rad = file.model().unwrap().pitch_rad();
        let truth = Truth { start_rad: pitch_rad * number as f64 / 24.0, ..drawn };
        let plant = Plant::new(truth);
        let bench = bench(file, &plant, folder.path());
        let order = OrderByWeight::new(DoseRequest::dose(volume_ml));
        let (prepared, made) = dose_as_recorded(&bench, &plant, &order);
        assert!(!prepared.whole.plan.start().is_known(pitch_rad));
        let made = made.unwrap_or_else(|error| panic!("{volume_ml} mL: {truth:?}: {error:?}"));
        let off_ml = plant.landed_g() / g_ml - volume_ml;
        let allowed_ml = truth.drop_ml.max(0.5 * prepared.whole.drop_ml) + 2.0 * truth.digit_g / g_ml + 0.002;
        assert!(off_ml.abs() <= allowed_ml, "{off_ml} mL off of {volume_ml}: {truth:?}: {made:?}");
        assert!(made.stretches < 25, "{volume_ml}: {truth:?}: {made:?}");
        // A flow after a stop is not learned from volumes that the model does not know.
        assert!(made.after_stop.is_none(), "{made:?}");
    });
}
