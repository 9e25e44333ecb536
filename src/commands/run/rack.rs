//! `dose run RACK`: several pumps by one timetable.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::sync::{Mutex, PoisonError};

use clap::Args;
use indicatif::ProgressBar;
use pump_bench::rack::{Rack, RackEnd, RackError, RackFile, RackProgress, RackReport};
use pump_bench::safety::UnfinishedPolicy;

use crate::advice;
use crate::commands::delivery::before_dose;
use crate::failure::Failure;
use crate::interrupt::{self, Interrupt};
use crate::options::dosing::DosingOptions;
use crate::terminal::{announce, print_json, tell, waiting, warn};

/// The message after a signal.
const STOPPED: &str = "stopped by the user; `dose resume --pump NAME` makes the rest of a pump, `dose discard --pump \
                       NAME` leaves it";

/// Options that mean nothing to a rack, whose file says them: by clap's ids.
const NOT_OF_RACKS: [&str; 21] = [
    "for",
    "volume",
    "profile",
    "rate",
    "speed",
    "within",
    "smooth",
    "ramps",
    "reverse",
    "start_angle",
    "fluid",
    "temperature",
    "max_outlet_pressure",
    "min_inlet_pressure",
    "tube_limit",
    "port",
    "verbose",
    "steps",
    "trace",
    "dt",
    "plot",
];

/// The rack.
#[derive(Debug, Args)]
pub(crate) struct RackArgs {
    /// Several pumps by one timetable: the file of a rack, or its name in the configuration
    #[arg(value_name = "RACK", conflicts_with_all = NOT_OF_RACKS)]
    rack: Option<String>,
}

impl RackArgs {
    /// The name of the rack, if one is given.
    pub(super) fn name(&self) -> Option<&str> {
        self.rack.as_deref()
    }

    /// Runs the rack of this name, or with `--dry-run` plans it.
    pub(super) fn run(&self, name: &str, options: &DosingOptions) -> Result<(), Failure> {
        if let Some(pump) = options.typed_pump() {
            let refused = format!("--pump {pump} and the rack {name} both name pumps; give one of them");
            return Err(Failure::refused(refused).value(pump));
        }
        let json = options.format.json();
        let config = options.config()?;
        let path = config.find_rack(name).map_err(Failure::of)?;
        let file = RackFile::read(&path).map_err(refused)?;
        let benches = options.benches_of_rack(file.pump_files(&config).map_err(refused)?)?;
        let rack = Rack::new(file, benches).map_err(refused)?.paced(options.rack_pace());
        if options.dry_run {
            return said(rack.rehearse().map_err(refused)?, json, &BTreeSet::new()).map(drop);
        }
        let interrupt = Interrupt::watch()?;
        let rack = rack.stopping_on(interrupt::stop_request()).unattended(options.unattended.is_unattended());
        let moved = finish_interrupted(&rack, options, &interrupt)?;
        let shown = Shown::new(&rack, json);
        let report = rack.run(|progress| shown.show(&progress));
        shown.bar.finish_and_clear();
        let report = report.map_err(|error| refused(error).after_earlier_motion(moved))?;
        ended(said(report, json, &shown.warned())?, &interrupt)
    }
}

/// The failure of a rack, with the name of the pump that refuses it.
fn refused(error: RackError) -> Failure {
    let pump = match &error {
        RackError::Dose { pump, .. } | RackError::Pump { pump, .. } => Some(pump.clone()),
        _ => None,
    };
    Failure::of(error).of_pump(pump)
}

/// Does as `--unfinished` says with the interrupted dose of each pump, one after the other, before the rack is planned.
/// Returns true if a pump moved.
fn finish_interrupted(rack: &Rack, options: &DosingOptions, interrupt: &Interrupt) -> Result<bool, Failure> {
    let mut moved = false;
    if options.unattended.unfinished() == UnfinishedPolicy::Ask {
        // Planning refuses it.
        return Ok(moved);
    }
    for member in rack.members() {
        let of_member = |failure: Failure| {
            let failure = failure.after(&format!("pump `{}` of the rack: ", member.name));
            failure.of_pump(Some(member.name.clone()))
        };
        let bench = member.bench.clone().stopping_on(interrupt::stop_request());
        let mut session =
            bench.session().map_err(|error| of_member(Failure::from(error).after_earlier_motion(moved)))?;
        if session.state().is_none_or(|state| state.unfinished.is_none()) {
            continue;
        }
        let told = before_dose(&bench, &mut session, options, interrupt);
        moved |= session.has_moved();
        let told = told.map_err(|failure| of_member(failure.after_earlier_motion(moved)))?;
        warn(&told.iter().map(|notice| format!("{}: {notice}", member.name)).collect::<Vec<_>>());
        if let Some(signal) = interrupt.signal() {
            let stopped = "stopped by the user before the rack began; what was moved is on record";
            return Err(Failure::stopped(signal, moved, stopped));
        }
    }
    Ok(moved)
}

