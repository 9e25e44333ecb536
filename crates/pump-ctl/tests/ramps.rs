//! Claims about line-aware ramps: back flow and time, against an outlet line that this file integrates itself.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use std::f64::consts::{PI, TAU};

use pump_ctl::plan::{
    Cruise, Doser, Limits, Motor, Phase, Plan, PressureLimits, Ramps, Request, Retarget, Torque, TorqueCurve,
};
use pump_model::{Line, Pump, Variant};

const MOTOR: Motor = Motor::new(12_800.0, 17.8, 500.0);

/// The paper's polynomial of the roller volume, highest order first, mL over degrees.
const ROLLER: [f64; 6] = [
    1.3157682477570371e-8,
    -1.2381057474044833e-6,
    -8.751039956479692e-6,
    2.7926272254840817e-3,
    -3.158742581049441e-3,
    -2.870791521667906e-4,
];

/// Flow per radian at the outlet of three rollers, mL/rad, from the paper's figures.
fn flow_ml_rad(angle_rad: f64) -> f64 {
    let nominal = PI * 5.0 * 5.0 * (63.0 - 7.0) / 1000.0;
    let x = 50.53 - angle_rad.rem_euclid(TAU / 3.0).to_degrees();
    if x < 0.0 {
        return nominal;
    }
    let slope = ROLLER.iter().take(5).enumerate().fold(0.0, |sum, (n, c)| sum * x + (5 - n) as f64 * c);
    nominal - slope.max(0.0).to_degrees()
}

/// The paper's line, with a compliance that is off by a factor.
struct OutletLine {
    compliance: f64,
}

/// A dose as the vessel sees it.
#[derive(Debug)]
struct Seen {
    backflow_ml: f64,
    /// Motion and settling to 1 uL, the last step's volume at once.
    time_s: f64,
}

impl OutletLine {
    const R: f64 = 0.1108;
    const L: f64 = 0.0042;

    fn off_by(factor: f64) -> Self {
        Self { compliance: 0.0361 * factor }
    }

    /// Rates of pressure, line flow and delivered volume.
    fn rates(&self, [p, q, _]: [f64; 3], rollers: f64) -> [f64; 3] {
        [(rollers - q) / self.compliance, (p - Self::R * q) / Self::L, q]
    }

    /// A step of the classical Runge-Kutta method with the flows at its start, middle and end.
    fn step(&self, x: [f64; 3], h: f64, [begin, middle, end]: [f64; 3]) -> [f64; 3] {
        let on = |k: [f64; 3], h: f64| [x[0] + h * k[0], x[1] + h * k[1], x[2] + h * k[2]];
        let k1 = self.rates(x, begin);
        let k2 = self.rates(on(k1, 0.5 * h), middle);
        let k3 = self.rates(on(k2, 0.5 * h), middle);
        let k4 = self.rates(on(k3, h), end);
        [0, 1, 2].map(|i| x[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]))
    }

    /// Follows a plan from rest, and the line for two seconds after it.
    fn follow(&self, plan: &Plan) -> Seen {
        let sign = if plan.steps() < 0 { -1.0 } else { 1.0 };
        let end_s = plan.profile().duration_s();
        let flow = |t: f64| flow_ml_rad(plan.angle_at(t)) * plan.speed_at(t);
        let mut x = [0.0; 3];
        let mut most_ml: f64 = 0.0;
        let count = (end_s / 2.5e-4).ceil();
        let h = end_s / count;
        for n in 0..count as u32 {
            let t = f64::from(n) * h;
            x = self.step(x, h, [flow(t), flow(t + 0.5 * h), flow((t + h).min(end_s - 1e-12))]);
            most_ml = most_ml.max(sign * x[2]);
        }
        let step_ml = flow_ml_rad(plan.end_angle_rad()) * sign * plan.step_rad();
        let mut stepped = [x[0] + step_ml / self.compliance, x[1], 0.0];
        let (h, mut settle_s) = (1e-4, 0.0);
        for n in 0..20_000 {
            x = self.step(x, h, [0.0; 3]);
            most_ml = most_ml.max(sign * x[2]);
            if (self.compliance * stepped[0]).abs() >= 1e-3 {
                settle_s = f64::from(n) * h;
            }
            stepped = self.step(stepped, h, [0.0; 3]);
        }
        Seen { backflow_ml: most_ml - sign * x[2], time_s: end_s + settle_s }
    }
}

