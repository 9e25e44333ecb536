//! Doses that are cut off and resumed.

use pump_bench::{DoseError, DoseReport, DoseRequest};
use pump_ctl::plan::{Cruise, Finish};
use pump_model::units::rad_s;

use crate::bench::{Lab, numbers, stop_at, warning};

#[test]
fn the_total_of_a_resumed_dose_is_stated_from_the_least_to_the_most_that_it_can_be() {
    for (volume_ml, entries) in [(5.0, 3), (5.3, 4), (6.2, 5), (7.7, 8)] {
        let lab = Lab::new();
        lab.killed(DoseRequest::dose(volume_ml), entries);
        let part = lab.unfinished();
        let rest = lab.rest(DoseRequest::dose(0.0));
        // The finished rest tells it too.
        let stated = warning(&rest, "with this rest it comes to");
        assert!(!stated.contains("will be"), "{stated}");
        let stated = numbers(stated.split("with this rest").nth(1).unwrap());
        let curve = lab.bench.model().outlet_curve();
        let rest_rad = rest.plan.steps() as f64 * rest.plan.step_rad();
        let total_ml = |made: i64| {
            // The dose began at 0 deg.
            curve.volume_ml(made as f64 * rest.plan.step_rad() + rest_rad)
        };
        let (least_ml, most_ml) = (total_ml(part.made_least), total_ml(part.made_most));
        // The pump's own error comes on both sides: that of a dose of this volume which one command makes.
        let unsure_ml = 0.5 * ((stated[1] - stated[0]) - (most_ml - least_ml));
        assert!(
            (stated[0] + unsure_ml - least_ml).abs() < 2e-4 && (stated[1] - unsure_ml - most_ml).abs() < 2e-4,
            "{volume_ml} mL: {stated:?}, and it is {least_ml} to {most_ml}"
        );
        let fresh = Lab::new();
        let whole = fresh.bench.prepare(DoseRequest::dose(volume_ml)).unwrap();
        let whole_ml = DoseReport::new(&fresh.bench, &whole, None).expanded_uncertainty_ml;
        assert!(
            (unsure_ml / whole_ml - 1.0).abs() < 0.1,
            "{volume_ml} mL: {unsure_ml}, and {whole_ml} in one"
        );
        assert!((stated[2] / unsure_ml - 1.0).abs() < 0.05, "{stated:?}");
    }
}

#[test]
fn a_dose_to_low_flow_is_resumed_to_its_planned_end_even_beyond_the_volume_asked_for() {
    let lab = Lab::new();
    let request = DoseRequest::dose(5.0).with_finish(low_flow());
    let whole = lab.stopped(request, 0.1);
    let rest = lab.rest(DoseRequest::dose(0.0));
    let end = lab.unfinished().made_least + rest.plan.steps();
    assert_eq!(end, whole.plan.steps());

    // This dose ends at low flow well beyond its volume.
    let slow = Some(Cruise::Flow { ml_s: 0.5 });
    let found = (1..100).map(|n| 4.0 + 0.1 * f64::from(n)).find_map(|volume_ml| {
        let request = DoseRequest::dose(volume_ml).with_cruise(slow).with_finish(low_flow());
        let prepared = Lab::new().bench.prepare(request).ok()?;
        (prepared.plan.planned_ml() > volume_ml + 1.0).then_some(request)
    });
    let lab = Lab::new();
    let whole = lab.stopped(found.unwrap(), 0.98);
    let part = lab.unfinished();
    let (delivered_ml, _) = part.delivered_ml(lab.bench.model());
    assert!(delivered_ml > whole.plan.requested_ml(), "{delivered_ml}");
    let rest = lab.rest(DoseRequest::dose(0.0));
    assert_eq!(part.made_least + rest.plan.steps(), whole.plan.steps());
    assert!((rest.carry_out_ml - whole.carry_out_ml).abs() < 1e-9);
}

