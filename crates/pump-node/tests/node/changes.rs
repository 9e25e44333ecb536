//! Changes of a move under way: another end and another plan from a segment on, without a rest.

use pump_ctl::step::Segment;
use pump_link::message::{Answer, AxisState, End, MoveChange, Refusal, Request};

use super::direct::{Direct, EVEN, order};

fn change(number: u32, first: u32, last: i64) -> MoveChange {
    MoveChange { number, first, last, shortest_interval: 900 }
}

fn told(direct: &mut Direct, move_number: u32, change: MoveChange) -> Answer {
    direct.ask(&Request::Retarget { axis: 0, move_number, change })
}

fn refused(direct: &mut Direct, move_number: u32, change: MoveChange) -> Refusal {
    direct.refused(&Request::Retarget { axis: 0, move_number, change })
}

/// Begins a move of 100 steps with 20 of them on the board. Returns the tick at which it begins.
fn begun(direct: &mut Direct) -> u64 {
    direct.ask(&Request::Prepare { axis: 0, move_number: 1, order: order(0, 100) });
    direct.segments(0, 1, 0, &[EVEN, EVEN]);
    let at = direct.now() + 5_000;
    assert_eq!(direct.ask(&Request::Begin { at, moves: [1, 0, 0, 0] }), Answer::Begun);
    at
}

#[test]
fn a_changed_move_goes_on_without_a_rest_to_its_new_end_and_no_farther() {
    for last in [40, 160] {
        let mut direct = Direct::configured(1);
        let at = begun(&mut direct);
        direct.run_to(at + 5_500);
        assert!(matches!(told(&mut direct, 1, change(1, 2, last)), Answer::Accepted { next: 2, .. }));
        let beyond = Segment { count: 1 + last as i32 - 20, ..EVEN };
        assert_eq!(direct.segments(0, 1, 2, &[beyond]), Answer::Refused(Refusal::Segment { number: 2 }));
        let rest = Segment { count: last as i32 - 20, ..EVEN };
        assert!(matches!(direct.segments(0, 1, 2, &[rest]), Answer::Accepted { next: 3, .. }));
        direct.run_with_host(400_000);
        let expected: Vec<u64> = (1..=last as u64).map(|n| at + 1000 * n).collect();
        assert_eq!(direct.rises(0), expected);
        let status = direct.status(0);
        assert_eq!((status.position, status.state), (last, AxisState::Ended(End::Complete)));
    }
}

#[test]
fn a_repeated_change_is_none_and_an_older_one_is_refused() {
    let mut direct = Direct::configured(1);
    begun(&mut direct);
    assert!(matches!(told(&mut direct, 1, change(1, 2, 60)), Answer::Accepted { .. }));
    assert!(matches!(told(&mut direct, 1, change(2, 2, 50)), Answer::Accepted { .. }));
    assert!(matches!(direct.segments(0, 1, 2, &[EVEN]), Answer::Accepted { next: 3, .. }));
    // The frames of both changes come again, late and in any order.
    assert_eq!(refused(&mut direct, 1, change(1, 2, 60)), Refusal::Old { newest: 2 });
    assert!(matches!(told(&mut direct, 1, change(2, 2, 50)), Answer::Accepted { next: 3, .. }));
    assert!(matches!(direct.segments(0, 1, 3, &[EVEN, EVEN]), Answer::Accepted { next: 5, .. }));
    direct.run_with_host(200_000);
    assert_eq!(direct.status(0).position, 50);
}

#[test]
fn a_change_that_comes_too_late_or_leads_back_changes_nothing() {
    let mut direct = Direct::configured(1);
    begun(&mut direct);
    let held = Refusal::Change { next: 2, position: 20 };
    for (first, last) in [(1, 60), (2, 20), (2, 10), (2, -60)] {
        assert_eq!(refused(&mut direct, 1, change(1, first, last)), held, "{first} {last}");
    }
    let fast = MoveChange { shortest_interval: 1, ..change(1, 2, 60) };
    assert_eq!(refused(&mut direct, 1, fast), Refusal::Pulse);
    assert_eq!(refused(&mut direct, 2, change(1, 2, 60)), Refusal::NoSuchMove { newest: 1 });
    // The whole plan is on the board: the motor comes to rest at its end.
    direct.segments(0, 1, 2, &[Segment { count: 80, ..EVEN }]);
    let whole = Refusal::Change { next: 3, position: 100 };
    assert_eq!(refused(&mut direct, 1, change(1, 3, 160)), whole);
    direct.run_with_host(300_000);
    assert_eq!(direct.status(0).position, 100);
    assert_eq!(refused(&mut direct, 1, change(1, 3, 160)), Refusal::NoSuchMove { newest: 1 });
}

#[test]
fn a_stop_or_a_lost_host_after_a_change_stays_within_the_new_end() {
    let mut direct = Direct::configured(1);
    let at = begun(&mut direct);
    told(&mut direct, 1, change(1, 2, 25));
    // No segment of the new plan comes: the motor comes to rest before the new end.
    direct.run_to(at + 200_000);
    let status = direct.status(0);
    assert_eq!(status.state, AxisState::Ended(End::Starved));
    assert!((20..=25).contains(&status.position), "{status:?}");
}
