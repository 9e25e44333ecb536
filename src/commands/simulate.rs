//! `dose simulate`: the model at constant speed.

use std::path::Path;

use clap::Args;
use pump_bench::Bench;
use pump_bench::calibration::Stored;
use pump_bench::displacement::SpeedDependentPump;
use pump_bench::export::Marks;
use pump_bench::notice::Notice;
use pump_bench::pump_file::PumpFile;
use pump_bench::report::{ErrorKind, SimulationReport};
use pump_bench::simulation::{AskedMethod, Method, ModelName, Simulation, choose_method, fastest_run};
use pump_bench::units;
use pump_ctl::plan::{Cruise, LimitedBy};
use pump_model::units::rpm;
use pump_model::{Pump, RollerCentric};

use crate::advice;
use crate::failure::Failure;
use crate::options::choice::choice;
use crate::options::files::{Files, PlotOption, TraceOptions};
use crate::options::fluid::FluidOptions;
use crate::options::pump::{ForeignRecord, PumpOption};
use crate::options::report::FormatOption;
use crate::options::speed::{ReverseOption, SpeedOptions};
use crate::outputs::{DEFAULT_DT_S, Outputs, PLOT_SAMPLES};
use crate::terminal::{print_json, tell};

/// Pitches of a run that its picture shows: more of them would hide the pulses.
const PLOT_PITCHES: f64 = 6.0;

#[derive(Debug, Args)]
pub(crate) struct SimulateArgs {
    #[command(flatten)]
    pump: PumpOption,
    #[command(flatten)]
    speed: SpeedOptions,
    #[command(flatten)]
    reverse: ReverseOption,
    /// Duration of the run, as 10s
    #[arg(long, value_name = "TIME", value_parser = units::time_s, help_heading = "Amount and speed")]
    duration: Option<f64>,
    /// Model of the rollers [default: flow-centric]
    #[arg(long, value_name = "flow-centric|roller-centric", help_heading = "Model")]
    #[arg(value_parser = choice(&[
        (ModelName::FlowCentric, "Flows at the rollers drive the lines"),
        (ModelName::RollerCentric, "Every roller a valve, every segment between two a chamber (experimental)"),
    ]))]
    model: Option<ModelName>,
    /// Method of the solution [default: auto]
    #[arg(long, value_name = "auto|exact|rodas5p|radau", help_heading = "Model")]
    #[arg(value_parser = choice(&[
        (AskedMethod::Auto, "The best that applies"),
        (AskedMethod::Exact, "The exact solution"),
        (AskedMethod::Rodas5p, "The implicit integrator for any model"),
        (AskedMethod::Radau, "The implicit integrator for lines with a constant R, in fewer steps"),
    ]))]
    method: Option<AskedMethod>,
    #[command(flatten)]
    fluid: FluidOptions,
    #[command(flatten)]
    format: FormatOption,
    #[command(flatten)]
    trace: TraceOptions,
    #[command(flatten)]
    plot: PlotOption,
    #[command(flatten)]
    record: ForeignRecord,
}

impl SimulateArgs {
    pub(crate) fn run(&self) -> Result<(), Failure> {
        let outputs = [("--trace", self.trace.trace.as_deref()), ("--plot", self.plot.plot.as_deref())];
        let state_dir = self.record.folder(&self.pump.config()?);
        Files {
            outputs: &outputs,
            inputs: &[self.pump.path()?.as_deref()],
            config: self.pump.config_path(),
            state_dir: state_dir.clone(),
        }
        .check()?;
        let mut file = self.pump.file()?;
        self.fluid.change(&mut file)?;
        let pump = file.speed_dependent_pump().map_err(Failure::of)?;
        let (speed_rad_s, limit) = self.speed_rad_s(&file, &pump)?;
        let Some(duration_s) = self.duration else {
            return Err(Failure::refused("how long? Add --duration 10s"));
        };
        let roller_centric = match self.model.unwrap_or_default() {
            ModelName::FlowCentric => None,
            ModelName::RollerCentric => {
                Some(RollerCentric::of(pump.base(), file.ambient.pressure_kpa).map_err(Failure::of)?)
            }
        };
        // The roller-centric model has a volume against speed of its own.
        let pump = match roller_centric {
            Some(_) => *pump.base(),
            None => pump.at(speed_rad_s).map_err(Failure::of)?,
        };
        let frictions = file.frictions().map_err(Failure::of)?;
        let method = choose_method(self.method.unwrap_or_default(), roller_centric, frictions, None)
            .map_err(Failure::of)?;
        let dt_s = self.trace.dt.unwrap_or(DEFAULT_DT_S.min(duration_s));
        let run = Simulation { method, ..Simulation::new(speed_rad_s, duration_s, dt_s) };
        let steady = run.steady_state(&pump).map_err(Failure::of)?;
        let report = SimulationReport::new(&file, &pump, &run, roller_centric, frictions, &steady);
        let report = limit.map_or(report.clone(), |limit| report.limited_by(limit));
        let calibration = state_dir.and_then(|folder| left_out(&file, &folder, speed_rad_s));
        let report =
            calibration.into_iter().fold(report, SimulationReport::with_warning).worded(advice::words);
        self.write_outputs(&run, &pump, &report)?;
        if self.format.json() { print_json(&(report.json() + "\n")) } else { tell(&report.text()) }
    }

