//! Observed orders of convergence of RODAS5P and of its two dense outputs, at fixed steps.

use crate::problems::{autonomous, fixed, kepler, kepler_solution, largest, orders, scalar};
use nalgebra::{SMatrix, SVector};
use pump_model::integrator::{Ode, Rodas5p};

/// Returns the largest errors at the ends of the steps and inside them, where `solution` is exact.
struct Errors {
    ends: f64,
    inside: f64,
}

fn errors<const N: usize>(
    ode: &impl Ode<N>,
    solution: impl Fn(f64) -> SVector<f64, N>,
    end_s: f64,
    steps: u32,
    stiff: bool,
) -> Errors {
    let mut solver = Rodas5p::new(0.0, solution(0.0).into(), fixed(end_s / f64::from(steps))).unwrap();
    let mut errors = Errors { ends: 0.0, inside: 0.0 };
    for n in 1..=steps {
        let step = solver.step(ode, end_s).unwrap();
        assert_eq!(step.end_s(), end_s * f64::from(n) / f64::from(steps));
        // The method's own output is of degree four, Hermite's of degree five.
        assert_eq!(step.polynomial(0).c[5] == 0.0, stiff);
        errors.ends = errors.ends.max(largest(&(SVector::from(solver.state()) - solution(step.end_s()))));
        for part in 1..8 {
            let t = step.start_s + step.length_s * f64::from(part) / 8.0;
            errors.inside = errors.inside.max(largest(&(SVector::from(step.at(t)) - solution(t))));
        }
    }
    assert_eq!(solver.time_s(), end_s);
    errors
}

fn assert_orders(what: &str, errors: &[f64], lowest: f64, highest: f64) {
    let orders = orders(errors);
    assert!(orders.iter().all(|order| (lowest..highest).contains(order)), "{what}: {orders:?} of {errors:?}");
}

fn series<const N: usize>(
    ode: &impl Ode<N>,
    solution: impl Fn(f64) -> SVector<f64, N>,
    end_s: f64,
    steps: &[u32],
    stiff: bool,
) -> (Vec<f64>, Vec<f64>) {
    let all: Vec<Errors> = steps.iter().map(|&n| errors(ode, &solution, end_s, n, stiff)).collect();
    (all.iter().map(|e| e.ends).collect(), all.iter().map(|e| e.inside).collect())
}

#[test]
fn two_bodies_converge_with_order_5_at_and_between_the_ends() {
    let (ends, inside) = series(&kepler(), kepler_solution, 4.0, &[64, 128, 256, 512], false);
    assert_orders("ends", &ends, 4.7, 5.3);
    assert_orders("inside", &inside, 4.7, 5.3);
}

#[test]
fn a_time_dependent_nonlinear_problem_converges_with_order_5() {
    // The equation y' = y² cos t has the solution y = 1 / (2 - sin t).
    let ode = scalar(|t, y| y * y * t.cos(), |t, y| 2.0 * y * t.cos(), |t, y| -y * y * t.sin());
    let solution = |t: f64| SVector::<f64, 1>::new(1.0 / (2.0 - t.sin()));
    let (ends, inside) = series(&ode, solution, 4.0, &[32, 64, 128, 256], false);
    assert_orders("ends", &ends, 4.7, 5.3);
    assert_orders("inside", &inside, 4.7, 5.3);
}

#[test]
fn an_integral_over_time_converges_with_order_5() {
    // Only alpha_i, gamma_i and f_t count in y' = cos t.
    let ode = scalar(|t, _| t.cos(), |_, _| 0.0, |t, _| -t.sin());
    let solution = |t: f64| SVector::<f64, 1>::new(t.sin());
    let (ends, inside) = series(&ode, solution, 4.0, &[8, 16, 32, 64], false);
    assert_orders("ends", &ends, 4.7, 5.3);
    assert_orders("inside", &inside, 4.7, 5.3);
}