fn plan(pump: &Pump, start_rad: f64, request: &Request) -> Plan {
    Doser::new(pump, Limits::new(MOTOR)).unwrap().plan(Phase::known(start_rad), request).unwrap()
}

/// Returns the largest back flow in uL and the mean time over start angles, for a compliance off by a factor.
fn seen(request: &Request, factor: f64, angles: u32) -> (f64, f64) {
    let pump = Pump::three_roller();
    let line = OutletLine::off_by(factor);
    let (mut worst_ul, mut time_s) = (0.0_f64, 0.0);
    for n in 0..angles {
        let start_rad = pump.pitch_rad() * f64::from(n) / f64::from(angles);
        let seen = line.follow(&plan(&pump, start_rad, request));
        worst_ul = worst_ul.max(1e3 * seen.backflow_ml);
        time_s += seen.time_s / f64::from(angles);
    }
    (worst_ul, time_s)
}

fn asked(volume_ml: f64, ml_s: f64) -> Request {
    Request::new(volume_ml, Cruise::Flow { ml_s })
}

#[test]
fn a_millilitre_takes_3_microlitres_back_at_most_and_is_settled_in_0_4_s() {
    let (worst_ul, time_s) = seen(&asked(1.0, 5.0), 1.0, 36);
    assert!(worst_ul < 3.0 && time_s < 0.40, "{worst_ul} uL, {time_s} s");
    for factor in [0.8, 1.2] {
        let (worst_ul, _) = seen(&asked(1.0, 5.0), factor, 36);
        assert!(worst_ul < 8.0, "{worst_ul} uL where C is {factor} of what is known");
    }
    let (fast_ul, fast_s) = seen(&asked(1.0, 5.0).with_ramps(Ramps::Fastest), 1.0, 36);
    assert!(fast_ul > 60.0 && fast_s > 0.5, "{fast_ul} uL, {fast_s} s");
}

#[test]
fn three_fast_millilitres_take_6_microlitres_back_at_most_and_are_settled_in_0_52_s() {
    let (worst_ul, time_s) = seen(&asked(3.0, 15.0), 1.0, 36);
    assert!(worst_ul < 6.0 && time_s < 0.52, "{worst_ul} uL, {time_s} s");
    for factor in [0.8, 1.2] {
        let (worst_ul, _) = seen(&asked(3.0, 15.0), factor, 36);
        assert!(worst_ul < 10.0, "{worst_ul} uL where C is {factor} of what is known");
    }
    let (fast_ul, _) = seen(&asked(3.0, 15.0).with_ramps(Ramps::Fastest), 1.0, 36);
    assert!(fast_ul > 200.0, "{fast_ul} uL");
}

#[test]
fn a_long_dose_is_settled_sooner_than_with_the_fastest_ramps() {
    let (worst_ul, time_s) = seen(&asked(25.0, 5.0), 1.0, 12);
    assert!(worst_ul < 3.0 && time_s < 5.19, "{worst_ul} uL, {time_s} s");
    let (_, fastest_s) = seen(&asked(25.0, 5.0).with_ramps(Ramps::Fastest), 1.0, 12);
    assert!(fastest_s > 5.25, "{fastest_s} s");
}

#[test]
fn small_and_reverse_doses_take_little_back_too() {
    for (volume_ml, ml_s) in [(0.05, 5.0), (0.3, 5.0), (-1.0, 5.0), (-0.05, 5.0), (1.0, 1.0)] {
        let (worst_ul, _) = seen(&asked(volume_ml, ml_s), 1.0, 12);
        assert!(worst_ul < 3.0, "{volume_ml} mL: {worst_ul} uL");
    }
}

/// Half a step's volume is 0.83 uL on average: 21.3185 mL in 12,800 steps.
#[test]
fn a_small_dose_takes_back_a_hundredth_of_its_volume_or_half_a_step() {
    for (volume_ml, ml_s) in [(0.005, 5.0), (0.05, 5.0), (-0.05, 15.0), (0.05, 1.0), (0.1, 5.0), (0.2, 5.0)] {
        let (worst_ul, time_s) = seen(&asked(volume_ml, ml_s), 1.0, 24);
        let limit_ul = f64::max(0.83, 10.0 * volume_ml.abs());
        assert!(worst_ul < limit_ul + 0.1, "{volume_ml} mL at {ml_s} mL/s: {worst_ul} uL");
        for factor in [0.8, 1.2] {
            let (worst_ul, _) = seen(&asked(volume_ml, ml_s), factor, 24);
            assert!(worst_ul < limit_ul + 0.4, "{worst_ul} uL where C is {factor} of what is known");
        }
        // Still sooner than with the fastest ramps, which take 0.28 s for 50 uL.
        let (_, fastest_s) = seen(&asked(volume_ml, ml_s).with_ramps(Ramps::Fastest), 1.0, 24);
        assert!(time_s < 0.85 * fastest_s, "{volume_ml} mL at {ml_s} mL/s: {time_s} {fastest_s}");
    }
}

