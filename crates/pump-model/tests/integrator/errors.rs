//! Claims that the integrator reports an equation that it cannot integrate, with the time, in a bounded
//! number of evaluations.

use core::cell::Cell;
use std::sync::mpsc;
use std::time::Duration;

use crate::problems::{go, kepler, kepler_solution, scalar, uniform};
use nalgebra::SVector;
use pump_model::integrator::{IntegrationError, Options, Rodas5p};

/// Integrates from y = 1 at `start_s`, and panics after `most` evaluations of f, so no test runs for ever.
fn fails(
    f: impl Fn(f64, f64) -> f64,
    df: impl Fn(f64, f64) -> f64,
    (start_s, end_s): (f64, f64),
    most: u32,
) -> IntegrationError {
    let evaluations = Cell::new(0);
    let ode = scalar(
        |t, y| {
            evaluations.set(evaluations.get() + 1);
            assert!(evaluations.get() <= most, "still at t = {t}, y = {y}");
            f(t, y)
        },
        df,
        |_, _| 0.0,
    );
    let mut solver = uniform(start_s, SVector::<f64, 1>::new(1.0), 1e-6);
    go(&mut solver, &ode, end_s, u64::from(most)).unwrap_err()
}

#[test]
fn not_a_number_at_the_start_is_told() {
    let ode = scalar(|_, _| f64::NAN, |_, _| 0.0, |_, _| 0.0);
    let mut solver = uniform(3.0, SVector::<f64, 1>::new(1.0), 1e-6);
    assert_eq!(solver.step(&ode, 4.0).unwrap_err(), IntegrationError::NotFinite { time_s: 3.0 });
    let ode = kepler();
    let mut broken = kepler_solution(0.0);
    broken[3] = f64::INFINITY;
    let mut solver = uniform(3.0, broken, 1e-6);
    assert_eq!(solver.step(&ode, 4.0).unwrap_err(), IntegrationError::NotFinite { time_s: 3.0 });
}

#[test]
fn not_a_number_on_the_way_is_told_with_its_time() {
    let error = fails(|t, _| if t < 0.5 { 1.0 } else { f64::NAN }, |_, _| 0.0, (0.0, 1.0), 2000);
    let IntegrationError::NotFinite { time_s } = error else { panic!("{error:?}") };
    assert!((time_s - 0.5).abs() < 1e-9, "{time_s}");
}

#[test]
fn a_state_that_leaves_the_domain_of_f_is_told_with_its_time() {
    // The solution of y' = -1 / sqrt(y) reaches 0 at t = 2/3 and does not exist beyond.
    let error = fails(|_, y| -1.0 / y.sqrt(), |_, y| 0.5 * y.powf(-1.5), (0.0, 1.0), 20_000);
    let (IntegrationError::NotFinite { time_s } | IntegrationError::StepUnderflow { time_s }) = error else {
        panic!("{error:?}")
    };
    assert!((time_s - 2.0 / 3.0).abs() < 1e-4, "{time_s}");
}

#[test]
fn a_blow_up_is_told_with_its_time() {
    // The equation y' = y² has the solution y = 1 / (1 - t).
    let error = fails(|_, y| y * y, |_, y| 2.0 * y, (0.0, 2.0), 100_000);
    let (IntegrationError::NotFinite { time_s } | IntegrationError::StepUnderflow { time_s }) = error else {
        panic!("{error:?}")
    };
    assert!((time_s - 1.0).abs() < 1e-4, "{time_s}");
}

#[test]
fn noise_that_no_step_can_follow_is_told() {
    let noise = |t: f64, _: f64| if t.to_bits() & 1 == 0 { 1e20 } else { -1e20 };
    let error = fails(noise, |_, _| 0.0, (1.0, 2.0), 20_000);
    assert!(matches!(error, IntegrationError::StepUnderflow { .. }), "{error:?}");
}

#[test]
fn a_jacobian_that_is_not_a_number_is_told() {
    let error = fails(|_, y| -y, |_, _| f64::NAN, (0.0, 1.0), 2000);
    let time_s = match error {
        IntegrationError::NotFinite { time_s } | IntegrationError::StepUnderflow { time_s } => time_s,
        _ => panic!("{error:?}"),
    };
    assert_eq!(time_s, 0.0);
}

