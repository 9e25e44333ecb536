//! Segments of real plans in a few bytes, within a tenth of a tick of the plan.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use proptest::prelude::*;
use pump_ctl::plan::{Cruise, Doser, Limits, Motor, Phase, Plan, Request};
use pump_ctl::step::{Segment, TickRate};
use pump_link::packing::{Codec, Grain, MAX_PACKED_SEGMENT, PackError, Rounder};
use pump_model::Pump;

const TICK_RATE: TickRate = TickRate::from_hz(1_000_000).unwrap();

fn plan(pump: &Pump, volume_ml: f64, ml_s: f64, smooth: bool) -> Plan {
    let motor = Motor::new(12_800.0, 17.8, 500.0);
    let request = Request::new(volume_ml, Cruise::Flow { ml_s });
    let request = if smooth { request.with_smooth(true) } else { request };
    Doser::new(pump, Limits::new(motor)).unwrap().plan(Phase::known(0.3), &request).unwrap()
}

/// Packs segments into frames of `room` bytes, and returns the bytes of each segment.
fn packed(segments: &[Segment], room: usize) -> Vec<usize> {
    let mut sizes = Vec::new();
    let mut frame = vec![0; room];
    let mut rest = &mut frame[..];
    let mut codec = Codec::new(Grain::Fine);
    for segment in segments {
        let before = rest.len();
        if codec.write(segment, &mut rest) == Err(PackError::Full) {
            codec = Codec::new(Grain::Fine);
            frame = vec![0; room];
            rest = &mut frame[..];
            codec.write(segment, &mut rest).unwrap();
            sizes.push(room - rest.len());
        } else {
            sizes.push(before - rest.len());
        }
    }
    sizes
}

#[test]
fn measure() {
    for (name, pump) in [("three", Pump::three_roller()), ("two", Pump::two_roller())] {
        for smooth in [true, false] {
            for ml_s in [0.1, 1.0, 4.0, 8.0] {
                let plan = plan(&pump, 25.0_f64.min(ml_s * 20.0), ml_s, smooth);
                let mut rounder = Rounder::default();
                let segments: Vec<_> =
                    plan.segments(TICK_RATE).map(|segment| rounder.round(segment).unwrap()).collect();
                let sizes = packed(&segments, 200);
                let all: usize = sizes.iter().sum();
                // largest bytes in 100 ms windows and segments
                let mut at = 0_u64;
                let mut windows = std::collections::BTreeMap::<u64, (usize, usize)>::new();
                for (segment, size) in segments.iter().zip(&sizes) {
                    let w = windows.entry(at / 100_000).or_default();
                    w.0 += size;
                    w.1 += 1;
                    at += segment.duration().whole;
                }
                let peak = windows.values().max().unwrap();
                let most = windows.values().map(|w| w.1).max().unwrap();
                println!(
                    "{name} smooth {smooth} {ml_s} mL/s: {} segments {:.2} bytes each, max {}, mean {:.2} kB/s, peak {:.2} kB/s, {most} in 100 ms",
                    segments.len(),
                    all as f64 / segments.len() as f64,
                    sizes.iter().max().unwrap(),
                    all as f64 / (at as f64 / 1e6) / 1e3,
                    peak.0 as f64 / 0.1 / 1e3
                );
            }
        }
    }
    let _ = (MAX_PACKED_SEGMENT,);
}

proptest! {
    #[test]
    fn x(_a in 0..1) {}
}
