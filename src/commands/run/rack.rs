//! `dose run RACK`: several pumps by one timetable.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::sync::{Mutex, PoisonError};

use clap::Args;
use indicatif::ProgressBar;
use pump_bench::notice::Notice;
use pump_bench::rack::{Rack, RackEnd, RackError, RackFile, RackProgress, RackReport};
use pump_bench::safety::UnfinishedPolicy;

use super::rack_lines::RackLines;
use super::rack_warnings::Gathered;
use crate::advice;
use crate::commands::delivery::{before_dose, unprinted};
use crate::failure::Failure;
use crate::interrupt::{self, Interrupt};
use crate::options::dosing::DosingOptions;
use crate::progress::supervised;
use crate::terminal::{announce, print_json, tell, waiting, warn};
use crate::told_commands::{completed, meaning};

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
        let file = RackFile::read(&path).map_err(Failure::of)?;
        let places = Places(file.pump_names().map(str::to_owned).zip(file.pump_places()).collect());
        let refused = |error| places.refused(error);
        let benches = options.benches_of_rack(file.pump_files(&config).map_err(refused)?)?;
        let rack = Rack::new(file, benches).map_err(refused)?.paced(options.rack_pace());
        if options.dry_run {
            return said(rack.rehearse().map_err(refused)?, json, &BTreeSet::new(), &places).map(drop);
        }
        let interrupt = Interrupt::watch()?;
        let rack = rack.stopping_on(interrupt::stop_request()).unattended(options.unattended.is_unattended());
        let moved = finish_interrupted((name, &rack), &places, options, &interrupt)?;
        let lines = supervised::tells().then(|| RackLines::begin(&rack));
        let shown = Shown::new(&rack, &places, json, lines);
        let report = rack.run(|progress| shown.show(&progress));
        shown.tell_warnings();
        shown.bar.finish_and_clear();
        let report = report.map_err(|error| refused(error).after_earlier_motion(moved))?;
        let (has_moved, total) = (report.has_moved(), report.total);
        let report = said(report, json, &shown.warned(), &places).map_err(|failure| {
            if has_moved {
                unprinted(&failure, total.delivered_ml, total.delivered_range_ml())
            } else {
                failure
            }
        })?;
        ended(report, &interrupt, &places)
    }
}

/// The pumps of a rack as a user types them, with their names in the rack, in its order.
struct Places(Vec<(String, String)>);

impl Places {
    /// The pump of this name as a user types it.
    fn of(&self, pump: &str) -> Option<&str> {
        self.0.iter().find(|(name, _)| name == pump).map(|(_, place)| place.as_str())
    }

    /// The names in the rack, each with the pump as a user types it.
    fn all(&self) -> Vec<(&str, &str)> {
        self.0.iter().map(|(name, place)| (name.as_str(), place.as_str())).collect()
    }

    /// Does something whose words are about this pump of the rack.
    fn meaning<T>(&self, pump: &str, does: impl FnOnce() -> T) -> T {
        meaning(self.of(pump).unwrap_or(pump), does)
    }

    /// The failure of a pump of the rack.
    fn failed(&self, pump: &str, failure: Failure) -> Failure {
        self.meaning(pump, || failure.completed()).of_pump(Some(pump.to_owned()))
    }

    /// The failure of a rack, with the name of the pump that refuses it.
    fn refused(&self, error: RackError) -> Failure {
        let pump = match &error {
            RackError::Dose { pump, .. } | RackError::Pump { pump, .. } | RackError::Alone { pump, .. } => {
                pump.clone()
            }
            RackError::Several { .. } => return self.refused_by_several(error),
            _ => return Failure::of(error),
        };
        self.failed(&pump, Failure::of(error))
    }

    /// The failure of a rack that several pumps refuse, each with its own commands. No single pump has failed.
    fn refused_by_several(&self, error: RackError) -> Failure {
        let told: Vec<String> = error
            .each()
            .map(|error| {
                let told = advice::told(error);
                let told = || completed(&told).into_owned();
                error.pump().map_or_else(told, |pump| self.meaning(pump, told))
            })
            .collect();
        Failure::of(error).saying(told.join("; "))
    }

