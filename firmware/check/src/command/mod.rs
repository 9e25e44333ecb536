//! The command `dose` itself, as a process with the emulated board at its port, in real time. The edges of the step pin
//! are held against its report, its record, and the steps that it planned.

mod bridge;
#[path = "../../../../examples/simulated_node/simulated_node/carrier.rs"]
mod carrier;
mod desk;
#[path = "../../../../examples/simulated_node/simulated_node/line.rs"]
mod line;
mod silence;

use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::Child;
use std::time::Duration;

use rustix::process::Signal;
use serde_json::Value;

use crate::board::motor::rises;
use crate::check;
use crate::doses::MOST_OFF_US;
use bridge::Bridge;
use desk::{Desk, signal};

/// Angle of the rotor before the first dose, and steps per revolution of the built-in pump's motor.
const START_DEG: f64 = 30.0;
const STEPS_PER_REV: f64 = 12_800.0;

/// Largest difference of the angle on record from that of the edges. Both are computed in floating point.
const MOST_OFF_DEG: f64 = 1e-6;

/// Steps of a dose after which it is cut off. Its plan has some 2,700.
const CUT_AFTER: i64 = 600;

/// Exit codes of a dose that ended in a fault, and of one that the user stopped.
const FAULT: i32 = 1;
const STOPPED: i32 = 130;

/// Scene of a computer and its board.
type Scene = fn(&mut Desk) -> Result<(), Box<dyn Error>>;

/// Scenes by the options of the emulator: over the UART, and over the USB port.
const SCENES: [(&str, &[&str], &[Scene]); 2] = [
    ("UART", &[], &[whole, stopped, killed, reset]),
    ("USB", &["--usb"], &[stopped, reset_over_usb, pulled]),
];

/// Time of the board without its cable, in which it stops by itself.
const PULLED: Duration = Duration::from_secs(2);

/// Makes a whole dose over the UART, stops one, kills the command in another, and resets the board in the last. Over
/// USB it stops a dose, resets the board, and pulls the cable. `command` is the command's program; without it it is
/// `dose` beside this program.
pub(crate) fn command(firmware: &Path, command: Option<&str>) -> Result<(), Box<dyn Error>> {
    let command = match command {
        Some(command) => PathBuf::from(command),
        None => std::env::current_exe()?.with_file_name("dose"),
    };
    if !command.is_file() {
        let missing = format!("{} is not there; `cargo build --bin dose` builds it", command.display());
        return Err(missing.into());
    }
    for (line, options, scenes) in SCENES {
        for scene in scenes {
            println!("over {line}:");
            let mut desk = Desk::new(firmware, &command, options)?;
            let home = ["home", "--set", "30deg", "--tolerance", "0deg", "--confirm-pump"];
            desk.run_well(&home)?;
            check(desk.motor.count == 0, "that nothing moves before a dose")?;
            scene(&mut desk)?;
        }
    }
    Ok(())
}

/// Holds the silences of the command while the motor turned.
fn hold_silence(bridge: &Bridge) -> Result<(), Box<dyn Error>> {
    let (took_s, stood_s) = bridge.times_s();
    let silence = bridge.longest_silence();
    println!(
        "  {took_s:.1} s by the computer's clock, in {stood_s:.1} s of which the board's time stood still; while the \
         motor turned the command was silent for {:.0} ms of its own time at most",
        1e3 * silence.as_secs_f64()
    );
    check(!silence.is_zero() && silence <= silence::LONGEST, "the silences of the command")
}