#[test]
fn the_plans_own_back_flow_is_that_of_the_plain_integration() {
    let pump = Pump::three_roller();
    for start_rad in [0.1, 0.9, 1.7] {
        let plan = plan(&pump, start_rad, &asked(3.0, 15.0));
        let seen = OutletLine::off_by(1.0).follow(&plan);
        let exact_ml = plan.back_flow(&pump).unwrap().backflow_ml;
        assert!((exact_ml - seen.backflow_ml).abs() < 5e-5, "{exact_ml} {}", seen.backflow_ml);
        let exact_s = plan.profile().duration_s() + plan.predict(&pump).unwrap().settle_s;
        assert!((exact_s - seen.time_s).abs() < 2e-3, "{exact_s} {}", seen.time_s);
    }
}

/// Checks that the legs of a plan join, stay within the acceleration and the speed, and end at the last step at rest.
fn check_legs(plan: &Plan, motor: Motor) {
    let mut angle_rad = plan.start().angle_rad();
    let mut speed_rad_s: Option<f64> = None;
    let mut time_s = 0.0;
    for leg in plan.legs() {
        let near = |a: f64, b: f64| (a - b).abs() < 1e-7 * (1.0 + a.abs());
        assert!(near(leg.angle_rad, angle_rad) && near(leg.start_s, time_s), "{leg:?} {angle_rad} {time_s}");
        assert!(speed_rad_s.is_none_or(|speed| near(speed, leg.speed_rad_s)), "{leg:?} {speed_rad_s:?}");
        assert!(leg.duration_s >= 0.0, "{leg:?}");
        assert!(leg.acceleration_rad_s2.abs() <= motor.max_acceleration_rad_s2 * (1.0 + 1e-9), "{leg:?}");
        assert!(leg.speed_rad_s.abs() <= motor.max_speed_rad_s * (1.0 + 1e-9), "{leg:?}");
        (angle_rad, time_s) = (leg.end_angle_rad(), leg.end_s());
        speed_rad_s = Some(leg.speed_at(leg.end_s()));
    }
    assert!(speed_rad_s.unwrap().abs() < 1e-6, "{speed_rad_s:?}");
    assert!((angle_rad - plan.end_angle_rad()).abs() < 1e-7, "{angle_rad} {}", plan.end_angle_rad());
    let mut before_s = 0.0;
    for step in plan.each_step() {
        assert!(step.time_s >= before_s, "step {} at {} after {before_s}", step.number, step.time_s);
        assert!((plan.angle_at(step.time_s) - step.angle_rad).abs() < 1e-7, "{step:?}");
        before_s = step.time_s;
    }
}

#[test]
fn ramps_change_no_step_and_no_end_and_keep_to_the_motor() {
    let fast_line = Line { compliance_ml_kpa: 1e-4, inertance_kpa_s2_ml: 1e-5, ..Line::PUBLISHED };
    let slow_line = Line { compliance_ml_kpa: 1.0, inertance_kpa_s2_ml: 0.1, ..Line::PUBLISHED };
    let creeping = Line { resistance_kpa_s_ml: 3.0, ..Line::PUBLISHED };
    let built_in = Pump::three_roller();
    let with = |line| Pump::new(*built_in.geometry(), *built_in.roller_volume(), line, line).unwrap();
    let pumps = [
        built_in,
        with(fast_line),
        with(slow_line),
        with(creeping),
        Pump::preset(2, Variant::Measured).unwrap(),
    ];
    let motors = [MOTOR, MOTOR.with_max_acceleration_rad_s2(5.0), MOTOR.with_max_acceleration_rad_s2(1e5)];
    for pump in &pumps {
        for motor in motors {
            let doser = Doser::new(pump, Limits::new(motor)).unwrap();
            for volume_ml in [0.005, 0.3, -1.0, 4.0, -12.0] {
                for cruise in [Cruise::Flow { ml_s: 3.0 }, Cruise::Fastest] {
                    for smooth in [false, true] {
                        let request = Request::new(volume_ml, cruise).with_smooth(smooth);
                        let aware = doser.plan(Phase::known(0.7), &request).unwrap();
                        let fastest = request.with_ramps(Ramps::Fastest);
                        let fastest = doser.plan(Phase::known(0.7), &fastest).unwrap();
                        assert_eq!((aware.steps(), fastest.steps()), (fastest.steps(), aware.steps()));
                        assert_eq!(aware.end_angle_rad(), fastest.end_angle_rad());
                        assert_eq!((aware.ramps(), fastest.ramps()), (Ramps::LineAware, Ramps::Fastest));
                        check_legs(&aware, motor);
                        check_legs(&fastest, motor);
                    }
                }
            }
        }
    }
}

