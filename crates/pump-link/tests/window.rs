//! The window: resends, gaps, and when the link is lost.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use pump_link::frame::{RequestHeader, body};
use pump_link::message::Request;
use pump_link::sender::{Answered, LinkLost, MOST_SENDS, RESEND_NS, Window, WindowError};

const MS: u64 = 1_000_000;

/// Returns the numbers of the requests that are sent now.
fn sent<const N: usize>(window: &mut Window<N>, now_ns: u64) -> Vec<u16> {
    let mut numbers = Vec::new();
    while let Some(frame) = window.next_to_send(now_ns) {
        let mut deframer = pump_link::frame::Deframer::new();
        let said = frame
            .bytes()
            .iter()
            .filter_map(|byte| deframer.push(*byte).map(|s| s.map(<[u8]>::to_vec)))
            .last();
        let payload = said.unwrap().unwrap();
        let (header, rest) = RequestHeader::split(&payload).unwrap();
        body::<Request<'_>>(rest).unwrap();
        numbers.push(header.number);
    }
    numbers
}

fn ask<const N: usize>(window: &mut Window<N>, lane: Option<u8>) -> Result<u16, WindowError> {
    window.request(&Request::Status { axis: 0 }, lane)
}

#[test]
fn an_answer_after_a_long_pause_of_the_host_is_no_lost_one() {
    let mut window = Window::<2>::new(1);
    let number = ask(&mut window, None).unwrap();
    assert_eq!(sent(&mut window, 0), [number]);
    // The process was stopped for a minute. Its input is read first.
    assert_eq!(window.answered(number), Some(Answered { sent_at_ns: Some(0), lane: None }));
    assert_eq!(window.expire(60_000 * MS), Ok(()));
    // A pause alone counts as one lost answer, however long it was.
    ask(&mut window, None).unwrap();
    sent(&mut window, 60_000 * MS);
    assert_eq!(window.expire(120_000 * MS), Ok(()));
    assert_eq!(sent(&mut window, 120_000 * MS).len(), 1);
}

#[test]
fn three_lost_answers_are_a_lost_link_and_any_answer_starts_the_count_anew() {
    let mut window = Window::<4>::new(1);
    let deaf = ask(&mut window, None).unwrap();
    let mut now = 0;
    assert_eq!(sent(&mut window, now), [deaf]);
    for _ in 1..MOST_SENDS {
        let other = ask(&mut window, None).unwrap();
        assert_eq!(sent(&mut window, now), [other]);
        now += RESEND_NS - 1;
        assert_eq!((window.expire(now), sent(&mut window, now)), (Ok(()), vec![]));
        now += 1;
        assert!(window.answered(other).is_some());
        assert_eq!((window.expire(now), sent(&mut window, now)), (Ok(()), vec![deaf]));
    }
    assert_eq!(window.expire(now + RESEND_NS), Err(LinkLost { sends: MOST_SENDS }));
    // Without answers in between.
    let mut window = Window::<4>::new(1);
    ask(&mut window, None).unwrap();
    ask(&mut window, None).unwrap();
    for n in 0..3 {
        assert_eq!(window.expire(n * RESEND_NS), Ok(()));
        assert_eq!(sent(&mut window, n * RESEND_NS), [0, 1]);
    }
    assert_eq!(window.expire(3 * RESEND_NS), Err(LinkLost { sends: 3 }));
}

#[test]
fn a_lost_link_stays_lost_however_often_a_host_asks() {
    let mut window = Window::<4>::new(1);
    let number = ask(&mut window, Some(0)).unwrap();
    for n in 0..3 {
        assert_eq!((window.expire(n * RESEND_NS), sent(&mut window, n * RESEND_NS)), (Ok(()), vec![number]));
    }
    // The thread of that lane is held up, and those of the other lanes look on.
    for _ in 0..1000 {
        assert_eq!(window.expire(3 * RESEND_NS), Err(LinkLost { sends: 3 }));
    }
    window.renew();
    assert_eq!((window.expire(3 * RESEND_NS), sent(&mut window, 3 * RESEND_NS)), (Ok(()), vec![number]));
}

#[test]
fn a_resent_request_tells_no_round_trip_and_is_answered_once() {
    let mut window = Window::<2>::new(1);
    let number = ask(&mut window, Some(3)).unwrap();
    sent(&mut window, 0);
    window.expire(RESEND_NS).unwrap();
    sent(&mut window, RESEND_NS);
    assert_eq!(window.answered(number), Some(Answered { sent_at_ns: None, lane: Some(3) }));
    assert_eq!(window.answered(number), None);
    assert!(window.is_empty());
}

#[test]
fn a_gap_sends_the_missing_request_again_at_once_and_once() {
    let mut window = Window::<4>::new(1);
    let numbers: Vec<_> = (0..3).map(|_| ask(&mut window, Some(0)).unwrap()).collect();
    let other = ask(&mut window, Some(1)).unwrap();
    assert_eq!(ask(&mut window, Some(0)), Err(WindowError::Full));
    assert_eq!(sent(&mut window, 0), [numbers[0], numbers[1], numbers[2], other]);
    // The first was lost, and the second comes back refused: both go again, before the time-out.
    window.gap(numbers[1]);
    assert_eq!(sent(&mut window, 5 * MS), numbers[..2]);
    // The third was refused for the same gap, which is being closed.
    window.gap(numbers[2]);
    assert_eq!(sent(&mut window, 6 * MS), numbers[2..]);
    assert_eq!(window.expire(49 * MS), Ok(()));
    assert_eq!(sent(&mut window, 49 * MS), []);
}