/// Words of a dose.
fn dose<'w>(volume: &'w str, more: &[&'w str]) -> Vec<&'w str> {
    [&[volume, "--rate", "1mL/s", "--smooth", "--format", "json"], more].concat()
}

/// Makes a dose, and holds each rise against the time of its step in `--steps`.
fn whole(desk: &mut Desk) -> Result<(), Box<dyn Error>> {
    let planned = desk.file("steps.csv");
    let planned = planned.to_str().ok_or("the folder's name is no text")?;
    desk.take_edges();
    let report = desk.run_well(&dose("2mL", &["--steps", planned]))?;
    let rises_us: Vec<f64> = rises(&desk.take_edges(), 0).iter().map(|ns| 1e-3 * ns).collect();
    let table = std::fs::read_to_string(planned)?;
    let due_us: Vec<f64> = table
        .lines()
        .skip(1)
        .filter_map(|row| Some(1e6 * row.split(',').nth(1)?.parse::<f64>().ok()?))
        .collect();
    let off_us: Vec<f64> = rises_us.iter().zip(&due_us).map(|(rise, due)| rise - due).collect();
    let (least, most) = off_us.iter().fold((f64::MAX, f64::MIN), |(a, b), off| (a.min(*off), b.max(*off)));
    let half_us = 0.5 * (most - least);
    println!(
        "`dose 2mL --smooth`: {} steps of the report, {} rises, within {half_us:.3} us of `--steps`",
        number(&report, "steps_made")?,
        rises_us.len()
    );
    check(due_us.len() == rises_us.len() && half_us <= MOST_OFF_US, "the times of the command's steps")?;
    hold_made(desk, &report, 0)?;
    hold_rest(desk)?;
    hold_silence(&desk.bridge)
}

/// Stops a dose by Ctrl-C, and resumes it.
fn stopped(desk: &mut Desk) -> Result<(), Box<dyn Error>> {
    let mut process = desk.start(&dose("5mL", &[]))?;
    desk.until_steps(&mut process, CUT_AFTER)?;
    signal(&process, Signal::INT)?;
    let ended = desk.end(process)?;
    let made = desk.motor.count;
    println!(
        "Ctrl-C: exit code {:?} after {} of {} steps; the pin rose {made} times",
        ended.code,
        number(&ended.report, "steps_made")?,
        number(&ended.report, "steps")?
    );
    check(ended.code == Some(STOPPED), "the exit code of a stop")?;
    check(made < number(&ended.report, "steps")?, "that a stop is in mid-dose")?;
    hold_made(desk, &ended.report, 0)?;
    desk.until_it_stands()?;
    check(desk.motor.count == made, "that nothing moves after a stop")?;
    check(bounds(&desk.run_well(&STATUS)?)? == [made, made], "that the steps of a stop are known exactly")?;
    resume(desk, number(&ended.report, "steps")?)?;
    hold_silence(&desk.bridge)
}

/// Kills the command in mid-dose, and resumes the dose with the board as it is.
fn killed(desk: &mut Desk) -> Result<(), Box<dyn Error>> {
    let mut process = desk.start(&dose("5mL", &[]))?;
    desk.until_steps(&mut process, CUT_AFTER)?;
    desk.bridge.set_host(None);
    signal(&process, Signal::KILL)?;
    let ended = desk.end(process)?;
    desk.until_it_stands()?;
    let made = desk.motor.count;
    let status = desk.run_well(&STATUS)?;
    let [least, most] = bounds(&status)?;
    println!("SIGKILL: {least} to {most} steps are on record, the pin rose {made} times");
    check(ended.code.is_none() && (least..=most).contains(&made), "the bounds after a kill")?;
    resume(desk, number(&status["unfinished"], "steps")?)?;
    hold_silence(&desk.bridge)
}

/// Resets the board in mid-dose.
fn reset(desk: &mut Desk) -> Result<(), Box<dyn Error>> {
    let mut process = desk.start(&dose("5mL", &[]))?;
    desk.until_steps(&mut process, CUT_AFTER)?;
    desk.emulator.reset()?;
    hold_reset(desk, process)?;
    hold_silence(&desk.bridge)
}

/// Resets the board in mid-dose. Its USB device vanishes and comes again.
fn reset_over_usb(desk: &mut Desk) -> Result<(), Box<dyn Error>> {
    let mut process = desk.start(&dose("5mL", &[]))?;
    desk.until_steps(&mut process, CUT_AFTER)?;
    desk.bridge.pull();
    desk.emulator.reset()?;
    hold_silence(&desk.bridge)?;
    desk.plug_in()?;
    hold_reset(desk, process)
}

/// Pulls the USB cable of a board with a supply of its own in mid-dose, plugs it in again, and resumes the dose.
fn pulled(desk: &mut Desk) -> Result<(), Box<dyn Error>> {
    let mut process = desk.start(&dose("5mL", &[]))?;
    desk.until_steps(&mut process, CUT_AFTER)?;
    desk.pull(PULLED);
    hold_silence(&desk.bridge)?;
    let made = desk.motor.count;
    desk.emulator.plug_usb()?;
    desk.plug_in()?;
    let ended = desk.end(process)?;
    desk.until_it_stands()?;
    check(desk.motor.count == made, "that the motor stands without its cable and after it")?;
    let status = desk.run_well(&STATUS)?;
    let [least, most] = bounds(&status)?;
    println!(
        "a pulled cable: exit code {:?}, {least} to {most} steps are on record, the pin rose {made} times",
        ended.code
    );
    check(ended.code == Some(FAULT), "the exit code of a pulled cable")?;
    check((least..=most).contains(&made), "the bounds after a pulled cable")?;
    resume(desk, number(&status["unfinished"], "steps")?)?;
    hold_silence(&desk.bridge)
}

/// Holds the end of a command whose board was reset in mid-dose.
fn hold_reset(desk: &mut Desk, process: Child) -> Result<(), Box<dyn Error>> {
    let ended = desk.end(process)?;
    desk.until_it_stands()?;
    let made = desk.motor.count;
    let [least, most] = bounds(&desk.run_well(&STATUS)?)?;
    println!(
        "a reset of the board: exit code {:?}, {least} to {most} steps are on record, the pin rose {made} times",
        ended.code
    );
    check(ended.code == Some(FAULT), "the exit code of a reset")?;
    check((least..=most).contains(&made), "the bounds after a reset")
}

/// Makes the rest of a dose of so many steps. None is lost, and none is made twice.
fn resume(desk: &mut Desk, steps: i64) -> Result<(), Box<dyn Error>> {
    let before = desk.motor.count;
    let report = desk.run_well(&["resume", "--format", "json"])?;
    println!(
        "  `dose resume` makes {} more, {} of {steps} in all",
        desk.motor.count - before,
        desk.motor.count
    );
    check(desk.motor.count == steps, "that no step is lost or made twice")?;
    hold_made(desk, &report, before)?;
    hold_rest(desk)
}

/// Words of the question for the record.
const STATUS: [&str; 3] = ["status", "--format", "json"];

/// Holds the steps and the angle of a report against the motor, which had made so many steps before.
fn hold_made(desk: &Desk, report: &Value, before: i64) -> Result<(), Box<dyn Error>> {
    check(number(report, "steps_made")? == desk.motor.count - before, "the steps of a report")?;
    hold_angle(desk, report, "end_angle_deg")
}

/// Holds the record of a pump without an unfinished dose against the motor.
fn hold_rest(desk: &mut Desk) -> Result<(), Box<dyn Error>> {
    let status = desk.run_well(&STATUS)?;
    check(status["unfinished"].is_null(), "that no dose is unfinished")?;
    check(number(&status, "device_count")? == desk.motor.count, "the board's count on record")?;
    hold_angle(desk, &status, "angle_deg")
}

/// Holds an angle against that of the motor.
fn hold_angle(desk: &Desk, said: &Value, field: &str) -> Result<(), Box<dyn Error>> {
    let angle_deg = said[field].as_f64().ok_or(format!("no {field} in {said}"))?;
    let expected_deg = START_DEG + 360.0 / STEPS_PER_REV * desk.motor.count as f64;
    let off_deg = (angle_deg - expected_deg + 180.0).rem_euclid(360.0) - 180.0;
    check(off_deg.abs() < MOST_OFF_DEG, "the angle of the rotor")
}

/// Returns the least and the most steps of the unfinished dose on record.
fn bounds(status: &Value) -> Result<[i64; 2], Box<dyn Error>> {
    let dose = &status["unfinished"];
    Ok([number(dose, "steps_made_least")?, number(dose, "steps_made_most")?])
}

fn number(said: &Value, field: &str) -> Result<i64, Box<dyn Error>> {
    Ok(said[field].as_i64().ok_or(format!("no {field} in {said}"))?)
}
