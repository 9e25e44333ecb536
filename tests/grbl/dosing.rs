//! Claims about doses without faults.

use std::time::Duration;

use pump_bench::drives::{Drive, Leave, Opening};

use crate::rig::{defective, dose, each, open, run, run_until, start, table};
use crate::simulated::options::{Defects, Options};

#[test]
fn every_step_of_a_dose_is_made_and_none_before_it_is_announced() {
    let board = start(Options::default());
    let mut grbl = open(&board);
    let mut stands = 0;
    for volume_ml in [1.7, -0.6, 0.9] {
        let plan = dose(&grbl, volume_ml, 5.0);
        let (made, announced) = run(&mut grbl, &board, &plan);
        stands += plan.steps();
        assert_eq!(made.unwrap(), plan.steps().unsigned_abs());
        assert_eq!((announced, board.truth().steps), (plan.steps().unsigned_abs(), stands));
        assert_eq!(grbl.count(), Some(stands));
        assert_eq!(grbl.disturbed(), None);
    }
}

#[test]
fn an_inverted_axis_turns_the_other_way_and_counts_the_same() {
    let board = start(Options::default());
    let mut grbl = board.open(&table().with_invert(true), &Opening::default()).unwrap();
    let plan = dose(&grbl, 0.5, 5.0);
    let made = grbl.run(&plan, &mut |_, _| Leave::Go).unwrap();
    assert_eq!(
        (made, board.truth().steps, grbl.count()),
        (plan.steps() as u64, -plan.steps(), Some(plan.steps()))
    );
}

#[test]
fn jogs_blend_at_the_cruise_speed() {
    let board = start(Options::default());
    let mut grbl = open(&board);
    let plan = dose(&grbl, 6.0, 4.0);
    run(&mut grbl, &board, &plan).0.unwrap();
    let truth = board.truth();
    let cruise = plan.profile().peak_rad_s() / plan.step_rad();
    assert_eq!(truth.starts, 1, "it came to rest between jogs");
    assert!((truth.peak_steps_s / cruise - 1.0).abs() < 1e-3, "{} of {cruise} steps/s", truth.peak_steps_s);
    assert!(truth.lines.iter().filter(|line| line.starts_with("$J=")).count() > 10);
}

#[test]
fn no_more_is_sent_ahead_than_a_stop_and_half_a_second() {
    let board = start(Options::default());
    let mut grbl = open(&board);
    let plan = dose(&grbl, 6.0, 4.0);
    let cruise = plan.profile().peak_rad_s() / plan.step_rad();
    let stop =
        cruise * cruise * plan.step_rad() / (2.0 * grbl.limits().unwrap().acceleration_rad_s2.unwrap());
    let mut ahead = 0;
    run_until(&mut grbl, &board, &plan, |made, about_to| {
        ahead = ahead.max(about_to - made);
        false
    })
    .0
    .unwrap();
    assert!((ahead as f64) < 1.2 * (0.5 * cruise + stop), "{ahead} steps ahead at {cruise} steps/s");
}

#[test]
fn a_dose_that_is_stopped_decelerates_and_knows_its_last_step() {
    let board = start(Options::default());
    let mut grbl = open(&board);
    let plan = dose(&grbl, 8.0, 4.0);
    let made = run_until(&mut grbl, &board, &plan, |made, _| made > 3_000).0.unwrap();
    assert!(made > 3_000 && made < plan.steps() as u64);
    assert_eq!(board.rest().steps, made as i64);
    let rest = dose(&grbl, 0.5, 4.0);
    assert_eq!(run(&mut grbl, &board, &rest).0.unwrap(), rest.steps() as u64);
    assert_eq!(board.truth().steps, made as i64 + rest.steps());
}

#[test]
fn a_dose_refused_at_its_first_step_moves_nothing() {
    let board = start(Options::default());
    let mut grbl = open(&board);
    let plan = dose(&grbl, 1.0, 4.0);
    assert_eq!(run_until(&mut grbl, &board, &plan, |_, _| true).0.unwrap(), 0);
    assert_eq!(board.rest().steps, 0);
}

#[test]
fn a_cancel_that_is_missed_is_repeated() {
    let board = defective(Defects { lost_cancels: 4, ..Defects::default() });
    let mut grbl = open(&board);
    let plan = dose(&grbl, 8.0, 2.0);
    let made = run_until(&mut grbl, &board, &plan, |made, _| made > 1_000).0.unwrap();
    assert!(made < plan.steps() as u64);
    assert_eq!(board.rest().steps, made as i64);
}

#[test]
fn late_answers_noise_pieces_and_merged_lines_cost_no_step() {
    each(0..6, |seed| {
        let board = defective(Defects {
            seed,
            late_ok: Duration::from_millis(if seed % 2 == 0 { 0 } else { 120 }),
            noise: seed % 3 != 0,
            chopped: seed % 3 != 1,
            ..Defects::default()
        });
        let mut grbl = open(&board);
        let plan = dose(&grbl, 2.5, 5.0);
        assert_eq!(run(&mut grbl, &board, &plan).0.unwrap(), plan.steps() as u64, "seed {seed}");
        assert_eq!(board.truth().steps, plan.steps(), "seed {seed}");
    });
}

#[test]
fn positions_are_read_in_every_kind_of_report() {
    each(
        [vec![(10, 0.0)], vec![(10, 2.0)], vec![(10, 3.0), (13, 1.0)], vec![(10, 0.0), (100, 80.0)]],
        |settings: Vec<(u16, f32)>| {
            let board = start(Options { settings: settings.clone(), ..Options::default() });
            let mut grbl = open(&board);
            let plan = dose(&grbl, 1.0, 1.0);
            assert_eq!(run(&mut grbl, &board, &plan).0.unwrap(), plan.steps() as u64, "{settings:?}");
            assert_eq!(board.truth().steps, plan.steps(), "{settings:?}");
        },
    );
}

#[test]
fn many_doses_far_from_zero_stay_exact() {
    let board = start(Options {
        time_scale: 20.0,
        settings: vec![(100, 37.5), (110, 30_000.0), (120, 2_000.0)],
        ..Options::default()
    });
    let mut grbl = open(&board);
    let mut stands = 0;
    for volume_ml in [500.0, 0.3, -0.31, 0.37] {
        let plan = dose(&grbl, volume_ml, 8.0);
        stands += plan.steps();
        run(&mut grbl, &board, &plan).0.unwrap();
        assert_eq!((board.truth().steps, grbl.count()), (stands, Some(stands)));
    }
    assert!(stands > 200_000);
}
