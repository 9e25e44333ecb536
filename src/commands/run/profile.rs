//! `dose run --profile FILE`: a flow over time.

use std::cell::LazyCell;
use std::path::Path;

use pump_bench::dosing::FlowProfile;
use pump_bench::export::{Marks, write_flow_steps};
use pump_bench::files::{MOST_TABLE_BYTES, read_text};
use pump_bench::notice::Notice;
use pump_bench::record::Purpose;
use pump_bench::simulation::{Method, Waveform, times};
use pump_bench::units::Amount;
use pump_bench::{Bench, Delivered, DoseError, DoseReport, PreparedProfile, Session};

use crate::commands::delivery::{Said, before_dose, failed_untold, refuse_rows, report_once};
use crate::failure::Failure;
use crate::interrupt::Interrupt;
use crate::options::dosing::DosingOptions;
use crate::options::volume::AskedVolume;
use crate::outputs::{DEFAULT_DT_S, Outputs, PLOT_SAMPLES};
use crate::progress::MotionBar;
use crate::progress::supervised::{self, Reached};
use crate::terminal::{announcing, noted, warn};
use crate::warned::Warned;

/// The message after a signal.
const STOPPED: &str =
    "stopped by the user; the run is on record, and nothing is left to make: the profile's times have passed";

/// Runs the pump by the flow over time in a file, or with `--dry-run` plans it.
pub(super) fn run(path: &Path, options: &DosingOptions) -> Result<(), Failure> {
    options.check_files_beside(Some(path))?;
    let bench = options.bench()?;
    let name = path.file_name().map_or_else(|| path.display().to_string(), |name| name.display().to_string());
    let text = read_text(path, MOST_TABLE_BYTES).map_err(|error| Failure::unread(path, &error))?;
    let mut profile = FlowProfile::parse(&name, &text).map_err(Failure::of)?;
    // The library finds the volume. The sign of this one is the direction.
    let forward = AskedVolume { amount: Amount::Volume(1.0), typed: name.clone() };
    let request = options.request(Purpose::Run, &forward, &bench)?;
    if request.volume_ml < 0.0 {
        profile = profile.reversed();
    }
    let json = options.format.json();
    let said = Said { json, verbose: options.verbose.verbose, asked: Some(&name) };
    let assumed = || options.start_angle.assumed(&bench).map(Notice::from);
    if options.dry_run {
        let mut prepared = bench.prepare_profile(request, &profile)?;
        prepared.whole.warnings.extend(assumed());
        write_outputs(&bench, &prepared, options)?;
        return report_once(
            &bench,
            DoseReport::by_profile(&bench, &prepared, None),
            &said,
            None,
            Vec::new(),
            &mut Warned::default(),
        );
    }
    let interrupt = Interrupt::watch()?;
    let mut session = bench.session()?;
    let mut before = before_dose(&bench, &mut session, options, &interrupt)?;
    let prepared = session.prepare_profile(request, &profile);
    let mut prepared =
        noted(&mut session, prepared).map_err(|error| Failure::from(error).of_session(&session))?;
    write_outputs(&bench, &prepared, options).map_err(|failure| failure.of_session(&session))?;
    prepared.whole.warnings.extend(before.notices().into_iter().chain(assumed()));
    let (delivered, was_told) = deliver(&mut session, &prepared, &interrupt, json)?;
    if failed_untold(&delivered, was_told) {
        warn(&prepared.whole.warnings);
    }
    let delivered = noted(&mut session, delivered).map_err(Failure::from);
    before.told(delivered.as_ref().err());
    let delivered = delivered?;
    if !bench.is_simulated() {
        warn(&delivered.warnings);
    }
    let report = DoseReport::by_profile(&bench, &prepared, Some(&delivered));
    let range_ml = report.delivered_range_ml();
    let printed = report_once(&bench, report, &said, None, Vec::new(), &mut Warned::default());
    match printed {
        Err(failure) => Err(failure.after_motion().delivered(range_ml)),
        Ok(()) if delivered.completed => Ok(()),
        Ok(()) => {
            let stopped = Failure::stopped(interrupt.signal().unwrap_or(0), delivered.made > 0, STOPPED);
            Err(stopped.delivered(range_ml))
        }
    }
}

/// Makes the flow, with its progress. Returns beside its end whether the warnings were told.
fn deliver(
    session: &mut Session<'_>,
    prepared: &PreparedProfile,
    interrupt: &Interrupt,
    json: bool,
) -> Result<(Result<Delivered, DoseError>, bool), Failure> {
    let bench = session.bench();
    let motion = prepared.motion();
    let (steps, whole_s) = (motion.steps().unsigned_abs(), motion.duration_s());
    announcing(session, json, &prepared.whole.warnings, |session| {
        supervised::begun(|| DoseReport::by_profile(bench, prepared, None));
        let pump = &bench.file().pump.id;
        let bar = LazyCell::new(|| MotionBar::new(pump, steps, prepared.planned_ml(), Some(whole_s), json));
        let delivered = session.run_profile(prepared, |made| {
            bar.made(made, || Reached {
                delivered_ml: prepared.delivered_ml(made),
                angle_rad: motion.angle_after(made),
            });
            interrupt.flow()
        });
        bar.end();
        delivered
    })
}

/// Writes the files that were asked for, all of them, before anything moves.
fn write_outputs(bench: &Bench, prepared: &PreparedProfile, options: &DosingOptions) -> Result<(), Failure> {
    let (flow, model) = (prepared.motion(), &prepared.whole.model);
    let (motion_s, end_s) = (flow.duration_s(), flow.duration_s() + prepared.whole.prediction.settle_s);
    let samples = |dt_s| {
        Waveform::new(model, flow.legs(), Method::Exact, times(dt_s, motion_s, end_s)).map_err(Failure::of)
    };
    let mut outputs = Outputs::default();
    if let Some(path) = &options.steps.steps {
        refuse_rows(flow.steps().unsigned_abs() as f64, "list of steps", "use a shorter profile")?;
        outputs.write(path, |to| write_flow_steps(to, &flow))?;
    }
    if let Some(path) = &options.trace.trace {
        let dt_s = options.trace.dt.unwrap_or(DEFAULT_DT_S);
        refuse_rows(end_s / dt_s, "trace", "use a longer --dt")?;
        outputs.trace(path, samples(dt_s)?)?;
    }
    if let Some(path) = &options.plot.plot {
        let title = format!("{} on {} (predicted)", prepared.name(), bench.file().pump.id);
        let marks = Marks { motion_s: Some(motion_s), ..Marks::default() };
        outputs.plot(path, &title, samples(f64::max(end_s / PLOT_SAMPLES, DEFAULT_DT_S))?, &marks)?;
    }
    outputs.put()
}
