//! The Rust source of a pump, for firmware. Its constants need no set-up and no memory but flash.

use std::fmt::Write;

use pump_ctl::plan::{Lowest, Torque};
use pump_model::{FlowCurve, Geometry, Line, ModelError, Pump};

use crate::pump_file::PumpFile;

/// Largest width of a line of curve data in the source, columns.
const WIDTH: usize = 110;

/// Returns the Rust source of a pump. It holds the pump's model, computed and checked here, and its limits.
///
/// # Errors
///
/// Fails with the [`ModelError`] of a pump file that has no model.
pub fn rust_source(file: &PumpFile) -> Result<String, ModelError> {
    let pump = file.model()?;
    let limits = file.limits();
    let motor = limits.motor;
    let mut source = format!(
        "// {} ({}), for the crates pump-model and pump-ctl {}.\n\
         // `dose pumps show` wrote this file. Change the pump file, not this source.\n\
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
        "/// Limits of every dose: motor, pressures and torque.\n\
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

fn write_pump(out: &mut String, pump: &Pump) {
    out.push_str("/// Model of the pump.\n#[rustfmt::skip]\npub const PUMP: Pump = Pump::precomputed(\n");
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
        push_wrapped(out, &format!("        {piece:?},"));
    }
    out.push_str("    ]),\n    [\n");
    write_line(out, pump.inlet());
    write_line(out, pump.outlet());
    out.push_str("    ],\n    [\n");
    write_curve(out, pump.inlet_curve());
    write_curve(out, pump.outlet_curve());
    out.push_str("    ],\n);\n\n");
}

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

fn write_line(out: &mut String, line: &Line) {
    let _ = writeln!(
        out,
        "        Line {{\n            \
             resistance_kpa_s_ml: {:?},\n            \
             compliance_ml_kpa: {:?},\n            \
             inertance_kpa_s2_ml: {:?},\n            \
             reservoir_kpa: {:?},\n        \
         }},",
        line.resistance_kpa_s_ml, line.compliance_ml_kpa, line.inertance_kpa_s2_ml, line.reservoir_kpa,
    );
}

/// Appends a line, divided after commas where it is wider than [`WIDTH`].
fn push_wrapped(out: &mut String, line: &str) {
    let indent = line.len() - line.trim_start().len() + 4;
    let mut rest = line.to_owned();
    while rest.len() > WIDTH
        && let Some(comma) = rest.get(..WIDTH).and_then(|start| start.rfind(", "))
    {
        let (head, tail) = rest.split_at(comma + 1);
        out.push_str(head);
        out.push('\n');
        rest = format!("{:indent$}{}", "", tail.trim_start());
    }
    out.push_str(&rest);
    out.push('\n');
}

fn write_curve(out: &mut String, curve: &FlowCurve) {
    let _ =
        writeln!(out, "        FlowCurve::precomputed({:?}, {:?}, &[", curve.pitch_rad(), curve.pitch_ml());
    for piece in curve.precomputed_pieces() {
        push_wrapped(out, &format!("            {piece:?},"));
    }
    out.push_str("        ]),\n");
}
