//! `dose pumps new`: a pump file from a drawing. `new_bought.rs` writes one of a bought head.

use std::path::{Path, PathBuf};

use clap::Args;
use pump_bench::catalogue::{DrawnPump, RollerRuns, unusual};
use pump_bench::export::{Axes, fit_svg};
use pump_bench::files::{MOST_TABLE_BYTES, Staged, read_text};
use pump_bench::pump_file::{CurveFit, PumpFile, RollerVolumeTable};
use pump_bench::report::ErrorKind;
use pump_bench::units;
use pump_bench::units::{ROLLERS, TubeSize, count};
use pump_model::{Geometry, ModelError};

use super::own_motor::OwnMotorOptions;
use super::show::draw_section;
use super::site::SiteOptions;
use crate::advice;
use crate::failure::Failure;
use crate::options::choice::choice;
use crate::options::files::Files;
use crate::options::pump::{ConfigOption, ForeignRecord};
use crate::outputs::Outputs;
use crate::terminal::{print, tell, warn};
use crate::told_commands::shell_word;

/// The dimensions that a drawing tells.
#[derive(Debug, Args)]
pub(crate) struct NewArgs {
    /// Bore x outer diameter of the tube, as 10x14mm
    #[arg(long, value_name = "SIZE", value_parser = units::tube_size)]
    #[arg(required_unless_present_any = ["head", "ml_per_rev"], conflicts_with_all = ["head", "ml_per_rev"])]
    tube: Option<TubeSize>,
    /// Radius of the backplate (raceway), as 63mm
    #[arg(long, value_name = "RADIUS", value_parser = units::length_mm)]
    #[arg(required_unless_present_any = ["head", "ml_per_rev"], conflicts_with_all = ["head", "ml_per_rev"])]
    backplate: Option<f64>,
    /// Radius of a roller, as 20mm
    #[arg(long, value_name = "RADIUS", value_parser = units::length_mm)]
    #[arg(required_unless_present_any = ["head", "ml_per_rev"], conflicts_with_all = ["head", "ml_per_rev"])]
    roller: Option<f64>,
    /// From the shaft to a roller's axis, as 40mm
    #[arg(long, value_name = "LENGTH", value_parser = units::length_mm)]
    #[arg(required_unless_present_any = ["head", "ml_per_rev"], conflicts_with_all = ["head", "ml_per_rev"])]
    offset: Option<f64>,
    /// Contact angle: the backplate spans 180deg and twice this, as 30deg, or as -20deg for a shorter bed
    #[arg(long, value_name = "ANGLE", allow_hyphen_values = true, value_parser = units::angle_rad)]
    #[arg(required_unless_present_any = ["head", "ml_per_rev"], conflicts_with_all = ["head", "ml_per_rev"])]
    contact: Option<f64>,
    /// Number of rollers
    #[arg(long, value_name = "N", required_unless_present = "head")]
    #[arg(value_parser = count("number of rollers", ROLLERS))]
    pub(super) rollers: Option<u32>,
    /// Volume of a revolution of a bought head in place of a drawing, as 0.5mL
    #[arg(long, value_name = "VOLUME", value_parser = units::volume_ml)]
    #[arg(conflicts_with_all = ["head", "hose", "roller_volume_points"])]
    pub(super) ml_per_rev: Option<f64>,
    /// Diameter of the tube's bore beside --ml-per-rev, as 1.6mm
    #[arg(long, value_name = "LENGTH", value_parser = units::length_mm, requires = "ml_per_rev")]
    pub(super) bore: Option<f64>,
    /// Bought head of the catalogue in place of a drawing, as masterflex-ls-16 (`dose pumps list --catalogue`)
    #[arg(long, value_name = "NAME", conflicts_with_all = ["hose", "roller_volume_points"])]
    pub(super) head: Option<String>,
    /// Name of the pump in records [default: after FILE's name, or my-pump]
    #[arg(long)]
    id: Option<String>,
    /// Length of the hose on either side, as 0.5m
    #[arg(long, value_name = "LENGTH", default_value = "331mm", value_parser = units::length_mm)]
    hose: f64,
    /// Volume of a roller as measured, CSV: angle_deg since first contact, volume_ml, run [default: from the drawing]
    #[arg(long, value_name = "FILE.csv")]
    roller_volume_points: Option<PathBuf>,
    /// Curve through these points
    #[arg(long, value_name = "quintic|spline", default_value_t = CurveFit::Quintic, requires = "roller_volume_points")]
    #[arg(value_parser = choice(&[
        (CurveFit::Quintic, "Least squares of 5th order, as McIntyre et al."),
        (CurveFit::Spline, "A rising spline, near more than 25 angles by least squares: a flow without jumps"),
    ]))]
    fit: CurveFit,
    #[command(flatten)]
    motor: OwnMotorOptions,
    #[command(flatten)]
    site: SiteOptions,
    /// File to write; it must not exist yet [default: standard output]
    #[arg(value_name = "FILE")]
    pub(super) file: Option<PathBuf>,
    /// Draw the section with these dimensions by name, or with --roller-volume-points the measured points
    #[arg(long, value_name = "FILE.svg", help_heading = "Output")]
    plot: Option<PathBuf>,
    #[command(flatten)]
    config: ConfigOption,
    #[command(flatten)]
    record: ForeignRecord,
}

