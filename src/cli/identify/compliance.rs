//! `dose identify compliance`: C from a syringe injection.

use clap::Args;
use pump_dose::fit_plot::{Axes, Fitted};
use pump_dose::identification::injection_of_csv;
use pump_dose::quantity;
use pump_model::Line;
use pump_model::identification::ComplianceFit;

use super::super::args::Options;
use super::super::outputs::Outputs;
use super::super::{Failure, print};
use super::report::{Parameter, Report};
use super::{DataArgs, LineName, plot};

#[derive(Debug, Args)]
pub(crate) struct ComplianceArgs {
    #[command(flatten)]
    data: DataArgs,
    /// Which line it is
    #[arg(long, value_name = "inlet|outlet", default_value = "outlet")]
    line: LineName,
    /// Volume that the closed line holds, as 26mL: gives its effective bulk modulus
    #[arg(long, value_name = "VOLUME", value_parser = quantity::volume_ml)]
    total_volume: Option<f64>,
}

pub(super) fn compliance(args: &ComplianceArgs, options: &Options) -> Result<(), Failure> {
    options.accept_only("dose identify compliance", &["--plot", "--format"])?;
    options.outputs_differ()?;
    let file = options.pump_file()?;
    let (pump, port) = (file.model().map_err(Failure::refused)?, args.line.port());
    let points = args.data.read(|text| injection_of_csv(text, port))?;
    let fit = ComplianceFit::of(&points).map_err(|error| args.data.in_table(error))?;
    let mut parameters = vec![
        Parameter::found("compliance_ml_kpa", "compliance", "mL/kPa", fit.compliance_ml_kpa),
        Parameter::found("start_kpa", "start", "kPa", fit.start_kpa),
    ];
    parameters.extend(args.total_volume.map(|total_ml| {
        Parameter::found("bulk_modulus_kpa", "bulk modulus", "kPa", fit.bulk_modulus_kpa(total_ml))
    }));
    let warnings = fit.bend.iter().map(|(slope, growth)| {
        format!(
            "the line {} as it fills: dP/dV is {:.3} kPa/mL at the start and changes by {:.3} per mL; inject over pressures like \
             those of doses",
            if growth.value > 0.0 { "stiffens (air does that)" } else { "softens" },
            slope.value,
            2.0 * growth.value,
        )
    });
    let mut fitted: Vec<_> = points
        .iter()
        .map(|point| Fitted {
            x: point.volume_ml,
            measured: point.pressure_kpa,
            fitted: fit.pressure_kpa(point.volume_ml),
        })
        .collect();
    fitted.sort_by(|one, other| one.x.total_cmp(&other.x));
    let report = Report {
        kind: "compliance",
        port,
        headline: format!("{} line, C = dV/dP over {} points", port.name(), points.len()),
        parameters,
        independent: points.len() as f64,
        points: fitted,
        warnings: warnings.collect(),
        line: Line { compliance_ml_kpa: fit.compliance_ml_kpa.value, ..*pump.line(port) },
    };
    let mut outputs = Outputs::default();
    if let Some(path) = &options.plot {
        let axes = Axes { x: "injected, mL", y: "pressure, kPa", left: "measured less fitted, kPa" };
        plot(&mut outputs, path, &report.headline, axes, &report.points)?;
    }
    outputs.put()?;
    print(&if options.json() { report.json() } else { report.text() })
}
