//! The report of a run at constant speed, in words and as JSON.

use std::fmt::Display;

use pump_ctl::plan::{LimitedBy, Lowest, SetBy};
use pump_model::units::{degrees, rpm};
use pump_model::{Extremes, Friction, Port, Pump, RollerCentric, SteadyState};
use serde::Serialize;

use super::choices::set_by_word;
use crate::catalogue::overlap_warning;
use crate::notice::{Notice, Wording};
use crate::pump_file::PumpFile;
use crate::simulation::{ModelName, Reached, Simulation, SteadyReport};

/// The report of a run at constant speed (`schema` `simulation/1`).
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct SimulationReport {
    schema: &'static str,
    pump: String,
    model: ModelName,
    #[serde(skip_serializing_if = "Option::is_none")]
    roller_centric: Option<Parameters>,
    /// Ports whose line is a hose that resists more at more flow, in place of an R.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    friction: Vec<&'static str>,
    method: &'static str,
    speed_rpm: f64,
    duration_s: f64,
    dt_s: f64,
    steady: SteadyReport,
    /// Smallest inlet and outlet pressure of the run from lines at rest, start-up included, kPa absolute; null for the
    /// roller-centric model.
    run_inlet_min_kpa: Option<f64>,
    run_outlet_min_kpa: Option<f64>,
    /// Smallest pressure that is allowed at the port that sucks, kPa absolute, as for a dose, and the reason for it.
    inlet_limit_kpa: Option<f64>,
    #[serde(serialize_with = "set_by_word")]
    inlet_limit: Option<SetBy>,
    /// Limit that a faster run would break, if the fastest run was asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    limited_by: Option<&'static str>,
    /// Fluid that is pumped, and its temperature, in °C.
    fluid: String,
    fluid_temperature_degc: f64,
    /// True for the inlet and the outlet if the file has their lines, so that pressures follow.
    #[serde(skip)]
    has_lines: [bool; 2],
    warnings: Vec<Notice>,
}

/// The assumptions of the roller-centric model.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
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

impl SimulationReport {
    /// Reports a run of `pump`, that of `file` at the run's speed, and the steady state that it tends to.
    pub fn new(
        file: &PumpFile,
        pump: &Pump,
        run: &Simulation,
        roller_centric: Option<RollerCentric>,
        frictions: [Option<Friction>; 2],
        steady: &SteadyState,
    ) -> Self {
        let ports = [Port::Inlet, Port::Outlet].into_iter().zip(frictions);
        let reached = roller_centric.is_none().then(|| Reached::of(pump, run.speed_rad_s, run.duration_s));
        let lowest = file.limits().lowest_where_it_sucks();
        Self {
            schema: "simulation/1",
            pump: file.pump.id.clone(),
            model: if roller_centric.is_some() { ModelName::RollerCentric } else { ModelName::FlowCentric },
            roller_centric: roller_centric.map(Parameters::from),
            friction: ports.filter_map(|(port, friction)| friction.map(|_| port.name())).collect(),
            method: run.method.name(),
            speed_rpm: rpm(run.speed_rad_s),
            duration_s: run.duration_s,
            dt_s: run.dt_s,
            steady: (*steady).into(),
            run_inlet_min_kpa: reached.map(|reached| reached.inlet.min_kpa),
            run_outlet_min_kpa: reached.map(|reached| reached.outlet.min_kpa),
            inlet_limit_kpa: lowest.map(|lowest| lowest.kpa),
            inlet_limit: lowest.map(|lowest| lowest.set_by),
            limited_by: None,
            fluid: file.fluid.name.clone(),
            fluid_temperature_degc: file.fluid.temperature_degc,
            has_lines: [!file.inlet.is_unknown(), !file.outlet.line.is_unknown()],
            warnings: warnings_of(file, run.speed_rad_s, steady, reached),
        }
    }

    /// Returns the report of the fastest run, which this limit binds.
    #[must_use]
    pub fn limited_by(self, limit: LimitedBy) -> Self {
        Self { limited_by: Some(limit.name()), ..self }
    }

    /// Returns the report with one more warning.
    #[must_use]
    pub fn with_warning(mut self, warning: Notice) -> Self {
        self.warnings.push(warning);
        self
    }

    /// Returns the report whose warnings have their remedies in a front end's words.
    #[must_use]
    pub fn worded(self, words: Wording) -> Self {
        Self { warnings: self.warnings.iter().map(|warning| warning.told(words)).collect(), ..self }
    }

    /// Title of a picture of the run.
    pub fn title(&self) -> String {
        format!("{} at {} r/min from rest", self.pump, (1e4 * self.speed_rpm).round() / 1e4)
    }

    /// One line of JSON.
    pub fn json(&self) -> String {
        serde_json::to_string(self).unwrap_or_else(|error| unreachable!("a report is plain data: {error}"))
    }

    /// The words for people: the steady state, the model and its warnings.
    pub fn text(&self) -> String {
        let warnings = self.warnings.iter().map(|warning| format!("  warning {warning}\n"));
        [self.figures(), self.fluid(), self.limit(), self.assumptions(), self.hoses()]
            .into_iter()
            .chain(warnings)
            .collect()
    }

