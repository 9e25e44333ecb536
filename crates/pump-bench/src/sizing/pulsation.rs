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
    /// Peak-to-peak ripples at the hose's end between which 95 % of the pulses lie that such a head may have. `None`
    /// for a head that is drawn or measured.
    pub end_between: Option<[f64; 2]>,
}

/// Returns the pulsation at the rollers and at the hose's end, with what the unknown pulse of a bought head leaves.
pub(super) fn pulsation(at: &Operating) -> Result<Pulsation, SizingError> {
    let end = at.pump.constant_speed_outflow_ripple(at.speed_rad_s);
    let end_between = match &at.file.head {
        None => None,
        Some(head) => {
            let prior = PulsePrior::of(at.file.rollers.count);
            let mut found = Vec::new();
            for pulse in prior.pulses() {
                let (inlet, outlet) = (*at.pump.inlet(), *at.pump.outlet());
                let pump = Pump::from_ml_per_rev(head.ml_per_rev, prior.rollers, pulse, inlet, outlet)?;
                let ripple = pump.constant_speed_outflow_ripple(at.speed_rad_s);
                found.extend(ripple.map(|ripple| ripple.peak_to_peak));
            }
            found.sort_unstable_by(f64::total_cmp);
            let beyond = found.len() / 40;
            found.get(beyond).zip(found.iter().nth_back(beyond)).map(|(least, most)| [*least, *most])
        }
    };
    Ok(Pulsation { rollers: at.pump.outlet_curve().ripple(), end, end_between })
}
