//! The suction margin: how far the inlet pressure stays above vapour and collapse.

use std::f64::consts::PI;

use pump_model::SteadyState;

use crate::pump_file::{PumpFile, TubeTable};

/// Standard acceleration of free fall, in m/s² (3rd CGPM, 1901; ISO 80000-3).
const GRAVITY_M_S2: f64 = 9.806_65;

/// The suction margin.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Suction {
    /// Vapour pressure of the fluid, in kPa absolute. `None` if it is not known.
    pub vapour_kpa: Option<f64>,
    /// Available net positive suction head by the smallest inlet pressure, in m of the fluid:
    /// (p_min - p_vapour)/(rho g). The velocity head is left out. `None` if the vapour pressure is not known.
    pub npsh_m: Option<f64>,
    /// Available net positive suction head by the mean inlet pressure, in m of the fluid.
    pub npsh_mean_m: Option<f64>,
    /// Pressure at which the pump's tube collapses, in kPa absolute. `None` if the tube's material is not known.
    pub collapse_kpa: Option<f64>,
    /// Pressure at which the hose of the inlet collapses, in kPa absolute, by a modulus that is assumed. `None` if it
    /// stands a vacuum, or where the line is no hose.
    pub hose_collapse_kpa: Option<f64>,
    /// Smallest pressure that is allowed at the inlet, in kPa absolute. `None` if nothing is known of it.
    pub limit_kpa: Option<f64>,
    /// Smallest inlet pressure less that limit, in kPa.
    pub margin_kpa: Option<f64>,
    /// Pressure that the mean flow loses by friction in the half of the swept tube that sucks, in kPa, at least:
    /// laminar flow through the bore, without the tube outside of the rollers' way. `None` if bore or viscosity is
    /// not known. The inlet pressure does not hold it.
    pub own_kpa: Option<f64>,
}

impl Suction {
    /// Returns true if the friction in the pump's own tube leaves nothing of the margin.
    pub(super) fn is_used_up(&self) -> bool {
        self.own_kpa.zip(self.margin_kpa).is_some_and(|(own_kpa, margin_kpa)| own_kpa >= margin_kpa)
    }
}

/// Returns the pressure that `flow_ml_s` loses in the half of the swept tube that sucks, in kPa.
///
/// Hagen and Poiseuille: dp = 8 mu l Q/(pi r⁴), with l = V_rev/(2 pi r²).
fn own_kpa(file: &PumpFile, revolution_ml: f64, flow_ml_s: f64) -> Option<f64> {
    let bore_mm = file.head.as_ref().and_then(|head| head.tube_bore_mm);
    let radius_mm = bore_mm.map(|mm| 0.5 * mm).or(file.tube.bore_radius_mm)?;
    let viscosity_mpa_s = file.fluid.fluid().ok()?.viscosity_mpa_s;
    let area_mm2 = PI * radius_mm * radius_mm;
    let length_mm = 0.5 * 1e3 * revolution_ml / area_mm2;
    Some(8e-3 * viscosity_mpa_s * length_mm * flow_ml_s * PI / (area_mm2 * area_mm2))
}

/// Returns the suction margin of a steady state, of a pump that displaces `revolution_ml`, at a mean flow.
pub(super) fn suction(file: &PumpFile, steady: &SteadyState, revolution_ml: f64, flow_ml_s: f64) -> Suction {
    let vapour_kpa = file.fluid.vapour_kpa();
    let metre_kpa = 1e-3 * file.fluid.density_kg_m3 * GRAVITY_M_S2;
    let npsh = |kpa: f64| vapour_kpa.map(|vapour_kpa| (kpa - vapour_kpa) / metre_kpa);
    let below = |tube: &TubeTable| {
        let kpa = file.ambient.pressure_kpa - tube.collapse_below_ambient_kpa()?;
        Some(kpa).filter(|kpa| *kpa > 0.0)
    };
    let limit_kpa = file.limits().lowest_where_it_sucks().map(|lowest| lowest.kpa);
    let hose = file.inlet.hose().map(|hose| TubeTable {
        bore_radius_mm: Some(hose.bore_radius_mm),
        outer_radius_mm: Some(hose.outer_radius_mm),
        modulus_mpa: Some(hose.modulus_mpa),
        poisson_ratio: Some(hose.poisson_ratio),
        life_ml: None,
        life_h: None,
        life_rev: None,
    });
    Suction {
        vapour_kpa,
        npsh_m: npsh(steady.inlet.min_kpa),
        npsh_mean_m: npsh(steady.inlet_mean_kpa),
        collapse_kpa: below(&file.tube),
        hose_collapse_kpa: hose.as_ref().and_then(below),
        limit_kpa,
        margin_kpa: limit_kpa.map(|limit_kpa| steady.inlet.min_kpa - limit_kpa),
        own_kpa: own_kpa(file, revolution_ml, flow_ml_s),
    }
}
