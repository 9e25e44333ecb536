//! `dose simulate`: the model at constant speed.

use pump_bench::pump_file::PumpFile;
use pump_bench::simulation::{AskedMethod, Simulation, SteadyReport, choose_method};
use pump_ctl::plan::Cruise;
use pump_model::math::{degrees, rpm};
use pump_model::{RollerCentric, SteadyState};
use serde::Serialize;

use crate::failure::{Failure, print};
use crate::options::{Method as MethodName, Model, Options};
use crate::outputs::{DEFAULT_DT_S, Outputs, PLOT_SAMPLES};

/// What `dose simulate --format json` prints.
#[derive(Serialize)]
struct Report<'a> {
    schema: &'static str,
    pump: &'a str,
    model: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    roller_centric: Option<Parameters>,
    /// Lines whose hose resists more at more flow, in place of an R.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    friction: Vec<&'static str>,
    method: &'static str,
    speed_rpm: f64,
    duration_s: f64,
    dt_s: f64,
    steady: SteadyReport,
    warnings: Vec<String>,
}

/// What the roller-centric model assumes.
#[derive(Serialize)]
struct Parameters {
    experimental: bool,
    scale: f64,
    distensibility_per_kpa: f64,
    valve_resistance_kpa_s_ml: f64,
    closure_deg: f64,
    ambient_kpa: f64,
}

impl From<RollerCentric> for Parameters {
    fn from(model: RollerCentric) -> Self {
        Self {
            experimental: true,
            scale: model.scale,
            distensibility_per_kpa: model.distensibility_per_kpa,
            valve_resistance_kpa_s_ml: model.valve_resistance_kpa_s_ml,
            closure_deg: degrees(model.closure_rad),
            ambient_kpa: model.ambient_kpa,
        }
    }
}

pub(crate) fn simulate(options: &Options) -> Result<(), Failure> {
    options.accept_only(
        "dose simulate",
        &[
            "--rate",
            "--speed",
            "--reverse",
            "--format",
            "--trace",
            "--plot",
            "--dt",
            "--duration",
            "--model",
            "--method",
        ],
    )?;
    options.outputs_differ()?;
    let file = options.pump_file()?;
    let pump = file.model().map_err(Failure::refused)?;
    let speed_rad_s = match options.cruise()? {
        Some(Cruise::Speed { rad_s }) => rad_s,
        Some(Cruise::Flow { ml_s }) => {
            let flow_ml_s = if options.reverse { -ml_s } else { ml_s };
            file.speed_for_flow(&pump, flow_ml_s).map_err(Failure::refused)?.abs()
        }
        _ => {
            return Err(Failure::refused("how fast? Add --speed 100rpm or --rate 10mL/s"));
        }
    };
    let Some(duration_s) = options.duration else {
        return Err(Failure::refused("how long? Add --duration 10s"));
    };
    let speed_rad_s = if options.reverse { -speed_rad_s } else { speed_rad_s };
    let roller_centric = match options.model.unwrap_or(Model::FlowCentric) {
        Model::FlowCentric => None,
        Model::RollerCentric => {
            Some(RollerCentric::of(&pump, file.ambient.pressure_kpa).map_err(Failure::refused)?)
        }
    };
    // The roller-centric model has a volume against speed of its own.
    let pump = if roller_centric.is_some() {
        pump
    } else {
        file.pump_at(&pump, speed_rad_s).map_err(Failure::refused)?
    };
    let frictions = file.frictions().map_err(Failure::refused)?;
    let asked = match options.method.unwrap_or(MethodName::Auto) {
        MethodName::Auto => AskedMethod::Auto,
        MethodName::Exact => AskedMethod::Exact,
        MethodName::Rodas5p => AskedMethod::Rodas5p,
    };
    let method = choose_method(asked, roller_centric, frictions, None).map_err(Failure::refused)?;
    let dt_s = options.dt.unwrap_or(DEFAULT_DT_S.min(duration_s));
    let run = Simulation { method, ..Simulation::new(speed_rad_s, duration_s, dt_s) };
    let steady = run.steady_state(&pump).map_err(Failure::refused)?;
    let has_friction =
        ["inlet", "outlet"].into_iter().zip(frictions).filter(|(_, friction)| friction.is_some());
    let report = Report {
        schema: "simulation/1",
        pump: &file.pump.id,
        model: if roller_centric.is_some() { "roller-centric" } else { "flow-centric" },
        roller_centric: roller_centric.map(Parameters::from),
        friction: has_friction.map(|(port, _)| port).collect(),
        method: method.name(),
        speed_rpm: rpm(speed_rad_s),
        duration_s,
        dt_s: run.dt_s,
        steady: steady.into(),
        warnings: warnings_of(&file, speed_rad_s, &steady),
    };

    let mut outputs = Outputs::default();
    if let Some(path) = &options.trace {
        outputs.trace(path, run.samples(&pump).map_err(Failure::refused)?)?;
    }
    if let Some(path) = &options.plot {
        // Fine enough for every pulse, whatever the trace's rows are.
        let fine = Simulation { dt_s: run.dt_s.min(DEFAULT_DT_S).max(duration_s / PLOT_SAMPLES), ..run };
        let samples = fine.samples(&pump).map_err(Failure::refused)?;
        let title = format!("{} at {:.4} r/min from rest", report.pump, report.speed_rpm);
        outputs.plot(path, &title, samples, None)?;
    }
    outputs.put()?;
    if options.json() {
        let json = serde_json::to_string(&report).map_err(Failure::refused)?;
        print(&(json + "\n"))
    } else {
        print(&text(&report))
    }
}

