//! Doses on the host as the firmware does, with the same crates, and compares: every bit of the plan, every
//! deadline, every time at which the step pin rose.
//!
//! `cargo run -p check-firmware target/firmware.txt`

#![allow(clippy::print_stdout, clippy::print_stderr, reason = "a program says what it found")]

mod documented;
#[path = "src/dose.rs"]
mod dose;
#[path = "src/pump.rs"]
#[allow(unreachable_pub, reason = "written by the command, for a module or a crate")]
mod pump;

use std::process::ExitCode;

use dose::{DOSE_ML, Executor, TICK_HZ, TICK_RATE};
use pump::{LIMITS, PUMP};
use pump_ctl::plan::Plan;
use pump_ctl::step::Action;

/// Largest distance of a rising pin from its deadline, counts: a tick.
const TOLERANCE: i64 = COUNTS_PER_TICK;
const COUNTS_PER_TICK: i64 = 25;

/// Most by which the first step after power-up may come later, counts. The direction pin is set up first,
/// held for 650 ns and ahead of the step for 650 ns.
const DIRECTION_COUNTS: i64 = 34;

/// A change takes effect within 10 ms.
const CHANGE_TICKS: i64 = 10_000;

/// Largest values of the lines of cost.
const MOST: [(&str, f64); 4] = [
    ("for a plan: ", 1e6),
    ("with a smooth flow", 20e6),
    ("to plan with line-aware ramps", 20e6),
    ("a step in on_deadline", 70.0),
];

type Checked = Result<(), String>;

fn main() -> ExitCode {
    let Some(path) = std::env::args().nth(1) else {
        eprintln!("usage: check_firmware FILE, the file with what the firmware wrote");
        return ExitCode::FAILURE;
    };
    let checked = std::fs::read_to_string(&path).map_err(|error| error.to_string());
    match checked.and_then(|text| check(&text)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(problem) => {
            eprintln!("{path}: {problem}");
            ExitCode::FAILURE
        }
    }
}

fn check(text: &str) -> Checked {
    // Costs are checked apart from the steps.
    let (figures, done): (Vec<_>, Vec<_>) =
        text.lines().partition(|line| line.starts_with("cost:") || line.starts_with("memory:"));
    let mut done = done.into_iter();
    let plan = dose::plan_dose(&dose::doser(), DOSE_ML).map_err(|error| error.to_string())?;
    let prediction = plan.predict(&PUMP).map_err(|error| error.to_string())?;
    let mut expected = String::new();
    dose::write_plan(&mut expected, &plan, &prediction).map_err(|error| error.to_string())?;
    let aware = dose::plan_line_aware(&dose::doser(), DOSE_ML).map_err(|error| error.to_string())?;
    dose::write_line_aware(&mut expected, &aware).map_err(|error| error.to_string())?;
    for line in expected.lines() {
        same(done.next(), line)?;
    }
    println!("plan: {} steps, every bit as on the host", plan.steps());
    whole(&mut done, &plan)?;
    stopped(&mut done, &plan)?;
    changed(&mut done, &plan)?;
    same(done.next(), "end")?;
    costs(&figures)
}

fn same(found: Option<&str>, expected: &str) -> Checked {
    match found {
        Some(found) if found == expected => Ok(()),
        Some(found) => Err(format!("the firmware says\n  {found}\nand the host\n  {expected}")),
        None => Err(format!("ends where the host says\n  {expected}")),
    }
}

/// Returns the whole numbers in a line.
fn numbers<const N: usize>(line: Option<&str>) -> Result<[i64; N], String> {
    let line = line.unwrap_or("the end of the file");
    let found = line.split(|c: char| !c.is_ascii_digit() && c != '-').filter_map(|word| word.parse().ok());
    let found: Vec<i64> = found.collect();
    found.try_into().map_err(|_| format!("{N} numbers expected in\n  {line}"))
}

fn queued(plan: &Plan) -> Result<Executor, String> {
    let mut executor = Executor::new(LIMITS.motor.brake(TICK_RATE).map_err(|error| error.to_string())?);
    dose::queue(&mut executor, plan);
    Ok(executor)
}

/// Makes up to `most` steps from `due` on. Adds their times to `made`, and returns the time of the next.
fn go_on(executor: &mut Executor, due: u64, most: i64, made: &mut Vec<u64>) -> u64 {
    let mut due = due;
    for _ in 0..most {
        let Action::Step { next, .. } = executor.on_deadline(due) else { break };
        made.push(due);
        due = next;
    }
    due
}

