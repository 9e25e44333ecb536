//! The options of every command that plans a motion of a given volume: dose, prime and purge.

use std::path::Path;

use clap::Args;
use pump_bench::calibration::Weighing;
use pump_bench::config::Config;
use pump_bench::pump_file::Pace;
use pump_bench::record::Purpose;
use pump_bench::{Bench, DoseRequest, PumpFile};

use super::bench::BenchOptions;
use super::files::{Files, PlotOption, StepsOption, TraceOptions};
use super::fluid::FluidOptions;
use super::limits::{DayLimit, PressureOptions, TubeLimit};
use super::report::{FormatOption, VerboseOption};
use super::speed::{CruiseOptions, RampsOption, ReverseOption};
use super::start_angle::StatedStartOption;
use super::unattended::UnattendedOptions;
use super::volume::AskedVolume;
use crate::failure::Failure;
use crate::on_fail::OnFail;
use crate::terminal::warn;

/// Help of `--smooth`.
const SMOOTH_HELP: &str = "Let the speed follow the rollers' angle, for a flow at the end of the outlet line \
                           that is as smooth as the limits allow. --verbose tells the ripple there and at the rollers.";

/// Delivery of a volume.
#[derive(Debug, Args)]
pub(crate) struct DosingOptions {
    #[command(flatten)]
    cruise: CruiseOptions,
    /// Let the speed follow the rollers for a smooth flow
    #[arg(long_help = SMOOTH_HELP)]
    #[arg(long, help_heading = "Amount and speed")]
    smooth: bool,
    #[command(flatten)]
    ramps: RampsOption,
    #[command(flatten)]
    reverse: ReverseOption,
    #[command(flatten)]
    pub(crate) start_angle: StatedStartOption,
    #[command(flatten)]
    fluid: FluidOptions,
    #[command(flatten)]
    limits: PressureOptions,
    #[command(flatten)]
    tube_limit: TubeLimit,
    #[command(flatten)]
    day_limit: DayLimit,
    #[command(flatten)]
    bench: BenchOptions,
    /// Plan and predict; move nothing, record nothing
    #[arg(long, help_heading = "Motor")]
    pub(crate) dry_run: bool,
    #[command(flatten)]
    pub(crate) unattended: UnattendedOptions,
    #[command(flatten)]
    pub(crate) format: FormatOption,
    #[command(flatten)]
    pub(crate) verbose: VerboseOption,
    #[command(flatten)]
    pub(crate) steps: StepsOption,
    #[command(flatten)]
    pub(crate) trace: TraceOptions,
    #[command(flatten)]
    pub(crate) plot: PlotOption,
}

impl DosingOptions {
    /// Refuses files that exclude each other, and those that must not be replaced.
    pub(crate) fn check_files(&self) -> Result<(), Failure> {
        self.check_files_beside(None)
    }

    /// Refuses files as [`Self::check_files`] does, and those that would replace the file `read`.
    pub(crate) fn check_files_beside(&self, read: Option<&Path>) -> Result<(), Failure> {
        let BenchOptions { pump, record, .. } = &self.bench;
        let state_dir = Some(record.folder(&pump.config()?)?);
        Files {
            outputs: &self.files(),
            inputs: &[pump.path()?.as_deref(), read],
            config: pump.config_path(),
            state_dir,
        }
        .check()?;
        if self.trace.dt.is_some() && self.trace.trace.is_none() {
            return Err(Failure::refused("--dt is the time between rows of --trace; name that file too"));
        }
        Ok(())
    }

