//! Coefficients of RODAS5P.
//!
//! The method is that of G. Steinebach, "Construction of Rosenbrock-Wanner method Rodas5P and numerical
//! benchmarks within the Julia Differential Equations package", BIT Numerical Mathematics 63:27 (2023). It
//! stands in the transformed form of Hairer and Wanner, "Solving Ordinary Differential Equations II", section
//! IV.7. There the stages u_i solve (1/(h gamma) - J) u_i = f(t + alpha_i h, y + sum a_ij u_j) + sum c_ij u_j
//! / h + gamma_i h f_t.

/// Number of stages.
pub(super) const STAGES: usize = 8;

/// Diagonal coefficient gamma.
pub(super) const GAMMA: f64 = 0.211_937_563_194_290_14;

/// Coefficients a_ij for stages 2 to 6. Stage 7 adds u_6, stage 8 adds u_7, and the new value adds u_8.
pub(super) const A: [[f64; 5]; 5] = [
    [3.0, 0.0, 0.0, 0.0, 0.0],
    [2.849_394_379_747_939, 0.458_422_422_044_639_23, 0.0, 0.0, 0.0],
    [-6.954_028_509_809_101, 2.489_845_061_869_568, -10.358_996_098_473_584, 0.0, 0.0],
    [
        2.802_998_627_562_896_4,
        0.507_246_473_622_820_6,
        -0.398_831_254_177_052_4,
        -0.047_211_872_304_046_41,
        0.0,
    ],
    [
        -7.502_846_399_306_121,
        2.561_846_144_803_919,
        -11.627_539_656_261_098,
        -0.182_687_676_599_422_56,
        0.030_198_172_008_377_946,
    ],
];

