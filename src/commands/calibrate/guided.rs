//! Guided runs: a run to try, then several at each of several speeds, each of them weighed.

use pump_bench::calibration::{Run, Weighing, now_utc};
use pump_bench::record::Purpose;
use pump_bench::{Bench, DoseRequest, Prepared, Session};
use pump_ctl::plan::Cruise;
use pump_model::math::{ceil, degrees, pow, rad_s, rpm};

use super::RunArgs;
use super::answers::{Answer, Answers, say};
use super::summary::short;
use crate::commands::dose::{deliver, watch};
use crate::failure::Failure;
use crate::interrupt::Interrupt;
use crate::options::Options;

/// Volume of a run, mL: on a scale that shows 0.01 g a reading is then good to 2e-4.
const LEAST_ML: f64 = 50.0;

/// Runs at each speed.
const RUNS: u32 = 3;

/// Slowest of the default speeds, over that of the default rate: doses a little slower than usual are covered too.
const SLOWEST: f64 = 0.5;

/// Runs under guidance.
struct Guide<'a, 'b> {
    bench: &'a Bench,
    session: Session<'b>,
    answers: Answers,
    interrupt: Interrupt,
    pitches: u32,
    temperature_degc: Option<f64>,
    options: &'a Options,
}

/// Makes the runs and asks for what arrived. None if the person left.
pub(super) fn runs(bench: &Bench, args: &RunArgs, options: &Options) -> Result<Option<Vec<Run>>, Failure> {
    let mut session = bench.session()?;
    session.connect()?;
    let speeds_rad_s = if args.speeds.is_empty() { default_speeds_rad_s(bench) } else { args.speeds.clone() };
    let each = args.runs.unwrap_or(RUNS);
    let pitch_ml = bench.model().outlet_curve().pitch_ml();
    let pitches = args.pitches.unwrap_or(ceil(LEAST_ML / pitch_ml) as u32);
    let (answers, interrupt) = (Answers::new(), watch()?);
    let mut guide =
        Guide { bench, session, answers, interrupt, pitches, temperature_degc: options.temperature, options };
    // Every speed is planned before anything moves.
    for speed_rad_s in &speeds_rad_s {
        guide.prepare(*speed_rad_s)?;
    }
    let all = each as usize * speeds_rad_s.len();
    let volume_ml = f64::from(pitches) * pitch_ml;
    say(&format!(
        "{all} runs of {pitches} pitches, {volume_ml:.1} mL by the model, after one to try; fill the line, and empty or tare \
         the vessel before each\n"
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
    while let Some(last) = runs.last().cloned() {
        say("enter keeps the calibration; redo repeats the last run; quit keeps nothing: ");
        match guide.answers.line(&mut guide.session, &guide.interrupt)?.trim() {
            "" | "yes" | "keep" => break,
            "quit" => return Ok(None),
            "redo" => {
                let title = format!("run {all} of {all}, again");
                match guide.weighed(rad_s(last.speed_rpm), all, &title)? {
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

/// Three speeds, each as many times the one before: from half the default rate's to the motor's fastest.
fn default_speeds_rad_s(bench: &Bench) -> Vec<f64> {
    let fastest_rad_s = bench.file().limits().motor.max_speed_rad_s;
    let usual_rad_s = pump_ctl::plan::speed_for_flow(bench.model(), bench.file().pump.default_rate_ml_s);
    let slowest_rad_s = SLOWEST * usual_rad_s;
    let step = pow(fastest_rad_s / slowest_rad_s, 0.5);
    vec![slowest_rad_s, slowest_rad_s * step, fastest_rad_s]
}

impl Guide<'_, '_> {
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
                deliver(self.bench, &mut self.session, &prepared, &self.interrupt, self.options)?;
            if !delivered.completed {
                let message = "stopped by the user in a run; nothing is kept of the readings".to_owned();
                return Err(Failure::Stopped(signal.unwrap_or(0), message));
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
