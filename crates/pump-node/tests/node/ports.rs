//! A session belongs to one port, and frames at another one do not disturb it.

use pump_link::frame::{Encoded, RequestHeader};
use pump_link::message::{Answer, AxisState, End, FaultCounts, Refusal, Request};

use super::direct::{Direct, EVEN, SESSION, order};

const STRANGER: u64 = 43;

/// Asks at another port than the one that has the session.
fn elsewhere<R>(direct: &mut Direct, ask: impl FnOnce(&mut Direct) -> R) -> R {
    direct.port = 1;
    let answer = ask(direct);
    direct.port = 0;
    answer
}

#[test]
fn another_port_may_ask_and_nothing_else() {
    let mut direct = Direct::configured(1);
    direct.go(0, 1, 30);
    direct.run_with_host(100_000);
    let before = direct.status(0);
    assert_eq!(before.state, AxisState::Moving);
    elsewhere(&mut direct, |direct| {
        assert!(matches!(direct.ask_as(0, &Request::Identify), Answer::Identity(_)));
        assert!(matches!(direct.ask(&Request::Status { axis: 0 }), Answer::Status(_)));
        let moves = [1, 0, 0, 0];
        // The number of the session is no secret, so it must not be enough.
        for request in [
            Request::Stop { moves },
            Request::Begin { at: 0, moves },
            Request::Prepare { axis: 1, move_number: 1, order: order(0, 10) },
            Request::FaultsRead { axis: 0, read: FaultCounts::default() },
        ] {
            assert_eq!(direct.refused(&request), Refusal::Session);
        }
        assert_eq!(direct.segments(0, 1, 30, &[EVEN]), Answer::Refused(Refusal::Session));
        for session in [SESSION, STRANGER] {
            let adopt = Request::Adopt { dead_man_ms: 10_000 };
            assert_eq!(direct.ask_as(session, &adopt), Answer::Refused(Refusal::Moving));
        }
    });
    direct.run_with_host(400_000);
    let after = direct.status(0);
    assert_eq!((after.state, after.position), (AxisState::Ended(End::Complete), 300));
    assert_eq!((direct.node.session(), after.faults), (SESSION, FaultCounts::default()));
}

#[test]
fn bytes_of_two_ports_do_not_run_into_each_other() {
    let mut direct = Direct::configured(1);
    let header = RequestHeader { number: 900, session: SESSION };
    let frame = Encoded::request(header, &Request::Status { axis: 0 }).unwrap();
    let (front, back) = frame.bytes().split_at(frame.bytes().len() / 2);
    assert!(direct.bytes(front).is_empty());
    elsewhere(&mut direct, |direct| {
        assert!(direct.bytes(b"\0Grbl 1.1h ['$' for help]\0").is_empty());
        assert!(matches!(direct.ask(&Request::Identify), Answer::Identity(_)));
    });
    assert!(matches!(direct.bytes(back)[..], [Answer::Status(_)]));
}

#[test]
fn frames_at_another_port_do_not_feed_the_dead_man_timer() {
    let mut direct = Direct::configured(1);
    let begun = direct.go(0, 1, 32);
    let heard = direct.now();
    while direct.now() < heard + 700_000 {
        let now = direct.now();
        direct.run_to(now + 20_000);
        elsewhere(&mut direct, |direct| direct.ask(&Request::Status { axis: 0 }));
    }
    let status = direct.status(0);
    assert!(begun < heard + 320_000 && status.position == 320, "the move was over before");
    let mut direct = Direct::configured(1);
    direct.go(0, 1, 32);
    direct.run_with_host(200_000);
    direct.axes.status(0).unwrap();
    let heard = direct.now();
    assert_eq!(direct.ask(&Request::Adopt { dead_man_ms: 100 }), Answer::Adopted);
    while direct.now() < heard + 100_000 {
        elsewhere(&mut direct, |direct| direct.ask(&Request::Status { axis: 0 }));
        let now = direct.now();
        direct.run_to(now + 5_000);
    }
    assert_eq!(direct.status(0).faults.link, 1);
}

#[test]
fn a_port_takes_the_session_from_a_host_that_is_quiet_and_at_rest() {
    let mut direct = Direct::configured(1);
    let prepare = Request::Prepare { axis: 0, move_number: 1, order: order(0, 10) };
    assert_eq!(direct.ask(&prepare), Answer::Accepted { next: 0, room: 32 });
    let adopt = Request::Adopt { dead_man_ms: 500 };
    let heard = direct.now();
    // The host loads a move: nothing moves yet.
    direct.run_to(heard + 499_000);
    assert_eq!(elsewhere(&mut direct, |direct| direct.refused(&adopt)), Refusal::Moving);
    direct.run_to(heard + 500_000);
    direct.port = 1;
    assert_eq!(direct.ask(&adopt), Answer::Adopted);
    // The cable was put elsewhere: the session's axes are as they were.
    assert_eq!(direct.status(0).revision, 1);
    direct.port = 0;
    assert_eq!(direct.refused(&prepare), Refusal::Session);
    // Another host takes it too, and configures it anew.
    direct.run_to(heard + 2_000_000);
    assert_eq!(direct.ask_as(STRANGER, &adopt), Answer::Adopted);
    assert_eq!((direct.node.session(), direct.status(0).state), (STRANGER, AxisState::Unconfigured));
}

#[test]
fn there_are_two_ports() {
    let mut direct = Direct::new();
    direct.port = pump_node::PORTS;
    let header = RequestHeader { number: 1, session: 0 };
    let frame = Encoded::request(header, &Request::Identify).unwrap();
    assert!(direct.bytes(frame.bytes()).is_empty());
}
