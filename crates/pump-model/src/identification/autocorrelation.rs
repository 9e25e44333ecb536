//! Number of samples of a record that say as much as one independent sample.

/// Number of lags of the autocorrelation.
pub(super) const LAGS: usize = 1024;

/// Returns the integrated autocorrelation time in samples, 1 + 2 (rho_1 + rho_2 + ...), at least 1; none if
/// it does not end within [`LAGS`].
///
/// Sums of neighbouring pairs are added while they are positive, each as the smallest so far (Geyer,
/// "Practical Markov chain Monte Carlo", Statist. Sci. 7, 1992, the initial monotone sequence). Beyond there
/// is noise alone. The values are not centred: a mean that is not 0 is a correlation too.
pub(super) fn correlated_samples(values: impl Iterator<Item = f64>) -> Option<f64> {
    // The last values, with the newest at `newest`.
    let (mut last, mut newest, mut count) = ([0.0; LAGS], 0, 0_usize);
    let mut sums = [0.0; LAGS];
    for value in values {
        newest = (newest + 1) % LAGS;
        last[newest] = value;
        count += 1;
        for (lag, sum) in sums.iter_mut().enumerate().take(count) {
            *sum += value * last[(newest + LAGS - lag) % LAGS];
        }
    }
    let (whole, _) = sums.as_chunks::<2>();
    let positive = whole.iter().map(|[even, odd]| even + odd).take_while(|pair| *pair > 0.0);
    let (mut pairs, mut sum, mut least) = (0, 0.0, f64::INFINITY);
    for pair in positive {
        least = pair.min(least);
        pairs += 1;
        sum += least;
    }
    if sums[0] == 0.0 {
        // All values are 0, so none is like another.
        return Some(1.0);
    }
    (pairs < whole.len()).then(|| (2.0 * sum / sums[0] - 1.0).max(1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns x_n = rho x_(n-1) + e_n with e uniform in -1 to 1, of a Weyl sequence scrambled by a
    /// multiplication.
    fn autoregressive(rho: f64, count: u64) -> impl Iterator<Item = f64> {
        let mut x = 0.0;
        (0..count).map(move |n| {
            let mut z = n.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ 0x1234_5678;
            z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
            x = rho * x + 2.0 * ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64 - 1.0;
            x
        })
    }

    #[test]
    fn an_autoregressive_record_has_the_time_that_is_known() {
        for rho in [0.0, 0.5, 0.9] {
            let known = (1.0 + rho) / (1.0 - rho);
            let found = correlated_samples(autoregressive(rho, 200_000)).unwrap();
            assert!((found / known - 1.0).abs() < 0.05, "{rho}: {found} for {known}");
        }
        assert!(correlated_samples(autoregressive(-0.5, 10_000)).unwrap() == 1.0);
    }

    #[test]
    fn what_never_ends_has_none() {
        assert_eq!(correlated_samples((0..5000).map(|_| 1.0)), None);
        assert_eq!(correlated_samples([0.0; 10].into_iter()), Some(1.0));
        assert_eq!(correlated_samples([1.0, -1.0].into_iter()), Some(1.0));
    }
}
