//! Coefficients of Radau IIA with seven stages, in the form for linear equations.
//!
//! The method is that of E. Hairer and G. Wanner, "Stiff differential equations solved by Radau methods", Journal of
//! Computational and Applied Mathematics 111 (1999). With the matrix A of the method, the stages z_i = y_i - y of a
//! linear equation y' = J y + g(t) solve sum_j (A^-1)_ij z_j - h J z_i = h f(t + c_i h, y). In the basis of the
//! eigenvectors of A^-1 these are one real system of the equation's size and three complex ones. The digits were
//! computed with 60 and rounded.

/// Number of stages.
pub(super) const STAGES: usize = 7;

/// Number of pairs of complex eigenvalues.
pub(super) const PAIRS: usize = 3;

/// Nodes c_i.
pub(super) const NODES: [f64; STAGES] = [
    0.029_316_427_159_784_893,
    0.148_078_599_668_484_3,
    0.336_984_690_281_154_3,
    0.558_671_518_771_550_1,
    0.769_233_862_030_054_5,
    0.926_945_671_319_741_1,
    1.0,
];

/// Real eigenvalue of A^-1.
pub(super) const REAL: f64 = 8.936_832_788_405_216;

/// Complex eigenvalues of A^-1, real and imaginary part, one of each pair.
pub(super) const COMPLEX: [[f64; 2]; PAIRS] = [
    [8.511_834_825_102_946, 3.281_013_624_325_059],
    [7.141_055_219_187_64, 6.623_045_922_639_276],
    [4.378_693_561_506_806, 10.169_693_283_795_011],
];

/// Rows that turn the slopes at the nodes into the right-hand sides: one of the real system, then for each complex
/// system one of the real parts and one of the imaginary parts.
pub(super) const INTO: [[f64; STAGES]; STAGES] = [
    [
        227.515_305_962_680_69,
        166.648_022_467_609_74,
        43.265_145_884_526_21,
        3.623_090_061_341_016,
        3.572_674_832_938_798,
        -2.743_556_365_603_367_5,
        1.451_453_540_254_750_4,
    ],
    [
        -149.593_124_014_126_06,
        -121.520_372_684_372_39,
        -24.388_552_039_018_936,
        -1.019_335_952_870_967_1,
        0.836_780_119_930_542_5,
        -0.543_687_016_028_553_1,
        0.450_969_124_648_049_67,
    ],
    [
        -46.538_251_448_717_65,
        11.940_815_528_140_572,
        19.639_440_365_406_923,
        7.194_457_842_745_54,
        -1.755_219_199_699_680_7,
        2.431_642_442_783_090_3,
        -1.123_241_364_795_619_9,
    ],
    [
        37.339_166_117_511_35,
        43.704_294_489_950_406,
        2.012_079_368_689_999,
        -1.857_403_157_579_182,
        -1.715_046_992_991_158_7,
        1.348_302_404_882_656_2,
        -0.469_346_371_803_773_1,
    ],
    [
        29.178_264_425_953_287,
        -5.034_386_978_900_09,
        -15.183_194_421_283_336,
        -0.510_010_432_592_433,
        -0.056_208_750_189_212_48,
        0.945_320_415_500_188_9,
        -0.485_824_319_691_574_14,
    ],
    [
        -1.503_695_084_725_646,
        -5.507_933_039_382_886,
        0.743_899_728_065_828_2,
        1.065_194_079_779_641_3,
        -0.908_070_543_408_782_8,
        0.567_162_793_947_580_5,
        -0.207_349_522_971_651_77,
    ],
    [
        -4.220_981_594_160_542,
        -0.325_262_637_028_757_5,
        3.470_335_365_184_938_2,
        -1.602_523_762_798_949_3,
        0.535_640_471_773_239_3,
        -0.177_425_374_560_811_1,
        0.045_992_745_663_932_77,
    ],
];

