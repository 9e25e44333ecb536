//! The way to rest that is queued at the end of the queue.

/// Returns the times of the steps in which a motor comes to rest, in s since the step before, from a speed in steps/s
/// with a deceleration in steps/s².
///
/// After k steps at constant deceleration a from the speed v the time is (v - sqrt(v² - 2 a k)) / a. A speed from which
/// the motor stops within a step has no ramp: it is the start-stop speed, at which the plan's own ramps begin.
pub(super) fn ramp(speed: f64, deceleration: f64) -> impl Iterator<Item = f64> + Send {
    let steps = steps(speed, deceleration);
    (1..=steps).map(move |k| {
        let left = (speed * speed - 2.0 * deceleration * k as f64).max(0.0);
        (speed - left.sqrt()) / deceleration
    })
}

/// Returns the number of these steps.
pub(super) fn steps(speed: f64, deceleration: f64) -> u64 {
    let steps = speed * speed / (2.0 * deceleration);
    if steps.is_finite() { steps as u64 } else { 0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ramp_slows_evenly_to_rest_and_a_slow_motor_has_none() {
        let times: Vec<f64> = ramp(10_000.0, 50_000.0).collect();
        assert_eq!(times.len(), 1000);
        // 10,000 steps/s at first, and 0.2 s in all.
        assert!((times[0] - 1e-4).abs() < 1e-7 && (times[999] - 0.2).abs() < 1e-9);
        assert!(times.windows(3).all(|three| three[2] - three[1] > three[1] - three[0]));
        assert_eq!(ramp(300.0, 50_000.0).count(), 0);
        assert_eq!(ramp(0.0, 50_000.0).count(), 0);
    }
}
