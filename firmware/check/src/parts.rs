//! The parts of the check. Each is a process of its own, with boards of its own.

use std::collections::VecDeque;
use std::error::Error;
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

use crate::{axes, command, cuts, doses, retarget, sensors, slow, stops, together, uf2, usb};

/// Names of the parts, those that take longest first.
const PARTS: [&str; 11] =
    ["slow", "cuts", "command", "doses", "even", "stops", "usb", "sensors", "axes", "smooth", "retarget"];

/// Number of stops, and of cuts of the link and kills of the host.
const STOPS: u32 = 30;
const CUTS: u32 = 200;

/// Minutes of the slow dose.
const SLOW_MIN: f64 = 5.0;

/// Makes a part. Some take a number: of stops, of cuts, of minutes. `uf2` and `command` take a
/// file.
pub(crate) fn make(firmware: &Path, part: &str, number: Option<&str>) -> Result<(), Box<dyn Error>> {
    let count = |usual| number.map_or(Ok(usual), str::parse);
    match part {
        "one" => doses::one(firmware),
        "doses" => doses::doses(firmware),
        "command" => command::command(firmware, number),
        "usb" => usb::dose(firmware),
        "even" => together::evens(firmware),
        "axes" => axes::axes(firmware),
        "sensors" => sensors::sensors(firmware),
        "retarget" => retarget::retarget(firmware),
        "smooth" => together::smooth(firmware),
        "stops" => stops::stops(firmware, count(STOPS)?),
        "cuts" => cuts::cuts(firmware, count(CUTS)?),
        "slow" => slow::slow(firmware, number.map_or(Ok(SLOW_MIN), str::parse)?),
        "uf2" => uf2::hold(firmware, number),
        other => Err(format!("'{other}' is no part; allowed are one, uf2, {}", PARTS.join(", ")).into()),
    }
}

/// Makes all parts, as many at a time as the computer has cores. A board and its host take turns, so they take one.
pub(crate) fn make_all(firmware: &Path) -> Result<(), Box<dyn Error>> {
    let program = std::env::current_exe()?;
    let (parts, failed) = (Mutex::new(VecDeque::from(PARTS)), Mutex::new(Vec::new()));
    let next = || parts.lock().unwrap_or_else(PoisonError::into_inner).pop_front();
    let work = || {
        while let Some(part) = next() {
            let began = Instant::now();
            let made = Command::new(&program).arg(firmware).arg(part).stderr(Stdio::inherit()).output();
            let (told, is_well) = match made {
                Ok(made) => (String::from_utf8_lossy(&made.stdout).into_owned(), made.status.success()),
                Err(error) => (format!("{error}\n"), false),
            };
            let how = if is_well { "passed" } else { "FAILED" };
            println!(
                "{part}: {how} in {:.0} s of this computer's time\n{told}",
                began.elapsed().as_secs_f64()
            );
            if !is_well {
                failed.lock().unwrap_or_else(PoisonError::into_inner).push(part);
            }
        }
    };
    let cores = std::thread::available_parallelism()?.get();
    std::thread::scope(|scope| {
        for _ in 0..cores.min(PARTS.len()) {
            scope.spawn(work);
        }
    });
    let failed = failed.into_inner().unwrap_or_else(PoisonError::into_inner);
    if failed.is_empty() { Ok(()) } else { Err(format!("these parts failed: {}", failed.join(", ")).into()) }
}
