//! The way out of a flow over time that a motor cannot meet.

use std::fmt;

use crate::numbers::significant;

/// Way out of a flow over time that a motor cannot meet. What nobody could find is `None`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub struct FlowWayOut {
    /// Factor by which all flows could be met.
    pub factor: Option<f64>,
    /// Largest flow then, in mL/s.
    pub most_ml_s: f64,
    /// Acceleration of the motor at which the flow as it is could be met, in rad/s² at the pump head.
    pub enough_rad_s2: Option<f64>,
}

impl FlowWayOut {
    /// Finds the way out. `meets` tells if the flows times a factor can be met by a motor of an acceleration times
    /// another one.
    pub(crate) fn find(largest_ml_s: f64, limit_rad_s2: f64, meets: impl Fn(f64, f64) -> bool) -> Self {
        let factor = largest_of(|factor| meets(factor, 1.0));
        // Four times as much at a time, and then the least of it.
        let enough = (1..=5).map(|power| f64::from(4_u32.pow(power))).find(|most| meets(1.0, *most));
        let enough = enough.map(|most| least_of(0.25 * most, most, |times| meets(1.0, times)));
        Self {
            factor,
            most_ml_s: factor.unwrap_or_default() * largest_ml_s,
            enough_rad_s2: enough.map(|times| times * limit_rad_s2),
        }
    }
}

/// Returns the largest hundredth, or else ten-thousandth, that can be met. `None` if no such part can.
fn largest_of(meets: impl Fn(f64) -> bool) -> Option<f64> {
    [100.0, 10_000.0].into_iter().find_map(|parts| {
        let (mut met, mut not) = (0.0, 100.0);
        while not - met > 1.0 {
            let middle = f64::floor(0.5 * (met + not));
            if meets(middle / parts) { met = middle } else { not = middle }
        }
        (met > 0.0).then(|| met / parts)
    })
}

/// Returns a number from `not` to `met` that can be met, within 1 % of the least.
fn least_of(mut not: f64, mut met: f64, meets: impl Fn(f64) -> bool) -> f64 {
    while met > 1.01 * not {
        let middle = 0.5 * (met + not);
        if meets(middle) { met = middle } else { not = middle }
    }
    met
}

impl fmt::Display for FlowWayOut {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(factor) = self.factor {
            write!(to, "; {factor} times these flows could, up to {} mL/s", significant(self.most_ml_s, 3))?;
        }
        if let Some(enough_rad_s2) = self.enough_rad_s2 {
            write!(to, "; a motor of {:.0} rad/s2 could as it is", enough_rad_s2.ceil())?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_gentlest_way_out_is_the_largest_part_and_the_least_acceleration() {
        // A pulse: the acceleration goes with the square of the flow.
        let pulse = |need: f64| move |factor: f64, times: f64| need * factor * factor <= times;
        let found = FlowWayOut::find(0.5, 100.0, pulse(2.0));
        assert_eq!(found.factor, Some(0.7));
        let enough_rad_s2 = found.enough_rad_s2.unwrap();
        assert!((200.0..203.0).contains(&enough_rad_s2), "{enough_rad_s2}");
        assert!(
            found.to_string().starts_with("; 0.7 times these flows could, up to 0.35 mL/s; a motor of 20")
        );
        assert_eq!(FlowWayOut::find(0.5, 100.0, pulse(1e6)).factor, Some(0.001));
        let none = FlowWayOut::find(0.5, 100.0, |_, _| false);
        assert_eq!((none.factor, none.to_string()), (None, String::new()));
    }
}
