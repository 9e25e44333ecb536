//! `dose identify resistance`: R from steady flows and pressures.

use clap::Args;
use pump_bench::export::Axes;
use pump_bench::identification::{flow_points_of_csv, identified_resistance};

use super::{DataArgs, LineName, plot};
use crate::failure::{Failure, print};
use crate::options::Options;
use crate::outputs::Outputs;

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
    let rate_ml_s = file.pump.default_rate_ml_s;
    let found = identified_resistance(&points, args.offset, (port, line), rate_ml_s)
        .map_err(|error| args.data.in_table(error))?;
    let mut outputs = Outputs::default();
    if let Some(path) = &options.plot {
        let axes = Axes { x: "flow, mL/s", y: "pressure drop, kPa", left: "measured less fitted, kPa" };
        plot(&mut outputs, path, &found.headline, axes, &found.points)?;
    }
    outputs.put()?;
    print(&if options.json() { found.json() } else { found.text() })
}