fn text(report: &Report<'_>) -> String {
    let s = &report.steady;
    let warnings: String = report.warnings.iter().map(|warning| format!("  warning {warning}\n")).collect();
    let experimental = report.roller_centric.as_ref().map_or(String::new(), |model| {
        format!(
            "  model   experimental: segments {} of the round tube's volume, {} /kPa more by pressure; rollers close at \
             {:.2}°, and open resist {} kPa s/mL\n",
            model.scale, model.distensibility_per_kpa, model.closure_deg, model.valve_resistance_kpa_s_ml
        )
    });
    let friction = match &report.friction[..] {
        [] => String::new(),
        ports => format!("  lines   friction of the hose at every flow ({}), integrated\n", ports.join(", ")),
    };
    let figures = format!(
        "{} at {:.4} r/min, {} model, periodic steady state\n\n  \
         flow    {:.4} mL/s mean; at the outlet rollers {:.1} % peak to peak, {:.1} % RMS\n  \
         inlet   {:.3} to {:.3} kPa absolute, mean {:.3}\n  \
         outlet  {:.3} to {:.3} kPa absolute, mean {:.3}\n",
        report.pump,
        report.speed_rpm,
        report.model,
        s.mean_flow_ml_s,
        100.0 * s.ripple_peak_to_peak,
        100.0 * s.ripple_rms,
        s.inlet_min_kpa,
        s.inlet_max_kpa,
        s.inlet_mean_kpa,
        s.outlet_min_kpa,
        s.outlet_max_kpa,
        s.outlet_mean_kpa,
    );
    figures + &experimental + &friction + &warnings
}

/// What makes the figures doubtful.
fn warnings_of(file: &PumpFile, speed_rad_s: f64, steady: &SteadyState) -> Vec<String> {
    let mut warnings = Vec::new();
    let limit_rpm = file.motor.max_speed_rpm;
    if rpm(speed_rad_s).abs() > limit_rpm * (1.0 + 1e-12) {
        warnings.push(format!("this is above the pump's limit of {limit_rpm} r/min"));
    }
    for (port, range) in [("inlet", steady.inlet), ("outlet", steady.outlet)] {
        if range.min_kpa < 0.0 {
            warnings.push(format!(
                "no liquid can be at {:.1} kPa absolute ({port}): it would cavitate",
                range.min_kpa
            ));
        }
    }
    warnings
}
