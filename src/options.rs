//! What may be typed.

use std::path::{PathBuf, absolute};

use clap::{ArgGroup, Args, Parser, Subcommand, ValueEnum};
use pump_bench::pump_file::{DriverName, PumpFile};
use pump_bench::record::default_state_dir;
use pump_bench::units;
use pump_bench::units::Pressure;
use pump_bench::{Bench, pump_named};
use pump_ctl::plan::Cruise;

use crate::commands::batch;
use crate::commands::calibrate::CalibrateCommand;
use crate::commands::identify::IdentifyCommand;
use crate::commands::new_pump::NewPump;
use crate::failure::Failure;

/// The command that prints pumps.
pub(crate) const SHOW: &str = "dose pumps show";

const EXAMPLES: &str = "Examples:
  dose 25mL
  dose 0.5mL --start-angle 30deg --dry-run
  dose 100mL --rate 600mL/min --plot dose.svg
  dose simulate --speed 100rpm --duration 10s --trace run.csv";

/// Doses with a peristaltic pump from the angle of its rollers
#[derive(Debug, Parser)]
#[command(
    name = "dose",
    version,
    about,
    override_usage = "dose [OPTIONS] <VOLUME>\n       dose [OPTIONS] <COMMAND>",
    after_help = EXAMPLES
)]
pub(crate) struct Cli {
    /// How much, with its unit: 25mL, 0.025L, 250uL, 25g; negative runs in reverse
    #[arg(value_name = "VOLUME")]
    pub(crate) volume: Vec<String>,
    #[command(subcommand)]
    pub(crate) command: Option<Command>,
    #[command(flatten)]
    pub(crate) options: Options,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Fill the line before a dose; what doses owe each other stays as it is
    Prime {
        /// How much, with its unit
        #[arg(value_name = "VOLUME")]
        volume: Vec<String>,
    },
    /// Empty the line: like prime, for the record; a negative volume runs back
    Purge {
        /// How much, with its unit
        #[arg(value_name = "VOLUME")]
        volume: Vec<String>,
    },
    /// Weigh what the pump delivers, so that doses are right
    Calibrate {
        #[command(subcommand)]
        command: Option<CalibrateCommand>,
    },
    /// Find the resistance, compliance and inertance of a line from measurements
    Identify {
        #[command(subcommand)]
        command: IdentifyCommand,
    },
    /// Run the model at constant speed (--speed or --rate, --duration)
    Simulate,
    /// Say where the rollers stand, what is owed, and what is unfinished
    Status,
    /// Make the rest of a dose that was stopped or cut off
    Resume,
    /// Accept a dose that was stopped or cut off as it is
    Discard,
    /// Let go of the rotor; its angle is less well known afterwards
    Release,
    /// Say that the tube was exchanged
    Tube {
        /// The tube is new: it has pumped nothing, and doses owe nothing
        #[arg(long, required = true)]
        new: bool,
    },
    /// Find out where the rollers stand, or say it
    #[command(group = ArgGroup::new("angle").required(true).args(["mark", "sensor", "set", "unknown"]))]
    Home {
        /// Turn the rotor with the arrow keys until its mark meets the housing's
        #[arg(long)]
        mark: bool,
        /// How well the two marks can be seen to meet [default: 0.5deg]
        #[arg(long, value_name = "ANGLE", value_parser = units::angle_rad, requires = "mark")]
        mark_tolerance: Option<f64>,
        /// Turn forward until the index sensor answers, a revolution at most
        #[arg(long)]
        sensor: bool,
        /// Do not ask before the sensor is looked for, whatever the pump pumps meanwhile
        #[arg(long, requires = "sensor")]
        yes: bool,
        /// The angle, as 30deg; 0deg: a roller begins to leave the outlet
        #[arg(long, value_name = "ANGLE", value_parser = units::angle_rad)]
        set: Option<f64>,
        /// Nobody knows: the rotor was turned by hand
        #[arg(long)]
        unknown: bool,
    },
    /// Print what a shell needs to complete this command
    Completions {
        /// bash, zsh, fish, elvish or powershell
        shell: clap_complete::Shell,
    },
    /// Built-in pumps and pump files
    Pumps {
        #[command(subcommand)]
        command: Option<PumpsCommand>,
    },
}