/// Compares the lines of a move's steps with the times at which they are due.
fn steps<'a>(
    done: &mut impl Iterator<Item = &'a str>,
    name: &str,
    dues: &[u64],
    first: i64,
    position: i64,
) -> Checked {
    let (mut earliest, mut latest) = (i64::MAX, i64::MIN);
    for (n, due) in dues.iter().enumerate() {
        let line = done.next();
        let [due_there, rose] = numbers(line)?;
        if due_there != *due as i64 {
            return Err(format!("{name}, step {}: due at {due_there} us there, {due} us here", n + 1));
        }
        let late = rose - COUNTS_PER_TICK * due_there;
        let allowed = TOLERANCE + if n == 0 { first } else { 0 };
        if late < -TOLERANCE || late > allowed {
            return Err(format!(
                "{name}, step {}: the pin rose {late} counts of 40 ns after its deadline",
                n + 1
            ));
        }
        (earliest, latest) = (late.min(earliest), late.max(latest));
    }
    same(done.next(), &format!("position: {position}"))?;
    println!(
        "{name}: {} steps, each deadline as on the host, each pin {} to {} ns after it",
        dues.len(),
        40 * earliest,
        40 * latest
    );
    Ok(())
}

fn whole<'a>(done: &mut impl Iterator<Item = &'a str>, plan: &Plan) -> Checked {
    let mut executor = queued(plan)?;
    let mut made = Vec::new();
    let due = executor.start(0).map_err(|error| error.to_string())?;
    go_on(&mut executor, due, i64::MAX, &mut made);
    for (due, step) in made.iter().zip(plan.each_step()) {
        let planned = step.time_s * f64::from(TICK_HZ);
        if (*due as f64 - planned).abs() > 1.0 {
            return Err(format!("step {} is due at {due} us and planned at {planned} us", step.number));
        }
    }
    same(done.next(), "run: whole")?;
    steps(done, "whole", &made, DIRECTION_COUNTS, plan.steps())
}

fn stopped<'a>(done: &mut impl Iterator<Item = &'a str>, plan: &Plan) -> Checked {
    same(done.next(), "run: stopped")?;
    let [count, asked, promised, last] = numbers(done.next())?;
    let mut executor = queued(plan)?;
    let mut made = Vec::new();
    let due = executor.start(0).map_err(|error| error.to_string())?;
    let due = go_on(&mut executor, due, count, &mut made);
    let cruise = due - made.last().copied().unwrap_or(0);
    let promise = executor.stop(asked as u64);
    if (promise.final_count, promise.last_step_at as i64) != (promised, last) {
        return Err(format!(
            "stopped: the firmware was promised step {promised} at {last}, the host {promise:?}"
        ));
    }
    go_on(&mut executor, due, i64::MAX, &mut made);
    // One step was due already; the next comes later than it would have.
    if made.get(count as usize + 1).is_some_and(|next| next - due <= cruise) {
        return Err("stopped: the stop does not act within a step".into());
    }
    steps(done, "stopped", &made, 0, promised)
}

fn changed<'a>(done: &mut impl Iterator<Item = &'a str>, plan: &Plan) -> Checked {
    same(done.next(), "run: changed")?;
    let [asked, position, at] = numbers(done.next())?;
    let mut executor = queued(plan)?;
    let mut made = Vec::new();
    let due = executor.start(0).map_err(|error| error.to_string())?;
    let junction =
        executor.retarget(asked as u64 + u64::from(dose::CHANGE_TICKS)).ok_or("changed: no step to come")?;
    if (junction.position, junction.at as i64) != (position, at) {
        return Err(format!(
            "changed: the firmware goes over at step {position}, {at} us, the host at {junction:?}"
        ));
    }
    if at - asked > CHANGE_TICKS {
        return Err(format!("changed: asked for at {asked} us, done at {at} us"));
    }
    let rest = dose::change(&dose::doser(), plan, position as u64).map_err(|error| error.to_string())?;
    dose::queue(&mut executor, &rest);
    go_on(&mut executor, due, i64::MAX, &mut made);
    println!("changed: {} us after it was asked for, planning included", at - asked);
    steps(done, "changed", &made, 0, position + rest.steps())
}

/// Prints the costs, and holds them to their limits.
fn costs(figures: &[&str]) -> Checked {
    for line in figures {
        println!("{line}");
    }
    for (what, most) in MOST {
        let line = figures
            .iter()
            .find(|line| line.contains(what))
            .ok_or(format!("no line says what {what} costs"))?;
        let cost = line.split(' ').find_map(|word| word.parse::<f64>().ok());
        if cost.is_none_or(|cost| cost > most) {
            return Err(format!("more than {most} instructions:\n  {line}"));
        }
    }
    documented::check(figures)
}
