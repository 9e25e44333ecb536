//! `dose pumps`: built-in pumps and pump files.

use pump_dose::pump_file::PumpFile;
use pump_dose::rust_source::rust_source;
use pump_dose::{BUILT_IN, built_in};
use pump_model::math::degrees;

use super::args::{Format, Options, PumpsCommand, SHOW, pump_named};
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
            let file = pump_named(name)?;
            match options.format {
                None => print(&file.to_toml()),
                Some(Format::Rust) => print(&rust_source(&file).map_err(Failure::refused)?),
                Some(Format::Text | Format::Json) => Err(Failure::refused(
                    "`dose pumps show` prints a pump file (TOML), or Rust with `--format rust`",
                )),
            }
        }
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
         volume    {revolution_ml:.4} mL per revolution, {:.4} mL per pitch of {:.2}°\n  \
         flow      {low:.4} to {high:.4} mL/rad at the outlet rollers\n  \
         fastest   {} r/min, {:.3} mL/s\n  \
         step      {} per revolution, {:.3} µL on average\n  \
         fluid     {} at {} °C, {} kg/m³\n{overlap}",
        file.pump.id,
        file.pump.name,
        pump.outlet_curve().pitch_ml(),
        degrees(pump.pitch_rad()),
        file.motor.max_speed_rpm,
        pump.average_flow_ml_s(limits.motor.max_speed_rad_s),
        limits.motor.steps_per_rev,
        1e3 * revolution_ml / limits.motor.steps_per_rev,
        file.fluid.name,
        file.fluid.temperature_degc,
        file.fluid.density_kg_m3,
    ))
}
