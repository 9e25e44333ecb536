//! The pulsation of the flow at the rollers and at the end of the outlet's hose.

use pump_model::{Pump, Ripple};

use crate::displacement::PulsePrior;

use super::error::SizingError;
use super::operating::Operating;

/// The pulsation of the flow.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Pulsation {
    /// Ripple at the rollers.
    pub rollers: Ripple,
    /// Ripple at the end of the outlet's hose. `None` at a resonance that nothing damps.
    pub end: Option<Ripple>,
    /// Smallest and largest peak-to-peak ripple at the hose's end over the pulses that drawings of such heads leave (two
    /// standard deviations of angle and fullness). `None` for a head that is drawn or measured.
    pub end_between: Option<[f64; 2]>,
}

/// Returns the pulsation at the rollers and at the hose's end, with what the unknown pulse of a bought head leaves.
pub(super) fn pulsation(at: &Operating) -> Result<Pulsation, SizingError> {
    let end = at.pump.constant_speed_outflow_ripple(at.speed_rad_s);
    let end_between = match &at.file.head {
        None => None,
        Some(head) => {
            let prior = PulsePrior::of(at.file.rollers.count);
            let mut found: Vec<f64> = end.iter().map(|ripple| ripple.peak_to_peak).collect();
            for sigmas in [[-2.0, 0.0], [2.0, 0.0], [0.0, -2.0], [0.0, 2.0]] {
                let (inlet, outlet) = (*at.pump.inlet(), *at.pump.outlet());
                let pulse = prior.pulse_at(sigmas);
                let pump = Pump::from_ml_per_rev(head.ml_per_rev, prior.rollers, pulse, inlet, outlet)?;
                let ripple = pump.constant_speed_outflow_ripple(at.speed_rad_s);
                found.extend(ripple.map(|ripple| ripple.peak_to_peak));
            }
            let least = found.iter().copied().fold(f64::INFINITY, f64::min);
            let most = found.iter().copied().fold(0.0, f64::max);
            (!found.is_empty()).then_some([least, most])
        }
    };
    Ok(Pulsation { rollers: at.pump.outlet_curve().ripple(), end, end_between })
}