#[test]
fn the_fastest_ramps_are_one_leg_each_way_at_the_motors_acceleration() {
    let plan = plan(&Pump::three_roller(), 0.3, &asked(25.0, 5.0).with_ramps(Ramps::Fastest));
    let legs: Vec<_> = plan.legs().map(|leg| leg.acceleration_rad_s2).collect();
    assert_eq!(legs, [500.0, 0.0, -500.0]);
    // The turn at the speed, and half a ramp more at each end.
    let speed_rad_s = 5.0 * TAU / Pump::three_roller().revolution_ml();
    let expected_s = 15_287.0 * TAU / 12_800.0 / speed_rad_s + speed_rad_s / 500.0;
    assert!((plan.profile().duration_s() - expected_s).abs() < 1e-9, "{}", plan.profile().duration_s());
}

#[test]
fn a_line_that_creeps_is_settled_no_later_than_with_the_fastest_ramps() {
    let built_in = Pump::three_roller();
    let creeping = Line { resistance_kpa_s_ml: 3.0, ..Line::PUBLISHED };
    let pump = Pump::new(*built_in.geometry(), *built_in.roller_volume(), creeping, creeping).unwrap();
    let total_s = |ramps| {
        let plan = plan(&pump, 0.4, &asked(3.0, 15.0).with_ramps(ramps));
        assert!(plan.back_flow(&pump).unwrap().backflow_ml < 2.5e-3);
        plan.profile().duration_s() + plan.predict(&pump).unwrap().settle_s
    };
    let (aware_s, fastest_s) = (total_s(Ramps::LineAware), total_s(Ramps::Fastest));
    assert!(aware_s < fastest_s + 0.02, "{aware_s} {fastest_s}");
}

#[test]
fn a_changed_dose_stops_as_gently_as_a_dose_from_rest() {
    let pump = Pump::three_roller();
    let doser = Doser::new(&pump, Limits::new(MOTOR)).unwrap();
    for ramps in Ramps::ALL {
        let mut worst_ul = 0.0_f64;
        for start in [0.0, 0.5, 1.0, 1.5] {
            let whole = plan(&pump, start, &asked(25.0, 5.0).with_ramps(ramps));
            let rest =
                doser.retarget(&whole, &Retarget::new(6000, 20.0, Cruise::Flow { ml_s: 8.0 })).unwrap();
            assert_eq!(rest.ramps(), ramps);
            check_legs_from(&rest, &whole);
            worst_ul = worst_ul.max(1e3 * rest.back_flow(&pump).unwrap().backflow_ml);
        }
        let gentle = ramps == Ramps::LineAware;
        assert!(if gentle { worst_ul < 4.0 } else { worst_ul > 50.0 }, "{ramps}: {worst_ul}");
    }
}

/// Checks that the rest of a dose goes on at the speed of the whole, and ends at rest at its last step.
fn check_legs_from(rest: &Plan, whole: &Plan) {
    let first = rest.legs().next().unwrap();
    assert!((first.speed_rad_s - whole.speed_after(6000)).abs() < 1e-9);
    assert!((rest.angle_at(1e3) - rest.end_angle_rad()).abs() < 1e-9);
    assert!(rest.speed_after(rest.steps().unsigned_abs()) < 1e-6);
}

