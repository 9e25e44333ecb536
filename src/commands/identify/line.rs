//! `dose identify line`: R, C and L from pressure waveforms.

use clap::{Args, ValueEnum};
use pump_bench::displacement::SpeedDependentPump;
use pump_bench::export::Axes;
use pump_bench::files::TableError;
use pump_bench::identification::{self, Turning, identified_line, waveforms_of_csv};
use pump_bench::{PumpFile, units};
use pump_ctl::plan::Cruise;
use pump_model::Port;
use pump_model::identification::Sought;

use super::data::{DataArgs, plot};
use crate::advice;
use crate::failure::Failure;
use crate::options::speed::{ReverseOption, SpeedOptions, StartAngleOption};
use crate::outputs::Outputs;
use crate::terminal::{print_json, tell, waiting};

#[derive(Debug, Args)]
pub(super) struct LineArgs {
    #[command(flatten)]
    speed: SpeedOptions,
    #[command(flatten)]
    reverse: ReverseOption,
    #[command(flatten)]
    start_angle: StartAngleOption,
    /// Start of the motion: ramp, step or steady
    #[arg(long, value_name = "ramp|step|steady", default_value = "ramp")]
    begin: BeginOption,
    /// When it began to turn, in the time of the table, as 0.2s [default: 0s]
    #[arg(long, value_name = "TIME", value_parser = units::time_s)]
    start_time: Option<f64>,
    /// Seek also the start (its time, near --start-time) or the reservoir (its pressure, or the sensor's error)
    #[arg(long, value_name = "start,reservoir", value_delimiter = ',')]
    also: Vec<Also>,
    /// Hold the pump file's value and do not seek it, as resistance,compliance
    #[arg(long, value_name = "PARAMETERS", value_delimiter = ',')]
    hold: Vec<Hold>,
    #[command(flatten)]
    data: DataArgs,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum BeginOption {
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

impl LineArgs {
    pub(super) fn run(&self) -> Result<(), Failure> {
        let (file, pump) = self.data.pump()?;
        let law = file.displacement_law().map_err(Failure::of)?;
        let pump = SpeedDependentPump::new(pump, law);
        let speed_rad_s = self.speed_rad_s(&pump)?;
        let pump = pump.at(speed_rad_s).map_err(Failure::of)?;
        if self.begin == BeginOption::Steady && self.start_time.is_some() {
            return Err(Failure::refused("--start-time means nothing to a steady record; leave it out"));
        }
        let waveforms = self.data.read(waveforms_of_csv)?;
        let ports = [(Port::Inlet, &waveforms.inlet), (Port::Outlet, &waveforms.outlet)];
        let ports: Vec<_> = ports.into_iter().filter(|(_, samples)| !samples.is_empty()).collect();
        if ports.is_empty() {
            return Err(self
                .data
                .in_table(TableError { line: 1, message: "there are no rows under the header".to_owned() }));
        }
        if ports.len() > 1 && self.data.plot.plot.is_some() {
            return Err(Failure::refused(
                "--plot draws one fit; leave p_in_kpa or p_out_kpa out of the table",
            ));
        }
        let (turning, sought) = (self.turning(&file, speed_rad_s), self.sought());
        let json = self.data.format.json();
        let mut outputs = Outputs::default();
        let mut texts = Vec::new();
        for (port, samples) in ports {
            let waiting = waiting(&format!("fitting the {} line to {} samples", port.name(), samples.len()));
            let found = identified_line(&pump, port, samples, &turning, sought);
            waiting.finish_and_clear();
            let found = found.map_err(|error| self.data.in_table(error))?.with_nozzle_of(&file);
            let axes = Axes { x: "time, s", y: "pressure, kPa absolute", left: "measured less fitted, kPa" };
            plot(&mut outputs, &self.data, &found.headline, axes, &found.points)?;
            let found = found.worded(advice::words);
            texts.push(if json { found.json() } else { found.text() });
        }
        outputs.put()?;
        if json { print_json(&texts.concat()) } else { tell(&texts.join("\n")) }
    }

    /// The speed that the rotor had, rad/s, negative in reverse.
    fn speed_rad_s(&self, pump: &SpeedDependentPump) -> Result<f64, Failure> {
        let speed_rad_s = match self.speed.cruise()? {
            Some(Cruise::Speed { rad_s }) => rad_s,
            Some(Cruise::Flow { ml_s }) => pump.speed_for_flow(ml_s).map_err(Failure::of)?,
            _ => {
                return Err(Failure::refused("how fast did it turn? Add --speed 100rpm or --rate 10mL/s"));
            }
        };
        Ok(if self.reverse.reverse { -speed_rad_s } else { speed_rad_s })
    }

    fn turning(&self, file: &PumpFile, speed_rad_s: f64) -> Turning {
        let begin = match self.begin {
            BeginOption::Ramp => {
                let acceleration_rad_s2 = file.limits().motor.max_acceleration_rad_s2;
                identification::Begin::Ramp { acceleration_rad_s2 }
            }
            BeginOption::Step => identification::Begin::Step,
            BeginOption::Steady => identification::Begin::Steady,
        };
        Turning {
            begin,
            start_s: self.start_time.unwrap_or(0.0),
            angle_rad: self.start_angle.start_angle.unwrap_or(0.0),
            speed_rad_s,
        }
    }

    fn sought(&self) -> Sought {
        Sought::new()
            .with_resistance(!self.hold.contains(&Hold::Resistance))
            .with_compliance(!self.hold.contains(&Hold::Compliance))
            .with_inertance(!self.hold.contains(&Hold::Inertance))
            .with_angle(self.start_angle.start_angle.is_none())
            .with_start(self.also.contains(&Also::Start))
            .with_pressure(self.also.contains(&Also::Reservoir))
    }
}
