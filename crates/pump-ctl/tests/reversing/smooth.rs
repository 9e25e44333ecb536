//! Claims about smooth flows, which pass the reversal as fast as they may.

use pump_ctl::plan::{Cruise, Phase, Request};

use crate::heads::Head;
use crate::planned;

#[test]
fn a_smooth_flow_passes_the_reversal_faster_and_says_what_ripple_is_left() {
    let head = Head::reference();
    let pump = head.pump();
    for volume_ml in [30.0, -30.0] {
        let request = Request::new(volume_ml, Cruise::Flow { ml_s: 3.0 });
        let even = planned(&pump, Phase::known(0.3), &request, 12_800.0).unwrap();
        let smooth = planned(&pump, Phase::known(0.3), &request.with_smooth(true), 12_800.0).unwrap();
        assert_eq!((even.steps(), even.planned_ml()), (smooth.steps(), smooth.planned_ml()));
        let ripples = smooth.ripples(&pump);
        // Below zero at its least, the flow cannot be even. But it is more even than at constant speed.
        assert!(ripples.after.rms < 0.6 * ripples.before.rms, "{ripples:?}");
        assert!(ripples.after.peak_to_peak > 1.0, "{ripples:?}");
        let outflow = (ripples.outflow_before.unwrap(), ripples.outflow_after.unwrap());
        assert!(outflow.1.rms < outflow.0.rms, "{ripples:?}");
        // The speed over the reversal and beside it, in the middle of the dose.
        let (reversal_rad, beside_rad) = (28.0_f64.to_radians(), 80.0_f64.to_radians());
        let pitch = (0.5 * smooth.end_angle_rad() / head.pitch_rad()).floor();
        let speed = |local_rad: f64| {
            let angle_rad = pitch * head.pitch_rad() + local_rad;
            let count = ((angle_rad - 0.3) / smooth.step_rad()).abs().round() as u64;
            smooth.speed_after(count)
        };
        assert!(
            speed(reversal_rad) > 3.0 * speed(beside_rad),
            "{} {}",
            speed(reversal_rad),
            speed(beside_rad)
        );
        assert!(smooth.profile().peak_rad_s() <= 17.8 * (1.0 + 1e-12));
    }
}

#[test]
fn the_ripple_of_a_smooth_flow_is_that_of_an_independent_sum_over_its_time() {
    let head = Head::reference();
    let pump = head.pump();
    let request = Request::new(200.0, Cruise::Flow { ml_s: 3.0 }).with_smooth(true);
    let plan = planned(&pump, Phase::known(0.3), &request, 12_800.0).unwrap();
    // Over whole pitches far from both ends of the dose.
    let time_of = |angle_rad: f64| plan.profile().time_of(angle_rad - 0.3);
    let (from_s, to_s) = (time_of(8.0 * head.pitch_rad()), time_of(20.0 * head.pitch_rad()));
    const LOOKS: u32 = 400_000;
    let flows = (0..LOOKS).map(|n| {
        let time_s = from_s + (to_s - from_s) * (f64::from(n) + 0.5) / f64::from(LOOKS);
        head.flow_ml_rad(plan.angle_at(time_s)) * plan.speed_at(time_s)
    });
    let (sum, square, low, high) = flows.fold((0.0, 0.0, f64::INFINITY, f64::NEG_INFINITY), |all, flow| {
        (all.0 + flow, all.1 + flow * flow, all.2.min(flow), all.3.max(flow))
    });
    let mean = sum / f64::from(LOOKS);
    let rms = (square / f64::from(LOOKS) - mean * mean).sqrt() / mean;
    let ripple = plan.ripples(&pump).after;
    assert!((mean - 3.0).abs() < 1e-3, "{mean}");
    assert!((ripple.rms - rms).abs() < 1e-3, "{ripple:?} {rms}");
    assert!((ripple.peak_to_peak - (high - low) / mean).abs() < 0.02, "{ripple:?} {}", (high - low) / mean);
}
