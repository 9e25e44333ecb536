//! `dose status`: what is on record.

use pump_model::math::degrees;
use serde::Serialize;

use super::args::Options;
use super::{Failure, print};

/// What `dose status --format json` prints.
#[derive(Serialize)]
struct Status<'a> {
    schema: &'static str,
    pump: &'a str,
    driver: &'static str,
    recorded: bool,
    angle_deg: f64,
    half_width_deg: f64,
    carry_ml: f64,
    folder: String,
}

pub(crate) fn status(options: &Options) -> Result<(), Failure> {
    options.accept_only("dose status", &["--driver", "--format"])?;
    let bench = options.bench()?;
    let record = bench.folder().read()?;
    let status = Status {
        schema: "status/1",
        pump: &bench.file().pump.id,
        driver: bench.driver().as_str(),
        recorded: record.is_some(),
        angle_deg: record.as_ref().map_or(0.0, |record| degrees(record.angle_rad)),
        half_width_deg: record.as_ref().map_or(0.0, |record| degrees(record.half_width_rad)),
        carry_ml: record.as_ref().map_or(0.0, |record| record.carry_ml),
        folder: bench.folder().path().display().to_string(),
    };
    if options.json() {
        let json = serde_json::to_string(&status).map_err(Failure::refused)?;
        return print(&(json + "\n"));
    }
    let Status { pump, driver, angle_deg, .. } = status;
    if !status.recorded {
        return print(&format!(
            "{pump} ({driver}): nothing on record; a fresh simulated pump stands at 0°\n"
        ));
    }
    let width = match status.half_width_deg {
        0.0 => String::new(),
        width => format!(" ± {width:.2}°"),
    };
    print(&format!(
        "{pump} ({driver}): rotor at {angle_deg:.4}°{width}, {:.2} µL carried to the next dose\n",
        1e3 * status.carry_ml,
    ))
}
