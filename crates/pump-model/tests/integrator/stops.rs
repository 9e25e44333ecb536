//! Claims about stops, jumps of the derivative, and impulses.

use crate::problems::{go, kepler, kepler_solution, largest, scalar, uniform};
use nalgebra::SVector;
use pump_model::integrator::{Ode, Rodas5p};

const TOLERANCE: f64 = 1e-8;

/// Returns fractions of 1 without order, equal in every run (multiples of the golden ratio).
fn scattered(n: u32) -> f64 {
    (f64::from(n) * 0.618_033_988_749_894_9).fract()
}

fn solver() -> Rodas5p<4> {
    uniform(0.0, kepler_solution(0.0), TOLERANCE)
}

#[test]
fn a_step_never_crosses_a_stop_and_lands_on_it_to_the_last_bit() {
    let (ode, mut solver) = (kepler(), solver());
    let mut stop_s = 0.0;
    for n in 1..300 {
        // Intervals go from a millionth of a step to many steps.
        stop_s += 10_f64.powf(-8.0 * scattered(n));
        let mut landed = false;
        while !landed {
            let from_s = solver.time_s();
            let step = solver.step(&ode, stop_s).unwrap();
            landed = solver.time_s() == stop_s;
            assert!(solver.time_s() > from_s && solver.time_s() <= stop_s);
            assert_eq!((step.start_s, step.end()), (from_s, solver.state()));
            assert_eq!(step.length_s, solver.time_s() - from_s);
            assert!((step.end_s() - solver.time_s()).abs() <= f64::EPSILON * stop_s);
            assert!(solver.statistics().steps < 20_000);
        }
    }
    assert!(largest(&(SVector::from(solver.state()) - kepler_solution(stop_s))) < 1e-4);
}

#[test]
fn the_end_of_a_step_is_the_time_reached() {
    let (ode, mut solver) = (kepler(), solver());
    let mut stop_s = 0.0;
    for n in 1..300 {
        stop_s += 10_f64.powf(-8.0 * scattered(n));
        while solver.time_s() < stop_s {
            assert_eq!(solver.step(&ode, stop_s).unwrap().end_s(), solver.time_s());
        }
    }
}

#[test]
fn a_polynomial_joins_the_states_of_its_step() {
    let (ode, mut solver) = (kepler(), solver());
    while solver.time_s() < 6.0 {
        let from = solver.state();
        let step = solver.step(&ode, 6.0).unwrap();
        assert_eq!(step.at(step.start_s), from);
        assert!(largest(&(SVector::from(step.at(solver.time_s())) - SVector::from(solver.state()))) < 1e-14);
        for state in 0..4 {
            let polynomial = step.polynomial(state);
            for x in [0.0, 0.3, 1.0] {
                let t = step.start_s + x * step.length_s;
                assert!((polynomial.at(x) - step.at(t)[state]).abs() < 1e-14);
            }
        }
    }
}

/// Returns the number of steps of a turn of two bodies with these stops.
fn steps_with(stops: impl Iterator<Item = f64>) -> u64 {
    let mut stops: Vec<f64> = stops.chain([6.0]).collect();
    stops.sort_by(f64::total_cmp);
    let (ode, mut solver) = (kepler(), solver());
    for stop_s in stops {
        go(&mut solver, &ode, stop_s, 10_000).unwrap();
    }
    assert!(largest(&(SVector::from(solver.state()) - kepler_solution(6.0))) < 100.0 * TOLERANCE);
    solver.statistics().steps
}

#[test]
fn a_thousand_stops_cost_a_thousand_steps() {
    let plain = steps_with([].into_iter());
    let even = steps_with((1..=1000).map(|n| 6.0 * f64::from(n) / 1001.0));
    let uneven = steps_with((1..=1000).map(|n| 6.0 * scattered(n)));
    // Each pair is a nanosecond apart.
    let pairs = steps_with((1..=1000).map(|n| 6.0 * scattered(n / 2) + 1e-9 * f64::from(n % 2)));
    assert!(even <= 1001 + plain / 10, "{even}, {plain} without");
    assert!(uneven <= 1001 + plain, "{uneven}, {plain} without");
    assert!(pairs <= 1001 + plain, "{pairs}, {plain} without");
}

#[test]
fn a_clipped_step_does_not_shorten_the_next() {
    let ode = kepler();
    let mut free = solver();
    let mut clipped = solver();
    for _ in 0..20 {
        free.step(&ode, 6.0).unwrap();
        clipped.step(&ode, 6.0).unwrap();
    }
    let nano = clipped.time_s() + 1e-9;
    assert_eq!(clipped.step(&ode, nano).unwrap().end_s(), nano);
    let (free, clipped) = (free.step(&ode, 6.0).unwrap(), clipped.step(&ode, 6.0).unwrap());
    assert!(
        (clipped.length_s / free.length_s - 1.0).abs() < 1e-6,
        "{} for {}",
        clipped.length_s,
        free.length_s
    );
}

/// Equation y' = -100 (y - level).
fn relaxing(level: f64) -> impl Ode<1> {
    scalar(move |_, y| -100.0 * (y - level), |_, _| -100.0, |_, _| 0.0)
}

/// Value of 1 - exp(-2).
const EXPECTED: f64 = 0.864_664_716_763_387_3;

fn rests() -> Rodas5p<1> {
    uniform(0.0, SVector::<f64, 1>::new(0.0), TOLERANCE)
}

#[test]
fn a_restart_at_a_jump_saves_rejections() {
    // The level jumps between 0 and 1 every second; 0.02 s after a jump to 1 the state is 1 - exp(-2).
    let mut told = rests();
    for n in 1..=10 {
        go(&mut told, &relaxing(f64::from(n % 2)), f64::from(n), 5000).unwrap();
        told.restart();
    }
    let end = go(&mut told, &relaxing(1.0), 10.02, 5000).unwrap();
    assert!((end[0] - EXPECTED).abs() < 100.0 * TOLERANCE);

    let mut hidden = rests();
    let level = |t: f64| (t.floor() + 1.0) % 2.0;
    let ode = scalar(|t, y| -100.0 * (y - level(t)), |_, _| -100.0, |_, _| 0.0);
    let end = go(&mut hidden, &ode, 10.02, 5000).unwrap();
    assert!((end[0] - EXPECTED).abs() < 100.0 * TOLERANCE);

    // The measured counts are 11 and 419 in eleven stretches.
    let (told, hidden) = (told.statistics().rejections, hidden.statistics().rejections);
    assert!(told <= 13 && hidden >= 100, "{told} and {hidden}");
}

#[test]
fn an_impulse_replaces_the_state() {
    let ode = relaxing(0.0);
    let mut solver = uniform(0.0, SVector::<f64, 1>::new(1.0), TOLERANCE);
    go(&mut solver, &ode, 0.5, 1000).unwrap();
    solver.set_state([3.0]);
    solver.restart();
    assert_eq!((solver.time_s(), solver.state()[0]), (0.5, 3.0));
    let end = go(&mut solver, &ode, 0.51, 1000).unwrap();
    assert!((end[0] - 3.0 * (-1.0_f64).exp()).abs() < 10.0 * TOLERANCE);
}
