//! Guided runs: a run to try, then several at each of several speeds, each of them weighed.

use pump_bench::calibration::{Run, Weighing, now_utc};
use pump_bench::record::Purpose;
use pump_bench::{Bench, DoseRequest, Prepared, Session};
use pump_ctl::plan::Cruise;
use pump_model::math::{ceil, degrees, pow, rad_s, rpm};

use super::answers::{Answer, Answers};
use crate::commands::delivery::deliver;
use crate::failure::Failure;
use crate::interrupt::Interrupt;
use crate::terminal::say;

/// Volume of a run, mL: on a scale that shows 0.01 g a reading is then good to 2e-4.
const LEAST_ML: f64 = 50.0;

/// Runs at each speed.
const RUNS: u32 = 3;

/// Slowest of the default speeds, over that of the default rate: doses a little slower than usual are covered too.
const SLOWEST: f64 = 0.5;

/// The course of the runs, as far as it is given.
pub(super) struct Course {
    /// Speeds of the runs, rad/s; empty for the usual ones.
    pub(super) speeds_rad_s: Vec<f64>,
    /// Runs at each speed.
    pub(super) each: Option<u32>,
    /// Whole pitches of each run.
    pub(super) pitches: Option<u32>,
    /// Temperature of the fluid, °C.
    pub(super) temperature_degc: Option<f64>,
    /// True if a program reads the result.
    pub(super) json: bool,
}

/// Runs under guidance.
struct Guide<'a, 'b> {
    bench: &'a Bench,
    session: Session<'b>,
    answers: Answers,
    interrupt: Interrupt,
    pitches: u32,
    temperature_degc: Option<f64>,
    json: bool,
}

/// Makes the runs and asks for what arrived. None if the person left.
pub(super) fn runs(bench: &Bench, course: Course) -> Result<Option<Vec<Run>>, Failure> {
    let mut session = bench.session()?;
    session.connect()?;
    let Course { mut speeds_rad_s, each, pitches, temperature_degc, json } = course;
    if speeds_rad_s.is_empty() {
        speeds_rad_s = default_speeds_rad_s(bench);
    }
    let pitch_ml = bench.model().outlet_curve().pitch_ml();
    let pitches = pitches.unwrap_or(ceil(LEAST_ML / pitch_ml) as u32);
    let (answers, interrupt) = (Answers::new(), Interrupt::watch()?);
    let mut guide = Guide { bench, session, answers, interrupt, pitches, temperature_degc, json };
    // Every speed is planned before anything moves.
    for speed_rad_s in &speeds_rad_s {
        guide.prepare(*speed_rad_s)?;
    }
    let each = each.unwrap_or(RUNS);
    let all = each as usize * speeds_rad_s.len();
    let volume_ml = f64::from(pitches) * pitch_ml;
    say(&format!(
        "{all} runs of {pitches} pitches, {volume_ml:.1} mL by the model, after one to try; fill the line, and empty \
         or tare the vessel before each\n"
    ));
    let middle = speeds_rad_s.get(speeds_rad_s.len() / 2).copied().unwrap_or_default();
    if guide.weighed(middle, 1, "trial run")?.is_none() {
        return Ok(None);
    }
    let mut runs = Vec::new();
    for speed_rad_s in &speeds_rad_s {
        for _ in 0..each {
            let title = format!("run {} of {all}, {} r/min", runs.len() + 1, short(rpm(*speed_rad_s)));
            match guide.weighed(*speed_rad_s, runs.len() + 1, &title)? {
                Some(run) => runs.push(run),
                None => return Ok(None),
            }
        }
    }
    guide.last_may_be_repeated(runs)
}

/// Three speeds, each as many times the one before: from half the default rate's to the motor's fastest.
fn default_speeds_rad_s(bench: &Bench) -> Vec<f64> {
    let fastest_rad_s = bench.file().limits().motor.max_speed_rad_s;
    let usual_rad_s = pump_ctl::plan::speed_for_flow(bench.model(), bench.file().pump.default_rate_ml_s);
    let slowest_rad_s = SLOWEST * usual_rad_s;
    let step = pow(fastest_rad_s / slowest_rad_s, 0.5);
    vec![slowest_rad_s, slowest_rad_s * step, fastest_rad_s]
}

/// A number with four decimals at most.
fn short(value: f64) -> String {
    format!("{value:.4}").trim_end_matches('0').trim_end_matches('.').to_owned()
}

impl Guide<'_, '_> {
    /// Asks whether the runs are kept, and repeats the last one as often as it is wanted. None if the person left.
    fn last_may_be_repeated(&mut self, mut runs: Vec<Run>) -> Result<Option<Vec<Run>>, Failure> {
        let all = runs.len();
        while let Some(last) = runs.last() {
            say("enter keeps the calibration; redo repeats the last run; quit keeps nothing: ");
            match self.answers.line(&mut self.session, &self.interrupt)?.trim() {
                "" | "yes" | "keep" => break,
                "quit" => return Ok(None),
                "redo" => {
                    let title = format!("run {all} of {all}, again");
                    match self.weighed(rad_s(last.speed_rpm), all, &title)? {
                        Some(run) => {
                            runs.pop();
                            runs.push(run);
                        }
                        None => return Ok(None),
                    }
                }
                other => say(&format!("`{other}` is none of these\n")),
            }
        }
        Ok(Some(runs))
    }

    fn prepare(&mut self, speed_rad_s: f64) -> Result<Prepared, Failure> {
        let volume_ml = f64::from(self.pitches) * self.bench.model().outlet_curve().pitch_ml();
        Ok(self.session.prepare(DoseRequest {
            purpose: Purpose::Calibrate,
            cruise: Some(Cruise::Speed { rad_s: speed_rad_s }),
            ..DoseRequest::dose(volume_ml)
        })?)
    }

    /// Makes a run until there is a reading of it that can be right. None if the person left.
    fn weighed(&mut self, speed_rad_s: f64, number: usize, title: &str) -> Result<Option<Run>, Failure> {
        loop {
            say(&format!("{title}: moving\n"));
            let prepared = self.prepare(speed_rad_s)?;
            let (delivered, signal) =
                deliver(self.bench, &mut self.session, &prepared, &self.interrupt, self.json)?;
            if !delivered.completed {
                let message = "stopped by the user in a run; nothing is kept of the readings";
                return Err(Failure::stopped(signal.unwrap_or(0), message));
            }
            let plan = &prepared.plan;
            let known = plan.start.is_known(self.bench.model().pitch_rad());
            loop {
                let answer = self.answers.reading(title, &mut self.session, &self.interrupt)?;
                let reading = match answer {
                    Answer::Read(reading) => reading,
                    Answer::Redo => break,
                    Answer::Quit => return Ok(None),
                };
                let run = Run {
                    speed_rpm: rpm(speed_rad_s),
                    start_angle_deg: known.then_some(degrees(plan.start.angle_rad)),
                    turned_deg: degrees(plan.steps as f64 * plan.step_rad),
                    reading,
                    temperature_degc: self.temperature_degc,
                    time: Some(now_utc()),
                };
                // The reading is refused, not the run.
                match run.volumes_ml(self.bench.model(), &Weighing::of(self.bench.file()), number) {
                    Ok(_) => return Ok(Some(run)),
                    Err(error) => say(&format!("{error}\n")),
                }
            }
        }
    }
}
