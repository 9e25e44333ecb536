//! Values that a stepper driver TMC2209 takes: its address, sense resistor, currents and microsteps.
//!
//! Source: Trinamic, TMC2209 datasheet, rev. 1.09. A current is I_rms = (CS + 1)/32 V_FS/(R_sense + 0.02 Ohm)/sqrt 2
//! for a scale CS (chapter 9).

use std::f64::consts::SQRT_2;

use crate::pump_file::range::{WrongValue, allow, within};

/// Voltage at the sense resistor for the full scale, in V, by `vsense` (chapter 20, V_SRTL and V_SRTH).
const FULL_SCALE_V: [f64; 2] = [0.325, 0.180];

/// Resistance between the chip and the sense resistor, in Ohm (chapter 9).
const INNER_OHM: f64 = 0.02;

/// Largest scale.
const SCALE_MOST: u8 = 31;

/// Largest current of the chip, in A (RMS) (features: 2.0 A).
const CHIP_MOST_A: f64 = 2.0;

/// Sense resistors, in Ohm, of the table in chapter 8.
const SENSE_OHM: (f64, f64) = (0.075, 1.0);

/// Largest address (chapter 4: pins MS1 and MS2).
const ADDRESS_MOST: u8 = 3;

/// Most microsteps of a full step (chapter 5.5.1, MRES).
pub(crate) const MICROSTEPS_MOST: u32 = 256;

/// Words for the microsteps that the chip makes.
pub(crate) const MICROSTEPS: &str = "1, 2, 4, 8, 16, 32, 64, 128 or 256";

/// Part of a step of the scale by which a current may miss it: currents are written with few digits.
const SLACK: f64 = 1e-6;

/// Returns the current of a scale in A (RMS). The sensitive measurement has the finer steps.
pub(crate) fn current_a(scale: u8, is_sensitive: bool, sense_ohm: f64) -> f64 {
    let full_scale_v = FULL_SCALE_V[usize::from(is_sensitive)];
    (f64::from(scale) + 1.0) / 32.0 * full_scale_v / (sense_ohm + INNER_OHM) / SQRT_2
}

/// Returns true if the sensitive measurement makes a current of a motor that turns.
pub(crate) fn is_sensitive(run_a: f64, sense_ohm: f64) -> bool {
    run_a <= current_a(SCALE_MOST, true, sense_ohm) * (1.0 + SLACK)
}

/// Returns the largest scale whose current in A (RMS) is not above one that the chip makes.
pub(crate) fn scale(wanted_a: f64, is_sensitive: bool, sense_ohm: f64) -> u8 {
    let steps = wanted_a / current_a(0, is_sensitive, sense_ohm) + SLACK;
    // Less than a step of the scale is its smallest.
    (steps.floor() - 1.0).clamp(0.0, f64::from(SCALE_MOST)) as u8
}

/// Returns the currents in motion and at rest that the chip makes of those that are asked for, in A (RMS).
pub(crate) fn made_a((run_a, hold_a): (f64, f64), sense_ohm: f64) -> (f64, f64) {
    let is_sensitive = is_sensitive(run_a, sense_ohm);
    let made = |wanted_a| current_a(scale(wanted_a, is_sensitive, sense_ohm), is_sensitive, sense_ohm);
    (made(run_a), made(hold_a))
}

/// Returns the smallest and the largest current of a motor in A (RMS).
pub(crate) fn range_a(sense_ohm: f64) -> (f64, f64) {
    let most = current_a(SCALE_MOST, false, sense_ohm);
    (current_a(0, true, sense_ohm), most.min(CHIP_MOST_A))
}

/// Returns words for the currents of a motor that turns, as refusals of them say what is allowed.
pub(crate) fn currents_in_words(sense_ohm: f64) -> String {
    let (least, most) = range_a(sense_ohm);
    format!("{least:.3} to {most:.3} A (RMS) with [drive.klipper.tmc] sense_ohm of {sense_ohm} Ohm")
}

