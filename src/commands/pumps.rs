//! `dose pumps`: built-in pumps and pump files.

use pump_bench::catalogue::BUILT_IN;
use pump_bench::displacement::RangedLaw;
use pump_bench::export::rust_source;
use pump_bench::pump_file::{LineTable, PumpFile, RollerVolumeTable};
use pump_bench::{built_in, pump_named};
use pump_model::math::{degrees, rad_s};
use pump_model::{Line, Pump, RollerVolume};

use crate::failure::{Failure, print};
use crate::options::{Format, Options, PumpsCommand, SHOW};

pub(crate) fn pumps(command: Option<&PumpsCommand>, options: &Options) -> Result<(), Failure> {
    match command {
        Some(PumpsCommand::Show { .. }) => options.accept_only(SHOW, &["--format"])?,
        Some(PumpsCommand::New(_)) => options.accept_only("dose pumps new", &["--plot"])?,
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
                Some(Format::Rust) if file.speed_law.standard().is_some() => Err(Failure::refused(
                    "firmware plans with one volume of a revolution, and this file has a speed law; write kind = \"none\" into its \
                     [speed_law] for the firmware",
                )),
                Some(Format::Rust) => print(&rust_source(&file).map_err(Failure::refused)?),
                Some(Format::Text | Format::Json) => Err(Failure::refused(
                    "`dose pumps show` prints a pump file (TOML), or Rust with `--format rust`",
                )),
            }
        }
        Some(PumpsCommand::New(drawing)) => drawing.write(options),
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
         speed law {}\n  \
         fastest   {} r/min, {:.3} mL/s\n  \
         step      {} per revolution, {:.3} µL on average\n  \
         fluid     {} at {} °C, {} kg/m³\n  \
         inlet     {}\n  \
         outlet    {}\n  \
         unsure    {} % of the volume{} and {} mL of a roller (standard uncertainty)\n{overlap}",
        file.pump.id,
        file.pump.name,
        roller_text(file, pump.roller_volume())?,
        pump.outlet_curve().pitch_ml(),
        degrees(pump.pitch_rad()),
        speed_law_text(file, &pump)?,
        file.motor.max_speed_rpm,
        fastest_ml_s(file, &pump)?,
        limits.motor.steps_per_rev,
        1e3 * revolution_ml / limits.motor.steps_per_rev,
        file.fluid.name,
        file.fluid.temperature_degc,
        file.fluid.density_kg_m3,
        line_text(file, &file.inlet, pump.inlet()),
        line_text(file, &file.outlet, pump.outlet()),
        100.0 * file.speed_law.standard().unwrap_or(file.uncertainty.model_percent / 100.0),
        if file.speed_law.standard().is_some() { " (the speed law's)" } else { "" },
        file.uncertainty.roller_volume_ml,
    ))
}

/// How the volume depends on the speed.
fn speed_law_text(file: &PumpFile, pump: &Pump) -> Result<String, Failure> {
    let Some(RangedLaw { law, least_rpm, most_rpm }) = file.speed_law().map_err(Failure::refused)? else {
        return Ok("none: the same volume at every speed".to_owned());
    };
    let factor = |rpm: f64| law.factor(pump, rad_s(rpm)).map_err(Failure::refused);
    Ok(format!(
        "inlet-pressure, s {}, D {:e} /kPa, closed at {:.2}°: {least_rpm} to {most_rpm} r/min, times {:.4} to {:.4}; experimental",
        law.scale,
        law.distensibility_per_kpa,
        degrees(law.closure_rad),
        factor(least_rpm)?,
        factor(most_rpm)?,
    ))
}

/// Mean flow at the motor's fastest speed, or the largest that the speed law gives up to it, mL/s.
fn fastest_ml_s(file: &PumpFile, pump: &Pump) -> Result<f64, Failure> {
    let most_rpm = file.motor.max_speed_rpm;
    match file.speed_law().map_err(Failure::refused)? {
        None => Ok(pump.average_flow_ml_s(file.limits().motor.max_speed_rad_s)),
        Some(law) => law.up_to(most_rpm).largest_ml_s(pump).map_err(Failure::refused),
    }
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
