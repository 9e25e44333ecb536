//! The built-in pumps: the pump of McIntyre et al., with three and two rollers, in the variants of its
//! figures.
//!
//! McIntyre, van Schoor, Uren, Kloppers, "Modelling the pulsatile flow rate and pressure response of a
//! roller-type peristaltic pump", Sensors and Actuators A.

use std::path::Path;

use pump_model::roller_volume::{PUBLISHED_COEFFICIENTS_DEG, PUBLISHED_ENGAGEMENT_DEG, PUBLISHED_TOTAL_ML};
use pump_model::{Geometry, Line, PUBLISHED_CONTACT_ANGLE_DEG, Variant};

use crate::pump_file::{
    AmbientTable, BackplateTable, FluidTable, LimitsTable, LineTable, MotorTable, PumpFile, PumpFileError,
    PumpTable, RollerVolumeTable, RollersTable, SCHEMA, SafetyTable, SpeedLawTable, TubeTable,
    UncertaintyTable,
};

/// Names of the built-in pumps, each with its description.
pub const BUILT_IN: [(&str, &str); 6] = [
    ("three-roller", "the paper's pump with 3 rollers: Table 1, measured roller volume 2.1055 mL"),
    ("two-roller", "the paper's pump with 2 rollers: Table 1, measured roller volume 2.1055 mL"),
    ("three-roller-published", "3 rollers, the curve scaled to the roller volume of Table 1, 2.06 mL"),
    ("two-roller-published", "2 rollers, the curve scaled to the roller volume of Table 1, 2.06 mL"),
    ("three-roller-as-built", "3 rollers, dimensions of the authors' published code"),
    ("two-roller-as-built", "2 rollers, dimensions of the authors' published code"),
];

/// Returns the built-in pump of a name, or `None` for another name.
///
/// ```
/// let pump = pump_bench::built_in("three-roller").unwrap();
/// assert_eq!(pump.motor.steps_per_rev, 12_800);
/// assert!(pump_bench::built_in("four-roller").is_none());
/// ```
pub fn built_in(name: &str) -> Option<PumpFile> {
    let (known, _) = BUILT_IN.iter().find(|(known, _)| *known == name)?;
    let rollers = if known.starts_with("three") { 3 } else { 2 };
    let variant = match known {
        known if known.ends_with("published") => Variant::Published,
        known if known.ends_with("as-built") => Variant::AsBuilt,
        _ => Variant::Measured,
    };
    Some(published(known, rollers, variant))
}

/// Returns a built-in pump, or reads a pump file if the name is a path.
///
/// A name is a path if it has a `/` or a `\`, ends in `.toml`, or exists as a file.
///
/// ```
/// assert_eq!(pump_bench::pump_named("two-roller")?.rollers.count, 2);
/// assert!(pump_bench::pump_named("four-roller").is_err());
/// # Ok::<(), pump_bench::pump_file::PumpFileError>(())
/// ```
///
/// # Errors
/// [`PumpFileError::Unknown`] for a name that is neither a built-in pump nor a path. Otherwise as
/// [`PumpFile::read`].
pub fn pump_named(name: &str) -> Result<PumpFile, PumpFileError> {
    if let Some(file) = built_in(name) {
        return Ok(file);
    }
    let path = Path::new(name);
    if path.exists() || name.contains(['/', '\\']) || name.ends_with(".toml") {
        return PumpFile::read(path);
    }
    let known = BUILT_IN.map(|(known, _)| known).join(", ");
    Err(PumpFileError::Unknown { name: name.to_owned(), known })
}