    /// The files of one dose, each with its option.
    pub(crate) fn files(&self) -> [(&'static str, Option<&Path>); 3] {
        [
            ("--steps", self.steps.steps.as_deref()),
            ("--trace", self.trace.trace.as_deref()),
            ("--plot", self.plot.plot.as_deref()),
        ]
    }

    /// The bench with the fluid and the tube that are named.
    pub(crate) fn bench(&self) -> Result<Bench, Failure> {
        let mut file = self.bench.pump.file()?;
        self.tube_limit.change(&mut file);
        self.day_limit.change(&mut file)?;
        self.limits.change(&mut file)?;
        self.fluid.change(&mut file)?;
        let bench = self.bench.bench_of(file)?;
        let config = self.config()?;
        if config.pumps().contains_key(self.bench.pump.name(&config)) {
            self.expect_record(&bench, &config)?;
        }
        Ok(bench)
    }

    /// Refuses a dose without a person that would begin the record of a real motor in a folder that nobody has named,
    /// as cron does in another home. A simulated one begins it with a warning.
    fn expect_record(&self, bench: &Bench, config: &Config) -> Result<(), Failure> {
        let is_named = self.bench.record.named()?.is_some() || config.named_state_dir().is_some();
        let of_pump = bench.folder().path().parent().is_some_and(Path::exists);
        if self.dry_run || is_named || of_pump || !self.unattended.is_unattended() {
            return Ok(());
        }
        let (pump, folder) = (&bench.file().pump.id, config.state_dir()?);
        let place =
            config.path().map_or_else(|| "the configuration".to_owned(), |path| path.display().to_string());
        let text = format!(
            "nothing is on record of {pump} in {}, the folder by HOME and XDG_STATE_HOME: under another user or cron \
             its angle, calibration and safety limits are elsewhere; name the folder with --state-dir <DIR>, or with \
             state_dir in {place}",
            folder.display()
        );
        if bench.is_simulated() {
            warn(&[text]);
            return Ok(());
        }
        Err(Failure::refused(format!("{text}; or make the first dose at a terminal")))
    }

    /// The configuration.
    pub(crate) fn config(&self) -> Result<Config, Failure> {
        self.bench.pump.config()
    }

    /// The name of the pump as it was typed, and not only found in the environment.
    pub(crate) fn typed_pump(&self) -> Option<&str> {
        let of_environment = std::env::var("DOSE_PUMP").ok();
        self.bench.pump.typed().filter(|typed| of_environment.as_deref() != Some(typed))
    }

    /// The benches of the pumps of a rack, each with the limit of a day. Options of real motors are those of its real
    /// ones.
    pub(crate) fn benches_of_rack(&self, mut files: Vec<PumpFile>) -> Result<Vec<Bench>, Failure> {
        for file in &mut files {
            let changed = self.day_limit.change(file);
            changed.map_err(|failure| failure.after(&format!("pump {} of the rack: ", file.pump.id)))?;
        }
        let moves = |file: &PumpFile| !self.bench.is_simulated(file);
        let is_mixed = files.iter().any(moves);
        let bench = |file: PumpFile| match is_mixed && !moves(&file) {
            true => self.bench.simulated(file),
            false => self.bench.bench_of(file),
        };
        let benches: Vec<Bench> = files.into_iter().map(bench).collect::<Result<_, Failure>>()?;
        let config = self.config()?;
        if config.exists() {
            let is_of =
                |name: &str, id: &str| name == id || config.pump(name).is_ok_and(|file| file.pump.id == id);
            let is_named = |id: &str| config.pumps().keys().any(|name| is_of(name, id));
            let mut named = benches.iter().filter(|bench| is_named(&bench.file().pump.id));
            named.try_for_each(|bench| self.expect_record(bench, &config))?;
        }
        Ok(benches)
    }

    /// True if a motion may begin whose rate nobody has typed.
    pub(crate) fn moves_at_any_rate(&self) -> bool {
        !self.dry_run && !self.cruise.is_given()
    }

    /// True if simulated motors are told to take no time.
    pub(crate) fn is_fast(&self) -> bool {
        self.bench.motor.pace == Some(Pace::Fast)
    }

    /// The pace of a rack's simulated motors.
    pub(crate) fn rack_pace(&self) -> Pace {
        self.bench.motor.pace.unwrap_or(Pace::Real)
    }

    /// The command to run if the dose fails; none without one, and for a dry run.
    pub(crate) fn on_fail(&self) -> Option<OnFail> {
        if self.dry_run { None } else { self.unattended.on_fail(&self.bench.pump) }
    }

    /// The amount as it was typed, with a minus in reverse.
    pub(crate) fn typed(&self, asked: &AskedVolume) -> String {
        if self.reverse.reverse { format!("-{}", asked.typed) } else { asked.typed.clone() }
    }

    /// The request to this bench.
    pub(crate) fn request(
        &self,
        purpose: Purpose,
        asked: &AskedVolume,
        bench: &Bench,
    ) -> Result<DoseRequest, Failure> {
        let file = bench.file();
        let mut volume_ml = Weighing::of(file).amount_ml(asked.amount)?;
        if self.reverse.reverse {
            if volume_ml < 0.0 {
                return Err(Failure::refused(
                    "--reverse and a negative volume both mean reverse; give one of them",
                ));
            }
            volume_ml = -volume_ml;
        }
        Ok(DoseRequest::new(purpose, volume_ml)
            .with_asked(&self.typed(asked))
            .with_cruise(self.cruise.cruise()?)
            .with_smooth(self.smooth)
            .with_ramps(self.ramps.ramps())
            .with_pressures(self.limits.pressures(file))
            .with_start_angle(self.start_angle.angle_rad(), self.start_angle.tolerance_rad(bench)))
    }
}
