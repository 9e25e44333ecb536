//! `dose pumps new`: a pump file from a drawing.

use std::path::{Path, PathBuf};

use clap::Args;
use pump_dose::pump_file::PumpFile;
use pump_dose::quantity::{self, TubeSize};
use pump_dose::{DrawnPump, Staged};
use pump_model::Geometry;

use super::{Failure, print};

/// What a drawing says.
#[derive(Debug, Args)]
pub(crate) struct NewPump {
    /// Bore x outer diameter of the tube, as 10x14mm
    #[arg(long, value_name = "SIZE", value_parser = quantity::tube_size)]
    tube: TubeSize,
    /// Radius of the backplate (raceway), as 63mm
    #[arg(long, value_name = "RADIUS", value_parser = quantity::length_mm)]
    backplate: f64,
    /// Radius of a roller, as 20mm
    #[arg(long, value_name = "RADIUS", value_parser = quantity::length_mm)]
    roller: f64,
    /// From the shaft to a roller's axis, as 40mm
    #[arg(long, value_name = "LENGTH", value_parser = quantity::length_mm)]
    offset: f64,
    /// Contact angle: the backplate spans 180deg and twice this, as 30deg
    #[arg(long, value_name = "ANGLE", value_parser = quantity::angle_rad)]
    contact: f64,
    /// Number of rollers
    #[arg(long, value_name = "N")]
    rollers: u32,
    /// Name of the pump in records [default: FILE's name without its ending, or my-pump]
    #[arg(long)]
    id: Option<String>,
    /// Length of the hose on either side, as 0.5m
    #[arg(long, value_name = "LENGTH", default_value = "331mm", value_parser = quantity::length_mm)]
    hose: f64,
    /// Where to write it; it must not be there yet [default: standard output]
    #[arg(value_name = "FILE")]
    file: Option<PathBuf>,
}

impl NewPump {
    /// Two files mostly are two pumps, and the id names the record.
    fn usual_id(&self) -> String {
        let stem = self
            .file
            .as_ref()
            .and_then(|file| file.file_stem())
            .map(|stem| stem.to_string_lossy().to_lowercase());
        stem.filter(|stem| !stem.is_empty() && stem.chars().all(may_be_in_id))
            .unwrap_or_else(|| "my-pump".to_owned())
    }

    /// Writes the file, or refuses a pump that cannot work.
    pub(crate) fn write(&self) -> Result<(), Failure> {
        let drawn = DrawnPump {
            id: self.id.clone().unwrap_or_else(|| self.usual_id()),
            geometry: Geometry {
                rollers: self.rollers,
                bore_radius_mm: 0.5 * self.tube.bore_mm,
                tube_outer_radius_mm: 0.5 * self.tube.outer_mm,
                backplate_radius_mm: self.backplate,
                contact_angle_rad: self.contact,
                roller_radius_mm: self.roller,
                roller_offset_mm: self.offset,
            },
            hose_length_mm: self.hose,
        };
        let text = drawn.toml().map_err(Failure::refused)?;
        // What is written must be read again: the id too.
        PumpFile::parse(&text, "from this drawing").map_err(Failure::refused)?;
        match &self.file {
            None => print(&text),
            Some(path) => write_new(path, &text),
        }
    }
}

/// What an id may hold.
fn may_be_in_id(letter: char) -> bool {
    letter.is_ascii_lowercase() || letter.is_ascii_digit() || letter == '-' || letter == '_'
}

fn write_new(path: &Path, text: &str) -> Result<(), Failure> {
    let shown = path.display();
    if path.symlink_metadata().is_ok() {
        return Err(Failure::refused(format!(
            "{shown} is there already; name a new file, or remove it first"
        )));
    }
    Staged::new(path, |file| file.write_all(text.as_bytes()))
        .and_then(Staged::put)
        .map_err(|error| Failure::refused(format!("cannot write {shown}: {error}")))?;
    print(&format!("{shown} is written; `dose pumps check {shown}` says what it gives\n"))
}