/// Returns the pump of McIntyre et al. with this number of rollers, in a variant of its figures.
fn published(id: &str, rollers: u32, variant: Variant) -> PumpFile {
    let geometry = Geometry::published(rollers, variant);
    let line = LineTable::from(Line::PUBLISHED);
    PumpFile {
        schema: SCHEMA.to_owned(),
        pump: PumpTable {
            id: id.to_owned(),
            name: format!("McIntyre et al., {rollers} rollers"),
            default_rate_ml_s: 5.0,
            mark_angle_deg: None,
        },
        head: None,
        tube: TubeTable {
            bore_radius_mm: Some(geometry.bore_radius_mm),
            outer_radius_mm: Some(geometry.tube_outer_radius_mm),
            // Soft PVC, nearly incompressible: estimates, as the paper gives neither.
            modulus_mpa: Some(3.5),
            poisson_ratio: Some(0.49),
            life_ml: None,
            life_h: None,
            life_rev: None,
        },
        rollers: RollersTable {
            count: rollers,
            radius_mm: Some(geometry.roller_radius_mm),
            offset_mm: Some(geometry.roller_offset_mm),
        },
        backplate: Some(BackplateTable {
            radius_mm: geometry.backplate_radius_mm,
            contact_angle_deg: PUBLISHED_CONTACT_ANGLE_DEG,
        }),
        roller_volume: Some(RollerVolumeTable::Polynomial {
            engagement_angle_deg: PUBLISHED_ENGAGEMENT_DEG,
            polynomial_ml_deg: PUBLISHED_COEFFICIENTS_DEG,
            total_ml: (variant == Variant::Published).then_some(PUBLISHED_TOTAL_ML),
        }),
        speed_law: SpeedLawTable::default(),
        inlet: line.clone(),
        outlet: line.into(),
        motor: motor(rollers),
        fluid: water(),
        ambient: AmbientTable::of_pressure_kpa(85.7),
        limits: LimitsTable::default(),
        safety: SafetyTable::default(),
        uncertainty: uncertainty(),
        drive: None,
    }
}

/// Returns the motor, with the speeds of the flow tests of McIntyre et al. with this number of rollers.
fn motor(rollers: u32) -> MotorTable {
    MotorTable {
        steps_per_rev: 12_800,
        full_steps_per_rev: 200,
        gear: 1.0,
        // Flow tests in Table 2 of McIntyre et al.: 10 to 170 r/min with 3 rollers, 10 to 300 with 2. Their pressure
        // tests reach 200.
        max_speed_rpm: if rollers == 3 { 170.0 } else { 300.0 },
        max_acceleration_rad_s2: 500.0,
        torque_curve_rpm_n_m: None,
        occlusion_torque_n_m: None,
        inertia_kg_m2: None,
        // The motor of the paper: nobody has said that it is the motor at hand.
        confirmed: Some(false),
        direction_confirmed: None,
    }
}

/// Returns water at 25 °C.
fn water() -> FluidTable {
    FluidTable {
        name: "water".to_owned(),
        temperature_degc: 25.0,
        density_kg_m3: 997.0,
        viscosity_mpa_s: None,
        bulk_modulus_mpa: None,
        vapour_kpa: None,
        surface_tension_mn_m: None,
        replaced: None,
    }
}

/// Returns the uncertainties that follow from the figures of McIntyre et al.
fn uncertainty() -> UncertaintyTable {
    UncertaintyTable {
        // NRMSE of the linear model over all speeds with 3 rollers, 2.37 %, McIntyre et al., Section 5.1.
        model_percent: 2.4,
        // The NRMSE is over all speeds, the one with 9.02 % among them.
        speed_percent: None,
        // 1 mL of 212.5 mL, the largest standard deviation of 10 revolutions under 160 r/min in McIntyre et
        // al.
        repeatability_percent: 0.47,
        repeatability_at_ml: None,
        // The tabulated 2.06 mL and the 2.1055 mL of the measured points: (2.1055 - 2.06)/sqrt(3),
        // rectangular.
        roller_volume_ml: Some(0.026),
        assumed: false,
        replaces_papers: false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use pump_model::Pump;

    #[test]
    fn every_built_in_pump_is_the_models_preset_and_survives_its_own_file() {
        for (name, _) in BUILT_IN {
            let file = built_in(name).unwrap();
            assert_eq!(PumpFile::parse(&file.to_toml(), name).unwrap(), file, "{name}");
        }
        assert_eq!(built_in("three-roller").unwrap().model().unwrap(), Pump::three_roller());
        assert_eq!(built_in("two-roller").unwrap().model().unwrap(), Pump::two_roller());
        assert_eq!(
            built_in("two-roller-published").unwrap().model().unwrap(),
            Pump::preset(2, Variant::Published).unwrap()
        );
        assert_eq!(
            built_in("three-roller-as-built").unwrap().model().unwrap(),
            Pump::preset(3, Variant::AsBuilt).unwrap()
        );
    }
}