/// Problem of Prothero and Robinson: y' = -rate (y - sin t) + cos t, y = sin t.
fn prothero_robinson(rate: f64) -> impl Ode<1> {
    scalar(
        move |t, y| -rate * (y - t.sin()) + t.cos(),
        move |_, _| -rate,
        move |t, _| rate * t.cos() - t.sin(),
    )
}

/// At the ends the error is of the order h³ over the rate, which keeps it below that of a method whose stages
/// have order three. Inside, the method's own output has order four whatever the rate.
#[test]
fn prothero_and_robinsons_problem_is_the_more_exact_the_stiffer_it_is() {
    let solution = |t: f64| SVector::<f64, 1>::new(t.sin());
    for rate in [1e4, 1e6, 1e8] {
        let (ends, inside) = series(&prothero_robinson(rate), solution, 4.0, &[4, 8, 16, 32], true);
        assert_orders("ends", &ends, 2.9, 3.2);
        assert!(ends[0] * rate < 7e-3, "{rate}: {ends:?}");
        assert_orders("inside", &inside, 3.9, 4.1);
        assert!(inside[0] < 4e-4, "{rate}: {inside:?}");
    }
}

/// At the ends the order is that of the reduced problem but for h² over the rate. P. Kaps's problem is stiff
/// and nonlinear: y1' = -(rate + 2) y1 + rate y2², y2' = y1 - y2 (1 + y2). Its solution is y1 = exp(-2 t),
/// y2 = exp(-t) whatever the rate.
#[test]
fn kapss_problem_loses_no_accuracy_to_stiffness() {
    let solution = |t: f64| SVector::<f64, 2>::new((-2.0 * t).exp(), (-t).exp());
    for rate in [1e4, 1e6, 1e8] {
        let ode = autonomous(
            |y: &SVector<f64, 2>| {
                SVector::<f64, 2>::new(-(rate + 2.0) * y[0] + rate * y[1] * y[1], y[0] - y[1] * (1.0 + y[1]))
            },
            |y: &SVector<f64, 2>| {
                SMatrix::<f64, 2, 2>::new(-(rate + 2.0), 2.0 * rate * y[1], 1.0, -1.0 - 2.0 * y[1])
            },
        );
        let (ends, inside) = series(&ode, solution, 4.0, &[8, 16, 32, 64], true);
        for (n, error) in ends.iter().enumerate() {
            let h = 0.5_f64.powi(n as i32 + 1);
            let allowed = 0.6 * h * h / rate + 3.2e-6 * (2.0 * h).powi(5);
            assert!(*error < allowed, "{rate}, {h}: {error:e}");
        }
        assert!(inside[0] < 3.2e-4, "{rate}: {inside:?}");
        if rate == 1e8 {
            assert_orders("ends", &ends[..3], 5.5, 6.3);
            assert_orders("inside", &inside, 3.6, 4.1);
        }
    }
}

/// Returns the result of one step of length 1 of y' = z y from y = 1, z complex.
fn stability(real: f64, imaginary: f64) -> f64 {
    let ode = autonomous(
        |y: &SVector<f64, 2>| {
            SVector::<f64, 2>::new(real * y[0] - imaginary * y[1], imaginary * y[0] + real * y[1])
        },
        |_: &SVector<f64, 2>| SMatrix::<f64, 2, 2>::new(real, -imaginary, imaginary, real),
    );
    let mut solver = Rodas5p::new(0.0, [1.0, 0.0], fixed(1.0)).unwrap();
    let end = solver.step(&ode, 1.0).unwrap().end();
    end[0].hypot(end[1])
}

#[test]
fn it_is_l_stable() {
    for n in -80..=80 {
        let size = 10_f64.powf(f64::from(n) / 10.0);
        // A function bounded on the imaginary axis and without a pole to its left is bounded to the left of
        // it.
        let boundary = stability(0.0, size);
        assert!(boundary < 1.0 + 1e-14, "{size}: {boundary}");
    }
    for (real, imaginary) in [(-1e6, 0.0), (0.0, 1e6), (-1e6, 1e6)] {
        let left = stability(real, imaginary);
        assert!(left < 2e-5, "{left:e}");
    }
}
