//! Repeatability of doses of any volume.

use libm::hypot;
use pump_model::Pump;

use crate::calibration::{ScatterPrior, Sureness, scatter_ml};
use crate::pump_file::UncertaintyTable;

/// Returns the standard deviation of repeated doses of `volume_ml`, in mL.
///
/// A scatter of doses of V_m bounds that of other doses by [`scatter_ml`].
///
/// - The pump file states s, and V_m if `verify` measured it. Ten revolutions of McIntyre et al. scatter by 1 mL at
///   most, so V_m is ten revolutions where the file names none.
/// - Runs that were weighed show their own s and V_m. They stand for the pump at volumes below V_m, and the file's
///   part of the volume remains the floor.
/// - A few weighed doses show s too little. The file's scatter then counts as a prior, widened, beside what they show.
pub(super) fn standard_ml(
    pump: &Pump,
    table: &UncertaintyTable,
    sureness: Option<&Sureness>,
    volume_ml: f64,
) -> f64 {
    let of_file = table.repeatability_percent / 100.0;
    let weighed = sureness.filter(|sureness| sureness.run_ml > 0.0);
    let at_ml = match (table.repeatability_at_ml, weighed) {
        (Some(at_ml), _) => Some(at_ml),
        (None, Some(_)) => Some(0.0),
        (None, None) => None,
    };
    let of_runs = weighed.map_or(0.0, |sureness| {
        scatter_ml(pump.revolution_ml(), sureness.repeatability, Some(sureness.run_ml), volume_ml)
    });
    let floor_ml = scatter_ml(pump.revolution_ml(), of_file, at_ml, volume_ml);
    let stated_ml = sureness.map_or(0.0, |sureness| prior_ml(pump, table, sureness, volume_ml));
    floor_ml.max(hypot(of_runs, stated_ml))
}

/// Returns the part of the standard deviation that rests on a prior, in mL; 0 without one.
fn prior_ml(pump: &Pump, table: &UncertaintyTable, sureness: &Sureness, volume_ml: f64) -> f64 {
    sureness.prior.map_or(0.0, |prior| {
        prior.over_file() / prior.over_expected * stated_ml(pump, table, &prior, volume_ml)
    })
}

/// Returns the standard deviation that a prior states for doses of `volume_ml`, in mL.
pub(super) fn stated_ml(pump: &Pump, table: &UncertaintyTable, prior: &ScatterPrior, volume_ml: f64) -> f64 {
    prior.over_expected
        * scatter_ml(pump.revolution_ml(), table.repeatability_percent / 100.0, None, volume_ml)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table() -> UncertaintyTable {
        crate::catalogue::built_in("three-roller").unwrap().uncertainty
    }

    #[test]
    fn independent_pitches_scatter_with_the_root_of_the_volume() {
        let pump = Pump::three_roller();
        // 1 mL sqrt(V/213 mL): the paper's bound for ten revolutions.
        for (volume_ml, standard_ml_) in
            [(0.005, 0.004_845), (0.05, 0.015_32), (1.0, 0.068_52), (25.0, 0.3426), (213.0, 1.0)]
        {
            let found = standard_ml(&pump, &table(), None, volume_ml);
            assert!((found / standard_ml_ - 1.0).abs() < 0.005, "{volume_ml}: {found}");
        }
        // Beyond ten revolutions errors that all pitches share are the larger ones.
        assert!((standard_ml(&pump, &table(), None, 1000.0) - 4.7).abs() < 1e-9);
    }

    #[test]
    fn a_scatter_that_was_measured_counts_from_its_own_volume_on() {
        let pump = Pump::three_roller();
        let verified =
            UncertaintyTable { repeatability_percent: 0.2, repeatability_at_ml: Some(1.0), ..table() };
        for (volume_ml, standard_ml_) in [(0.25, 0.001), (1.0, 0.002), (25.0, 0.05)] {
            let found = standard_ml(&pump, &verified, None, volume_ml);
            assert!((found - standard_ml_).abs() < 1e-12, "{volume_ml}: {found}");
        }
        let runs = Sureness {
            factor: 0.001,
            speed_dependence: 0.0,
            repeatability: 0.002,
            run_ml: 64.0,
            prior: None,
            warmer_degc: 0.0,
        };
        // 0.2 % of 64 mL scaled by the root, with 0.47 % of the volume as the floor.
        for (volume_ml, standard_ml_) in [(1.0, 0.016), (0.01, 0.0016), (25.0, 0.1175)] {
            let found = standard_ml(&pump, &table(), Some(&runs), volume_ml);
            assert!((found - standard_ml_).abs() < 1e-12, "{volume_ml}: {found}");
        }
    }
}
