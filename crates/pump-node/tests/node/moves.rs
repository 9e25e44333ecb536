//! Moves: prepared, fed, begun together, stopped, and never beyond their end.

use pump_ctl::step::Segment;
use pump_link::message::{Answer, AxisState, End, MoveOrder, Refusal, Request};

use super::direct::{Direct, EVEN, Edge, SESSION, config_with, order};

#[test]
fn a_move_makes_its_steps_when_they_are_due_and_is_complete() {
    let mut direct = Direct::configured(1);
    let at = direct.go(0, 1, 3);
    direct.run_with_host(100_000);
    let expected: Vec<u64> = (1..=30).map(|n| at + 1000 * n).collect();
    assert_eq!(direct.rises(0), expected);
    let status = direct.status(0);
    assert_eq!(
        (status.position, status.state, status.next_segment),
        (30, AxisState::Ended(End::Complete), 3)
    );
    // Each pulse lasts 1.9 us, rounded up to ticks, and a tick more: the pin rises between two ticks.
    let falls = direct.with(|hardware| {
        let fell = hardware.edges.iter().filter(|(_, _, edge)| *edge == Edge::Step(false));
        fell.map(|(at, ..)| *at).collect::<Vec<_>>()
    });
    assert_eq!(falls, expected.iter().map(|at| at + 3).collect::<Vec<_>>());
    // The count goes on in another move, and in reverse.
    let back = Request::Prepare { axis: 0, move_number: 2, order: order(30, 10) };
    assert_eq!(direct.ask(&back), Answer::Accepted { next: 0, room: 32 });
    let reverse = Segment { count: -10, ..EVEN };
    assert_eq!(direct.segments(0, 2, 0, &[reverse, reverse]), Answer::Accepted { next: 2, room: 30 });
    let at = direct.now() + 3_000;
    assert_eq!(direct.ask(&Request::Begin { at, moves: [2, 0, 0, 0] }), Answer::Begun);
    direct.run_with_host(100_000);
    assert_eq!(direct.status(0).position, 10);
    let turned =
        direct.with(|hardware| hardware.edges.iter().position(|(.., edge)| *edge == Edge::Direction(false)));
    assert!(turned.is_some());
}

#[test]
fn four_axes_begin_at_one_tick_or_none_does() {
    let mut direct = Direct::configured(4);
    for axis in 0..4 {
        direct.ask(&Request::Prepare { axis, move_number: 1, order: order(0, 20) });
        direct.segments(axis, 1, 0, &[EVEN, EVEN]);
    }
    let at = direct.now() + 2_000;
    let twice = Request::Begin { at, moves: [1; 4] };
    assert_eq!(
        direct.refused(&Request::Begin { at, moves: [1, 1, 1, 2] }),
        Refusal::NoSuchMove { newest: 1 }
    );
    assert!((0..4).all(|axis| direct.status(axis).state == AxisState::Prepared));
    assert_eq!(direct.ask(&twice), Answer::Begun);
    assert_eq!(direct.ask(&twice), Answer::Begun);
    direct.run_with_host(50_000);
    for axis in 0..4 {
        let first = direct.rises(axis)[0];
        assert!((at + 1000..=at + 1001).contains(&first), "{first} {at}");
        assert_eq!(direct.status(axis as u8).position, 20);
    }
    // The pulses overlap: all four rise before the first falls.
    let edges = direct.with(|hardware| {
        let steps =
            hardware.edges.iter().filter(|(at, ..)| *at >= 1000).filter_map(|(.., edge)| match edge {
                Edge::Step(high) => Some(*high),
                _ => None,
            });
        steps.take(8).collect::<Vec<_>>()
    });
    assert_eq!(edges, [true, true, true, true, false, false, false, false]);
}

#[test]
fn a_move_begins_neither_in_the_past_nor_before_its_motor_is_ready() {
    let mut direct = Direct::configured(1);
    direct.run_with_host(20_000);
    let order = order(0, 10);
    direct.ask(&Request::Prepare { axis: 0, move_number: 1, order });
    let now = direct.now();
    let moves = [1, 0, 0, 0];
    assert_eq!(direct.refused(&Request::Begin { at: now + 5_000, moves }), Refusal::Empty);
    direct.segments(0, 1, 0, &[EVEN]);
    // The driver wakes up in 1.7 ms.
    let earliest = now + 1_700;
    assert_eq!(direct.refused(&Request::Begin { at: earliest - 1, moves }), Refusal::Begin { earliest });
    let late = Request::Begin { at: earliest + 10_000_001, moves };
    assert_eq!(direct.refused(&late), Refusal::Begin { earliest });
    assert_eq!(direct.ask(&Request::Begin { at: earliest, moves }), Answer::Begun);
}

#[test]
fn repeated_segments_are_ignored_and_gaps_refused() {
    let mut direct = Direct::configured(1);
    direct.ask(&Request::Prepare { axis: 0, move_number: 1, order: order(0, 40) });
    assert_eq!(direct.segments(0, 1, 1, &[EVEN]), Answer::Refused(Refusal::Gap { next: 0 }));
    assert_eq!(direct.segments(0, 1, 0, &[EVEN, EVEN]), Answer::Accepted { next: 2, room: 30 });
    assert_eq!(direct.segments(0, 1, 0, &[EVEN, EVEN]), Answer::Accepted { next: 2, room: 30 });
    // A frame that overlaps what is there adds the rest.
    assert_eq!(direct.segments(0, 1, 1, &[EVEN, EVEN, EVEN]), Answer::Accepted { next: 4, room: 28 });
    assert_eq!(direct.segments(0, 2, 0, &[EVEN]), Answer::Refused(Refusal::NoSuchMove { newest: 1 }));
    let again = Request::Prepare { axis: 0, move_number: 1, order: order(0, 40) };
    assert_eq!(direct.ask(&again), Answer::Accepted { next: 4, room: 28 });
    let other = Request::Prepare { axis: 0, move_number: 1, order: order(0, 30) };
    assert_eq!(direct.refused(&other), Refusal::Old { newest: 1 });
}