    /// A warning of a pump of the rack, as `pump: text`.
    fn warning(&self, pump: &str, warning: &Notice) -> String {
        let text = warning.worded(advice::words);
        self.meaning(pump, || format!("{pump}: {}", completed(&text)))
    }
}

/// Does as `--unfinished` says with the interrupted dose of each pump, one after the other, before the rack is planned.
/// Returns true if a pump moved.
fn finish_interrupted(
    (name, rack): (&str, &Rack),
    places: &Places,
    options: &DosingOptions,
    interrupt: &Interrupt,
) -> Result<bool, Failure> {
    let mut moved = false;
    match options.unattended.unfinished() {
        // Planning refuses it.
        UnfinishedPolicy::Ask => return Ok(moved),
        UnfinishedPolicy::Resume => rack.check_rests().map_err(|error| places.refused(error))?,
        UnfinishedPolicy::Accept => {}
    }
    for member in rack.members() {
        let of_member = |failure: Failure| {
            places.failed(&member.name, failure.after(&format!("pump `{}` of the rack: ", member.name)))
        };
        let bench = member.bench.clone().stopping_on(interrupt::stop_request());
        let mut session =
            bench.session().map_err(|error| of_member(Failure::from(error).after_earlier_motion(moved)))?;
        if session.state().is_none_or(|state| state.unfinished.is_none()) {
            continue;
        }
        let told = places.meaning(&member.name, || before_dose(&bench, &mut session, options, interrupt));
        moved |= session.has_moved();
        let mut told = told.map_err(|failure| {
            of_member(failure.after_earlier_motion(moved)).with(&waits_after((name, rack), &member.name))
        })?;
        warn(&told.take().iter().map(|notice| places.warning(&member.name, notice)).collect::<Vec<_>>());
        if let Some(signal) = interrupt.signal() {
            let stopped = "stopped by the user before the rack began; what was moved is on record";
            return Err(Failure::stopped(signal, moved, stopped));
        }
    }
    Ok(moved)
}

/// Tells the pumps after this one whose interrupted doses wait too, as the rest of a message.
fn waits_after((rack_name, rack): (&str, &Rack), pump: &str) -> String {
    let after = rack.members().iter().skip_while(|member| member.name != pump).skip(1);
    let waits = after.filter(|member| {
        member.bench.story().is_ok_and(|story| story.state.is_some_and(|state| state.unfinished.is_some()))
    });
    let names: Vec<&str> = waits.map(|member| member.name.as_str()).collect();
    match names.as_slice() {
        [] => String::new(),
        names => {
            let names = names.join(", ");
            format!("; a dose is unfinished of {names} too, see `dose status --rack {rack_name}`")
        }
    }
}

/// Progress bar and words of the pumps, which their threads show.
struct Shown<'a> {
    rack: &'a Rack,
    places: &'a Places,
    json: bool,
    bar: ProgressBar,
    told: Mutex<Told>,
}

/// Words that were told while the pumps ran.
#[derive(Default)]
struct Told {
    /// Pumps whose motors move.
    announced: BTreeSet<String>,
    /// Warnings that were told before a real motor moved, each with its pump.
    warned: BTreeSet<(String, String)>,
    /// Warnings of pumps that are about to move, which are told at once.
    gathered: Gathered,
    /// Volume of each pump and that of its whole step, in mL, and the number of the step.
    volumes: BTreeMap<String, (f64, f64, usize)>,
    /// Lines to a supervising program, if there is one.
    lines: Option<RackLines>,
}

impl<'a> Shown<'a> {
    fn new(rack: &'a Rack, places: &'a Places, json: bool, lines: Option<RackLines>) -> Self {
        let bar = if json { ProgressBar::hidden() } else { waiting("checking every pump") };
        let told = Mutex::new(Told { lines, ..Told::default() });
        Self { rack, places, json, bar, told }
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
                let text = warning.worded(advice::words);
                if told.warned.insert((progress.pump.to_owned(), text.clone())) {
                    told.gathered.add(progress.pump, text);
                }
            }
        }
        // The pumps of a step come to this point together, in threads of their own, before the first of them moves.
        if progress.made > 0 || told.gathered.is_due() {
            warn(&told.gathered.take(&self.places.all()));
        }
        told.lines.iter_mut().for_each(|lines| lines.show(progress));
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

    /// Tells the warnings that wait for those of further pumps.
    fn tell_warnings(&self) {
        let mut told = self.told.lock().unwrap_or_else(PoisonError::into_inner);
        warn(&told.gathered.take(&self.places.all()));
    }

    fn warned(&self) -> BTreeSet<(String, String)> {
        self.told.lock().unwrap_or_else(PoisonError::into_inner).warned.clone()
    }
}

