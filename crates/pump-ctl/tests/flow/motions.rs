//! The motion of a whole flow: its steps by number, its segments, its stop and its pressures.

use pump_ctl::plan::{
    FlowError, FlowKnot, FlowMotion, FlowPace, FlowPlan, FlowRow, Limits, Lowest, Phase, PressureLimits,
    SetBy, Step,
};
use pump_ctl::step::{TickRate, Ticks};
use pump_model::{ExactRun, Leg, LineState, Port, Pump};

use crate::{STEP_RAD, motor, rows};

/// A flow with a pause, a step and a way back to rest.
const FLOW: [(f64, f64); 7] =
    [(0.0, 0.0), (3.0, 2.0), (5.0, 2.0), (5.5, 0.0), (7.0, 0.0), (9.0, 1.2), (12.0, 0.0)];

/// Returns the knots and the speeds of a flow.
pub(crate) fn planned(pump: &Pump, start_rad: f64, of: &[FlowRow]) -> (Vec<FlowKnot>, FlowPace) {
    let mut plan = FlowPlan::new(pump, motor(), Phase::known(start_rad)).unwrap();
    let mut knots = Vec::new();
    for row in of {
        plan.take(*row).unwrap();
        knots.extend(plan.knot());
    }
    (knots, plan.end().unwrap())
}

#[test]
fn a_motion_tells_the_time_of_every_step_of_its_plan_by_its_number() {
    let pump = Pump::three_roller();
    for sign in [1.0, -1.0] {
        let of: Vec<_> =
            rows(&FLOW).iter().map(|row| FlowRow::new(row.time_s, sign * row.flow_ml_s)).collect();
        let (knots, pace) = planned(&pump, 0.4, &of);
        let motion = FlowMotion::new(&pump, motor(), Phase::known(0.4), &knots, pace);
        let steps = crate::steps(&pump, 0.4, &of).unwrap();
        assert_eq!(motion.steps(), sign as i64 * steps.len() as i64);
        for step in &steps {
            assert_eq!(motion.time_of(step.number), step.time_s);
            assert_eq!(motion.angle_after(step.number), step.angle_rad);
        }
        assert!(motion.each_step().eq(steps.iter().copied()));
        assert_eq!((motion.time_of(0), motion.duration_s()), (0.0, 12.0));
        let longest = steps.windows(2).map(|pair| pair[1].time_s - pair[0].time_s).fold(0.0, f64::max);
        assert!((pace.longest_interval_s - longest).abs() < 1e-9 && longest > 1.5, "{longest}");
    }
}

#[test]
fn segments_hold_every_step_within_a_quarter_of_a_tick() {
    let pump = Pump::three_roller();
    let (knots, pace) = planned(&pump, 0.4, &rows(&FLOW));
    let motion = FlowMotion::new(&pump, motor(), Phase::known(0.4), &knots, pace);
    let fixed = |ticks: Ticks| (i128::from(ticks.whole) << 32) + i128::from(ticks.frac);
    let (mut at, mut number, mut segments) = (0_i128, 0_u64, 0);
    for segment in motion.segments(TickRate::from_hz(1_000_000).unwrap()) {
        segments += 1;
        for k in 1..=segment.steps() {
            at += fixed(segment.interval_before(k));
            number += 1;
            let (due, wanted) = (at as f64 / 4_294_967_296.0, 1e6 * motion.time_of(number));
            assert!((due - wanted).abs() <= 0.26, "step {number}: {due} {wanted}");
        }
    }
    assert_eq!(number, motion.steps().unsigned_abs());
    // A segment a step would load a link for nothing.
    assert!(segments * 6 < number, "{segments} segments of {number} steps");
}

#[test]
fn a_stop_leads_from_the_flows_speed_to_rest_within_the_flows_own_steps() {
    let pump = Pump::three_roller();
    let (knots, pace) = planned(&pump, 0.4, &rows(&FLOW));
    let motion = FlowMotion::new(&pump, motor(), Phase::known(0.4), &knots, pace);
    let all = motion.steps().unsigned_abs();
    let mut stops = 0;
    for made in (0..=all).step_by(97) {
        let Some(stop) = motion.stop(&pump, made) else { continue };
        stops += 1;
        assert!(made + stop.steps().unsigned_abs() <= all);
        assert_eq!(stop.start().angle_rad(), motion.angle_after(made));
        let first: Step = stop.each_step().next().unwrap();
        // The first step of the stop comes when the rotor gets there at the flow's speed, or later.
        assert!(first.time_s >= STEP_RAD / motion.speed_after(made) * 0.999, "{made}");
        assert!(stop.profile().duration_s() < 1.01 * motion.speed_after(made) / 500.0 + 0.05, "{made}");
    }
    assert!(stops > 50, "{stops}");
    assert!(motion.stop(&pump, 0).is_none() && motion.stop(&pump, all).is_none());
}

