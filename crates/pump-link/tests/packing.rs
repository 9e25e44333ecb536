//! Segments of real plans in a few bytes, each step within a tenth of a tick of the plan.

#![allow(clippy::unwrap_used, reason = "a test may panic")]
#![allow(clippy::print_stdout, reason = "the figures of the README")]

use std::collections::BTreeMap;

use proptest::prelude::*;
use pump_ctl::plan::{Cruise, Doser, Limits, Motor, Phase, Request};
use pump_ctl::step::{Segment, TickRate};
use pump_link::message::MAX_PACKED;
use pump_link::packing::{Codec, Grain, MAX_PACKED_SEGMENT, PackError, Rounder};
use pump_link::sender::{Demand, FRAME_OVERHEAD};
use pump_model::Pump;

const TICK_RATE: TickRate = TickRate::from_hz(1_000_000).unwrap();

/// Bytes a second of a serial line at 460,800 baud, ten bits a byte.
const LINE_BYTES_S: u32 = 46_080;

fn segments(pump: &Pump, volume_ml: f64, ml_s: f64, smooth: bool) -> Vec<Segment> {
    let motor = Motor::new(12_800.0, 17.8, 500.0);
    let request = Request::new(volume_ml, Cruise::Flow { ml_s }).with_smooth(smooth);
    let plan = Doser::new(pump, Limits::new(motor)).unwrap().plan(Phase::known(0.3), &request).unwrap();
    plan.segments(TICK_RATE).collect()
}

fn rounded(segments: &[Segment]) -> Vec<Segment> {
    let mut rounder = Rounder::default();
    segments.iter().map(|segment| rounder.round(*segment).unwrap()).collect()
}

/// Packs segments into frames of `room` bytes. Returns the bytes of each segment, and what the other end reads.
fn packed(segments: &[Segment], room: usize, grain: Grain) -> (Vec<usize>, Vec<Segment>) {
    let (mut sizes, mut read) = (Vec::new(), Vec::new());
    let mut to_come = segments;
    while !to_come.is_empty() {
        let mut frame = vec![0; room];
        let mut rest = &mut frame[..];
        let mut codec = Codec::new(grain);
        while let [segment, others @ ..] = to_come {
            let before = rest.len();
            match codec.write(segment, &mut rest) {
                Ok(()) => sizes.push(before - rest.len()),
                Err(PackError::Full) => break,
                Err(refused) => panic!("{refused}"),
            }
            to_come = others;
        }
        let used = room - rest.len();
        let (mut codec, mut bytes) = (Codec::new(grain), &frame[..used]);
        while !bytes.is_empty() {
            read.push(codec.read(&mut bytes).unwrap());
        }
    }
    (sizes, read)
}

/// Returns the times of all steps since the start, 2^-32 tick.
fn times(segments: &[Segment]) -> Vec<i128> {
    let mut at = 0_i128;
    let mut times = Vec::new();
    for segment in segments {
        let first = (i128::from(segment.interval) << 32) | i128::from(segment.frac);
        for k in 0..i128::from(segment.steps()) {
            at += first + i128::from(segment.add) * k;
            times.push(at);
        }
    }
    times
}

#[test]
fn smooth_plans_take_less_than_four_bytes_a_segment_and_four_axes_fit_the_line() {
    // Bounds of the figures in the README: bytes a segment, kB/s of four axes where a plan needs most.
    for (ml_s, bytes, kb_s) in [(1.0, 3.5, 7.0), (4.0, 3.5, 14.0), (8.0, 3.5, 16.0)] {
        let plan = rounded(&segments(&Pump::three_roller(), 25.0, ml_s, true));
        let (sizes, read) = packed(&plan, MAX_PACKED, Grain::Fine);
        assert_eq!(read, plan);
        let mean = sizes.iter().sum::<usize>() as f64 / plan.len() as f64;
        assert!(mean < bytes && sizes.iter().all(|size| *size <= MAX_PACKED_SEGMENT), "{mean}");
        let mut windows = BTreeMap::<u64, usize>::new();
        let mut at = 0;
        let mut demand = Demand::<256>::new(1_000_000, LINE_BYTES_S / 4);
        for (segment, size) in plan.iter().zip(&sizes) {
            // The frame's own bytes are shared by the segments in it.
            let share = size * (MAX_PACKED + FRAME_OVERHEAD) / MAX_PACKED + 1;
            *windows.entry(at / 100_000).or_default() += share;
            demand.segment(segment, u32::try_from(share).unwrap()).unwrap();
            at += segment.duration().whole;
        }
        let peak = 4.0 * *windows.values().max().unwrap() as f64 / 100.0;
        println!("{ml_s} mL/s: {} segments, {mean:.2} bytes each, four axes {peak:.1} kB/s", plan.len());
        assert!(peak < kb_s, "{peak}");
    }
}

