//! `dose simulate`: the model at constant speed.

use clap::Args;
use pump_bench::displacement::SpeedDependentPump;
use pump_bench::report::SimulationReport;
use pump_bench::simulation::{AskedMethod, ModelName, Simulation, choose_method};
use pump_bench::units;
use pump_ctl::plan::Cruise;
use pump_model::{Pump, RollerCentric};

use crate::failure::Failure;
use crate::options::choice::choice;
use crate::options::files::{Files, PlotOption, TraceOptions};
use crate::options::pump::{ForeignRecord, PumpOption};
use crate::options::report::FormatOption;
use crate::options::speed::{ReverseOption, SpeedOptions};
use crate::outputs::{DEFAULT_DT_S, Outputs, PLOT_SAMPLES};
use crate::terminal::{print, tell};

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
    #[arg(long, value_name = "auto|exact|rodas5p", help_heading = "Model")]
    #[arg(value_parser = choice(&[
        (AskedMethod::Auto, "The best that applies"),
        (AskedMethod::Exact, "The exact solution"),
        (AskedMethod::Rodas5p, "The implicit integrator"),
    ]))]
    method: Option<AskedMethod>,
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
        Files { outputs: &outputs, inputs: &[self.pump.path()?.as_deref()], state_dir }.check()?;
        let file = self.pump.file()?;
        let pump = file.speed_dependent_pump().map_err(Failure::of)?;
        let speed_rad_s = self.speed_rad_s(&pump)?;
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
        self.write_outputs(&run, &pump, &report)?;
        if self.format.json() { print(&(report.json() + "\n")) } else { tell(&report.text()) }
    }

    /// The speed that is asked for, rad/s, negative in reverse.
    fn speed_rad_s(&self, pump: &SpeedDependentPump) -> Result<f64, Failure> {
        let reverse = self.reverse.reverse;
        let speed_rad_s = match self.speed.cruise()? {
            Some(Cruise::Speed { rad_s }) => rad_s,
            Some(Cruise::Flow { ml_s }) => {
                let flow_ml_s = if reverse { -ml_s } else { ml_s };
                pump.speed_for_flow(flow_ml_s).map_err(Failure::of)?.abs()
            }
            _ => return Err(Failure::refused("how fast? Add --speed 100rpm or --rate 10mL/s")),
        };
        Ok(if reverse { -speed_rad_s } else { speed_rad_s })
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
            outputs.plot(path, &report.title(), fine.samples(pump).map_err(Failure::of)?, None)?;
        }
        outputs.put()
    }
}
