//! `dose size`: a head and its speed for a flow, hoses and lifts.

use clap::Args;
use pump_bench::config::PumpPlace;
use pump_bench::heads::{bought_head, nearest_heads};
use pump_bench::report::{ErrorKind, sizing_json, sizing_text, sizing_title};
use pump_bench::sizing::{Duty, Sizing, SizingError, curve_svg};
use pump_bench::units::{self, HoseSize, Pressure, ROLLERS, count};

use crate::advice;
use crate::commands::pumps::site::SiteOptions;
use crate::failure::Failure;
use crate::options::files::{Files, PlotOption};
use crate::options::fluid::FluidOptions;
use crate::options::pump::{ConfigOption, ForeignRecord};
use crate::options::report::FormatOption;
use crate::outputs::Outputs;
use crate::terminal::{print_json, tell, warn};

/// The duty, and the pump if it is chosen already.
#[derive(Debug, Args)]
pub(crate) struct SizeArgs {
    /// Mean flow, as 2L/h
    #[arg(long, value_name = "FLOW", value_parser = units::flow_ml_s, help_heading = "Duty")]
    flow: f64,
    /// Hose from the supply to the pump: bore x outer diameter and length, as 6x10mm,1m
    #[arg(long, value_name = "SIZE,LENGTH", value_parser = units::hose_size, help_heading = "Duty")]
    inlet_hose: Option<HoseSize>,
    /// Hose from the pump to the vessel, as 6x10mm,3m
    #[arg(long, value_name = "SIZE,LENGTH", value_parser = units::hose_size, help_heading = "Duty")]
    outlet_hose: Option<HoseSize>,
    /// Largest pressure at the outlet, as 120kPaa or 20kPag [default: that of the pump, or of its tubing]
    #[arg(long, value_name = "PRESSURE", value_parser = units::pressure, help_heading = "Duty")]
    max_outlet_pressure: Option<Pressure>,
    #[command(flatten)]
    fluid: FluidOptions,
    #[command(flatten)]
    site: SiteOptions,
    /// Pump in place of a head of the catalogue: a name of the configuration, a built-in pump or a pump file
    #[arg(long, value_name = "NAME|FILE", conflicts_with_all = ["head", "rollers"], help_heading = "Pump")]
    pump: Option<String>,
    /// Head of the catalogue, as masterflex-ls-16 [default: the nearest one that serves]
    #[arg(long, value_name = "NAME", help_heading = "Pump")]
    head: Option<String>,
    /// Number of rollers of that head, where its document states none
    #[arg(long, value_name = "N", requires = "head", help_heading = "Pump")]
    #[arg(value_parser = count("number of rollers", ROLLERS))]
    rollers: Option<u32>,
    #[command(flatten)]
    config: ConfigOption,
    #[command(flatten)]
    format: FormatOption,
    #[command(flatten)]
    plot: PlotOption,
    #[command(flatten)]
    record: ForeignRecord,
}

impl SizeArgs {
    /// Sizes a pump and reports it.
    pub(crate) fn run(&self) -> Result<(), Failure> {
        let outputs = [("--plot", self.plot.plot.as_deref())];
        let config = self.config.config()?;
        let state_dir = self.record.folder(&config);
        let pump = self.pump.as_deref().map(|name| config.find(name)).transpose().map_err(Failure::of)?;
        let inputs = [pump.as_ref().and_then(PumpPlace::file)];
        Files { outputs: &outputs, inputs: &inputs, config: self.config.path(), state_dir }.check()?;
        let sizing = self.sized()?;
        if let Some(path) = &self.plot.plot {
            let mut outputs = Outputs::default();
            outputs.drawing(path, curve_svg(&sizing, &sizing_title(&sizing)))?;
            outputs.put()?;
        }
        if self.format.json() {
            warn(&sizing.warnings);
            return print_json(&(sizing_json(&sizing) + "\n"));
        }
        let curve = if self.plot.plot.is_none() { "`--plot size.svg` draws the pump's curve\n" } else { "" };
        tell(&(sizing_text(&sizing, advice::words) + curve))
    }

    fn sized(&self) -> Result<Sizing, Failure> {
        let duty = self.duty()?;
        let sized = match (&self.pump, &self.head) {
            (Some(name), _) => {
                let file = self.config.config()?.pump(name).map_err(Failure::of)?;
                Sizing::of_pump(file, &duty)
            }
            (None, Some(name)) => self.of_head(name, &duty)?,
            (None, None) => Sizing::of_catalogue(&duty),
        };
        sized.map_err(|error| match error {
            SizingError::NoLine { side } => {
                Failure::of(error).with(&format!("; give --{side}-hose 6x10mm,1m"))
            }
            error => Failure::of(error),
        })
    }

    fn of_head(&self, name: &str, duty: &Duty) -> Result<Result<Sizing, SizingError>, Failure> {
        let Some(head) = bought_head(name) else {
            let nearest = nearest_heads(name).join(", ");
            let refused = Failure::refused(format!(
                "no head of the catalogue is `{name}`; the nearest are {nearest}; `dose pumps list --catalogue` has all"
            ));
            return Err(refused.kind(ErrorKind::Usage).value(name).allowed(&nearest));
        };
        let Some(rollers) = self.rollers.or(head.rollers) else {
            let refused = Failure::refused(format!(
                "the document of {name} does not state the number of rollers; count yours and add --rollers 3"
            ));
            return Err(refused.kind(ErrorKind::Usage).value("no --rollers").allowed("--rollers N"));
        };
        Ok(Sizing::of_head(head, rollers, duty))
    }

    fn duty(&self) -> Result<Duty, Failure> {
        let (fluid, temperature_degc) = self.fluid.named();
        let (suction_mm, discharge_mm) = self.site.lifts_mm();
        Ok(Duty::new(self.flow)
            .with_fluid(fluid, temperature_degc)
            .with_hoses(self.inlet_hose, self.outlet_hose)
            .with_lifts(suction_mm, discharge_mm)
            .with_ambient(self.site.ambient()?)
            .with_max_outlet(self.max_outlet_pressure))
    }
}