#[test]
fn a_change_that_leaves_no_room_for_gentle_ramps_still_stops_in_time() {
    let pump = Pump::three_roller();
    let doser = Doser::new(&pump, Limits::new(MOTOR)).unwrap();
    let whole = plan(&pump, 0.3, &asked(25.0, 60.0));
    let made = 6000;
    let least_ml = whole.delivered_ml(&pump, made) + whole.stop(&pump, made).unwrap().planned_ml();
    let rest = doser.retarget(&whole, &Retarget::new(made, least_ml + 0.01, Cruise::Fastest)).unwrap();
    check_legs_from(&rest, &whole);
    assert!((rest.before_ml() + rest.planned_ml() - least_ml - 0.01).abs() < 2e-3);
}

#[test]
fn a_stop_in_mid_dose_takes_the_motors_own_acceleration() {
    let pump = Pump::three_roller();
    let plan = plan(&pump, 0.3, &asked(25.0, 5.0));
    let stop = plan.stop(&pump, 6000).unwrap();
    let ways_down: Vec<_> =
        stop.legs().map(|leg| leg.acceleration_rad_s2).filter(|rad_s2| *rad_s2 < 0.0).collect();
    assert_eq!(ways_down, [-500.0]);
    assert_eq!(plan.stop_at(2.0).acceleration_rad_s2, -500.0);
    // On the way down of the dose itself the stop is sooner than its end.
    let made = plan.steps().unsigned_abs() - 60;
    assert!(plan.stop(&pump, made).unwrap().steps() < 60);
}

#[test]
fn limits_and_times_hold_with_the_ramps_that_are_chosen() {
    let pump = Pump::three_roller();
    let pressures = PressureLimits { max_outlet_kpa: Some(105.0), min_inlet_kpa: Some(70.0) };
    let curve = TorqueCurve::new(&[(0.0, 0.9), (17.8, 0.6)]).unwrap();
    let torque = Torque::new(88.637, curve).with_inertia_kg_m2(1e-3);
    let limits = Limits::new(MOTOR).with_pressures(pressures).with_torque(torque);
    let doser = Doser::new(&pump, limits).unwrap();
    for start in [Phase::known(0.2), Phase::known(1.4), Phase::within(0.5, 0.3)] {
        for volume_ml in [0.5, 12.0] {
            let fastest = doser.plan(start, &Request::new(volume_ml, Cruise::Fastest)).unwrap();
            let margins = limits.margins(&pump, &fastest);
            let used = [margins.inlet, margins.outlet, margins.torque].map(|margin| margin.unwrap().used);
            assert!(used.iter().all(|used| *used <= 1.0), "{used:?}");
            let takes_s = fastest.profile().duration_s() + fastest.predict(&pump).unwrap().settle_s;
            let time_s = takes_s + 1.0;
            let within = doser.plan(start, &Request::new(volume_ml, Cruise::Within { time_s })).unwrap();
            let total_s = within.profile().duration_s() + within.predict(&pump).unwrap().settle_s;
            assert!(total_s <= time_s, "{total_s} {time_s}");
        }
    }
}

#[test]
fn a_smooth_dose_stops_gently_too() {
    let pump = Pump::three_roller();
    let mut worst_ul = [0.0_f64; 2];
    for (worst_ul, ramps) in worst_ul.iter_mut().zip(Ramps::ALL) {
        for n in 0..12 {
            let start_rad = pump.pitch_rad() * f64::from(n) / 12.0;
            let request = asked(5.0, 5.0).with_smooth(true).with_ramps(ramps);
            let seen = OutletLine::off_by(1.0).follow(&plan(&pump, start_rad, &request));
            *worst_ul = worst_ul.max(1e3 * seen.backflow_ml);
        }
    }
    let [aware_ul, fastest_ul] = worst_ul;
    assert!(aware_ul < 4.0 && fastest_ul > 20.0, "{aware_ul} {fastest_ul}");
}

#[test]
fn an_unknown_angle_gets_ramps_that_suit_most_angles() {
    let pump = Pump::three_roller();
    let doser = Doser::new(&pump, Limits::new(MOTOR)).unwrap();
    let unknown = Phase::unknown(pump.pitch_rad());
    let worst_ul = |ramps| {
        let request = asked(10.0, 5.0).with_ramps(ramps);
        1e3 * doser.plan(unknown, &request).unwrap().back_flow(&pump).unwrap().backflow_ml
    };
    let (aware_ul, fastest_ul) = (worst_ul(Ramps::LineAware), worst_ul(Ramps::Fastest));
    assert!(aware_ul < 12.0 && fastest_ul > 55.0, "{aware_ul} {fastest_ul}");
}