/// Prints the report. Warnings in `warned` were told before.
fn said(
    report: RackReport,
    json: bool,
    warned: &BTreeSet<(String, String)>,
    places: &Places,
) -> Result<RackReport, Failure> {
    let mut report = report.worded(advice::words);
    let mut gathered = Gathered::default();
    for row in &mut report.pumps {
        for warning in &row.warnings {
            if !warned.contains(&(row.name.clone(), warning.text().to_owned())) {
                gathered.add(&row.name, warning.text().to_owned());
            }
        }
        let told = |warning: &Notice| Notice::from(completed(warning.text()).into_owned());
        row.warnings = places.meaning(&row.name, || row.warnings.iter().map(told).collect());
    }
    let untold = gathered.take(&places.all());
    if json {
        warn(&untold);
        print_json(&(report.json() + "\n"))?;
        return Ok(report);
    }
    let headline = if report.simulated { "SIMULATED: no motor moved\n" } else { "" };
    let headline = match report.end {
        RackEnd::Planned if !report.simulated => "DRY RUN: no motor moves\n",
        _ => headline,
    };
    let warnings: String = untold.iter().map(|line| format!("warning: {line}\n")).collect();
    tell(&format!("{headline}{}{warnings}", report.text()))?;
    Ok(report)
}

/// The end of the command after a rack whose report was printed.
fn ended(report: RackReport, interrupt: &Interrupt, places: &Places) -> Result<(), Failure> {
    let (moved, range_ml) = (report.has_moved(), report.total.delivered_range_ml());
    let (rests, others) = (rests(&report, places), report.others_in_words());
    match (report.end, report.fault) {
        (RackEnd::Fault, Some(fault)) => {
            let failure = Failure::of(&fault.error).after(&format!("pump `{}` of the rack: ", fault.pump));
            let failure = places.failed(&fault.pump, failure);
            let others = if moved { others } else { Some("the rack moved no motor") };
            let others = others.map_or(String::new(), |others| format!("; {others}"));
            let failure = failure.with(&format!("{others}{rests}"));
            Err(if moved { failure.after_motion().delivered(range_ml) } else { failure })
        }
        (RackEnd::Stopped, _) => {
            let signal = interrupt.signal().unwrap_or(0);
            let stopped = format!("stopped by the user{rests}");
            Err(Failure::stopped(signal, moved, stopped).delivered(range_ml))
        }
        _ => Ok(()),
    }
}

/// The ways out of each unfinished dose of a stopped rack, and the steps that have none, as the rest of a message. The
/// message of a fault has the ways out of the pump that failed.
fn rests(report: &RackReport, places: &Places) -> String {
    let failed = report.fault.as_ref().map(|fault| fault.pump.as_str());
    let mut text = String::new();
    for row in report.pumps.iter().filter(|row| row.unfinished && failed != Some(row.name.as_str())) {
        let name = &row.name;
        let way = match row.over_time {
            true => format!("; the flow of {name} over time has no rest, `dose accept` leaves it"),
            false => format!("; `dose resume` makes the rest of {name}, `dose accept` leaves it"),
        };
        text += &places.meaning(&row.name, || completed(&way).into_owned());
    }
    if !report.pumps.iter().any(|row| row.unfinished) {
        text += "; no dose is unfinished";
    }
    let undone = report.pumps.iter().filter(|row| row.steps_not_begun > 0);
    let undone: Vec<String> = undone.map(|row| format!("{} of {}", row.steps_not_begun, row.name)).collect();
    if !undone.is_empty() {
        let _ = write!(text, "; steps that did not begin are in no rest: {}", undone.join(", "));
    }
    text
}
