//! A program that supervises this command, as `dose serve` does: with `DOSE_SUPERVISED=1` in its environment the
//! command tells its progress as lines of JSON (`progress/1`) on standard output, between its reports. Its standard
//! input is the line by which it is stopped: a line `stop REASON` stops it as SIGTERM would, and so does the input's
//! end, since then nobody supervises the motion any more. With `DOSE_SUPERVISED=quiet` it hears the stop and tells no
//! lines of its own.

use std::cell::Cell;
use std::env;
use std::io::{self, BufRead};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use pump_bench::DoseReport;
use pump_bench::rack::RackReport;
use pump_model::units::degrees;
use serde::Serialize;
use serde_json::Value;

use crate::interrupt;
use crate::terminal::print_json;

/// Schema of a line.
const SCHEMA: &str = "progress/1";

/// Time from one line of a motion to its next.
const APART: Duration = Duration::from_millis(100);

/// Longest time between two lines while the motor makes no further step: the supervising program hears that this one
/// lives.
const ALIVE: Duration = Duration::from_secs(1);

/// Whether a supervising program is told lines; empty while none supervises this one.
static TELLS: OnceLock<bool> = OnceLock::new();

/// True once the person who stops the command sees its end.
static SEEN: AtomicBool = AtomicBool::new(false);

/// True if the person who stopped the command sees its end.
pub(crate) fn is_seen() -> bool {
    SEEN.load(Ordering::Relaxed)
}

/// Begins to listen to the supervising program, if there is one.
pub(crate) fn begin() {
    let tells = match env::var("DOSE_SUPERVISED").as_deref() {
        Ok("1") => true,
        Ok("quiet") => false,
        _ => return,
    };
    if TELLS.set(tells).is_err() {
        return;
    }
    thread::spawn(|| {
        for line in io::stdin().lock().lines() {
            let Ok(line) = line else { break };
            if line == "seen" {
                SEEN.store(true, Ordering::Relaxed);
            } else if let Some(reason) = line.strip_prefix("stop") {
                interrupt::stop_for(reason.trim());
            }
        }
        interrupt::stop_for("the end of the service");
    });
}

/// True if a supervising program is told lines.
pub(crate) fn tells() -> bool {
    TELLS.get() == Some(&true)
}

/// Place that a motion has reached.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Reached {
    /// Volume that was delivered, in mL.
    pub(crate) delivered_ml: f64,
    /// Angle of the rollers, in rad.
    pub(crate) angle_rad: f64,
}

/// One line to the supervising program.
#[derive(Debug, Serialize)]
struct Line<'a> {
    schema: &'static str,
    pump: &'a str,
    #[serde(flatten)]
    told: Told<'a>,
}

#[derive(Debug, Serialize)]
#[serde(tag = "state", rename_all = "kebab-case")]
enum Told<'a> {
    /// A motion begins, or a rack, whose `pump` is empty. `plan` is its report before it.
    Begun { plan: Plan<'a> },
    /// A motion goes on.
    Moving { steps: u64, of_steps: u64, delivered_ml: f64, of_ml: Option<f64>, angle_deg: f64 },
    /// A batch waits for its next dose.
    Waiting { next_s: f64, number: u64, count: u64 },
    /// The motion is over, and the command runs the one that tells a person of its failure.
    Ending,
    /// The command has failed, and has told that in words. `error` is its `error/1`.
    Failed { error: Value },
}

#[derive(Debug, Serialize)]
#[serde(untagged)]
enum Plan<'a> {
    Dose(&'a DoseReport),
    Rack(&'a RackReport),
}

/// The lines of one motion.
#[derive(Debug)]
pub(crate) struct Lines {
    pump: String,
    of_steps: u64,
    /// Volume of the whole motion, in mL; `None` for a run until it is stopped.
    of_ml: Option<f64>,
    /// Time and steps of the last line.
    told: Cell<Option<(Instant, u64)>>,
}

impl Lines {
    /// The lines of a motion of `of_steps` and `of_ml`; none without a supervising program.
    pub(crate) fn of(pump: &str, of_steps: u64, of_ml: f64) -> Option<Self> {
        let of_ml = Some(of_ml).filter(|of_ml| of_ml.is_finite());
        tells().then(|| Self { pump: pump.to_owned(), of_steps, of_ml, told: Cell::default() })
    }

    /// Tells the place that the motion has `reached`, if it is a new one, and the last line is old enough or this is
    /// the last step. The same place is told again once a second.
    pub(crate) fn made(&self, steps: u64, reached: impl FnOnce() -> Reached) {
        let is_due = self.told.get().is_none_or(|(told, before)| {
            let (is_new, is_last) = (before != steps, steps == self.of_steps);
            is_new && (told.elapsed() >= APART || is_last) || !is_last && told.elapsed() >= ALIVE
        });
        if !is_due {
            return;
        }
        self.told.set(Some((Instant::now(), steps)));
        let Reached { delivered_ml, angle_rad } = reached();
        let (of_steps, of_ml, angle_deg) = (self.of_steps, self.of_ml, degrees(angle_rad));
        tell(&self.pump, Told::Moving { steps, of_steps, delivered_ml, of_ml, angle_deg });
    }
}

/// Tells that a motion begins by this plan.
pub(crate) fn begun(plan: impl FnOnce() -> DoseReport) {
    if tells() {
        let plan = plan();
        tell(&plan.pump, Told::Begun { plan: Plan::Dose(&plan) });
    }
}

/// Tells that a rack begins by this plan.
pub(crate) fn rack_begun(plan: &RackReport) {
    if tells() {
        tell("", Told::Begun { plan: Plan::Rack(plan) });
    }
}

/// Tells that a batch waits for `left` until dose `number` of `count`.
pub(crate) fn waits(pump: &str, left: Duration, number: u64, count: u64) {
    if tells() {
        tell(pump, Told::Waiting { next_s: left.as_secs_f64(), number, count });
    }
}

/// Tells that the motion is over, and that a person is told of its failure now.
pub(crate) fn ends() {
    if tells() {
        tell("", Told::Ending);
    }
}

/// Tells the `error/1` of a failure that is told to a person in words.
pub(crate) fn failed(error: &str) {
    let error = serde_json::from_str(error).ok().filter(|_| tells());
    error.into_iter().for_each(|error| tell("", Told::Failed { error }));
}

fn tell(pump: &str, told: Told<'_>) {
    let line = serde_json::to_string(&Line { schema: SCHEMA, pump, told });
    // A supervising program that is gone ends standard input too, which stops the motion.
    if let Ok(line) = line {
        let _ = print_json(&(line + "\n"));
    }
}