/// Coefficients c_ij for stages 2 to 8.
pub(super) const C: [[f64; 7]; 7] = [
    [-14.155_112_264_123_755, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    [-17.972_960_358_859_52, -2.859_693_295_451_294, 0.0, 0.0, 0.0, 0.0, 0.0],
    [147.121_502_757_117_16, -1.412_214_027_182_13, 71.689_402_513_023_58, 0.0, 0.0, 0.0, 0.0],
    [
        165.435_170_248_716_76,
        -0.459_282_345_649_112_6,
        42.909_383_369_586_03,
        -5.961_986_721_573_306,
        0.0,
        0.0,
        0.0,
    ],
    [
        24.854_864_614_690_072,
        -3.000_922_700_283_218_6,
        47.493_111_002_076_8,
        5.581_419_782_155_812_5,
        -0.661_069_182_524_947_1,
        0.0,
        0.0,
    ],
    [
        30.912_732_140_285_99,
        -3.120_824_334_993_797_4,
        77.799_546_460_708_92,
        34.286_460_282_947_83,
        -19.097_331_116_725_623,
        -28.087_943_162_872_662,
        0.0,
    ],
    [
        37.802_771_233_905_63,
        -3.257_196_902_907_227_6,
        112.269_188_494_963_27,
        66.934_723_124_404_7,
        -40.066_189_370_910_02,
        -54.667_802_628_779_68,
        -9.488_616_523_096_27,
    ],
];

/// Places alpha_i in the step at which each stage evaluates f.
pub(super) const ALPHA: [f64; STAGES] = [
    0.0,
    0.635_812_689_582_870_4,
    0.409_579_839_339_753_5,
    0.976_930_672_506_071_6,
    0.428_840_360_955_866_4,
    1.0,
    1.0,
    1.0,
];

/// Weights gamma_i of h f_t in each stage.
pub(super) const GAMMA_I: [f64; STAGES] = [
    0.211_937_563_194_290_14,
    -0.423_875_126_388_580_27,
    -0.338_462_712_623_592_4,
    1.804_645_287_288_273_4,
    2.325_825_639_765_069,
    0.0,
    0.0,
    0.0,
];

/// Weights of the stages in the dense output's k1, k2, k3.
pub(super) const H: [[f64; STAGES]; 3] = [
    [
        25.948_786_856_663_858,
        -2.557_972_484_584_623_5,
        10.433_815_404_888_879,
        -2.367_925_102_268_520_4,
        0.524_948_541_321_073,
        1.124_108_831_045_040_4,
        0.427_287_619_443_187_4,
        -0.172_022_210_701_554_93,
    ],
    [
        -9.915_688_506_951_71,
        -0.968_994_459_411_515_4,
        3.043_803_724_297_845_3,
        -24.495_224_566_215_796,
        20.176_138_334_709_044,
        15.980_663_614_246_51,
        -6.789_040_303_419_874,
        -6.710_236_069_923_372,
    ],
    [
        11.419_903_575_922_262,
        2.887_964_514_613_699_4,
        72.921_379_959_960_29,
        80.125_118_346_226_43,
        -52.072_871_366_152_654,
        -59.789_936_252_667_29,
        -0.155_826_842_827_519_13,
        4.883_087_185_713_722,
    ],
];

#[cfg(test)]
mod tests {
    use nalgebra::{SMatrix, SVector};

    use super::super::lu::Lu;
    use super::*;

    type Matrix = SMatrix<f64, STAGES, STAGES>;
    type Vector = SVector<f64, STAGES>;

    /// The coefficients are rounded to doubles and reach 1e2. The largest residual is 2e-14.
    const ROUNDING: f64 = 1e-13;

    /// Coefficients of the method as a Rosenbrock method in its own stages k_i.
    struct Rosenbrock {
        /// Coefficients alpha_ij.
        alpha: Matrix,
        /// Sums beta_ij = alpha_ij + gamma_ij.
        beta: Matrix,
        /// Coefficients gamma_ij.
        gamma: Matrix,
    }

    /// Returns a_ij of all stages, in the transformed form.
    fn a() -> Matrix {
        Matrix::from_fn(|i, j| match i {
            0 => 0.0,
            1..=5 => {
                if j < i {
                    A[i - 1][j]
                } else {
                    0.0
                }
            }
            _ => {
                if j < 5 {
                    A[4][j]
                } else if j < i {
                    1.0
                } else {
                    0.0
                }
            }
        })
    }

    /// Returns the weights of u_i in the new value and in the embedded one.
    fn weights() -> [Vector; 2] {
        let embedded = a().row(7).transpose();
        let mut new = embedded;
        new[7] = 1.0;
        [new, embedded]
    }

    /// Returns the Rosenbrock form (Hairer and Wanner, section IV.7): u = Gamma k,
    /// c = diag(1/gamma) - Gamma⁻¹, a = alpha Gamma⁻¹.
    fn rosenbrock() -> Rosenbrock {
        let inverse = Matrix::from_fn(|i, j| match i {
            _ if i == j => 1.0 / GAMMA,
            _ if j < i => -C[i - 1][j],
            _ => 0.0,
        });
        let lu = Lu::new(inverse).unwrap();
        let mut gamma = Matrix::zeros();
        for j in 0..STAGES {
            gamma.set_column(j, &lu.solve(Matrix::identity().column(j).into_owned()));
        }
        let alpha = a() * gamma;
        Rosenbrock { alpha, beta: alpha + gamma, gamma }
    }

    fn row_sums(matrix: &Matrix) -> Vector {
        matrix * Vector::repeat(1.0)
    }

    /// Returns the rooted trees of order one to five (Hairer and Wanner, table IV.7.1). Each is the product
    /// over its branches for every stage, with its order and density. A vertex with one branch takes beta_ij,
    /// with more alpha_ij.
    fn trees() -> [(Vector, i32, f64); 17] {
        let Rosenbrock { alpha, beta, .. } = rosenbrock();
        let (a, b) = (row_sums(&alpha), row_sums(&beta));
        let a2 = a.component_mul(&a);
        let a3 = a2.component_mul(&a);
        let (ab, bb) = (alpha * b, beta * b);
        let a_ab = a.component_mul(&ab);
        [
            (Vector::repeat(1.0), 1, 1.0),
            (b, 2, 2.0),
            (a2, 3, 3.0),
            (bb, 3, 6.0),
            (a3, 4, 4.0),
            (a_ab, 4, 8.0),
            (beta * a2, 4, 12.0),
            (beta * bb, 4, 24.0),
            (a3.component_mul(&a), 5, 5.0),
            (a2.component_mul(&ab), 5, 10.0),
            (a.component_mul(&(alpha * a2)), 5, 15.0),
            (ab.component_mul(&ab), 5, 20.0),
            (a.component_mul(&(alpha * bb)), 5, 30.0),
            (beta * a3, 5, 20.0),
            (beta * a_ab, 5, 40.0),
            (beta * (beta * a2), 5, 60.0),
            (beta * (beta * bb), 5, 120.0),
        ]
    }

    #[test]
    fn row_sums_are_alpha_and_gamma() {
        let method = rosenbrock();
        let (alpha, gamma) = (row_sums(&method.alpha), row_sums(&method.gamma));
        for i in 0..STAGES {
            assert!((alpha[i] - ALPHA[i]).abs() < ROUNDING, "{i}: {} for {}", alpha[i], ALPHA[i]);
            assert!((gamma[i] - GAMMA_I[i]).abs() < ROUNDING, "{i}: {} for {}", gamma[i], GAMMA_I[i]);
            assert!((method.gamma[(i, i)] - GAMMA).abs() < 1e-15);
        }
    }

    #[test]
    fn the_new_value_has_order_5_and_the_embedded_one_order_4() {
        let [new, embedded] = weights().map(|m| rosenbrock().gamma.tr_mul(&m));
        for (n, (tree, order, density)) in trees().into_iter().enumerate() {
            let error = new.dot(&tree) - 1.0 / density;
            assert!(error.abs() < ROUNDING, "tree {n} of order {order}: {error:e}");
            let error = embedded.dot(&tree) - 1.0 / density;
            assert!(order == 5 || error.abs() < ROUNDING, "embedded, tree {n} of order {order}: {error:e}");
        }
    }

    #[test]
    fn the_embedded_value_is_not_of_order_5() {
        // Otherwise the difference would estimate no error.
        let embedded = rosenbrock().gamma.tr_mul(&weights()[1]);
        let missed = trees().into_iter().filter(|(_, order, _)| *order == 5);
        let largest = missed.map(|(tree, _, density)| (embedded.dot(&tree) * density - 1.0).abs());
        assert!(largest.fold(0.0, f64::max) > 1e-3);
    }

    #[test]
    fn both_values_are_stiffly_accurate() {
        // The weights are b_i = beta_8i and, for the embedded value, beta_7i: both vanish for a problem that
        // is infinitely stiff.
        let method = rosenbrock();
        let [new, embedded] = weights().map(|m| method.gamma.tr_mul(&m));
        assert!((new - method.beta.row(7).transpose()).amax() < ROUNDING);
        assert!((embedded - method.beta.row(6).transpose()).amax() < ROUNDING);
        assert!((embedded - method.alpha.row(7).transpose()).amax() < ROUNDING);
        assert_eq!(ALPHA[5..], [1.0; 3]);
    }

    #[test]
    fn the_dense_output_has_order_4_everywhere_in_the_step() {
        let gamma = rosenbrock().gamma;
        let [k1, k2, k3] = H.map(Vector::from);
        for n in 1..10 {
            let x = f64::from(n) / 10.0;
            let m = weights()[0] * x + (k1 + (k2 + k3 * x) * x) * (x * (1.0 - x));
            let b = gamma.tr_mul(&m);
            for (tree, order, density) in trees().into_iter().filter(|(_, order, _)| *order < 5) {
                let error = b.dot(&tree) - x.powi(order) / density;
                assert!(error.abs() < ROUNDING, "x = {x}, order {order}, 1/{density}: {error:e}");
            }
        }
    }
}
