//! `dose calibrate phase`: roller volume, engagement angle and zero from short doses.

use std::path::PathBuf;

use clap::Args;
use pump_bench::calibration::{Calibration, Weighing, short_doses_of_csv};
use pump_bench::report::{phase_json, phase_text};

use super::reading::{ReadingOptions, in_table, read};
use crate::advice;
use crate::failure::Failure;
use crate::options::bench::RecordOptions;
use crate::options::fluid::FluidOptions;
use crate::options::report::FormatOption;
use crate::terminal::{print_json, tell};

#[derive(Debug, Args)]
pub(super) struct PhaseArgs {
    /// Table of short doses, CSV: start_angle_deg, turned_deg, mass_g or volume_ml, temperature_degc
    #[arg(long, value_name = "FILE", required = true)]
    from: PathBuf,
    #[command(flatten)]
    reading: ReadingOptions,
    /// Dose with the roller volume, the engagement angle and the zero that were found, from now on
    #[arg(long = "use")]
    uses: bool,
    #[command(flatten)]
    fluid: FluidOptions,
    #[command(flatten)]
    record: RecordOptions,
    #[command(flatten)]
    format: FormatOption,
}

impl PhaseArgs {
    pub(super) fn run(&self) -> Result<(), Failure> {
        self.reading.check()?;
        let mut file = self.record.pump.file()?;
        self.fluid.change(&mut file)?;
        let bench = self.record.bench_of(file, None)?;
        let doses = short_doses_of_csv(&read(&self.from)?, &Weighing::of(bench.file()));
        let doses = in_table(&self.from, doses)?;
        let _held = bench.folder().lock()?;
        let before = bench.calibrations().active()?.map(|active| active.calibration);
        let expected = self.reading.expected(bench.file());
        let (mut calibration, found) =
            Calibration::of_short_doses(bench.file(), doses, &expected, before.as_ref())?;
        calibration.tube = self.reading.tube.clone().or(calibration.tube);
        calibration.note = self.reading.note.clone();
        let version = if self.uses { Some(bench.keep_calibration(calibration)?.version) } else { None };
        if self.format.json() {
            print_json(&phase_json(&found, version))
        } else {
            tell(&phase_text(&bench, &found, version, advice::words))
        }
    }
}
