//! Shares of the outlet's nozzle: the drop that hangs from it, and the back flow that it loses.

use libm::sqrt;
use pump_model::{ModelError, falling_drop_ml};

use super::Budget;
use super::share::{Share, ShareSource};
use crate::pump_file::{OutletEnd, PumpFile};

/// Returns the volume of a drop that falls from the nozzle of `file`, in mL. It is 0 for a nozzle that is immersed.
///
/// # Errors
///
/// [`ModelError`] of a nozzle or a fluid that is out of range.
pub(crate) fn drop_ml(file: &PumpFile) -> Result<f64, ModelError> {
    if !file.outlet.is_in_air() {
        return Ok(0.0);
    }
    falling_drop_ml(file.outlet.nozzle_mm(), file.fluid.surface_tension_mn_m()?, file.fluid.density_kg_m3)
}

impl Budget {
    /// Returns the budget with the shares of the nozzle of `file`: `drop_ml` falls from it, and `backflow_ml` flows
    /// back at the stop.
    ///
    /// - A drop of V hangs at the nozzle before and after the dose, each as large as it may be: between nothing and
    ///   V with equal likelihood beyond the residue that always stays. The vessel lacks the difference, which is
    ///   triangular with the variance 2 V²/12 (GUM, JCGM 100:2008, 4.3.7 and 4.3.9): V/sqrt(6).
    /// - Back flow b is given and drawn back. A nozzle in air draws in air in its place, so between nothing and b stays
    ///   with the vessel: the root of the mean square is b/sqrt(3). Only an end that is said to be in air has the
    ///   share: an immersed one draws the fluid itself back.
    #[must_use]
    pub(crate) fn with_outlet(mut self, file: &PumpFile, drop_ml: f64, backflow_ml: f64) -> Self {
        let is_said = file.outlet.end == Some(OutletEnd::Air);
        let lost_ml = if is_said { backflow_ml } else { 0.0 };
        self.shares.push(Share::new(ShareSource::Drop, drop_ml / sqrt(6.0)));
        self.shares.push(Share::new(ShareSource::Backflow, lost_ml / sqrt(3.0)));
        self.with_percentages()
    }

    /// Returns the budget without the share of the back flow.
    #[must_use]
    pub(crate) fn beside_back_flow(&self) -> Self {
        let mut beside = self.clone();
        beside.shares.retain(|share| share.source != ShareSource::Backflow);
        beside.with_percentages()
    }
}

#[cfg(test)]
mod tests {
    use pump_ctl::plan::{Cruise, Doser, Phase, Request};

    use super::*;
    use crate::dosing::Swept;
    use crate::pump_file::{HoseTable, LineTable};

    fn file() -> PumpFile {
        crate::catalogue::built_in("three-roller").unwrap()
    }

    fn shares_ml(file: &PumpFile, backflow_ml: f64) -> [f64; 2] {
        let pump = file.model().unwrap();
        let request = Request::new(0.005, Cruise::Flow { ml_s: 0.1 });
        let plan = Doser::new(&pump, file.limits()).unwrap().plan(Phase::known(0.3), &request).unwrap();
        let budget = Budget::new(&pump, &Swept::whole(&pump, &plan), &file.uncertainty, None).with_outlet(
            file,
            drop_ml(file).unwrap(),
            backflow_ml,
        );
        [ShareSource::Drop, ShareSource::Backflow]
            .map(|source| budget.shares.iter().find(|share| share.source == source).unwrap().standard_ml)
    }

    #[test]
    fn an_unknown_nozzle_is_one_of_4_mm_in_air_and_loses_no_back_flow() {
        // Harkins and Brown's table gives 59.95 uL of water at 25 °C from 4 mm.
        let [drop_ml, back_ml] = shares_ml(&file(), 0.06);
        assert!((drop_ml / (0.05995 / 6_f64.sqrt()) - 1.0).abs() < 0.01 && back_ml == 0.0, "{drop_ml}");
    }

    #[test]
    fn a_nozzle_in_air_has_both_shares_and_an_immersed_one_none() {
        let mut file = file();
        file.outlet.nozzle_bore_mm = Some(1.0);
        file.outlet.end = Some(OutletEnd::Air);
        let [drop_ml, back_ml] = shares_ml(&file, 0.06);
        assert!((drop_ml / (0.01917 / 6_f64.sqrt()) - 1.0).abs() < 0.02, "{drop_ml}");
        assert!((back_ml - 0.034_641).abs() < 1e-6);
        file.outlet.end = Some(OutletEnd::Immersed);
        assert_eq!(shares_ml(&file, 0.06), [0.0, 0.0]);
    }

    #[test]
    fn an_unknown_bore_is_that_of_the_outlets_hose() {
        let mut file = file();
        let hose = HoseTable {
            bore_radius_mm: 5.0,
            outer_radius_mm: 7.0,
            length_mm: 331.0,
            modulus_mpa: 3.5,
            poisson_ratio: 0.5,
            minor_loss: 5.75,
            resistance_at_ml_s: None,
        };
        file.outlet = LineTable::of_hose(88.637, hose).into();
        assert!((drop_ml(&file).unwrap() / 0.13992 - 1.0).abs() < 0.01);
        // Ethanol has less than a third of water's tension.
        file.fluid = file.fluid.changed_to(Some("ethanol"), None).unwrap();
        let as_water_ml = drop_ml(&file).unwrap();
        file.fluid.surface_tension_mn_m = Some(22.0);
        assert!(drop_ml(&file).unwrap() < 0.5 * as_water_ml);
    }
}