/// Rows that turn the solutions, ordered as in [`INTO`], into the coefficients of x to x^7 of the solution over the
/// step.
pub(super) const OUT: [[f64; STAGES]; STAGES] = [
    [
        0.160_424_245_471_165_9,
        -0.138_981_922_072_475_56,
        -0.376_021_879_767_498_7,
        -0.629_985_928_304_056_3,
        0.523_044_339_021_574_2,
        2.787_568_844_222_611_6,
        1.886_148_552_904_507_4,
    ],
    [
        -3.213_551_685_552_623_4,
        2.196_695_053_316_789_7,
        7.840_218_778_628_222,
        14.917_346_431_242_349,
        -8.860_829_185_623_139,
        -52.601_705_672_870_41,
        -56.255_566_360_439_715,
    ],
    [
        21.870_160_755_454_673,
        -12.433_200_031_098_014,
        -53.857_868_155_118_43,
        -107.530_603_287_525_41,
        48.492_043_461_441_4,
        278.887_291_685_657_9,
        465.890_891_928_008_7,
    ],
    [
        -69.049_327_989_546_87,
        31.517_276_671_715_19,
        171.967_136_860_974_36,
        351.360_421_028_223_13,
        -119.821_468_252_910_42,
        -559.080_734_725_719_9,
        -1_585.370_378_470_208_2,
    ],
    [
        112.407_181_163_748_19,
        -37.804_151_017_791_29,
        -280.682_713_229_229_8,
        -582.979_098_278_468_8,
        132.329_593_340_521_23,
        383.571_460_254_832_35,
        2_521.404_077_615_271,
    ],
    [
        -91.978_641_214_143_6,
        17.616_018_760_474_088,
        230.512_553_130_124_3,
        470.910_419_597_607_13,
        -44.750_984_028_811_97,
        46.075_845_100_866_33,
        -1_859.960_260_479_591_6,
    ],
    [
        30.803_754_724_569_04,
        1.046_342_485_455_715_5,
        -75.403_305_505_611_12,
        -144.048_499_562_774_37,
        -7.911_399_673_638_666,
        -97.639_725_486_988_82,
        512.405_087_214_054_9,
    ],
];

/// Weights of the solutions, ordered as in [`INTO`], in the change of the state over a step.
pub(super) const END: [f64; STAGES] = [1.0, 2.0, 0.0, 2.0, 0.0, 2.0, 0.0];

/// Largest error inside a step over the error that its slope has at the start, times the step's length.
///
/// The slope of the solution over the step is wrong by a multiple of prod (x - c_i). That product's integral from 0 is
/// the error.
pub(super) const INSIDE: f64 = 0.017_400_403_889_135_58;

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the coefficients of x to x^7 that the method gives for y' = g(t) over a step of length 1.
    fn coefficients(slope: impl Fn(f64) -> f64) -> [f64; STAGES] {
        let right = INTO.map(|row| row.iter().zip(NODES).map(|(weight, c)| weight * slope(c)).sum::<f64>());
        let mut solved = [0.0; STAGES];
        solved[0] = right[0] / REAL;
        for (n, [re, im]) in COMPLEX.into_iter().enumerate() {
            let (b, c) = (right[1 + 2 * n], right[2 + 2 * n]);
            let square = re * re + im * im;
            solved[1 + 2 * n] = (b * re + c * im) / square;
            solved[2 + 2 * n] = (c * re - b * im) / square;
        }
        let end: f64 = END.iter().zip(solved).map(|(weight, part)| weight * part).sum();
        let found = OUT.map(|row| row.iter().zip(solved).map(|(weight, part)| weight * part).sum::<f64>());
        assert!((found.iter().sum::<f64>() - end).abs() < 1e-11, "{found:?} for {end}");
        found
    }

    #[test]
    fn powers_of_time_are_integrated_exactly() {
        for power in 0..STAGES {
            let found = coefficients(|x| (power + 1) as f64 * x.powi(power as i32));
            for (n, found) in found.into_iter().enumerate() {
                let expected = if n == power { 1.0 } else { 0.0 };
                assert!((found - expected).abs() < 1e-10, "x^{n} for {power}: {found}");
            }
        }
    }

    /// A method of order 13 integrates powers to the twelfth exactly, and no higher one.
    #[test]
    fn the_end_has_order_13() {
        for power in 0..=13 {
            let end: f64 = coefficients(|x| f64::from(power + 1) * x.powi(power)).iter().sum();
            assert_eq!((end - 1.0).abs() < 1e-11, power < 13, "{power}: {:e}", end - 1.0);
        }
    }

    #[test]
    fn the_largest_error_inside_is_that_of_the_nodes() {
        let product = |x: f64| NODES.iter().map(|c| x - c).product::<f64>();
        let (mut sum, mut largest) = (0.0_f64, 0.0_f64);
        for n in 0..100_000 {
            sum += product((f64::from(n) + 0.5) * 1e-5) * 1e-5;
            largest = largest.max(sum.abs());
        }
        assert!((largest / product(0.0).abs() / INSIDE - 1.0).abs() < 1e-6);
        assert!(sum.abs() < 1e-6 * largest, "the error vanishes at the end");
    }
}