impl NewArgs {
    /// The id of the pump.
    pub(super) fn id(&self) -> String {
        self.id.clone().unwrap_or_else(|| self.usual_id())
    }

    /// The id if none is given: two files mostly are two pumps, and the id names the record.
    fn usual_id(&self) -> String {
        let id = self.stem().map(|stem| id_of(&stem));
        id.filter(|id| !id.is_empty()).unwrap_or_else(|| "my-pump".to_owned())
    }

    /// The name of the file without its ending.
    fn stem(&self) -> Option<String> {
        Some(self.file.as_ref()?.file_stem()?.to_string_lossy().into_owned())
    }

    /// Says the id where it is not the file's name, and warns of an id that has a record already.
    fn tell_id(&self, id: &str) -> Result<(), Failure> {
        if self.stem().is_some_and(|stem| stem != id) {
            tell(&format!("  id        {id}: the name of its record; --id gives another\n"))?;
        }
        let records = self.record.folder(&self.config.config()?);
        if records.is_some_and(|records| records.join(id).is_dir()) {
            tell(&format!(
                "  warning   a pump `{id}` has a record already, and this file goes on with its angle, carry and \
                 calibration; for another pump change `id` in the file\n"
            ))?;
        }
        Ok(())
    }

    /// Refuses to draw a bought head, of which no dimension is known.
    fn refuse_plot_of_bought(&self) -> Result<(), Failure> {
        let bought = match (&self.head, self.ml_per_rev) {
            (Some(_), _) => "--head",
            (None, Some(_)) => "--ml-per-rev",
            (None, None) => return Ok(()),
        };
        if self.plot.is_none() {
            return Ok(());
        }
        let refused = format!(
            "--plot draws the dimensions of a head, and {bought} gives none; leave --plot out, or give the drawing: \
             --tube, --backplate, --roller, --offset, --contact"
        );
        Err(Failure::refused(refused).value(bought).allowed("a head by its drawing"))
    }

    /// Writes the file, or refuses a pump that cannot work.
    pub(super) fn run(&self) -> Result<(), Failure> {
        self.refuse_plot_of_bought()?;
        let outputs = [("FILE", self.file.as_deref()), ("--plot", self.plot.as_deref())];
        let inputs = [self.roller_volume_points.as_deref()];
        let state_dir = self.record.folder(&self.config.config()?);
        Files { outputs: &outputs, inputs: &inputs, config: self.config.path(), state_dir }.check()?;
        let Some(geometry) = self.geometry() else { return self.write_bought() };
        let runs = self.roller_volume_points.as_deref().map(read_runs).transpose()?;
        let report = match &runs {
            Some(runs) => runs.report(self.fit, &geometry).map_err(|error| self.in_points(error))?,
            None => Vec::new(),
        };
        let drawn = DrawnPump {
            id: self.id(),
            geometry,
            hose_length_mm: self.hose,
            roller_volume: runs.as_ref().map_or(RollerVolumeTable::Drawing, |runs| runs.table(self.fit)),
        };
        let mut file = drawn.pump_file().map_err(Failure::of)?;
        let motor = self.state(&mut file)?;
        let remarks: String = report.iter().map(|line| format!("# {line}\n")).collect();
        let text = drawn.toml_of(&file, advice::words).replacen(
            "# Measured.\n",
            &format!("# Measured.\n{remarks}"),
            1,
        );
        // The file must be readable again, its id too.
        PumpFile::parse(&text, "from this drawing").map_err(Failure::of)?;
        let mut outputs = Outputs::default();
        self.draw(&mut outputs, &file, runs.as_ref())?;
        match &self.file {
            None => print(&text)?,
            Some(path) => {
                write_new(path, &text)?;
                tell(&report.iter().map(|line| format!("  {line}\n")).collect::<String>())?;
                tell(&format!("  {motor}\n"))?;
            }
        }
        self.warn(&file)?;
        outputs.put()
    }