#[test]
fn a_stop_that_is_reached_or_past_is_refused() {
    let ode = kepler();
    let mut solver = uniform(1.0, kepler_solution(1.0), 1e-6);
    for stop_s in [1.0, 0.5, f64::NEG_INFINITY] {
        let refused = solver.step(&ode, stop_s).unwrap_err();
        assert_eq!(refused, IntegrationError::StepUnderflow { time_s: 1.0 });
        assert_eq!((solver.time_s(), solver.state()), (1.0, kepler_solution(1.0).into()));
    }
    assert!(solver.step(&ode, 1.5).is_ok());
}

/// Returns the longest step of two bodies with this limit, over stops at multiples of `stop_s`.
fn longest_step(limit_s: f64, stop_s: f64) -> f64 {
    let ode = kepler();
    let options = Options::uniform(1e-2).unwrap().with_max_step_s(limit_s);
    let mut solver = Rodas5p::new(0.0, kepler_solution(0.0).into(), options).unwrap();
    let mut longest = 0.0_f64;
    for n in 1..=20 {
        while solver.time_s() < stop_s * f64::from(n) {
            longest = longest.max(solver.step(&ode, stop_s * f64::from(n)).unwrap().length_s);
        }
    }
    longest
}

#[test]
fn no_step_is_longer_than_the_limit() {
    // Differences of times up to 20 are rounded to 4e-15.
    for (limit_s, stop_s) in [(0.05, 0.3), (0.05, 1.0), (0.01, 0.011), (0.01, 0.009)] {
        let longest = longest_step(limit_s, stop_s);
        assert!(longest <= limit_s + 1e-14, "{longest} of {limit_s}, stops {stop_s}");
        assert!(longest > 0.5 * limit_s);
    }
}

#[test]
fn no_step_stretches_over_the_limit_to_reach_a_stop() {
    let longest = longest_step(0.01, 0.010_005);
    assert!(longest <= 0.01 + 1e-14, "{longest}");
}

#[test]
fn a_state_at_rest_reaches_any_time_in_few_steps() {
    let ode = scalar(|_, _| 0.0, |_, _| 0.0, |_, _| 0.0);
    let mut solver = uniform(0.0, SVector::<f64, 1>::new(1.0), 1e-6);
    assert_eq!(go(&mut solver, &ode, 1e12, 30).unwrap()[0], 1.0);
}

#[test]
fn a_state_at_rest_without_a_stop_comes_to_an_end() {
    let (done, wait) = mpsc::channel();
    std::thread::spawn(move || {
        let ode = scalar(|_, _| 0.0, |_, _| 0.0, |_, _| 0.0);
        let mut solver = uniform(0.0, SVector::<f64, 1>::new(1.0), 1e-6);
        let mut steps = 0;
        while solver.time_s() < f64::INFINITY && steps < 1000 && solver.step(&ode, f64::INFINITY).is_ok() {
            steps += 1;
        }
        done.send(steps)
    });
    let steps = wait.recv_timeout(Duration::from_secs(1));
    assert!(steps.is_ok(), "still running");
}

#[test]
fn a_tolerance_by_which_every_step_would_be_accepted_is_refused() {
    for tolerance in [f64::NAN, -1e-6, 0.0, f64::INFINITY] {
        let refused = Options::<2>::uniform(tolerance).unwrap_err();
        assert!(matches!(refused, IntegrationError::OutOfRange { .. }), "{refused:?}");
    }
    let good = Options::<2>::uniform(1e-6).unwrap();
    let message = |options| Rodas5p::new(0.0, [1.0; 2], options).unwrap_err().to_string();
    for (options, expected) in [
        (good.with_relative([1e-6, -1.0]), "relative tolerance of a state is -1e0; allowed: "),
        (good.with_relative([f64::NAN, 1e-6]), "relative tolerance of a state is NaN; allowed: "),
        (good.with_absolute([1e-6, 0.0]), "absolute tolerance of a state is 0e0; allowed: "),
        (good.with_absolute([f64::INFINITY; 2]), "absolute tolerance of a state is inf; allowed: "),
        (good.with_max_step_s(f64::NAN), "longest step in s is NaN; allowed: "),
        (good.with_max_step_s(0.0), "longest step in s is 0e0; allowed: "),
    ] {
        assert!(message(options).starts_with(expected), "{}", message(options));
    }
    // The volume of a line is integrated without a relative tolerance.
    assert!(Rodas5p::new(0.0, [1.0; 2], good.with_relative([0.0; 2])).is_ok());
}
