//! `dose identify line`: R, C and L from pressure waveforms.

use clap::{Args, ValueEnum};
use pump_ctl::plan::{Cruise, speed_for_flow};
use pump_dose::fit_plot::{Axes, Fitted};
use pump_dose::identification::waveforms_of_csv;
use pump_dose::quantity;
use pump_model::identification::{Estimate, LineFit, Motion, PressureSample, Recording, Sought};
use pump_model::math::{degrees, rpm};
use pump_model::{Leg, Line, Port, Pump};

use super::super::args::Options;
use super::super::outputs::Outputs;
use super::super::{Failure, print};
use super::report::{Parameter, Report};
use super::{DataArgs, plot};

#[derive(Debug, Args)]
pub(crate) struct LineArgs {
    #[command(flatten)]
    data: DataArgs,
    /// What the rotor did
    #[arg(long, value_name = "ramp|step|steady", default_value = "ramp")]
    begin: Begin,
    /// When it began to turn, in the time of the table, as 0.2s [default: 0s]
    #[arg(long, value_name = "TIME", value_parser = quantity::time_s)]
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
        Some(Cruise::Flow { ml_s }) => speed_for_flow(&pump, ml_s),
        _ => return Err(Failure::refused("how fast did it turn? Add --speed 100rpm or --rate 10mL/s")),
    };
    let speed_rad_s = if options.reverse { -speed_rad_s } else { speed_rad_s };
    if args.begin == Begin::Steady && args.start_time.is_some() {
        return Err(Failure::refused("--start-time means nothing to a steady record; leave it out"));
    }
    let waveforms = args.data.read(waveforms_of_csv)?;
    let start_s = args.start_time.unwrap_or(0.0);
    let angle_rad = options.start_angle.unwrap_or(0.0);
    let acceleration_rad_s2 = file.limits().motor.max_acceleration_rad_s2;
    let legs = legs(args.begin, start_s, angle_rad, speed_rad_s, acceleration_rad_s2);
    let motion = match args.begin {
        Begin::Steady => Motion::Steady { angle_rad, speed_rad_s },
        Begin::Ramp | Begin::Step => Motion::FromRest(&legs),
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
        let recording = Recording { port: *port, samples, motion };
        let report = report(&pump, &recording, sought, start_s, angle_rad, args)?;
        if let Some(path) = &options.plot {
            let axes = Axes { x: "time, s", y: "pressure, kPa absolute", left: "measured less fitted, kPa" };
            plot(&mut outputs, path, &report.headline, axes, &report.points)?;
        }
        if port != first && !options.json() {
            text.push('\n');
        }
        text += &if options.json() { report.json() } else { report.text() };
    }
    outputs.put()?;
    print(&text)
}

/// The motion from rest; a step has a ramp of no time.
fn legs(begin: Begin, start_s: f64, angle_rad: f64, speed_rad_s: f64, acceleration_rad_s2: f64) -> Vec<Leg> {
    let cruise = Leg { start_s, ..Leg::constant_speed(angle_rad, speed_rad_s) };
    if begin != Begin::Ramp {
        return vec![cruise];
    }
    let ramp = Leg {
        duration_s: speed_rad_s.abs() / acceleration_rad_s2,
        speed_rad_s: 0.0,
        acceleration_rad_s2: acceleration_rad_s2 * speed_rad_s.signum(),
        ..cruise
    };
    vec![ramp, Leg { start_s: ramp.end_s(), angle_rad: ramp.end_angle_rad(), ..cruise }]
}

fn report(
    pump: &Pump,
    recording: &Recording<'_>,
    sought: Sought,
    start_s: f64,
    angle_rad: f64,
    args: &LineArgs,
) -> Result<Report, Failure> {
    let refused = |error| args.data.in_table(error);
    let fit = LineFit::of(pump, recording, sought).map_err(refused)?;
    let (line, samples, port) = (fit.line(), recording.samples, recording.port);
    let fitted = fit.pressures_kpa(pump, recording, &line).map_err(refused)?;
    let points: Vec<_> = samples
        .iter()
        .zip(fitted)
        .map(|(sample, fitted)| Fitted { x: sample.time_s, measured: sample.pressure_kpa, fitted })
        .collect();
    let moved = |found: Estimate, by: f64| Estimate { value: found.value + by, ..found };
    let angle = moved(fit.angle_rad, angle_rad).times(degrees(1.0));
    let parameters = [
        ("resistance_kpa_s_ml", "resistance", "kPa s/mL", fit.resistance_kpa_s_ml, sought.resistance),
        ("compliance_ml_kpa", "compliance", "mL/kPa", fit.compliance_ml_kpa, sought.compliance),
        ("inertance_kpa_s2_ml", "inertance", "kPa s²/mL", fit.inertance_kpa_s2_ml, sought.inertance),
        ("reservoir_kpa", "reservoir", "kPa absolute", fit.reservoir_kpa, sought.pressure),
        ("start_angle_deg", "start angle", "°", angle, sought.angle),
        ("start_s", "start", "s", moved(fit.start_s, start_s), sought.start),
    ]
    .into_iter()
    .map(|(key, name, unit, found, is_sought)| Parameter { key, name, unit, found, is_held: !is_sought });
    let speed_rad_s = match recording.motion {
        Motion::Steady { speed_rad_s, .. } => speed_rad_s,
        Motion::FromRest(legs) => legs.last().map_or(0.0, |leg| leg.speed_rad_s),
    };
    let independent = samples.len() as f64 / fit.correlated_samples;
    Ok(Report {
        kind: "line",
        port,
        headline: format!(
            "{} line at {:.4} r/min, {} samples worth {independent:.0} independent ones",
            port.name(),
            rpm(speed_rad_s),
            samples.len(),
        ),
        parameters: parameters.collect(),
        independent,
        points,
        warnings: too_few_per_swing(samples, &line).into_iter().collect(),
        line,
    })
}

/// Whether the swings of the line pass between the samples.
fn too_few_per_swing(samples: &[PressureSample], line: &Line) -> Option<String> {
    let (first, last) = (samples.first()?, samples.last()?);
    let interval_s = (last.time_s - first.time_s) / (samples.len() - 1) as f64;
    let swing_s = std::f64::consts::TAU / line.natural_rad_s();
    (swing_s < 4.0 * interval_s).then(|| {
        format!("a swing of the line takes {swing_s:.4} s, less than four samples; record more often")
    })
}
