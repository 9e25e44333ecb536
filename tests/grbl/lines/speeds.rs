//! Claims about pumps whose volume of a revolution depends on the speed, on a line that gives one of them another speed
//! than its own.

use std::sync::Mutex;
use std::sync::atomic::AtomicBool;

use pump_bench::pump_file::{PumpFile, SpeedLawTable};
use pump_bench::{DoseRequest, built_in};
use pump_ctl::plan::Phase;
use pump_model::units::radians;
use pump_model::{Line, SpeedLaw};

use super::pair::Pair;
use crate::simulated::options::Options;

static NEVER: AtomicBool = AtomicBool::new(false);

/// Growth of a segment's volume with the pressure, in 1/kPa.
const GROWTH_PER_KPA: f64 = 0.06;

/// Angle at which an engaging roller closes the lumen, in deg.
const CLOSURE_DEG: f64 = 30.0;

/// Returns a pump that sucks through a narrow line, so that a segment holds some percent less at a faster speed.
fn head() -> PumpFile {
    let mut file = built_in("three-roller").unwrap();
    file.inlet = Line { resistance_kpa_s_ml: 1.0, ..Line::PUBLISHED }.into();
    file.speed_law = SpeedLawTable::InletPressure {
        s: 0.953,
        d_per_kpa: GROWTH_PER_KPA,
        closure_angle_deg: Some(CLOSURE_DEG),
        least_rpm: 0.5,
        most_rpm: 170.0,
        residual_percent: 2.4,
    };
    file
}

/// Returns kappa(N), the volume of a revolution at a speed in rad/s over that of the model, by the law itself.
fn factor(head: &PumpFile, speed_rad_s: f64) -> f64 {
    let law = SpeedLaw {
        scale: 0.953,
        distensibility_per_kpa: GROWTH_PER_KPA,
        closure_rad: radians(CLOSURE_DEG),
        ambient_kpa: head.ambient.pressure_kpa,
    };
    law.factor(&head.model().unwrap(), speed_rad_s).unwrap()
}

/// Steps of both motors over the time of the board, in s.
type Track = Vec<(f64, [i64; 2])>;

/// Returns the speed of a motor in the middle of its way, in steps/s.
fn cruise_steps_s(track: &Track, motor: usize) -> f64 {
    let all = track.last().unwrap().1[motor];
    let at = |part: f64| {
        let passed = |(_, steps): &&(f64, [i64; 2])| steps[motor].abs() as f64 >= part * all.abs() as f64;
        track.iter().find(passed).unwrap()
    };
    let ((from_s, from), (to_s, to)) = (at(0.3), at(0.7));
    (to[motor] - from[motor]) as f64 / (to_s - from_s)
}

/// Runs a rack from these angles. Checks that each pump delivers `asked_ml` by the steps that its motor made and the
/// speed at which it made them. Returns the volumes that the pumps would have missed with the plan of their own.
fn missed_alone(steps: &str, starts_rad: [f64; 2], asked_ml: [f64; 2]) -> [f64; 2] {
    let (head, pair) = (head(), Pair::of(head(), Options::default()));
    let model = head.model().unwrap();
    let step_rad = std::f64::consts::TAU / head.limits().motor.steps_per_rev;
    let own = [0, 1].map(|pump| {
        pair.with_session(pump, |session| {
            session.set_angle(Some(Phase::known(starts_rad[pump]))).unwrap();
            let request = DoseRequest::dose(asked_ml[pump]);
            let rate_ml_s = if steps.contains("ratio") { 2.0 } else { [4.0, 4.7][pump] };
            let cruise = pump_ctl::plan::Cruise::Flow { ml_s: rate_ml_s };
            session.prepare(request.with_cruise(cruise)).unwrap().plan
        })
    });
    let track = Mutex::new(Track::new());
    let report = pair.run(steps, &NEVER, &|_| {
        track.lock().unwrap().push((pair.board.now().as_secs_f64(), pair.places()));
    });
    assert!(report.completed, "{}", report.json());
    let mut track = track.into_inner().unwrap();
    track.sort_by(|(one_s, _), (two_s, _)| one_s.total_cmp(two_s));
    let ends = pair.places();
    [0, 1].map(|pump| {
        let rad_s = cruise_steps_s(&track, pump) * step_rad;
        let moved_ml = |steps: i64| {
            let (curve, start) = (model.outlet_curve(), starts_rad[pump]);
            curve.volume_ml(start + steps as f64 * step_rad) - curve.volume_ml(start)
        };
        let delivered_ml = factor(&head, rad_s) * moved_ml(ends[pump]);
        let off_ml = delivered_ml - asked_ml[pump];
        assert!(off_ml.abs() < 0.002 * asked_ml[pump], "pump {pump}: {delivered_ml} mL at {rad_s} rad/s");
        let told_ml = report.pumps[pump].delivered_ml;
        assert!((told_ml - asked_ml[pump]).abs() < 2e-3, "pump {pump}: {told_ml}");
        (factor(&head, rad_s) * moved_ml(own[pump].steps()) - asked_ml[pump]).abs()
    })
}

#[test]
fn doses_that_begin_together_deliver_what_was_asked_at_the_speed_of_their_line() {
    let together = r#"
[[step]]
at = "0s"
pump = "acid"
volume = "8mL"
rate = "4mL/s"
[[step]]
at = "0s"
pump = "base"
volume = "8mL"
rate = "4.7mL/s"
"#;
    let missed_ml = missed_alone(together, [0.0, 0.0], [8.0, 8.0]);
    assert!(missed_ml[1] > 0.05, "the line slows the second pump: {missed_ml:?}");
}

#[test]
fn the_shares_of_a_ratio_deliver_what_was_asked_however_much_the_line_slows_one() {
    let curve = *head().model().unwrap().outlet_curve();
    let turned_ml = |angle: &f64| curve.volume_ml(angle + 0.4) - curve.volume_ml(*angle);
    let angles = || (0..60).map(|part| f64::from(part) * radians(2.0));
    let low = angles().min_by(|one, two| turned_ml(one).total_cmp(&turned_ml(two))).unwrap();
    let high = angles().max_by(|one, two| turned_ml(one).total_cmp(&turned_ml(two))).unwrap();
    let ratio = "[[step]]\nratio = { acid = 1, base = 1 }\nvolume = \"4mL\"\nrate = \"4mL/s\"\n";
    let missed_ml = missed_alone(ratio, [low, high], [2.0, 2.0]);
    assert!(missed_ml[1] > 0.015, "the line slows the second pump: {missed_ml:?}");
}