/// Refuses the first value that no TMC2209 takes: its address, the sense resistor in Ohm, and the motor's currents in
/// motion and at rest in A (RMS).
pub(crate) fn check(address: u8, sense_ohm: f64, (run_a, hold_a): (f64, f64)) -> Result<(), WrongValue> {
    within("[drive.klipper.tmc] address", address, 0..=ADDRESS_MOST)?;
    let (least, most) = SENSE_OHM;
    let allowed = format!("{least} to {most} Ohm; the board's papers name it, and 0.11 Ohm is usual");
    let is_usual = (least..=most).contains(&sense_ohm);
    allow(is_usual, "[drive.klipper.tmc] sense_ohm", format!("{sense_ohm} Ohm"), &allowed)?;
    let (least, most) = range_a(sense_ohm);
    let is_made = (least..=most).contains(&run_a);
    allow(is_made, "[drive.klipper.tmc] run_a", format!("{run_a} A"), &currents_in_words(sense_ohm))?;
    let least = current_a(0, is_sensitive(run_a, sense_ohm), sense_ohm);
    let allowed = format!("{least:.3} A to run_a, {run_a} A");
    let is_made = (least..=run_a).contains(&hold_a);
    allow(is_made, "[drive.klipper.tmc] hold_a", format!("{hold_a} A"), &allowed)
}

/// Returns the microsteps of a full step, or refuses those that no TMC2209 makes.
pub(crate) fn microsteps(steps_per_rev: u32, full_steps: u32) -> Result<u16, WrongValue> {
    let microsteps = steps_per_rev / full_steps.max(1);
    let is_made = steps_per_rev.is_multiple_of(full_steps.max(1))
        && microsteps.is_power_of_two()
        && microsteps <= MICROSTEPS_MOST;
    let allowed = format!(
        "full_steps_per_rev times {MICROSTEPS}, which are the microsteps that a TMC2209 makes; remove \
         [drive.klipper.tmc] if the board does not set the stepper driver"
    );
    let value = format!("{steps_per_rev} beside full_steps_per_rev = {full_steps}");
    allow(is_made, "[motor] steps_per_rev", value, &allowed)?;
    Ok(u16::try_from(microsteps).unwrap_or_default())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The datasheet's table of chapter 8: largest RMS current in A by the sense resistor in Ohm, with IRUN = 31 and
    /// vsense = 0.
    #[test]
    fn largest_currents_are_those_of_the_datasheet() {
        for (sense_ohm, most_a) in [
            (1.0, 0.23),
            (0.82, 0.27),
            (0.75, 0.30),
            (0.68, 0.33),
            (0.50, 0.44),
            (0.47, 0.47),
            (0.39, 0.56),
            (0.33, 0.66),
            (0.27, 0.79),
            (0.22, 0.96),
            (0.18, 1.15),
            (0.15, 1.35),
            (0.12, 1.64),
            (0.10, 1.92),
        ] {
            assert!((current_a(31, false, sense_ohm) - most_a).abs() < 0.0051, "{sense_ohm} Ohm");
        }
        // 2.4 A there, and above the chip's rating.
        assert_eq!(range_a(0.075).1, 2.0);
    }

    #[test]
    fn each_value_is_refused_with_what_the_chip_takes() {
        let said = |checked: Result<(), WrongValue>| checked.unwrap_err().in_file("a file").to_string();
        let ends = |checked, words: &str| {
            let said = said(checked);
            assert!(said.ends_with(words), "{said}");
        };
        assert_eq!(check(3, 0.11, (0.5, 0.3)), Ok(()));
        ends(check(4, 0.11, (0.5, 0.3)), "[drive.klipper.tmc] address is 4; allowed: 0 to 3");
        ends(check(0, 0.05, (0.5, 0.3)), "0.075 to 1 Ohm; the board's papers name it, and 0.11 Ohm is usual");
        for run_a in [0.0, 0.02, 1.9, f64::NAN] {
            ends(
                check(0, 0.11, (run_a, run_a)),
                "0.031 to 1.768 A (RMS) with [drive.klipper.tmc] sense_ohm of 0.11 Ohm",
            );
        }
        ends(check(0, 0.11, (0.5, 0.9)), "hold_a is 0.9 A; allowed: 0.031 A to run_a, 0.5 A");
        // The coarse scale begins higher.
        ends(check(0, 0.11, (1.2, 0.04)), "hold_a is 0.04 A; allowed: 0.055 A to run_a, 1.2 A");
        assert_eq!(
            [(3200, 200), (200, 200), (102_400, 400)].map(|(n, full)| microsteps(n, full)),
            [Ok(16), Ok(1), Ok(256)]
        );
        for (steps, full) in [(3000, 200), (3210, 200), (102_400, 200), (100, 200)] {
            let words = said(microsteps(steps, full).map(drop));
            assert!(
                words.contains(&format!("is {steps} beside full_steps_per_rev = {full}; allowed: full_st")),
                "{words}"
            );
        }
    }
}
