//! The flows of a gradient: the shares change linearly over time, and the sum of all flows stays.

use super::step_keys::WrongKey;
use crate::dosing::FlowProfile;

/// Flows of a step over time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Gradient {
    /// Flow of all pumps together between the ramps, in mL/s.
    pub(super) rate_ml_s: f64,
    /// Time from the first flow to the last, ramps included, in s.
    pub(super) time_s: f64,
    /// Time in which the flows rise at the begin, and fall at the end, in s.
    pub(super) ramp_s: f64,
}

impl Gradient {
    /// Makes the gradient of two of volume, rate and time.
    pub(super) fn of(
        number: usize,
        (volume_ml, rate_ml_s, time_s): (Option<f64>, Option<f64>, Option<f64>),
        ramp_s: f64,
    ) -> Result<Self, WrongKey> {
        // Each ramp passes half of what the whole flow would in its time.
        let (rate_ml_s, time_s) = match (volume_ml, rate_ml_s, time_s) {
            (Some(volume_ml), Some(rate_ml_s), None) => (rate_ml_s, volume_ml / rate_ml_s + ramp_s),
            (Some(volume_ml), None, Some(time_s)) => (volume_ml / (time_s - ramp_s), time_s),
            (None, Some(rate_ml_s), Some(time_s)) => (rate_ml_s, time_s),
            _ => {
                let allowed = "two of volume, rate and for";
                return Err(WrongKey::value(&format!("step {number}"), "a flow over time", allowed));
            }
        };
        if 2.0 * ramp_s > time_s {
            let allowed = format!("{} s at most: half of the step's {time_s} s", 0.5 * time_s);
            return Err(WrongKey::value(&format!("step {number}, ramp"), &format!("{ramp_s} s"), &allowed));
        }
        Ok(Self { rate_ml_s, time_s, ramp_s })
    }

    /// Returns the volume and the flow over time of a pump whose share goes from `first` to `last`, as parts of 1. The
    /// flow has what was asked for as its name.
    pub(super) fn flow(&self, asked: &str, (first, last): (f64, f64), sign: f64) -> (f64, FlowProfile) {
        let Self { rate_ml_s, time_s, ramp_s } = *self;
        let at = |at_s: f64| sign * rate_ml_s * (first + (last - first) * at_s / time_s);
        let falls_s = time_s - ramp_s;
        let times_s = [0.0, ramp_s, falls_s, time_s];
        let flows_ml_s = [0.0, at(ramp_s), at(falls_s), 0.0];
        let profile = FlowProfile::from_columns(asked, &times_s, &flows_ml_s)
            .unwrap_or_else(|error| unreachable!("four rows: {error}"));
        (profile.volume_ml(), profile)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_flows_of_a_gradient_add_up_to_its_rate_and_its_volume() {
        let gradient = Gradient::of(1, (Some(18.0), None, Some(10.0)), 1.0).unwrap();
        assert_eq!(gradient.rate_ml_s, 2.0);
        let (one_ml, one) = gradient.flow("one", (1.0, 0.25), 1.0);
        let (other_ml, other) = gradient.flow("other", (0.0, 0.75), 1.0);
        assert!((one_ml + other_ml - 18.0).abs() < 1e-12, "{one_ml} {other_ml}");
        for (row, (one, other)) in one.rows().iter().zip(other.rows()).enumerate() {
            let sum = if row == 1 || row == 2 { 2.0 } else { 0.0 };
            assert!((one.flow_ml_s + other.flow_ml_s - sum).abs() < 1e-12);
        }
        // At a quarter of the time a quarter of the way is gone.
        assert!((one.rows()[1].flow_ml_s - 2.0 * (1.0 - 0.075)).abs() < 1e-12);
    }
}
