//! The Rust source of a pump, for firmware. Its statics need no set-up and no memory but flash.

use std::fmt::Write;

use pump_ctl::generated::torque_points;
use pump_ctl::plan::{Lowest, Torque};
use pump_model::generated::{flow_pieces, volume_pieces};
use pump_model::{FlowCurve, Geometry, Line, Pump};

use crate::displacement::DisplacementError;
use crate::notice::{Remedy, Wording};
use crate::pump_file::PumpFile;

/// Largest width of a line of curve data in the source, columns.
const WIDTH: usize = 110;

/// Returns the Rust source of a pump. It holds the pump's model, computed and checked here, and its limits.
///
/// # Errors
///
/// [`DisplacementError::NotConstant`] if the pump's volumes depend on the speed, and
/// [`DisplacementError::Model`] if the pump file has no model.
pub fn rust_source(file: &PumpFile, words: Wording) -> Result<String, DisplacementError> {
    let pump = file.speed_dependent_pump()?.into_constant()?;
    let limits = file.limits();
    let motor = limits.motor;
    let mut source = header(file, words);
    let out = &mut source;
    let torque = if limits.torque.is_some() { ", Torque" } else { "" };
    if limits.torque.is_some() {
        out.push_str("use pump_ctl::generated::torque_curve;\n");
    }
    let (lowest, set_by) = if limits.lowest.is_some() { (", Lowest", ", SetBy") } else { ("", "") };
    let _ = writeln!(out, "use pump_ctl::plan::{{Limits{lowest}, Motor, PressureLimits{set_by}{torque}}};");
    out.push_str("use pump_model::generated::{flow_curve, pump, roller_volume};\n");
    out.push_str("use pump_model::{Geometry, Line, Pump};\n\n");

    write_pump(out, &pump);
    let _ = write!(
        out,
        "/// Limits of every dose: motor, pressures and torque.\n\
         pub static LIMITS: Limits = Limits::new(Motor::new({:?}, {:?}, {:?}))\n    \
             .with_pressures(PressureLimits {{ max_outlet_kpa: {:?}, min_inlet_kpa: {:?} }})",
        motor.steps_per_rev,
        motor.max_speed_rad_s,
        motor.max_acceleration_rad_s2,
        limits.pressures.max_outlet_kpa,
        limits.pressures.min_inlet_kpa,
    );
    if let Some(Lowest { kpa, set_by }) = limits.lowest {
        let _ = write!(out, "\n    .with_lowest(Lowest {{ kpa: {kpa:?}, set_by: SetBy::{set_by:?} }})");
    }
    if let Some(torque) = &limits.torque {
        out.push_str(&torque_source(torque));
    }
    out.push_str(";\n");
    Ok(source)
}

/// Returns the comment of the source, and the check that it is compiled with the crates that it is for.
fn header(file: &PumpFile, words: Wording) -> String {
    format!(
        "// {} ({}), for the crates pump-model and pump-ctl {}.\n\
         // This source was written from a pump file. Change the pump file, not this source.\n\
         // Units: mm, rad, mL, kPa, s.\n\n\
         const _: () = assert!(\n    \
             pump_model::generated::FORMAT == {} && pump_ctl::generated::FORMAT == {},\n    \
             \"other versions of pump-model and pump-ctl wrote this source: \\\n     \
             {}\"\n\
         );\n\n",
        one_line(&file.pump.name),
        file.pump.id,
        env!("CARGO_PKG_VERSION"),
        pump_model::generated::FORMAT,
        pump_ctl::generated::FORMAT,
        words(Remedy::PrintSource),
    )
}

/// Returns the call that adds the torque to the limits.
fn torque_source(torque: &Torque) -> String {
    format!(
        "\n    .with_torque(\n        \
             Torque::new(\n            \
                 {:?},\n            \
                 torque_curve({:?}).expect(\"the torque curve is whole\"),\n        \
             )\n        \
             .with_occlusion_n_m({:?})\n        \
             .with_inertia_kg_m2({:?}),\n    \
         )",
        torque.ambient_kpa,
        torque_points(&torque.motor),
        torque.occlusion_n_m,
        torque.inertia_kg_m2,
    )
}

/// Shows the control characters of a text, so that a comment does not end before its line.
fn one_line(text: &str) -> String {
    let mut line = String::new();
    for c in text.chars() {
        if c.is_control() { line.extend(c.escape_default()) } else { line.push(c) }
    }
    line
}

fn write_pump(out: &mut String, pump: &Pump) {
    out.push_str("/// Model of the pump.\n#[rustfmt::skip]\npub static PUMP: Pump = pump(\n");
    write_geometry(out, pump.geometry());
    let volume = pump.roller_volume();
    let _ = writeln!(
        out,
        "    roller_volume({:?}, {:?}, {:?}, &[",
        volume.engagement_rad(),
        volume.inset_rad(),
        volume.total_ml()
    );
    for piece in volume_pieces(volume) {
        push_wrapped(out, &format!("        {piece:?},"));
    }
    out.push_str("    ]),\n    [\n");
    write_line(out, pump.inlet());
    write_line(out, pump.outlet());
    out.push_str("    ],\n    [\n");
    write_curve(out, pump.inlet_curve());
    write_curve(out, pump.outlet_curve());
    out.push_str("    ],\n)\n.expect(\"the curves of the pump are whole\");\n\n");
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
    let _ = writeln!(out, "        flow_curve({:?}, {:?}, &[", curve.pitch_rad(), curve.pitch_ml());
    for piece in flow_pieces(curve) {
        push_wrapped(out, &format!("            {piece:?},"));
    }
    out.push_str("        ]),\n");
}