#[test]
fn the_smooth_motion_has_the_flow_of_the_rows_at_the_outlet() {
    let pump = Pump::three_roller();
    let of = rows(&FLOW);
    let (knots, pace) = planned(&pump, 0.4, &of);
    let motion = FlowMotion::new(&pump, motor(), Phase::known(0.4), &knots, pace);
    let (mut last, mut worst): (Option<Leg>, f64) = (None, 0.0);
    for leg in motion.legs() {
        if let Some(before) = last {
            assert!((before.end_s() - leg.start_s).abs() < 1e-9);
            assert!((before.end_angle_rad() - leg.angle_rad).abs() < 1e-9);
        }
        for part in [0.0, 0.3, 0.7, 0.999] {
            let time_s = leg.start_s + part * leg.duration_s;
            let flow_ml_s = pump.outlet_curve().flow_ml_rad(leg.angle_at(time_s)) * leg.speed_at(time_s);
            let pair = of.windows(2).find(|pair| pair[1].time_s > time_s).unwrap();
            let slope = (pair[1].flow_ml_s - pair[0].flow_ml_s) / (pair[1].time_s - pair[0].time_s);
            let wanted = pair[0].flow_ml_s + slope * (time_s - pair[0].time_s);
            worst = worst.max((flow_ml_s - wanted).abs());
        }
        last = Some(leg);
    }
    assert!(worst < 0.06, "{worst} mL/s");
}

#[test]
fn pressures_are_those_of_a_line_that_follows_the_flow() {
    let pump = Pump::three_roller();
    let (knots, pace) = planned(&pump, 0.4, &rows(&FLOW));
    let motion = FlowMotion::new(&pump, motor(), Phase::known(0.4), &knots, pace);
    let (predicted, _) = motion.predict(&pump, &Limits::new(motor())).unwrap();
    // A slow flow drops R q and moves the fluid by L q', and nothing swings: at 2 mL/s just before 5 s.
    let line = pump.outlet();
    let expected = line.reservoir_kpa + line.resistance_kpa_s_ml * 2.0;
    assert!((predicted.outlet.max_kpa - expected).abs() < 0.15, "{} {expected}", predicted.outlet.max_kpa);
    let mut run = ExactRun::new(&pump, Port::Outlet, motion.legs(), LineState::AT_REST);
    assert!((run.pressure_kpa(4.9) - expected).abs() < 0.02);
    assert!(predicted.settle_s < 2.0 && predicted.step_kpa > 0.0);
    assert!(motion.back_flow(&pump).unwrap().backflow_ml < 0.01);
}

#[test]
fn a_pressure_beyond_its_limit_is_refused_at_the_first_instant() {
    let pump = Pump::three_roller();
    let (knots, pace) = planned(&pump, 0.4, &rows(&FLOW));
    let motion = FlowMotion::new(&pump, motor(), Phase::known(0.4), &knots, pace);
    let line = pump.outlet();
    let limit_kpa = line.reservoir_kpa + line.resistance_kpa_s_ml * 1.5;
    let pressures = PressureLimits { max_outlet_kpa: Some(limit_kpa), ..PressureLimits::NONE };
    let refused = motion.predict(&pump, &Limits::new(motor()).with_pressures(pressures)).unwrap_err();
    let FlowError::Pressure { row, time_s, port, reached_kpa, is_most, .. } = refused else {
        panic!("{refused}")
    };
    assert_eq!((row, port, is_most), (2, Port::Outlet, true));
    // The flow is 1.5 mL/s after 2.25 s; the motor's steps take some of the room, since they are as slow as the line
    // swings where the flow begins.
    assert!((0.8..2.3).contains(&time_s) && reached_kpa > limit_kpa, "{refused}");
    let lowest = Lowest { kpa: pump.inlet().reservoir_kpa - 0.05, set_by: SetBy::TubeCollapse };
    let refused = motion.predict(&pump, &Limits::new(motor()).with_lowest(lowest)).unwrap_err();
    assert!(refused.to_string().contains("at which the tube would collapse"), "{refused}");
    assert!(matches!(refused, FlowError::Pressure { is_most: false, .. }), "{refused}");
}
