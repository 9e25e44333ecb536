//! `dose identify line`: R, C and L from pressure waveforms.

use clap::{Args, ValueEnum};
use pump_bench::export::Axes;
use pump_bench::identification::{self, Turning, identified_line, waveforms_of_csv};
use pump_bench::units;
use pump_ctl::plan::Cruise;
use pump_model::Port;
use pump_model::identification::Sought;

use super::{DataArgs, plot};
use crate::failure::{Failure, print};
use crate::options::Options;
use crate::outputs::Outputs;

#[derive(Debug, Args)]
pub(crate) struct LineArgs {
    #[command(flatten)]
    data: DataArgs,
    /// What the rotor did
    #[arg(long, value_name = "ramp|step|steady", default_value = "ramp")]
    begin: Begin,
    /// When it began to turn, in the time of the table, as 0.2s [default: 0s]
    #[arg(long, value_name = "TIME", value_parser = units::time_s)]
    start_time: Option<f64>,
    /// Seek also this: start (the time at which it began, near --start-time), reservoir (its pressure, or what the sensor is off)
    #[arg(long, value_name = "start,reservoir", value_delimiter = ',')]
    also: Vec<Also>,
    /// Do not seek this, hold the pump file's, as resistance,compliance
    #[arg(long, value_name = "PARAMETERS", value_delimiter = ',')]
    hold: Vec<Hold>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Begin {
    /// It started from rest with the pump file's acceleration
    Ramp,
    /// It started from rest at full speed, as `dose simulate` does
    Step,
    /// It had turned at this speed for long
    Steady,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Also {
    Start,
    Reservoir,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Hold {
    Resistance,
    Compliance,
    Inertance,
}

pub(super) fn line(args: &LineArgs, options: &Options) -> Result<(), Failure> {
    options.accept_only(
        "dose identify line",
        &["--rate", "--speed", "--reverse", "--start-angle", "--plot", "--format"],
    )?;
    options.outputs_differ()?;
    let file = options.pump_file()?;
    let pump = file.model().map_err(Failure::refused)?;
    let speed_rad_s = match options.cruise()? {
        Some(Cruise::Speed { rad_s }) => rad_s,
        Some(Cruise::Flow { ml_s }) => file.speed_for_flow(&pump, ml_s).map_err(Failure::refused)?,
        _ => return Err(Failure::refused("how fast did it turn? Add --speed 100rpm or --rate 10mL/s")),
    };
    let speed_rad_s = if options.reverse { -speed_rad_s } else { speed_rad_s };
    let pump = file.pump_at(&pump, speed_rad_s).map_err(Failure::refused)?;
    if args.begin == Begin::Steady && args.start_time.is_some() {
        return Err(Failure::refused("--start-time means nothing to a steady record; leave it out"));
    }
    let waveforms = args.data.read(waveforms_of_csv)?;
    let begin = match args.begin {
        Begin::Ramp => {
            identification::Begin::Ramp { acceleration_rad_s2: file.limits().motor.max_acceleration_rad_s2 }
        }
        Begin::Step => identification::Begin::Step,
        Begin::Steady => identification::Begin::Steady,
    };
    let turning = Turning {
        begin,
        start_s: args.start_time.unwrap_or(0.0),
        angle_rad: options.start_angle.unwrap_or(0.0),
        speed_rad_s,
    };
    let sought = Sought {
        resistance: !args.hold.contains(&Hold::Resistance),
        compliance: !args.hold.contains(&Hold::Compliance),
        inertance: !args.hold.contains(&Hold::Inertance),
        angle: options.start_angle.is_none(),
        start: args.also.contains(&Also::Start),
        pressure: args.also.contains(&Also::Reservoir),
    };
    let ports = [(Port::Inlet, &waveforms.inlet), (Port::Outlet, &waveforms.outlet)];
    let ports: Vec<_> = ports.into_iter().filter(|(_, samples)| !samples.is_empty()).collect();
    let Some((first, _)) = ports.first() else {
        return Err(args.data.in_table("there are no rows under the header"));
    };
    if ports.len() > 1 && options.plot.is_some() {
        return Err(Failure::refused("--plot draws one fit; leave p_in_kpa or p_out_kpa out of the table"));
    }
    let mut outputs = Outputs::default();
    let mut text = String::new();
    for (port, samples) in &ports {
        let found = identified_line(&pump, *port, samples, &turning, sought)
            .map_err(|error| args.data.in_table(error))?;
        if let Some(path) = &options.plot {
            let axes = Axes { x: "time, s", y: "pressure, kPa absolute", left: "measured less fitted, kPa" };
            plot(&mut outputs, path, &found.headline, axes, &found.points)?;
        }
        if port != first && !options.json() {
            text.push('\n');
        }
        text += &if options.json() { found.json() } else { found.text() };
    }
    outputs.put()?;
    print(&text)
}