#[test]
fn segments_that_lead_beyond_turn_round_or_are_too_fast_are_refused() {
    let mut direct = Direct::configured(1);
    let elsewhere = Request::Prepare { axis: 0, move_number: 1, order: order(5, 30) };
    assert_eq!(direct.refused(&elsewhere), Refusal::Position { position: 0 });
    direct.ask(&Request::Prepare { axis: 0, move_number: 1, order: order(0, 15) });
    assert_eq!(direct.segments(0, 1, 0, &[EVEN, EVEN]), Answer::Refused(Refusal::Segment { number: 1 }));
    for segment in [
        Segment { count: -5, ..EVEN },
        Segment { count: 5, interval: 899, ..EVEN },
        Segment { count: 5, interval: 1000, add: -60 * (1 << 32), frac: 0 },
    ] {
        assert_eq!(direct.segments(0, 1, 1, &[segment]), Answer::Refused(Refusal::Segment { number: 1 }));
    }
    let at = direct.now() + 3_000;
    let moves = [1, 0, 0, 0];
    assert_eq!(
        direct.segments(0, 1, 1, &[Segment { count: 5, ..EVEN }]),
        Answer::Accepted { next: 2, room: 30 }
    );
    assert_eq!(direct.ask(&Request::Begin { at, moves }), Answer::Begun);
    direct.run_with_host(100_000);
    assert_eq!(direct.status(0).position, 15);
}

#[test]
fn a_stop_tells_its_end_and_a_stopped_move_never_begins() {
    let mut direct = Direct::configured(2);
    let at = direct.go(0, 1, 30);
    direct.run_to(at + 50_500);
    let moves = [1, 1, 0, 0];
    let Answer::Stopped { ends: [Some(end), Some(unborn), None, None] } =
        direct.ask(&Request::Stop { moves })
    else {
        panic!()
    };
    assert_eq!(unborn.final_count, 0);
    let again = direct.ask(&Request::Stop { moves: [1, 0, 0, 0] });
    assert_eq!(again, Answer::Stopped { ends: [Some(end), None, None, None] });
    direct.run_with_host(300_000);
    let status = direct.status(0);
    assert_eq!((status.position, status.state), (end.final_count, AxisState::Ended(End::Stopped)));
    assert_eq!(direct.rises(0).last(), Some(&end.last_step_at));
    assert!(status.position >= 51 && status.position < 300);
    // The stop of axis 1 came before its move: the move is refused when it comes.
    let prepare = Request::Prepare { axis: 1, move_number: 1, order: order(0, 10) };
    assert_eq!(direct.refused(&prepare), Refusal::Old { newest: 1 });
    // A stop of a move that is over does not stop the next.
    direct.go(1, 2, 2);
    let late = Request::Stop { moves: [0, 1, 0, 0] };
    assert_eq!(direct.ask(&late), Answer::Stopped { ends: [None; 4] });
    direct.run_with_host(100_000);
    assert_eq!(direct.status(1).state, AxisState::Ended(End::Complete));
}

#[test]
fn the_sum_of_step_rates_is_limited_before_anything_moves() {
    let mut direct = Direct::configured(3);
    let prepare = |axis, shortest_interval| {
        let order = MoveOrder { from: 0, last: 10, shortest_interval };
        Request::Prepare { axis, move_number: 1, order }
    };
    assert_eq!(direct.refused(&prepare(0, 5)), Refusal::Pulse);
    assert_eq!(direct.ask(&prepare(0, 25)), Answer::Accepted { next: 0, room: 32 });
    assert_eq!(direct.ask(&prepare(1, 20)), Answer::Accepted { next: 0, room: 32 });
    // 1 MHz over 25, 20 and 80 ticks.
    let refused = Refusal::StepRate { sum_hz: 40_000 + 50_000 + 12_500, allowed_hz: 100_000 };
    assert_eq!(direct.refused(&prepare(2, 80)), refused);
    // A move that is over leaves its share.
    direct.ask(&Request::Stop { moves: [0, 1, 0, 0] });
    assert_eq!(direct.ask(&prepare(2, 80)), Answer::Accepted { next: 0, room: 32 });
}

#[test]
fn the_index_is_where_its_sensor_became_active() {
    let mut direct = Direct::configured(0);
    direct.configure(0, config_with(|config| config.has_index = true));
    let at = direct.go(0, 1, 3);
    direct.run_to(at + 12_500);
    direct.with(|hardware| hardware.index[0] = true);
    direct.run_with_host(100_000);
    // It stood at step 12 when the sensor became active.
    assert_eq!(direct.status(0).index_at, Some(12));
}

#[test]
fn another_session_is_refused_while_a_motor_moves_and_begins_anew_at_rest() {
    let mut direct = Direct::configured(1);
    direct.go(0, 1, 3);
    let adopt = Request::Adopt { dead_man_ms: 500 };
    assert_eq!(direct.ask_as(SESSION + 1, &adopt), Answer::Refused(Refusal::Moving));
    direct.run_with_host(100_000);
    assert_eq!(direct.ask_as(SESSION + 1, &adopt), Answer::Adopted);
    // The old host is told, and the count stays.
    assert_eq!(direct.refused(&Request::Stop { moves: [1, 0, 0, 0] }), Refusal::Session);
    let status = direct.status(0);
    assert_eq!((status.position, status.state, status.revision), (30, AxisState::Unconfigured, 0));
}
