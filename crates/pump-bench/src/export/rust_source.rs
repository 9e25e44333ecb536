//! A pump as Rust source for firmware: constants that need no set-up and no memory but flash.

use std::fmt::Write;

use pump_ctl::plan::{Lowest, Torque};
use pump_model::{FlowCurve, Geometry, Line, ModelError, Pump};

use crate::pump_file::PumpFile;

/// Writes the Rust source of a pump: its limits and its model, which is computed and checked here.
///
/// # Errors
/// Returns the [`ModelError`] of a pump that cannot work.
pub fn rust_source(file: &PumpFile) -> Result<String, ModelError> {
    let pump = file.model()?;
    let limits = file.limits();
    let motor = limits.motor;
    let mut source = format!(
        "// {} ({}), for the crates pump-model and pump-ctl {}.\n\
         // Written by `dose pumps show`; change the pump file, not this.\n\
         // Units: mm, rad, mL, kPa, s.\n\n",
        file.pump.name,
        file.pump.id,
        env!("CARGO_PKG_VERSION"),
    );
    let out = &mut source;
    let torque = if limits.torque.is_some() { ", Torque, TorqueCurve" } else { "" };
    let (lowest, set_by) = if limits.lowest.is_some() { (", Lowest", ", SetBy") } else { ("", "") };
    let _ = writeln!(out, "use pump_ctl::plan::{{Limits{lowest}, Motor, PressureLimits{set_by}{torque}}};");
    out.push_str("use pump_model::{FlowCurve, Geometry, Line, Pump, RollerVolume};\n\n");

    write_pump(out, &pump);
    let option = |limit: Option<f64>| limit.map_or("None".to_owned(), |kpa| format!("Some({kpa:?})"));
    let _ = write!(
        out,
        "/// Limits that a dose must keep.\n\
         pub const LIMITS: Limits = Limits {{\n    \
             motor: Motor {{\n        \
                 steps_per_rev: {:?},\n        \
                 max_speed_rad_s: {:?},\n        \
                 max_acceleration_rad_s2: {:?},\n    \
             }},\n    \
             pressures: PressureLimits {{ max_outlet_kpa: {}, min_inlet_kpa: {} }},\n    \
             lowest: {},\n    \
             torque: {},\n\
         }};\n",
        motor.steps_per_rev,
        motor.max_speed_rad_s,
        motor.max_acceleration_rad_s2,
        option(limits.pressures.max_outlet_kpa),
        option(limits.pressures.min_inlet_kpa),
        limits.lowest.map_or("None".to_owned(), |Lowest { kpa, set_by }| {
            format!("Some(Lowest {{ kpa: {kpa:?}, set_by: SetBy::{set_by:?} }})")
        }),
        limits.torque.as_ref().map_or("None".to_owned(), torque_source),
    );
    Ok(source)
}

/// Returns the source of a torque limit.
fn torque_source(torque: &Torque) -> String {
    format!(
        "Some(Torque {{\n        \
             occlusion_n_m: {:?},\n        \
             inertia_kg_m2: {:?},\n        \
             ambient_kpa: {:?},\n        \
             motor: TorqueCurve::precomputed({:?}),\n    \
         }})",
        torque.occlusion_n_m,
        torque.inertia_kg_m2,
        torque.ambient_kpa,
        torque.motor.precomputed_points(),
    )
}

/// Writes the constant of the pump.
fn write_pump(out: &mut String, pump: &Pump) {
    out.push_str("/// The pump.\n#[rustfmt::skip]\npub const PUMP: Pump = Pump::precomputed(\n");
    write_geometry(out, pump.geometry());
    let volume = pump.roller_volume();
    let _ = writeln!(
        out,
        "    RollerVolume::precomputed({:?}, {:?}, {:?}, &[",
        volume.engagement_rad(),
        volume.inset_rad(),
        volume.total_ml()
    );
    for piece in volume.precomputed_pieces() {
        let _ = writeln!(out, "        {piece:?},");
    }
    out.push_str("    ]),\n    [\n");
    write_line(out, pump.inlet());
    write_line(out, pump.outlet());
    out.push_str("    ],\n    [\n");
    write_curve(out, pump.inlet_curve());
    write_curve(out, pump.outlet_curve());
    out.push_str("    ],\n);\n\n");
}

/// Writes the dimensions of the pump head.
fn write_geometry(out: &mut String, geometry: &Geometry) {
    let _ = writeln!(
        out,
        "    Geometry {{\n        \
             rollers: {},\n        \
             bore_radius_mm: {:?},\n        \
             tube_outer_radius_mm: {:?},\n        \
             backplate_radius_mm: {:?},\n        \
             contact_angle_rad: {:?},\n        \
             roller_radius_mm: {:?},\n        \
             roller_offset_mm: {:?},\n    \
         }},",
        geometry.rollers,
        geometry.bore_radius_mm,
        geometry.tube_outer_radius_mm,
        geometry.backplate_radius_mm,
        geometry.contact_angle_rad,
        geometry.roller_radius_mm,
        geometry.roller_offset_mm,
    );
}

/// Writes a line with its R, C, L and reservoir.
fn write_line(out: &mut String, line: &Line) {
    let _ = writeln!(
        out,
        "        Line {{ resistance_kpa_s_ml: {:?}, compliance_ml_kpa: {:?}, inertance_kpa_s2_ml: {:?}, \
             reservoir_kpa: {:?} }},",
        line.resistance_kpa_s_ml, line.compliance_ml_kpa, line.inertance_kpa_s2_ml, line.reservoir_kpa,
    );
}

/// Writes a flow curve with its precomputed pieces.
fn write_curve(out: &mut String, curve: &FlowCurve) {
    let _ =
        writeln!(out, "        FlowCurve::precomputed({:?}, {:?}, &[", curve.pitch_rad(), curve.pitch_ml());
    for piece in curve.precomputed_pieces() {
        let _ = writeln!(out, "            {piece:?},");
    }
    out.push_str("        ]),\n");
}
