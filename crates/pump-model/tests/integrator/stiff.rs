//! Stiff problems with published solutions. Problems without another source have the reference solutions of
//! F. Mazzia, C. Magherini, "Test Set for Initial Value Problem Solvers", release 2.4 (2008).

use crate::problems::{autonomous, go, uniform};
use nalgebra::{SMatrix, SVector};
use pump_model::integrator::{Ode, Options, Rodas5p};

/// Relative tolerances at which every problem is solved.
const TOLERANCES: [f64; 3] = [1e-4, 1e-7, 1e-10];

/// Integrates to `end_s` at each of the tolerances, with absolute ones in proportion, and compares every
/// state with its reference.
///
/// The error may be three times the tolerance, relative to the state. The step counts allowed are a quarter
/// above those measured.
fn assert_solves<const N: usize>(
    ode: &impl Ode<N>,
    start: [f64; N],
    absolute: [f64; N],
    (end_s, reference): (f64, [f64; N]),
    most_steps: [u64; 3],
) {
    for (tolerance, most_steps) in TOLERANCES.into_iter().zip(most_steps) {
        let options = Options::uniform(tolerance).unwrap().with_absolute(absolute.map(|one| one * tolerance));
        let mut solver = Rodas5p::new(0.0, start, options).unwrap();
        let end = go(&mut solver, ode, end_s, most_steps).unwrap();
        assert_eq!(solver.time_s(), end_s);
        for (found, reference) in end.iter().zip(reference) {
            let error = (found / reference - 1.0).abs();
            assert!(error < 3.0 * tolerance, "{found} for {reference}, {error:e} at {tolerance:e}");
        }
        let statistics = solver.statistics();
        assert_eq!(statistics.factorisations, statistics.steps + statistics.rejections);
        assert!(statistics.rejections as f64 <= 0.7 * statistics.steps as f64, "{statistics:?}");
    }
}

/// Van der Pol's equation (Hairer and Wanner, "Solving ODEs II", section IV.1): y1' = y2, y2' = ((1 - y1²) y2
/// - y1) / 1e-6.
#[test]
fn van_der_pols_equation_is_solved() {
    let ode = autonomous(
        |y: &SVector<f64, 2>| SVector::<f64, 2>::new(y[1], ((1.0 - y[0] * y[0]) * y[1] - y[0]) * 1e6),
        |y: &SVector<f64, 2>| {
            SMatrix::<f64, 2, 2>::new(0.0, 1.0, (-2.0 * y[0] * y[1] - 1.0) * 1e6, (1.0 - y[0] * y[0]) * 1e6)
        },
    );
    let reference = (2.0, [1.706_167_732_170_483, -0.892_809_701_024_797_5]);
    assert_solves(&ode, [2.0, 0.0], [1.0; 2], reference, [275, 1400, 8800]);
}

/// H. H. Robertson's reactions of autocatalysis.
fn robertson() -> impl Ode<3> {
    autonomous(
        |y: &SVector<f64, 3>| {
            let (slow, fast, middle) = (0.04 * y[0], 3e7 * y[1] * y[1], 1e4 * y[1] * y[2]);
            SVector::<f64, 3>::new(middle - slow, slow - middle - fast, fast)
        },
        |y: &SVector<f64, 3>| {
            let (by_y1, by_y2) = (1e4 * y[2], 6e7 * y[1]);
            SMatrix::<f64, 3, 3>::from_row_slice(&[
                -0.04,
                by_y1,
                1e4 * y[1],
                0.04,
                -by_y1 - by_y2,
                -1e4 * y[1],
                0.0,
                by_y2,
                0.0,
            ])
        },
    )
}

#[test]
fn robertsons_reactions_are_solved() {
    // The reference is Hairer and Wanner, "Solving ODEs II", section IV.10.
    let early = (40.0, [0.715_827_068_719_4, 9.185_534_764_558e-6, 0.284_163_745_745_8]);
    let late = (1e11, [2.083_340_149_701_255e-8, 8.333_360_770_334_713e-14, 0.999_999_979_166_505]);
    assert_solves(&robertson(), [1.0, 0.0, 0.0], [1e-6, 1e-10, 1e-6], early, [34, 114, 1435]);
    assert_solves(&robertson(), [1.0, 0.0, 0.0], [1e-10, 1e-15, 1e-6], late, [171, 580, 3440]);
}