/// Progress bar and words of the pumps, which their threads show.
struct Shown<'a> {
    rack: &'a Rack,
    json: bool,
    bar: ProgressBar,
    told: Mutex<Told>,
}

/// Words that were told while the pumps ran.
#[derive(Default)]
struct Told {
    /// Pumps whose motors move.
    announced: BTreeSet<String>,
    /// Warnings that were told before a real motor moved, as `pump: text`.
    warned: BTreeSet<String>,
    /// Volume of each pump and that of its whole step, in mL, and the number of the step.
    volumes: BTreeMap<String, (f64, f64, usize)>,
}

impl<'a> Shown<'a> {
    fn new(rack: &'a Rack, json: bool) -> Self {
        let bar = if json { ProgressBar::hidden() } else { waiting("checking every pump") };
        Self { rack, json, bar, told: Mutex::default() }
    }

    /// Shows the progress of a pump. That a motor moves is said before it does.
    fn show(&self, progress: &RackProgress<'_>) {
        let mut told = self.told.lock().unwrap_or_else(PoisonError::into_inner);
        let member = self.rack.members().iter().find(|member| member.name == progress.pump);
        if let Some(member) = member.filter(|member| !member.bench.is_simulated() && progress.made == 0) {
            if told.announced.insert(progress.pump.to_owned()) {
                // Standard output that is gone must not stop the pumps: the report fails later.
                let _ = announce(&member.bench, self.json);
            }
            for warning in progress.warnings {
                let text = format!("{}: {}", progress.pump, warning.worded(advice::words));
                if told.warned.insert(text.clone()) {
                    warn(&[text]);
                }
            }
        }
        if self.bar.is_hidden() {
            return;
        }
        told.volumes.insert(progress.pump.to_owned(), (progress.volume_ml, progress.whole_ml, progress.step));
        let mut text = String::new();
        for (pump, (volume_ml, whole_ml, step)) in &told.volumes {
            let _ = write!(text, "{pump} step {step}: {volume_ml:.3} of {whole_ml:.3} mL  ");
        }
        self.bar.set_message(text);
    }

    fn warned(&self) -> BTreeSet<String> {
        self.told.lock().unwrap_or_else(PoisonError::into_inner).warned.clone()
    }
}

/// Prints the report. Warnings in `warned` were told before.
fn said(report: RackReport, json: bool, warned: &BTreeSet<String>) -> Result<RackReport, Failure> {
    let report = report.worded(advice::words);
    let lines = report.warning_lines();
    let untold = lines.lines().filter(|line| !warned.contains(line.trim_start_matches("warning: ")));
    let untold: Vec<&str> = untold.collect();
    if json {
        for line in &untold {
            warn(&[line.trim_start_matches("warning: ")]);
        }
        print_json(&(report.json() + "\n"))?;
        return Ok(report);
    }
    let headline = if report.simulated { "SIMULATED: no motor moved\n" } else { "" };
    let headline = match report.end {
        RackEnd::Planned if !report.simulated => "DRY RUN: no motor moves\n",
        _ => headline,
    };
    let warnings: String = untold.iter().map(|line| format!("{line}\n")).collect();
    tell(&format!("{headline}{}{warnings}", report.text()))?;
    Ok(report)
}

/// The end of the command after a rack whose report was printed.
fn ended(report: RackReport, interrupt: &Interrupt) -> Result<(), Failure> {
    let (moved, delivered_ml) = (report.has_moved(), report.total.delivered_ml);
    match (report.end, report.fault) {
        (RackEnd::Fault, Some(fault)) => {
            let failure = Failure::of(&fault.error).after(&format!("pump `{}` of the rack: ", fault.pump));
            let failure = failure.with("; every other pump was stopped").of_pump(Some(fault.pump));
            Err(if moved { failure.after_motion() } else { failure })
        }
        (RackEnd::Stopped, _) => {
            let signal = interrupt.signal().unwrap_or(0);
            Err(Failure::stopped(signal, moved, STOPPED).delivered(delivered_ml))
        }
        _ => Ok(()),
    }
}