    /// Warns of what is unusual of a new pump: below the words on its file, or beside the file itself.
    pub(super) fn warn(&self, file: &PumpFile) -> Result<(), Failure> {
        let warnings = unusual(file);
        if self.file.is_none() {
            warn(&warnings);
            return Ok(());
        }
        self.tell_id(&file.pump.id)?;
        tell(&warnings.iter().map(|warning| format!("  warning   {warning}\n")).collect::<String>())
    }

    /// Writes the place and the motor into a new file as its owner states them. Returns the motor's steps in words, or
    /// that nobody has said them.
    pub(super) fn state(&self, file: &mut PumpFile) -> Result<String, Failure> {
        self.site.write_to(file)?;
        let Some(motor) = self.motor.stated()? else {
            return Ok(
                "the motor's steps are not known: a real motor does not move until they stand in the file"
                    .to_owned(),
            );
        };
        motor.write_to(file);
        Ok(motor.to_string())
    }

    /// The dimensions of the drawing. `None` where a bought head stands in their place.
    fn geometry(&self) -> Option<Geometry> {
        let tube = self.tube.as_ref()?;
        Some(Geometry {
            rollers: self.rollers?,
            bore_radius_mm: 0.5 * tube.bore_mm,
            tube_outer_radius_mm: 0.5 * tube.outer_mm,
            backplate_radius_mm: self.backplate?,
            contact_angle_rad: self.contact?,
            roller_radius_mm: self.roller?,
            roller_offset_mm: self.offset?,
        })
    }

    /// Draws the measured points and the fit, or else the section through the head, if a picture is asked for.
    fn draw(&self, outputs: &mut Outputs, file: &PumpFile, runs: Option<&RollerRuns>) -> Result<(), Failure> {
        let Some(path) = &self.plot else { return Ok(()) };
        let Some(runs) = runs else { return draw_section(outputs, path, file) };
        let axes =
            Axes { x: "angle since first contact, °", y: "volume, mL", left: "measured less fitted, mL" };
        let fitted = runs.fitted(self.fit).map_err(|error| self.in_points(error))?;
        let title = format!("volume that a roller of {id} displaces", id = file.pump.id);
        outputs.drawing(path, fit_svg(&title, axes, &fitted))
    }

    /// Says in which table of points an error is.
    fn in_points(&self, error: ModelError) -> Failure {
        match &self.roller_volume_points {
            Some(path) => Failure::of(error).after(&format!("{}: ", path.display())),
            None => Failure::of(error),
        }
    }
}

fn read_runs(path: &Path) -> Result<RollerRuns, Failure> {
    let text = read_text(path, MOST_TABLE_BYTES).map_err(|error| Failure::unread(path, &error))?;
    RollerRuns::of_csv(&text).map_err(|error| Failure::of(error).after(&format!("{}: ", path.display())))
}

/// The id of a file's name. A hyphen stands for what an id may not hold.
fn id_of(stem: &str) -> String {
    let parts = stem.to_lowercase();
    let parts = parts.split(|letter| !may_be_in_id(letter)).filter(|part| !part.is_empty());
    parts.collect::<Vec<_>>().join("-")
}

/// True for a letter that an id may hold.
fn may_be_in_id(letter: char) -> bool {
    letter.is_ascii_lowercase() || letter.is_ascii_digit() || letter == '-' || letter == '_'
}

pub(super) fn write_new(path: &Path, text: &str) -> Result<(), Failure> {
    let shown = path.display();
    if path.symlink_metadata().is_ok() {
        let refused =
            Failure::refused(format!("{shown} is there already; name a new file, or remove it first"));
        return Err(refused.kind(ErrorKind::Output).value(shown).allowed("a new file"));
    }
    Staged::new(path, |file| file.write_all(text.as_bytes()))
        .and_then(Staged::put)
        .map_err(|error| Failure::unwritten(path, &error))?;
    let word = shell_word(&shown.to_string());
    tell(&format!("{shown} is written; `dose pumps check {word}` says what it gives\n"))
}