#[derive(Debug, Subcommand)]
pub(crate) enum PumpsCommand {
    /// List the built-in pumps
    List,
    /// Print a pump as a pump file, or with --format rust as constants for firmware
    Show {
        /// Built-in name or TOML file
        name: String,
    },
    /// Write a pump file from a drawing
    New(NewPump),
    /// Check a pump file and say what it gives
    Check {
        /// TOML file
        file: PathBuf,
    },
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Format {
    /// For people
    Text,
    /// One object a line
    Json,
    /// Constants for firmware: `dose pumps show` alone
    Rust,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Driver {
    /// Simulated stepper, pump and vessel
    Sim,
    /// A controller that speaks grbl 1.1's protocol over a serial port: grbl, grblHAL, FluidNC
    Grbl,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum FinishAt {
    /// Anywhere
    Any,
    /// Where the flow is at most half of what it is between pulses: drips less, in finer steps
    LowFlow,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Missed {
    /// Leave it out
    Skip,
    /// Make it at once
    Now,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Model {
    /// Flows at the rollers drive the lines
    FlowCentric,
    /// Every roller a valve, every segment between two a chamber (experimental)
    RollerCentric,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Method {
    /// The best that applies
    Auto,
    /// The exact solution
    Exact,
    /// The implicit integrator
    Rodas5p,
}

/// Every option is accepted before and after a command.
#[derive(Debug, Args)]
pub(crate) struct Options {
    /// Built-in pump or TOML pump file
    #[arg(long, global = true, value_name = "NAME|FILE", env = "DOSE_PUMP", default_value = "three-roller")]
    pub(crate) pump: String,
    /// Where angle and carry are kept
    #[arg(long, global = true, value_name = "DIR", env = "DOSE_STATE_DIR")]
    pub(crate) state_dir: Option<PathBuf>,
    /// Mean flow while cruising, as 10mL/s, or max: the fastest that holds every limit [default: the pump file's]
    #[arg(long, global = true, value_name = "FLOW", value_parser = units::rate)]
    pub(crate) rate: Option<Cruise>,
    /// Speed of the pump head while cruising, as 100rpm
    #[arg(long, global = true, value_name = "SPEED", value_parser = units::speed_rad_s)]
    pub(crate) speed: Option<f64>,
    /// Total time with ramps and settling, as 10s
    #[arg(long, global = true, value_name = "TIME", value_parser = units::time_s)]
    pub(crate) within: Option<f64>,
    /// Let the speed follow the rollers' angle, for a flow as smooth as the limits allow
    #[arg(long, global = true)]
    pub(crate) smooth: bool,
    /// Where in a pitch the dose may end [default: any]
    #[arg(long, global = true, value_name = "any|low-flow")]
    pub(crate) finish: Option<FinishAt>,
    /// What is pumped, where it is not the pump file's fluid: water, ethanol, isopropanol, glycerol 50%
    #[arg(long, global = true, value_name = "NAME")]
    pub(crate) fluid: Option<String>,
    /// Temperature of what is pumped, as 20degC [default: the pump file's]
    #[arg(long, global = true, value_name = "TEMPERATURE", value_parser = units::temperature_degc)]
    pub(crate) temperature: Option<f64>,
    /// Suck back so much after the dose; the next one repays it
    #[arg(long, global = true, value_name = "VOLUME", value_parser = units::volume_ml)]
    pub(crate) retract: Option<f64>,
    /// Run in reverse
    #[arg(long, global = true)]
    pub(crate) reverse: bool,
    /// Where the rollers stand, as 30deg; 0deg: a roller begins to leave the outlet [default: as recorded]
    #[arg(long, global = true, value_name = "ANGLE", value_parser = units::angle_rad)]
    pub(crate) start_angle: Option<f64>,
    /// Largest pressure at the port that pushes, as 120kPaa or 20kPag
    #[arg(long, global = true, value_name = "PRESSURE", value_parser = units::pressure)]
    pub(crate) max_outlet_pressure: Option<Pressure>,
    /// Smallest pressure at the port that sucks, as 45kPaa
    #[arg(long, global = true, value_name = "PRESSURE", value_parser = units::pressure)]
    pub(crate) min_inlet_pressure: Option<Pressure>,
    /// Volume that a tube lasts, as 100L: warned of from 90 % on, then doses are refused [default: the pump file's]
    #[arg(long, global = true, value_name = "VOLUME", value_parser = units::volume_ml)]
    pub(crate) tube_limit: Option<f64>,
    /// A batch of this many doses, one after the other or as --every says
    #[arg(long, global = true, value_name = "N", value_parser = batch::number_of_doses)]
    pub(crate) repeat: Option<u64>,
    /// Time from the start of one dose of a batch to the start of the next, as 30s
    #[arg(long, global = true, value_name = "TIME", value_parser = units::time_s)]
    pub(crate) every: Option<f64>,
    /// What becomes of a dose whose time has passed [default: skip]
    #[arg(long, global = true)]
    pub(crate) missed: Option<Missed>,
    /// What turns the motor [default: the pump file's, else sim]
    #[arg(long, global = true)]
    pub(crate) driver: Option<Driver>,
    /// Serial port of the controller, as /dev/ttyUSB0 [default: the pump file's]
    #[arg(long, global = true, value_name = "DEVICE")]
    pub(crate) port: Option<PathBuf>,
    /// Write the controller's settings where they do not fit the pump; what was changed is said
    #[arg(long, global = true)]
    pub(crate) configure: bool,
    /// Plan and predict; move nothing, record nothing
    #[arg(long, global = true)]
    pub(crate) dry_run: bool,
    /// Report for people or programs [default: text]
    #[arg(long, global = true)]
    pub(crate) format: Option<Format>,
    /// Write every planned step as CSV
    #[arg(long, global = true, value_name = "FILE")]
    pub(crate) steps: Option<PathBuf>,
    /// Write the predicted waveform as CSV
    #[arg(long, global = true, value_name = "FILE")]
    pub(crate) trace: Option<PathBuf>,
    /// Draw flows, pressures, speed and delivered volume
    #[arg(long, global = true, value_name = "FILE.svg")]
    pub(crate) plot: Option<PathBuf>,
    /// Time between rows of --trace [default: 1ms]
    #[arg(long, global = true, value_name = "TIME", value_parser = units::time_s)]
    pub(crate) dt: Option<f64>,
    /// How long `simulate` runs, as 10s
    #[arg(long, global = true, value_name = "TIME", value_parser = units::time_s)]
    pub(crate) duration: Option<f64>,
    /// What `simulate` computes [default: flow-centric]
    #[arg(long, global = true)]
    pub(crate) model: Option<Model>,
    /// How `simulate` computes it [default: auto]
    #[arg(long, global = true)]
    pub(crate) method: Option<Method>,
}

impl Options {
    /// Refuses options that `command` would ignore: nobody should believe that they were obeyed.
    pub(crate) fn accept_only(&self, command: &str, accepted: &[&str]) -> Result<(), Failure> {
        let given = [
            ("--rate", self.rate.is_some()),
            ("--speed", self.speed.is_some()),
            ("--within", self.within.is_some()),
            ("--smooth", self.smooth),
            ("--finish", self.finish.is_some()),
            ("--fluid", self.fluid.is_some()),
            ("--temperature", self.temperature.is_some()),
            ("--retract", self.retract.is_some()),
            ("--reverse", self.reverse),
            ("--start-angle", self.start_angle.is_some()),
            ("--max-outlet-pressure", self.max_outlet_pressure.is_some()),
            ("--min-inlet-pressure", self.min_inlet_pressure.is_some()),
            ("--tube-limit", self.tube_limit.is_some()),
            ("--repeat", self.repeat.is_some()),
            ("--every", self.every.is_some()),
            ("--missed", self.missed.is_some()),
            ("--driver", self.driver.is_some()),
            ("--port", self.port.is_some()),
            ("--configure", self.configure),
            ("--dry-run", self.dry_run),
            ("--format", self.format.is_some()),
            ("--steps", self.steps.is_some()),
            ("--trace", self.trace.is_some()),
            ("--plot", self.plot.is_some()),
            ("--dt", self.dt.is_some()),
            ("--duration", self.duration.is_some()),
            ("--model", self.model.is_some()),
            ("--method", self.method.is_some()),
        ];
        if let Some((name, _)) = given.iter().find(|(name, given)| *given && !accepted.contains(name)) {
            return Err(Failure::refused(format!("{name} means nothing to `{command}`; leave it out")));
        }
        if self.format == Some(Format::Rust) && command != SHOW {
            return Err(Failure::refused(format!("`--format rust` belongs to `{SHOW}`; leave it out")));
        }
        Ok(())
    }

    /// The cruise that is asked for; one of the three ways at most.
    pub(crate) fn cruise(&self) -> Result<Option<Cruise>, Failure> {
        let speed = self.speed.map(|rad_s| Cruise::Speed { rad_s });
        let within = self.within.map(|time_s| Cruise::Within { time_s });
        let mut given = [self.rate, speed, within].into_iter().flatten();
        match (given.next(), given.next()) {
            (_, Some(_)) => {
                Err(Failure::refused("--rate, --speed and --within exclude each other; give one at most"))
            }
            (cruise, None) => Ok(cruise),
        }
    }

    /// The pump that is named.
    pub(crate) fn pump_file(&self) -> Result<PumpFile, Failure> {
        pump_named(&self.pump).map_err(Failure::refused)
    }

    /// The bench of that pump.
    pub(crate) fn bench(&self) -> Result<Bench, Failure> {
        let mut file = self.pump_file()?;
        file.tube.life_ml = self.tube_limit.or(file.tube.life_ml);
        file.fluid =
            file.fluid.changed_to(self.fluid.as_deref(), self.temperature).map_err(Failure::refused)?;
        let driver = self.driver.map(|driver| match driver {
            Driver::Sim => DriverName::Sim,
            Driver::Grbl => DriverName::Grbl,
        });
        if driver.unwrap_or(file.driver()) == DriverName::Sim {
            let given = [("--port", self.port.is_some()), ("--configure", self.configure)];
            if let Some((name, _)) = given.iter().find(|(_, given)| *given) {
                return Err(Failure::refused(format!(
                    "{name} means nothing to a simulated motor; to move a real one name its driver, as --driver grbl"
                )));
            }
        }
        let state_dir = match &self.state_dir {
            Some(dir) if dir.as_os_str().is_empty() => {
                return Err(Failure::refused("--state-dir is empty"));
            }
            Some(dir) => dir.clone(),
            None => default_state_dir()?,
        };
        Ok(Bench::new(file, driver, &state_dir)?.at_port(self.port.clone()).configuring(self.configure))
    }

    /// Whether a program reads the report.
    pub(crate) fn json(&self) -> bool {
        self.format == Some(Format::Json)
    }

    /// Refuses to write two outputs into one file.
    pub(crate) fn outputs_differ(&self) -> Result<(), Failure> {
        let paths: Vec<&PathBuf> = [&self.steps, &self.trace, &self.plot].into_iter().flatten().collect();
        for (n, path) in paths.iter().enumerate() {
            if path.as_os_str() == "-" {
                return Err(Failure::refused("`-` is no file; standard output carries the report"));
            }
            let place = |path: &PathBuf| absolute(path).unwrap_or(path.clone());
            if paths[..n].iter().any(|other| place(other) == place(path)) {
                let path = path.display();
                return Err(Failure::refused(format!(
                    "{path} is named for two outputs; give each its own file"
                )));
            }
        }
        Ok(())
    }
}
