//! A slow dose in fast time: the emulator skips the time in which the processor sleeps.

use std::error::Error;
use std::path::Path;
use std::time::Instant;

use pump_bench::drives::{Drive, Leave};
use pump_bench::pump_file::Axis;

use crate::board::motor::rises;
use crate::check;
use crate::doses::{distances_us, meet};

/// Flow of the slow dose, mL/s.
const FLOW_ML_S: f64 = 0.005;

/// Number of halvings in which the volume of a dose of so many minutes is found.
const HALVINGS: u32 = 12;

/// Largest distance of a rise from its time, us.
const MOST_OFF_US: f64 = 1.0;

/// Doses slowly for so many minutes of the board's time.
pub(crate) fn slow(firmware: &Path, minutes: f64) -> Result<(), Box<dyn Error>> {
    let mut met = meet(firmware, Axis::X)?;
    // A dose that begins where a roller leaves the outlet takes longer than its volume over its flow.
    let (mut less, mut more) = (0.0, FLOW_ML_S * 60.0 * minutes);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (less + more);
        let lasts_s = met.plan(middle, FLOW_ML_S, false)?.profile().duration_s();
        (less, more) = if lasts_s <= 60.0 * minutes { (middle, more) } else { (less, middle) };
    }
    let volume_ml = 0.5 * (less + more);
    let plan = met.plan(volume_ml, FLOW_ML_S, false)?;
    let began = Instant::now();
    let made = met.node.run(&plan, &mut |_, _| Leave::Go)?;
    let rises = rises(&met.emulator.take_edges(), 0);
    let off_us = distances_us(&plan, &rises);
    let (least, most) = off_us.iter().fold((f64::MAX, f64::MIN), |(a, b), off| (a.min(*off), b.max(*off)));
    let half_us = 0.5 * (most - least);
    let real_s = began.elapsed().as_secs_f64();
    println!(
        "{volume_ml:.2} mL at {FLOW_ML_S} mL/s in {:.1} min: {} steps within {half_us:.2} us of the plan, in \
         {real_s:.0} s of this computer's time",
        plan.profile().duration_s() / 60.0,
        rises.len()
    );
    check(made == plan.steps().unsigned_abs() && rises.len() as u64 == made, "the number of slow steps")?;
    check(half_us <= MOST_OFF_US, "the times of the slow steps")
}
