//! `dose pumps`: built-in pumps and pump files.

use pump_dose::pump_file::{LineTable, PumpFile, RollerVolumeTable};
use pump_dose::rust_source::rust_source;
use pump_dose::{BUILT_IN, built_in, pump_named};
use pump_model::math::degrees;
use pump_model::{Line, RollerVolume};

use super::args::{Format, Options, PumpsCommand, SHOW};
use super::{Failure, print};

pub(crate) fn pumps(command: Option<&PumpsCommand>, options: &Options) -> Result<(), Failure> {
    match command {
        Some(PumpsCommand::Show { .. }) => options.accept_only(SHOW, &["--format"])?,
        _ => options.accept_only("dose pumps", &[])?,
    }
    match command {
        None | Some(PumpsCommand::List) => {
            print(&BUILT_IN.map(|(name, what)| format!("{name:<24}{what}\n")).concat())
        }
        Some(PumpsCommand::Show { name }) => {
            let file = pump_named(name).map_err(Failure::refused)?;
            match options.format {
                None => print(&file.to_toml()),
                Some(Format::Rust) => print(&rust_source(&file).map_err(Failure::refused)?),
                Some(Format::Text | Format::Json) => Err(Failure::refused(
                    "`dose pumps show` prints a pump file (TOML), or Rust with `--format rust`",
                )),
            }
        }
        Some(PumpsCommand::New(drawing)) => drawing.write(),
        Some(PumpsCommand::Check { file }) => {
            if !file.exists() && file.to_str().is_some_and(|name| built_in(name).is_some()) {
                let name = file.display();
                return Err(Failure::refused(format!(
                    "{name} is built in; `dose pumps show {name}` prints its file"
                )));
            }
            let file = PumpFile::read(file).map_err(Failure::refused)?;
            print(&summary(&file)?)
        }
    }
}

/// What a pump gives, in a few lines.
fn summary(file: &PumpFile) -> Result<String, Failure> {
    let pump = file.model().map_err(Failure::refused)?;
    let limits = file.limits();
    let revolution_ml = pump.revolution_ml();
    let (low, high) = pump.outlet_curve().flow_range_ml_rad();
    let geometry = pump.geometry();
    let apart_mm = 2.0 * geometry.roller_offset_mm * (0.5 * pump.pitch_rad()).sin();
    let overlap = if apart_mm < 2.0 * geometry.roller_radius_mm {
        format!("  warning   the rollers' axes stand {apart_mm:.2} mm apart: less than their diameter\n")
    } else {
        String::new()
    };
    Ok(format!(
        "{} ({}): ok\n\n  \
         roller    {}\n  \
         volume    {revolution_ml:.4} mL per revolution, {:.4} mL per pitch of {:.2}°\n  \
         flow      {low:.4} to {high:.4} mL/rad at the outlet rollers\n  \
         fastest   {} r/min, {:.3} mL/s\n  \
         step      {} per revolution, {:.3} µL on average\n  \
         fluid     {} at {} °C, {} kg/m³\n  \
         inlet     {}\n  \
         outlet    {}\n  \
         unsure    {} % of the volume and {} mL of a roller (standard uncertainty)\n{overlap}",
        file.pump.id,
        file.pump.name,
        roller_text(file, pump.roller_volume())?,
        pump.outlet_curve().pitch_ml(),
        degrees(pump.pitch_rad()),
        file.motor.max_speed_rpm,
        pump.average_flow_ml_s(limits.motor.max_speed_rad_s),
        limits.motor.steps_per_rev,
        1e3 * revolution_ml / limits.motor.steps_per_rev,
        file.fluid.name,
        file.fluid.temperature_degc,
        file.fluid.density_kg_m3,
        line_text(file, &file.inlet, pump.inlet()),
        line_text(file, &file.outlet, pump.outlet()),
        file.uncertainty.model_percent,
        file.uncertainty.roller_volume_ml,
    ))
}

/// A roller's volume and where it comes from.
fn roller_text(file: &PumpFile, curve: &RollerVolume) -> Result<String, Failure> {
    let source = match &file.roller_volume {
        RollerVolumeTable::Polynomial { .. } => "from its polynomial".to_owned(),
        RollerVolumeTable::Drawing => "estimated from the drawing".to_owned(),
        RollerVolumeTable::Measured { fit, points } => {
            let fit = fit.of(points).map_err(Failure::refused)?;
            let mut source = format!("from {} measured points, {:.4} mL RMS off", points.len(), fit.rms_ml());
            for (from_deg, to_deg, fall_ml) in fit.falls().into_iter().flatten() {
                source += &format!("; they fall by {fall_ml:.4} mL from {from_deg:.2}° to {to_deg:.2}°");
            }
            source
        }
    };
    Ok(format!("{:.4} mL over {:.2}°, {source}", curve.total_ml(), curve.engagement_deg()))
}

/// A line and where it comes from.
fn line_text(file: &PumpFile, table: &LineTable, line: &Line) -> String {
    let source = match table {
        LineTable::Given(_) => "as given".to_owned(),
        LineTable::Hose { hose, .. } => {
            let at_ml_s = hose.resistance_at_ml_s.unwrap_or(file.pump.default_rate_ml_s);
            format!("estimated from its hose, R at {at_ml_s} mL/s")
        }
    };
    format!(
        "R {:.4} kPa s/mL, C {:.4} mL/kPa, L {:.5} kPa s²/mL, {source}",
        line.resistance_kpa_s_ml, line.compliance_ml_kpa, line.inertance_kpa_s2_ml
    )
}