#[test]
fn robertsons_mass_is_kept() {
    let mut solver = uniform(0.0, SVector::<f64, 3>::new(1.0, 0.0, 0.0), 1e-6);
    let end = go(&mut solver, &robertson(), 40.0, 1000).unwrap();
    assert!((end.sum() - 1.0).abs() < 1e-13, "{:e}", end.sum() - 1.0);
}

/// Solution of [`hires_is_solved`] at 321.8122.
const HIRES: [f64; 8] = [
    0.737_131_257_332_566_8e-3,
    0.144_248_572_631_618_5e-3,
    0.588_872_974_096_757_5e-4,
    0.117_565_134_328_314_9e-2,
    0.238_635_619_883_133_1e-2,
    0.623_896_825_274_279_6e-2,
    0.284_999_839_518_576_9e-2,
    0.285_000_160_481_423_1e-2,
];

/// High irradiance responses of photomorphogenesis, E. Schäfer (1975), eight substances.
#[test]
fn hires_is_solved() {
    let ode = autonomous(
        |y: &SVector<f64, 8>| {
            let bound = 280.0 * y[5] * y[7];
            SVector::from([
                -1.71 * y[0] + 0.43 * y[1] + 8.32 * y[2] + 0.0007,
                1.71 * y[0] - 8.75 * y[1],
                -10.03 * y[2] + 0.43 * y[3] + 0.035 * y[4],
                8.32 * y[1] + 1.71 * y[2] - 1.12 * y[3],
                -1.745 * y[4] + 0.43 * (y[5] + y[6]),
                -bound + 0.69 * y[3] + 1.71 * y[4] - 0.43 * y[5] + 0.69 * y[6],
                bound - 1.81 * y[6],
                -bound + 1.81 * y[6],
            ])
        },
        |y: &SVector<f64, 8>| {
            let mut j = SMatrix::<f64, 8, 8>::zeros();
            for (row, column, value) in [
                (0, 0, -1.71),
                (0, 1, 0.43),
                (0, 2, 8.32),
                (1, 0, 1.71),
                (1, 1, -8.75),
                (2, 2, -10.03),
                (2, 3, 0.43),
                (2, 4, 0.035),
                (3, 1, 8.32),
                (3, 2, 1.71),
                (3, 3, -1.12),
                (4, 4, -1.745),
                (4, 5, 0.43),
                (4, 6, 0.43),
                (5, 3, 0.69),
                (5, 4, 1.71),
                (5, 5, -0.43),
                (5, 6, 0.69),
                (6, 6, -1.81),
                (7, 6, 1.81),
            ] {
                j[(row, column)] = value;
            }
            for (row, sign) in [(5, -280.0), (6, 280.0), (7, -280.0)] {
                j[(row, 5)] += sign * y[7];
                j[(row, 7)] += sign * y[5];
            }
            j
        },
    );
    let start = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0057];
    assert_solves(&ode, start, [1e-4; 8], (321.8122, HIRES), [85, 636, 4450]);
}

/// R. J. Field and R. M. Noyes's model of the Belousov-Zhabotinskii reaction.
#[test]
fn the_oregonator_is_solved() {
    let ode = autonomous(
        |y: &SVector<f64, 3>| {
            SVector::<f64, 3>::new(
                77.27 * (y[1] + y[0] * (1.0 - 8.375e-6 * y[0] - y[1])),
                (y[2] - (1.0 + y[0]) * y[1]) / 77.27,
                0.161 * (y[0] - y[2]),
            )
        },
        |y: &SVector<f64, 3>| {
            SMatrix::<f64, 3, 3>::from_row_slice(&[
                77.27 * (1.0 - 2.0 * 8.375e-6 * y[0] - y[1]),
                77.27 * (1.0 - y[0]),
                0.0,
                -y[1] / 77.27,
                -(1.0 + y[0]) / 77.27,
                1.0 / 77.27,
                0.161,
                0.0,
                -0.161,
            ])
        },
    );
    let reference = (360.0, [1.000_814_870_318_523, 1_228.178_521_549_917, 132.055_494_284_670_6]);
    assert_solves(&ode, [1.0, 2.0, 3.0], [1e-4; 3], reference, [395, 2270, 13_300]);
}
