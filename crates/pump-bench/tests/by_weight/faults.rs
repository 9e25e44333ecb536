//! Claims about doses that a fault ends: decelerated, on record, and told.

use std::ops::ControlFlow;
use std::thread::scope;
use std::time::Duration;

use pump_bench::dosing::WeightFault;
use pump_bench::report::{Ending, Explain, with_sources};
use pump_bench::{DoseError, DoseRequest, OrderByWeight};
use pump_ctl::plan::Cruise;

use crate::plant::{Defect, Plant, Truth};
use crate::{bench, dose, file, session, truth};

/// Makes a dose of 20 mL whose balance fails after `from_ml`. Returns the fault in words, and what left the tube.
fn fault(defect: Defect, from_ml: f64) -> (String, DoseError, f64) {
    let folder = tempfile::tempdir().unwrap();
    let file = file(1.6, 1000.0);
    let plant = Plant::new(Truth { defect, defect_from_ml: from_ml, ..truth(&file) });
    let bench = bench(file, &plant, folder.path());
    let request = DoseRequest::dose(20.0).with_cruise(Cruise::Flow { ml_s: 2.0 });
    let (_, made) = dose(&bench, &plant, &OrderByWeight::new(request).with_longest(Duration::from_secs(5)));
    let error = made.unwrap_err();
    assert!(!plant.moves());
    assert_eq!(error.ending(), Ending::Moved, "{error}");
    // The dose stays on record with what the model delivered, and no dose is planned over it.
    let state = bench.story().unwrap().state.unwrap();
    let dose = state.unfinished.expect("unfinished");
    let (least_ml, most_ml) = dose.delivered_ml(bench.model());
    let left_ml = plant.left_ml();
    assert!((least_ml - left_ml).abs() < 1e-6 && (most_ml - left_ml).abs() < 1e-6, "{least_ml} {left_ml}");
    let DoseError::ByWeight { turned_ml, .. } = error else { panic!("{error}") };
    assert!((turned_ml - left_ml).abs() < 1e-6);
    assert!(matches!(bench.prepare(DoseRequest::dose(1.0)), Err(DoseError::Unfinished { .. })));
    // Resuming goes on by volume, to the volume that was asked for and not to the ceiling, and says so.
    let rest = bench.prepare_rest(DoseRequest::dose(0.0)).unwrap();
    assert!((rest.plan.planned_ml() - (20.0 - left_ml)).abs() < 0.002, "{}", rest.plan.planned_ml());
    assert!(rest.warnings.iter().any(|warning| warning.text().contains("made by volume")));
    (with_sources(&error), error, left_ml)
}

#[test]
fn a_balance_that_fails_in_motion_ends_the_dose_with_what_was_delivered() {
    let cases = [
        (Defect::Silent, 4.0, "sent nothing for 2", 4.0 + 2.0 * 2.4),
        (Defect::Garbage, 4.0, "which is no mass", 4.5),
        (Defect::OtherUnit, 4.0, "1.9 oz", 4.5),
        (Defect::Overload, 4.0, "overloaded", 4.5),
        (Defect::Removed, 4.0, "taken away", 4.5),
        // Three seconds of flow, and as much as is too little for sure.
        (Defect::TubeOff, 0.0, "is the vessel on it", 3.5 * 2.2),
    ];
    scope(|scope| {
        for (defect, from_ml, words, most_ml) in cases {
            scope.spawn(move || {
                let (told, error, left_ml) = fault(defect, from_ml);
                assert!(told.contains(words), "{defect:?}: {told}");
                assert!(left_ml < most_ml, "{defect:?}: {left_ml}");
                assert!(told.contains("by the model") && told.contains(" g by the balance"), "{told}");
                assert_eq!(error.facts().kind.as_str(), "balance", "{told}");
            });
        }
    });
}

#[test]
fn a_balance_that_fails_before_the_motion_moves_nothing() {
    for defect in [Defect::Silent, Defect::Garbage, Defect::Overload] {
        let folder = tempfile::tempdir().unwrap();
        let file = file(1.6, 1000.0);
        let plant = Plant::new(Truth { defect, defect_from_ml: 0.0, ..truth(&file) });
        let bench = bench(file, &plant, folder.path());
        let (_, made) = dose(&bench, &plant, &OrderByWeight::new(DoseRequest::dose(5.0)));
        let error = made.unwrap_err();
        assert!(matches!(error, DoseError::Balance(_)) && error.ending() == Ending::Refused, "{error}");
        assert_eq!(plant.steps(), 0);
        assert!(bench.story().unwrap().state.unwrap().unfinished.is_none());
    }
}

#[test]
fn a_pump_that_turns_for_the_most_that_it_may_is_stopped_there() {
    let folder = tempfile::tempdir().unwrap();
    let file = file(1.6, 1000.0);
    // A seventh is lost on the way, where the file is sure to 5.6 %.
    let plant = Plant::new(Truth { factor: 0.86, ..truth(&file) });
    let bench = bench(file, &plant, folder.path());
    let order = OrderByWeight::new(DoseRequest::dose(6.0));
    let (prepared, made) = dose(&bench, &plant, &order);
    let error = made.unwrap_err();
    assert!(
        matches!(error, DoseError::ByWeight { fault: WeightFault::Ceiling { .. }, .. }),
        "{}",
        with_sources(&error)
    );
    assert!(plant.left_ml() <= 0.86 * prepared.most_ml + 0.002, "{} {}", plant.left_ml(), prepared.most_ml);
    let discarded = session(&bench, &plant).accept().unwrap();
    assert!(discarded.state.unfinished.is_none());
}

#[test]
fn a_user_who_stops_a_dose_by_weight_finds_it_unfinished() {
    let folder = tempfile::tempdir().unwrap();
    let file = file(1.6, 1000.0);
    let plant = Plant::new(truth(&file));
    let bench = bench(file, &plant, folder.path());
    let mut session = session(&bench, &plant);
    session.set_angle(None).unwrap();
    let prepared = session.prepare_by_weight(&OrderByWeight::new(DoseRequest::dose(15.0))).unwrap();
    let stop = |_: u64| match plant.left_ml() > 3.0 {
        true => ControlFlow::Break(()),
        false => ControlFlow::Continue(()),
    };
    let made = session.run_by_weight(&prepared, &mut plant.balance(), stop).unwrap();
    assert!(!made.completed && plant.left_ml() < 5.0, "{made:?}");
    assert!(session.state().unwrap().unfinished.is_some());
}

#[test]
fn what_no_balance_can_end_is_refused_before_anything_moves() {
    let folder = tempfile::tempdir().unwrap();
    let file = file(1.6, 1000.0);
    let plant = Plant::new(truth(&file));
    let bench = bench(file, &plant, folder.path());
    for (request, words) in [
        (DoseRequest::dose(-5.0), "forward"),
        (DoseRequest::dose(5.0).with_smooth(true), "smooth"),
        (DoseRequest::dose(5.0).with_retraction(0.1), "retraction"),
        (DoseRequest::dose(5.0).with_cruise(Cruise::Within { time_s: 9.0 }), "no time"),
    ] {
        let error = bench.prepare_by_weight(&OrderByWeight::new(request)).unwrap_err();
        assert!(error.to_string().contains(words), "{error}");
    }
    let order = OrderByWeight::new(DoseRequest::dose(5.0)).with_most_ml(Some(4.0));
    assert!(bench.prepare_by_weight(&order).unwrap_err().to_string().contains("its own volume"));
}