    /// The speed that is asked for, rad/s, negative in reverse, and the limit of the fastest run.
    fn speed_rad_s(
        &self,
        file: &PumpFile,
        pump: &SpeedDependentPump,
    ) -> Result<(f64, Option<LimitedBy>), Failure> {
        let reverse = self.reverse.reverse;
        let speed_rad_s = match self.speed.cruise()? {
            Some(Cruise::Speed { rad_s }) => rad_s,
            Some(Cruise::Flow { ml_s }) => {
                let flow_ml_s = if reverse { -ml_s } else { ml_s };
                pump.speed_for_flow(flow_ml_s).map_err(Failure::of)?.abs()
            }
            Some(Cruise::Fastest) => return self.fastest(file, pump),
            _ => return Err(Failure::refused("how fast? Add --speed 100rpm, --rate 10mL/s or --rate max")),
        };
        Ok((if reverse { -speed_rad_s } else { speed_rad_s }, None))
    }

    /// The speed of the fastest run that holds every limit of the pump, rad/s, and the limit that binds it.
    fn fastest(
        &self,
        file: &PumpFile,
        pump: &SpeedDependentPump,
    ) -> Result<(f64, Option<LimitedBy>), Failure> {
        if self.model == Some(ModelName::RollerCentric) {
            return Err(Failure::refused(
                "--rate max is sought with the flow-centric model; give --speed beside --model roller-centric",
            ));
        }
        let frictions = file.frictions().map_err(Failure::of)?;
        let method = choose_method(AskedMethod::Auto, None, frictions, None).map_err(Failure::of)?;
        let steady = |pump: &Pump, speed_rad_s| match method {
            // The start-up of the exact solution contains its steady state.
            Method::Exact => Ok(None),
            method => Ok(Some(method.steady_state(pump, speed_rad_s)?)),
        };
        let found = fastest_run(pump, &file.limits(), self.reverse.reverse, steady).map_err(Failure::of)?;
        let Some(speed_rad_s) = found.speed_rad_s else {
            let refused = format!(
                "--rate max: no speed holds every limit of this pump, as {} breaks one",
                found.limited_by
            );
            return Err(Failure::refused(refused).kind(ErrorKind::Limit).value(found.limited_by));
        };
        Ok((speed_rad_s, Some(found.limited_by)))
    }

    fn write_outputs(&self, run: &Simulation, pump: &Pump, report: &SimulationReport) -> Result<(), Failure> {
        let mut outputs = Outputs::default();
        if let Some(path) = &self.trace.trace {
            outputs.trace(path, run.samples(pump).map_err(Failure::of)?)?;
        }
        if let Some(path) = &self.plot.plot {
            // Fine enough for every pulse, whatever the trace's rows are.
            let dt_s = run.dt_s.min(DEFAULT_DT_S).max(run.duration_s / PLOT_SAMPLES);
            let fine = Simulation { dt_s, ..*run };
            let pitch_s = pump.pitch_rad() / run.speed_rad_s.abs();
            let from_s = run.duration_s - PLOT_PITCHES * pitch_s;
            let title = match from_s > 0.0 {
                true => format!("{}, the last {PLOT_PITCHES} pitches", report.title()),
                false => report.title(),
            };
            let samples = fine.samples(pump).map_err(Failure::of)?;
            let last =
                samples.filter(|sample| sample.as_ref().map_or(true, |sample| sample.time_s >= from_s));
            outputs.plot(path, &title, last, &Marks::default())?;
        }
        outputs.put()
    }
}

/// The warning that doses of this pump take a calibration on record, and the model of its file does not.
fn left_out(file: &PumpFile, state_dir: &Path, speed_rad_s: f64) -> Option<Notice> {
    let bench = Bench::new(file.clone(), None, state_dir).ok()?;
    let Stored { version, calibration, .. } = bench.calibrations().active().ok()??;
    let factor = calibration.displacement?.factor_at(bench.model(), rpm(speed_rad_s)).ok()?;
    Some(Notice::from(format!(
        "this is the model of the pump file; doses take calibration {version} ({}), by which a revolution delivers \
         {factor:.4} times as much",
        bench.drive_id()
    )))
}
