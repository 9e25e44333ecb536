//! Frames over a line that corrupts, and messages of every kind.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use proptest::prelude::*;
use pump_link::frame::{
    AnswerHeader, Deframer, Encoded, FrameError, MAX_FRAME, RequestHeader, VERSION, body,
};
use pump_link::message::{
    Answer, AxisConfig, AxisState, AxisStatus, End, FaultCounts, Identity, MAX_PACKED, MoveChange, MoveOrder,
    Refusal, Request, Stopping,
};

const HEADER: RequestHeader = RequestHeader { number: 0xfe01, session: 0x8877_6655_4433_2211 };

/// Returns what a deframer says to bytes.
fn said(bytes: &[u8]) -> Vec<Result<Vec<u8>, FrameError>> {
    let mut deframer = Deframer::new();
    bytes.iter().filter_map(|byte| deframer.push(*byte).map(|said| said.map(<[u8]>::to_vec))).collect()
}

fn requests(packed: &[u8]) -> [Request<'_>; 11] {
    let order = MoveOrder { from: i64::MIN, last: i64::MAX, shortest_interval: u32::MAX };
    let change =
        MoveChange { number: u32::MAX, first: u32::MAX, last: i64::MIN, shortest_interval: u32::MAX };
    let (axis, revision, move_number) = (u8::MAX, u32::MAX, u32::MAX);
    [
        Request::Identify,
        Request::Adopt { dead_man_ms: u16::MAX },
        Request::Status { axis },
        Request::Configure { axis, revision, config: AxisConfig::new(u8::MAX) },
        Request::Brake { axis, revision, first: u8::MAX, entries: packed },
        Request::Prepare { axis, move_number, order },
        Request::Segments { axis, move_number, first: u32::MAX, packed },
        Request::Begin { at: u64::MAX, moves: [u32::MAX; 4] },
        Request::Stop { moves: [u32::MAX; 4] },
        Request::Retarget { axis, move_number, change },
        Request::FaultsRead { axis, read: FaultCounts { late: u32::MAX, ..FaultCounts::default() } },
    ]
}

#[test]
fn every_request_fits_a_frame_and_comes_back() {
    let packed = [0xff; MAX_PACKED];
    for request in requests(&packed) {
        let frame = Encoded::request(HEADER, &request).unwrap();
        assert!(frame.bytes().len() <= MAX_FRAME);
        let said = said(frame.bytes());
        let [Ok(payload)] = &said[..] else { panic!("{said:?}") };
        let (header, rest) = RequestHeader::split(payload).unwrap();
        assert_eq!((header, body(rest)), (HEADER, Ok(request)));
    }
    let too_long = [0; 240];
    let request = Request::Segments { axis: 0, move_number: 1, first: 0, packed: &too_long };
    assert_eq!(Encoded::request(HEADER, &request), Err(FrameError::TooLong));
}

#[test]
fn every_answer_fits_a_frame_and_comes_back() {
    let faults =
        FaultCounts { late: u32::MAX, starved: u32::MAX, driver: u32::MAX, link: u32::MAX, estop: u32::MAX };
    let status = AxisStatus {
        position: i64::MIN,
        state: AxisState::Ending(End::DeadMan),
        revision: u32::MAX,
        move_number: u32::MAX,
        next_segment: u32::MAX,
        room: u16::MAX,
        energised: true,
        angle_lost: true,
        index_at: Some(i64::MIN),
        faults,
        unread: faults,
    };
    let end = Some(Stopping { last_step_at: u64::MAX, final_count: i64::MIN });
    let answers = [
        Answer::Refused(Refusal::StepRate { sum_hz: u32::MAX, allowed_hz: u32::MAX }),
        Answer::Identity(Identity::new(u64::MAX, [u16::MAX; 3], 4, u16::MAX, u32::MAX, u32::MAX)),
        Answer::Adopted,
        Answer::Status(status),
        Answer::Configured { brake_entries: 32 },
        Answer::Accepted { next: u32::MAX, room: u16::MAX },
        Answer::Begun,
        Answer::Stopped { ends: [end; 4] },
        Answer::Faults { unread: faults },
    ];
    let header = AnswerHeader { number: 513, session: u64::MAX, received_at: 0x0102_0304_0506_0708 };
    for answer in answers {
        let said = said(Encoded::answer(header, &answer).unwrap().bytes());
        let [Ok(payload)] = &said[..] else { panic!("{said:?}") };
        let (read, rest) = AnswerHeader::split(payload).unwrap();
        assert_eq!((read, body(rest)), (header, Ok(answer)));
    }
}

#[test]
fn the_bytes_of_a_frame_stay_what_they_are() {
    // Version 3, number 2, session 3, `Status` (the third request) of axis 1. The CRC-32 of these bytes is that of zip:
    // python3 -c 'import zlib; print(hex(zlib.crc32(bytes([3,2,0,3,0,0,0,0,0,0,0,2,1]))))'.
    let frame =
        Encoded::request(RequestHeader { number: 2, session: 3 }, &Request::Status { axis: 1 }).unwrap();
    let crc = CRC_OF_THE_EXAMPLE.to_le_bytes();
    let mut expected = vec![0, 3, 3, 2, 2, 3, 1, 1, 1, 1, 1, 1, 7, 2, 1];
    expected.extend(crc);
    expected.push(0);
    assert_eq!(frame.bytes(), expected);
}

const CRC_OF_THE_EXAMPLE: u32 = 0xf083_5dc4;

#[test]
fn another_version_is_told_by_its_number_and_never_read() {
    let frame = Encoded::request(HEADER, &Request::Begin { at: 1, moves: [1; 4] }).unwrap();
    let said = said(frame.bytes());
    let mut payload = said[0].clone().unwrap();
    for version in (0..=u8::MAX).filter(|version| *version != VERSION) {
        payload[0] = version;
        assert_eq!(RequestHeader::split(&payload), Err(FrameError::Version { version }));
        assert_eq!(RequestHeader::of_any_version(&payload), Some(HEADER));
        assert_eq!(AnswerHeader::split(&payload), Err(FrameError::Version { version }));
    }
    assert_eq!(body::<Request<'_>>(&[2, 1, 0]), Err(FrameError::Body), "a byte too many");
    assert_eq!(body::<Request<'_>>(&[99]), Err(FrameError::Body));
}

proptest! {
    #[test]
    fn a_flipped_bit_a_lost_byte_or_noise_never_makes_another_frame(
        place in any::<prop::sample::Index>(),
        bit in 0..8_u8,
        lose in any::<bool>(),
        noise in prop::collection::vec(any::<u8>(), 0..300),
    ) {
        let frame = Encoded::request(HEADER, &Request::Begin { at: 12_345, moves: [7; 4] }).unwrap();
        let right = said(frame.bytes());
        let mut bytes = frame.bytes().to_vec();
        let place = place.index(bytes.len());
        if lose { let _ = bytes.remove(place); } else { bytes[place] ^= 1 << bit; }
        for frame in said(&bytes).into_iter().flatten() {
            // A zero at an end may be lost without harm.
            prop_assert_eq!(&frame, right[0].as_ref().unwrap());
        }
        // After any noise the next frame is found.
        let mut after = noise;
        after.extend(frame.bytes());
        let after = said(&after);
        prop_assert_eq!(after.last(), right.last());
    }
}

#[test]
fn the_readme_names_the_version_of_the_protocol() {
    let readme = include_str!("../README.md");
    assert!(
        readme.contains(&format!(
            "| version of the protocol, {VERSION} | version of the protocol, {VERSION} |"
        ))
    );
}