#[test]
fn rounding_moves_no_step_by_more_than_a_tenth_of_a_tick() {
    for (pump, smooth, ml_s) in [
        (Pump::three_roller(), true, 4.0_f64),
        (Pump::two_roller(), true, 1.0),
        (Pump::three_roller(), false, 25.0),
        (Pump::two_roller(), false, 0.01),
    ] {
        let plan = segments(&pump, f64::min(20.0 * ml_s, 50.0), ml_s, smooth);
        let (exact, sent) = (times(&plan), times(&rounded(&plan)));
        assert_eq!(exact.len(), sent.len());
        let off = exact.iter().zip(&sent).map(|(exact, sent)| (exact - sent).abs()).max().unwrap();
        assert!(off as f64 / (1_u64 << 32) as f64 <= 0.1, "{off}");
    }
}

#[test]
fn a_brake_crosses_to_its_last_bit() {
    for acceleration in [0.5, 20.0, 500.0] {
        let brake = Motor::new(12_800.0, 17.8, acceleration).brake(TICK_RATE).unwrap();
        let climb: Vec<_> = brake.climb().copied().collect();
        let (sizes, read) = packed(&climb, MAX_PACKED, Grain::Exact);
        assert_eq!(read, climb);
        assert!(sizes.iter().sum::<usize>() < 3 * MAX_PACKED);
    }
}

#[test]
fn segments_that_were_not_rounded_are_refused() {
    let segment = Segment { count: 3, interval: 1000, add: 1, frac: 1 };
    let (mut bytes, mut codec) = ([0; 64], Codec::new(Grain::Fine));
    assert_eq!(codec.write(&segment, &mut &mut bytes[..]), Err(PackError::Grain));
    assert_eq!(codec.write(&Segment { count: 0, ..segment }, &mut &mut bytes[..]), Err(PackError::Segment));
    assert_eq!(Rounder::default().round(Segment { interval: 0, ..segment }), Err(PackError::Segment));
}

fn any_segment() -> impl Strategy<Value = Segment> {
    let count =
        prop_oneof![1..100_i32, 1..i32::MAX, Just(1)].prop_flat_map(|n| prop_oneof![Just(n), Just(-n)]);
    (count, 1..1_u64 << 40, prop_oneof![Just(0_i64), -(1 << 40)..1_i64 << 40], any::<u32>())
        .prop_map(|(count, interval, add, frac)| Segment { count, interval, add, frac })
        .prop_filter("a segment that can be made", Segment::is_valid)
}

proptest! {
    #[test]
    fn any_segments_come_back(segments in prop::collection::vec(any_segment(), 1..40)) {
        // A segment of one step has no change of interval.
        let exact = |s: &Segment| Segment { add: if s.steps() > 1 { s.add } else { 0 }, ..*s };
        let exact: Vec<_> = segments.iter().map(exact).collect();
        prop_assert_eq!(packed(&exact, MAX_PACKED, Grain::Exact).1, exact);
        let mut rounder = Rounder::default();
        let sent: Vec<_> = segments.iter().filter_map(|segment| rounder.round(*segment).ok()).collect();
        let (_, read) = packed(&sent, MAX_PACKED, Grain::Fine);
        prop_assert_eq!(read, sent);
    }

    #[test]
    fn any_bytes_are_valid_segments_or_refused(bytes in prop::collection::vec(any::<u8>(), 0..80)) {
        let (mut codec, mut rest) = (Codec::new(Grain::Fine), &bytes[..]);
        while let Ok(segment) = codec.read(&mut rest) {
            prop_assert!(segment.is_valid());
        }
    }
}
