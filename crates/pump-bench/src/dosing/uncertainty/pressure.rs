//! How unsure a predicted pressure is.

use libm::sqrt;
use pump_model::Extremes;

/// Mean Pearson correlation of predicted with measured waveforms: the lowest of the four that McIntyre et al. state
/// in "Pressure pulsations", over all their speeds. With 3 rollers they have 0.83 at the inlet and 0.74 at the
/// outlet, with 2 rollers 0.80 and 0.79.
const CORRELATION: f64 = 0.74;

/// Returns the expanded uncertainty (k = 2) of predicted extremes, in kPa: 0.51 of the predicted swing.
///
/// Waveforms of the same mean and the same RMS s about it that correlate by r differ by s sqrt(2 (1 - r)), RMS.
/// A sine that swings from least to most has s = (most - least)/sqrt(8). So twice the RMS difference is
/// (most - least) sqrt(1 - r).
///
/// A correlation says nothing of an offset or of a scale, and the paper publishes no figures of them. So this
/// is what is known to be unsure, not all of it.
pub(crate) fn pressure_uncertainty_kpa(extremes: Extremes) -> f64 {
    (extremes.max_kpa - extremes.min_kpa) * sqrt(1.0 - CORRELATION)
}

#[cfg(test)]
mod tests {
    use pump_model::Pump;
    use pump_model::units::rad_s;

    use super::*;

    /// RMS of the outlet pressure about its mean over the last ten of 60 pitches from rest, by Euler's method with
    /// the flow of the midpoint: C dP/dt = Q - Q_L, L dQ_L/dt = P - P_res - R Q_L.
    fn rms_of_outlet_kpa(pump: &Pump, speed_rpm: f64) -> f64 {
        const STEPS: u32 = 20_000;
        let (line, speed_rad_s) = (pump.outlet(), rad_s(speed_rpm));
        let step_s = pump.pitch_rad() / speed_rad_s / f64::from(STEPS);
        let (mut above_kpa, mut flow_ml_s, mut sums) = (0.0, 0.0, [0.0; 2]);
        for n in 0..60 * STEPS {
            let angle_rad = speed_rad_s * step_s * (f64::from(n) + 0.5);
            let rollers_ml_s = pump.outlet_curve().flow_ml_rad(angle_rad) * speed_rad_s;
            let driving_kpa = above_kpa - line.resistance_kpa_s_ml * flow_ml_s;
            flow_ml_s += step_s * driving_kpa / line.inertance_kpa_s2_ml;
            above_kpa += step_s * (rollers_ml_s - flow_ml_s) / line.compliance_ml_kpa;
            if n >= 50 * STEPS {
                sums = [sums[0] + above_kpa, sums[1] + above_kpa * above_kpa];
            }
        }
        let [mean, square] = sums.map(|sum| sum / f64::from(10 * STEPS));
        (square - mean * mean).sqrt()
    }

    #[test]
    fn twice_the_rms_between_waveforms_that_correlate_so_is_within_the_uncertainty() {
        // A measured waveform of the same mean and RMS is r p + sqrt(1 - r²) n, with n as large as p and
        // independent of it: the difference is sqrt((1 - r)² + 1 - r²) = sqrt(2 (1 - r)) times the RMS of p.
        for (pump, speeds_rpm) in
            [(Pump::three_roller(), [50.0, 100.0, 150.0]), (Pump::two_roller(), [50.0, 100.0, 150.0])]
        {
            for speed_rpm in speeds_rpm {
                let speed_rad_s = rad_s(speed_rpm);
                let steady = pump.steady_state(speed_rad_s).unwrap();
                let (rms_kpa, expanded_kpa) =
                    (rms_of_outlet_kpa(&pump, speed_rpm), pressure_uncertainty_kpa(steady.outlet));
                let twice_kpa = 2.0 * rms_kpa * sqrt(2.0 * (1.0 - CORRELATION));
                let part = twice_kpa / expanded_kpa;
                // These waveforms have sharper peaks than a sine, so their RMS is less.
                assert!((0.5..=1.05).contains(&part), "{speed_rpm}: {twice_kpa} of {expanded_kpa}");
            }
        }
    }
}