    fn figures(&self) -> String {
        let s = &self.steady;
        let pressures = |is_known: bool, least_kpa: f64, most_kpa: f64, mean_kpa: f64| match is_known {
            true => format!("{least_kpa:.3} to {most_kpa:.3} kPa absolute, mean {mean_kpa:.3}"),
            false => "pressures not known: the pump file names no line".to_owned(),
        };
        let [has_inlet, has_outlet] = self.has_lines;
        format!(
            "{} at {:.4} r/min, {} model, periodic steady state\n\n  \
             flow    {:.4} mL/s mean; at the outlet rollers {:.1} % peak to peak, {:.1} % RMS\n  \
             inlet   {}\n  outlet  {}\n",
            self.pump,
            self.speed_rpm,
            self.model,
            s.mean_flow_ml_s,
            100.0 * s.ripple_peak_to_peak,
            100.0 * s.ripple_rms,
            pressures(has_inlet, s.inlet_min_kpa, s.inlet_max_kpa, s.inlet_mean_kpa),
            pressures(has_outlet, s.outlet_min_kpa, s.outlet_max_kpa, s.outlet_mean_kpa),
        )
    }

    fn fluid(&self) -> String {
        format!("  fluid   {} at {} °C\n", self.fluid, self.fluid_temperature_degc)
    }

    fn limit(&self) -> String {
        self.limited_by.map_or(String::new(), |by| {
            format!("  limit   this is the fastest run that holds every limit; limited by {by}\n")
        })
    }

    fn assumptions(&self) -> String {
        self.roller_centric.as_ref().map_or(String::new(), |model| {
            format!(
                "  model   experimental: segments {} of the round tube's volume, {} /kPa more by pressure; rollers \
                 close at {:.2}°, and open resist {} kPa s/mL\n",
                model.scale, model.distensibility_per_kpa, model.closure_deg, model.valve_resistance_kpa_s_ml
            )
        })
    }

    fn hoses(&self) -> String {
        match &self.friction[..] {
            [] => String::new(),
            ports => {
                format!("  lines   friction of the hose at every flow ({}), integrated\n", ports.join(", "))
            }
        }
    }
}

/// Returns the warning of an absolute pressure below 0, kPa, with the place at which a model reaches it.
pub fn cavitation_warning(kpa: f64, place: impl Display) -> String {
    format!("no liquid can be at {kpa:.1} kPa absolute ({place}): it would cavitate")
}

/// The reasons for which the figures are doubtful. A pressure limit is checked where a dose checks it: the lowest
/// pressure of tube and fluid at both ports, those of the pump file by the ports' roles.
fn warnings_of(
    file: &PumpFile,
    speed_rad_s: f64,
    steady: &SteadyState,
    reached: Option<Reached>,
) -> Vec<Notice> {
    let mut warnings: Vec<String> = Vec::new();
    let limit_rpm = file.motor.max_speed_rpm;
    if rpm(speed_rad_s).abs() > limit_rpm * (1.0 + 1e-12) {
        warnings.push(format!("this is above the pump's limit of {limit_rpm} r/min"));
    }
    if file.inlet.is_unknown() || file.outlet.line.is_unknown() {
        warnings.push(
            "the pump file names no lines, so the pressures are no prediction: give [inlet] and [outlet]"
                .to_owned(),
        );
    }
    warnings.extend(file.model().ok().and_then(|pump| overlap_warning(pump.geometry())));
    let limits = file.limits();
    let of_run =
        |of: fn(Reached) -> Extremes, steady: Extremes| reached.map_or(steady, |run| of(run).and(steady));
    let inlet = ("inlet", steady.inlet, of_run(|run| run.inlet, steady.inlet));
    let outlet = ("outlet", steady.outlet, of_run(|run| run.outlet, steady.outlet));
    let (sucking, pushing) = if speed_rad_s < 0.0 { ("outlet", "inlet") } else { ("inlet", "outlet") };
    for (port, steady, run) in [inlet, outlet] {
        let lowest = if port == sucking { limits.lowest_where_it_sucks() } else { limits.lowest };
        // The steady state goes on, so it is told where it breaks the limit itself.
        let broken = |lowest: &Lowest| run.min_kpa < lowest.kpa;
        let starting = |limit_kpa: f64| if steady.min_kpa < limit_kpa { "" } else { " at start-up" };
        let told = |limit_kpa: f64| if steady.min_kpa < limit_kpa { steady } else { run }.min_kpa;
        if run.min_kpa < 0.0 {
            warnings.push(cavitation_warning(told(0.0), format_args!("{port}{}", starting(0.0))));
        } else if let Some(lowest) = lowest.filter(broken) {
            warnings.push(format!(
                "the {port} pressure falls to {:.2} kPa absolute{}, below the limit of {:.2} kPa{}; a dose that \
                 reaches this is refused",
                told(lowest.kpa),
                starting(lowest.kpa),
                lowest.kpa,
                lowest.set_by
            ));
        }
        let most = limits.pressures.max_outlet_kpa.filter(|most| port == pushing && run.max_kpa > *most);
        if let Some(most_kpa) = most {
            warnings.push(format!(
                "the {port} pressure rises to {:.2} kPa absolute, above the limit of {most_kpa:.2} kPa; a dose that \
                 reaches this is refused",
                run.max_kpa
            ));
        }
    }
    file.resistance_warning().into_iter().chain(warnings.into_iter().map(Notice::from)).collect()
}
