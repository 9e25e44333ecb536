//! `dose identify resistance`: R from steady flows and pressures.

use clap::Args;
use pump_dose::fit_plot::{Axes, Fitted};
use pump_dose::identification::flow_points_of_csv;
use pump_model::Line;
use pump_model::identification::ResistanceFit;

use super::super::args::Options;
use super::super::outputs::Outputs;
use super::super::{Failure, print};
use super::report::{Parameter, Report};
use super::{DataArgs, LineName, plot};

#[derive(Debug, Args)]
pub(crate) struct ResistanceArgs {
    #[command(flatten)]
    data: DataArgs,
    /// Which line it is
    #[arg(long, value_name = "inlet|outlet", default_value = "outlet")]
    line: LineName,
    /// Seek also the pressure at no flow: a reservoir or a sensor that is off
    #[arg(long)]
    offset: bool,
}

pub(super) fn resistance(args: &ResistanceArgs, options: &Options) -> Result<(), Failure> {
    options.accept_only("dose identify resistance", &["--plot", "--format"])?;
    options.outputs_differ()?;
    let file = options.pump_file()?;
    let (pump, port) = (file.model().map_err(Failure::refused)?, args.line.port());
    let line = pump.line(port);
    let points = args.data.read(|text| flow_points_of_csv(text, port, line.reservoir_kpa))?;
    let fit = ResistanceFit::of(&points, args.offset).map_err(|error| args.data.in_table(error))?;
    let mut parameters =
        vec![Parameter::found("resistance_kpa_s_ml", "resistance", "kPa s/mL", fit.resistance_kpa_s_ml)];
    parameters.extend(fit.offset_kpa.map(|offset| Parameter::found("offset_kpa", "offset", "kPa", offset)));
    let warnings = fit.bend.iter().map(|bend| {
        let rate_ml_s = file.pump.default_rate_ml_s;
        format!(
            "the resistance changes with the flow: {:.5} + {:.6} per mL/s, {:.5} kPa s/mL at the pump's {rate_ml_s} mL/s; \
             measure at flows like those of doses",
            bend.at_no_flow_kpa_s_ml.value,
            bend.per_flow_kpa_s2_ml2.value,
            bend.resistance_kpa_s_ml(rate_ml_s),
        )
    });
    let mut fitted: Vec<_> = points
        .iter()
        .map(|point| Fitted {
            x: point.flow_ml_s,
            measured: point.drop_kpa,
            fitted: fit.drop_kpa(point.flow_ml_s),
        })
        .collect();
    fitted.sort_by(|one, other| one.x.total_cmp(&other.x));
    let report = Report {
        kind: "resistance",
        port,
        headline: format!("{} line, dP = R Q over {} points", port.name(), points.len()),
        parameters,
        independent: points.len() as f64,
        points: fitted,
        warnings: warnings.collect(),
        line: Line { resistance_kpa_s_ml: fit.resistance_kpa_s_ml.value, ..*line },
    };
    let mut outputs = Outputs::default();
    if let Some(path) = &options.plot {
        let axes = Axes { x: "flow, mL/s", y: "pressure drop, kPa", left: "measured less fitted, kPa" };
        plot(&mut outputs, path, &report.headline, axes, &report.points)?;
    }
    outputs.put()?;
    print(&if options.json() { report.json() } else { report.text() })
}
