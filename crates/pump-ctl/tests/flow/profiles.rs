//! The steps of a flow against an account of their own.

use pump_ctl::plan::FlowRow;
use pump_model::Pump;

use crate::heads::Head;
use crate::{STEP_RAD, motor, rows, steps};

/// Numbers from 0 to 1 of a linear congruential generator (Knuth, MMIX).
struct Random(u64);

impl Random {
    fn part(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// Returns a flow that wanders up to 3 mL/s, with pauses and small steps, from rest to rest. In a pulse of this head
/// the rotor is near its largest acceleration then.
fn wandering(random: &mut Random, sign: f64) -> Vec<FlowRow> {
    let mut time_s = 0.0;
    let mut all = vec![FlowRow::new(0.0, 0.0)];
    for _ in 0..12 {
        time_s += 0.5 + 4.0 * random.part();
        let flow_ml_s = if random.part() < 0.2 { 0.0 } else { 3.0 * random.part() };
        all.push(FlowRow::new(time_s, sign * flow_ml_s));
        if random.part() < 0.3 {
            // 0.4 mL/s are 0.1 rad/s where nothing takes from the flow, and some 1 rad/s in a pulse.
            all.push(FlowRow::new(time_s, sign * (flow_ml_s + 0.4 * random.part())));
        }
    }
    all.push(FlowRow::new(time_s + 3.0, 0.0));
    all
}

/// Returns the volume of the rows up to a time, mL: Simpson's rule on a fine grid over their straight lines.
fn quadrature_ml(rows: &[FlowRow], until_s: f64) -> f64 {
    let mut sum_ml = 0.0;
    for pair in rows.windows(2) {
        let (from, to) = (pair[0], pair[1]);
        let end_s = to.time_s.min(until_s);
        if end_s <= from.time_s {
            continue;
        }
        let flow = |time_s: f64| {
            let slope = (to.flow_ml_s - from.flow_ml_s) / (to.time_s - from.time_s);
            from.flow_ml_s + slope * (time_s - from.time_s)
        };
        const PARTS: u32 = 64;
        let part_s = (end_s - from.time_s) / f64::from(PARTS);
        for n in 0..PARTS {
            let at = |part: f64| flow(from.time_s + (f64::from(n) + part) * part_s);
            sum_ml += part_s * (at(0.0) + 4.0 * at(0.5) + at(1.0)) / 6.0;
        }
    }
    sum_ml
}

#[test]
fn at_a_thousand_instants_the_volume_at_the_rollers_is_within_a_step_of_the_rows_own() {
    let head = Head::new(3, 1.0, 50.53, 30.0);
    let pump = head.pump();
    let (mut random, mut instants) = (Random(7), 0);
    for n in 0..20 {
        let sign = if n % 4 == 3 { -1.0 } else { 1.0 };
        let start_rad = 7.0 * random.part();
        let of = wandering(&mut random, sign);
        let made = steps(&pump, start_rad, &of).unwrap();
        let last_s = of.last().unwrap().time_s;
        for _ in 0..50 {
            let until_s = 1.05 * last_s * random.part();
            let count = made.partition_point(|step| step.time_s <= until_s);
            let stands_rad = start_rad + sign * count as f64 * STEP_RAD;
            // A step further is where the rollers would be too far.
            let [here_ml, next_ml] = [stands_rad, stands_rad + sign * STEP_RAD]
                .map(|angle_rad| sign * (head.volume_ml(angle_rad) - head.volume_ml(start_rad)));
            let wanted_ml = sign * quadrature_ml(&of, until_s);
            let rounding_ml = 1e-6;
            assert!(here_ml <= wanted_ml + rounding_ml, "{n}, {until_s} s: {here_ml} of {wanted_ml}");
            assert!(next_ml >= wanted_ml - rounding_ml, "{n}, {until_s} s: {next_ml} of {wanted_ml}");
            instants += 1;
        }
    }
    assert_eq!(instants, 1000);
}

#[test]
fn steps_come_in_order_at_speeds_and_accelerations_of_the_motor() {
    let pump = Pump::three_roller();
    let mut random = Random(11);
    for _ in 0..10 {
        let made = steps(&pump, random.part(), &wandering(&mut random, 1.0)).unwrap();
        for (n, pair) in made.windows(2).enumerate() {
            assert_eq!(pair[0].number, n as u64 + 1);
            let interval_s = pair[1].time_s - pair[0].time_s;
            assert!(interval_s >= STEP_RAD / motor().max_speed_rad_s * (1.0 - 1e-9), "{interval_s}");
        }
    }
}

#[test]
fn a_constant_flow_needs_the_speed_that_gives_it_at_every_angle() {
    let pump = Pump::three_roller();
    // 1 mL/s for 60 s is 8.44 pitches of 7.106 mL.
    let made = steps(&pump, 0.0, &rows(&[(0.0, 1.0), (60.0, 1.0)])).unwrap();
    let slowest = made.windows(2).map(|pair| pair[1].time_s - pair[0].time_s).fold(0.0, f64::max);
    let fastest = made.windows(2).map(|pair| pair[1].time_s - pair[0].time_s).fold(f64::MAX, f64::min);
    // Between pulses the tube gives pi 5² (63 - 7)/1000 mL/rad = 4.398 mL/rad.
    assert!((slowest / STEP_RAD - 4.398).abs() < 0.01, "{}", slowest / STEP_RAD);
    let (least_ml_rad, _) = pump.outlet_curve().flow_range_ml_rad();
    assert!((fastest / STEP_RAD - least_ml_rad).abs() < 0.02 * least_ml_rad, "{}", fastest / STEP_RAD);
    assert!((made.last().unwrap().angle_rad / (TAU_3 * 60.0 / 7.106) - 1.0).abs() < 0.05);
}

/// Angle of a pitch of three rollers, rad.
const TAU_3: f64 = core::f64::consts::TAU / 3.0;
