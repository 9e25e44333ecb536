//! Integrals of functions that are smooth between known corners.

/// Nodes and weights of Gauss-Legendre quadrature with 16 nodes over [-1, 1], the positive half (Abramowitz
/// and Stegun, table 25.4). The rule is exact to degree 31.
const NODES: [(f64, f64); 8] = [
    (0.989_400_934_991_649_9, 0.027_152_459_411_754_096),
    (0.944_575_023_073_232_6, 0.062_253_523_938_647_894),
    (0.865_631_202_387_831_7, 0.095_158_511_682_492_79),
    (0.755_404_408_355_003, 0.124_628_971_255_533_88),
    (0.617_876_244_402_643_7, 0.149_595_988_816_576_73),
    (0.458_016_777_657_227_4, 0.169_156_519_395_002_54),
    (0.281_603_550_779_258_9, 0.182_603_415_044_923_58),
    (0.095_012_509_837_637_44, 0.189_450_610_455_068_5),
];

/// Returns the integral of `function` over [low, high]. `corners`, in rising order, are the points at which
/// it is not smooth; corners outside have no effect.
pub(crate) fn between<const N: usize>(
    low: f64,
    high: f64,
    corners: [f64; N],
    function: impl Fn(f64) -> f64,
) -> f64 {
    let mut sum = 0.0;
    let mut start = low;
    for end in corners.into_iter().chain([high]) {
        let end = end.min(high);
        if end > start {
            sum += smooth(start, end, &function);
            start = end;
        }
    }
    sum
}

fn smooth(low: f64, high: f64, function: impl Fn(f64) -> f64) -> f64 {
    let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
    let pair = |x: f64| function(middle - half * x) + function(middle + half * x);
    half * NODES.iter().map(|(x, weight)| weight * pair(*x)).sum::<f64>()
}
