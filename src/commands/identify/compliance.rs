//! `dose identify compliance`: C from a syringe injection.

use clap::Args;
use pump_bench::export::Axes;
use pump_bench::identification::{identified_compliance, injection_of_csv};
use pump_bench::units;

use super::{DataArgs, LineName, plot};
use crate::failure::{Failure, print};
use crate::options::Options;
use crate::outputs::Outputs;

#[derive(Debug, Args)]
pub(crate) struct ComplianceArgs {
    #[command(flatten)]
    data: DataArgs,
    /// Which line it is
    #[arg(long, value_name = "inlet|outlet", default_value = "outlet")]
    line: LineName,
    /// Volume that the closed line holds, as 26mL: gives its effective bulk modulus
    #[arg(long, value_name = "VOLUME", value_parser = units::volume_ml)]
    total_volume: Option<f64>,
}

pub(super) fn compliance(args: &ComplianceArgs, options: &Options) -> Result<(), Failure> {
    options.accept_only("dose identify compliance", &["--plot", "--format"])?;
    options.outputs_differ()?;
    let file = options.pump_file()?;
    let (pump, port) = (file.model().map_err(Failure::refused)?, args.line.port());
    let points = args.data.read(|text| injection_of_csv(text, port))?;
    let found = identified_compliance(&points, args.total_volume, (port, pump.line(port)))
        .map_err(|error| args.data.in_table(error))?;
    let mut outputs = Outputs::default();
    if let Some(path) = &options.plot {
        let axes = Axes { x: "injected, mL", y: "pressure, kPa", left: "measured less fitted, kPa" };
        plot(&mut outputs, path, &found.headline, axes, &found.points)?;
    }
    outputs.put()?;
    print(&if options.json() { found.json() } else { found.text() })
}
