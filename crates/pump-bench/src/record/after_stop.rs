//! The flow that still arrives on a balance after the motor has stopped, as doses by weight have found it.

use libm::sqrt;
use serde::{Deserialize, Serialize};

/// Most stops that count. An older one then counts less and less: tube and vessel change.
const MOST: u32 = 30;

/// Time of flow that a balance still shows after the motor's last step: the line's settling, the drops in the air, and
/// the balance's own delay. All of them grow with the flow, so the time is the same at any flow.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct AfterStop {
    /// Number of stops that count.
    pub stops: u32,
    /// Mean time, in s.
    pub mean_s: f64,
    /// Variance of the times about their mean, in s², with `stops - 1` degrees of freedom.
    pub(crate) variance_s2: f64,
}

impl AfterStop {
    /// Returns the times with one more, in s.
    pub(crate) fn with(before: Option<Self>, time_s: f64) -> Self {
        let Some(Self { stops, mean_s, variance_s2 }) = before else {
            return Self { stops: 1, mean_s: time_s, variance_s2: 0.0 };
        };
        // The recurrence of Welford (Technometrics 4 (1962) 419), with the number of stops held at MOST.
        let n = f64::from(stops.min(MOST - 1) + 1);
        let off_s = time_s - mean_s;
        let mean_s = mean_s + off_s / n;
        let squares_s2 = variance_s2 * (n - 2.0) + off_s * (time_s - mean_s);
        Self { stops: n as u32, mean_s, variance_s2: squares_s2 / (n - 1.0) }
    }

    /// Returns the standard deviation of the times, in s. 0 after the first stop.
    pub(crate) fn spread_s(&self) -> f64 {
        sqrt(self.variance_s2)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mean_and_spread_are_those_of_the_times() {
        let times = [0.5, 0.7, 0.9, 0.6];
        let found = times.iter().fold(None, |before, time| Some(AfterStop::with(before, *time))).unwrap();
        // Mean 0.675; squares 0.030625 + 0.000625 + 0.050625 + 0.005625 over 3.
        assert!((found.mean_s - 0.675).abs() < 1e-12 && (found.variance_s2 - 0.0875 / 3.0).abs() < 1e-12);
        let settled = (0..200).fold(found, |before, _| AfterStop::with(Some(before), 1.0));
        assert!(settled.stops == 30 && (settled.mean_s - 1.0).abs() < 2e-3, "{settled:?}");
    }
}