fn low_flow() -> Option<Finish> {
    Some(Finish::LowFlow)
}

#[test]
fn a_dose_that_was_stopped_before_its_first_step_leaves_nothing_and_a_rest_keeps_its_dose() {
    let lab = Lab::new();
    lab.stopped(DoseRequest::dose(5.0), 0.0);
    assert_eq!(lab.status()["unfinished"], serde_json::Value::Null);
    lab.stopped(DoseRequest::dose(5.0), 0.3);
    let before = lab.unfinished().delivered_ml(lab.bench.model());
    {
        let mut session = lab.bench.session().unwrap();
        let rest = session.prepare_rest(DoseRequest::dose(0.0)).unwrap();
        stop_at(&mut session, &rest, 0.0);
    }
    assert_eq!(lab.unfinished().delivered_ml(lab.bench.model()), before);
    assert!((lab.status()["unfinished"]["requested_ml"].as_f64().unwrap() - 5.0).abs() < 1e-9);
}

#[test]
fn a_dose_to_low_flow_is_resumed_to_any_end_if_that_is_asked_for() {
    let lab = Lab::new();
    let request = DoseRequest::dose(5.0).with_finish(low_flow());
    lab.stopped(request, 0.3);
    let rest = lab.rest(DoseRequest::dose(0.0).with_finish(Finish::Any));
    let (delivered_ml, _) = lab.unfinished().delivered_ml(lab.bench.model());
    assert!((delivered_ml + rest.plan.planned_ml() - 5.0).abs() < 1e-3, "{delivered_ml}");
}

#[test]
fn a_dose_with_a_suck_back_is_resumed_again_and_again() {
    let lab = Lab::new();
    lab.stopped(DoseRequest::dose(5.0).with_retraction(1.0), 0.5);
    for _ in 0..3 {
        let mut session = lab.bench.session().unwrap();
        let rest = session.prepare_rest(DoseRequest::dose(0.0)).unwrap();
        stop_at(&mut session, &rest, 0.5);
    }
    let rest = lab.rest(DoseRequest::dose(0.0));
    assert!(rest.plan.requested_ml() < 1.0 && rest.retraction.is_some());
    let status = lab.status();
    assert_eq!(status["unfinished"]["requested_ml"], 5.0, "the whole was asked for");
    let delivered_ml = status["unfinished"]["delivered_least_ml"].as_f64().unwrap();
    assert!((delivered_ml + rest.plan.planned_ml() - 5.0).abs() < 1e-3, "{delivered_ml}");
}

#[test]
fn a_rest_keeps_the_speed_that_was_asked_for_and_not_the_peak_of_a_short_dose() {
    for cruise in [Cruise::Speed { rad_s: rad_s(150.0) }, Cruise::Flow { ml_s: 40.0 }, Cruise::Fastest] {
        let lab = Lab::new();
        let whole = lab.stopped(DoseRequest::dose(0.8).with_cruise(cruise), 0.05);
        assert!(whole.plan.profile().peak_rad_s() < rad_s(140.0), "too short to reach the speed");
        assert_eq!(lab.rest(DoseRequest::dose(0.0)).request.cruise, Some(cruise));
    }
}

#[test]
fn a_smooth_dose_that_was_killed_twice_is_resumed_at_constant_speed() {
    let lab = Lab::new();
    lab.killed(DoseRequest::dose(20.0).with_smooth(true), 3);
    let slow = Cruise::Speed { rad_s: rad_s(20.0) };
    let at_speed = DoseRequest::dose(0.0).with_cruise(slow);
    lab.resumed_and_killed(at_speed, 3);
    let refused = lab.bench.session().unwrap().prepare_rest(at_speed.with_smooth(true));
    assert!(matches!(refused, Err(DoseError::RestWithoutAngle(_))), "{refused:?}");
    let rest = lab.rest(at_speed);
    assert!(!rest.plan.is_smooth() && rest.plan.steps() > 0);
}
