//! The pins of a step driver at a node or at a Klipper board, and which of their values the pump file gives.

use crate::numbers::significant;
use crate::pump_file::{DriverFault, DriverName, KlipperTable, Pins, PumpFile, TmcTable, tmc_range};

/// Returns the times and the polarity of the pins, for a pump at a node or at a Klipper board.
pub(super) fn pins_text(file: &PumpFile) -> Option<String> {
    if let Some((table, dead_man_ms)) = klipper(file) {
        return Some(klipper_text(table, dead_man_ms));
    }
    let drive = file.drive.as_ref().filter(|drive| drive.driver == DriverName::Node)?;
    let pins = drive.pins_or_usual();
    let Pins { step_pulse_us, step_pause_us, direction_setup_us, direction_hold_us, enable_setup_ms, .. } =
        pins;
    let level = |is_low: bool| if is_low { "low" } else { "high" };
    let [step, enable, index] =
        [pins.step_active_low, pins.enable_active_low, pins.index_active_low].map(level);
    let index = if drive.index_angle_deg.is_some() { index } else { "sensor not connected" };
    let fault = match pins.driver_fault {
        DriverFault::None => "not connected",
        DriverFault::Low => "low in a fault",
        DriverFault::High => "high in a fault",
    };
    Some(format!(
        "step {step} for {step_pulse_us} us, then {step_pause_us} us off; direction {direction_setup_us} us before and \
         {direction_hold_us} us after a step; enable {enable}, {enable_setup_ms} ms before a step; index {index}; \
         stepper driver's fault {fault}; dead-man {} ms",
        drive.dead_man_or_usual_ms()
    ))
}

/// Returns the values of the pins, and if the file gives them.
pub(super) fn pins_given(file: &PumpFile) -> Vec<(&'static str, bool)> {
    if let Some((table, _)) = klipper(file) {
        let mut given = vec![
            ("pins", true),
            ("step pulse", table.step_pulse_us.is_some()),
            ("dead-man time", file.drive.as_ref().is_some_and(|drive| drive.dead_man_ms.is_some())),
        ];
        if let Some(tmc) = &table.tmc {
            given.extend([("current of the motor", true), ("current at rest", tmc.hold_a.is_some())]);
        }
        return given;
    }
    let Some(drive) = file.drive.as_ref().filter(|drive| drive.driver == DriverName::Node) else {
        return Vec::new();
    };
    let pins = drive.pins.unwrap_or_default();
    vec![
        ("step pulse", pins.step_pulse_us.is_some()),
        ("step pause", pins.step_pause_us.is_some()),
        ("direction setup", pins.direction_setup_us.is_some()),
        ("direction hold", pins.direction_hold_us.is_some()),
        ("enable setup", pins.enable_setup_ms.is_some()),
        ("step level", pins.step_active_low.is_some()),
        ("enable level", pins.enable_active_low.is_some()),
        ("index level", pins.index_active_low.is_some()),
        ("stepper driver's fault", pins.driver_fault.is_some()),
        ("dead-man time", drive.dead_man_ms.is_some()),
    ]
}

/// Returns the table of a Klipper board and its dead-man time in ms, for a pump at one.
fn klipper(file: &PumpFile) -> Option<(&KlipperTable, u16)> {
    let drive = file.drive.as_ref().filter(|drive| drive.driver == DriverName::Klipper)?;
    Some((drive.klipper.as_ref()?, drive.dead_man_or_usual_ms()))
}

fn klipper_text(table: &KlipperTable, dead_man_ms: u16) -> String {
    let (step, dir, pulse_us) = (&table.step, &table.dir, table.pulse_us());
    let enable = table
        .enable
        .as_ref()
        .map_or("no enable, so the motor always has current".to_owned(), |enable| format!("enable {enable}"));
    let index = table.index.as_ref().map_or("no index sensor".to_owned(), |index| format!("index {index}"));
    format!(
        "step {step} for {pulse_us} us, then {pulse_us} us off at least; direction {dir}; {enable}; {index}; dead-man \
         {dead_man_ms} ms"
    )
}

/// Returns the stepper driver that the board sets, its currents and its microsteps, for a pump at a Klipper board.
pub(super) fn driver_text(file: &PumpFile) -> Option<String> {
    let (table, _) = klipper(file)?;
    let Some(tmc) = &table.tmc else {
        return Some("stays as its jumpers and its trimmer set it".to_owned());
    };
    let TmcTable { uart, address, sense_ohm, .. } = tmc;
    let written = tmc.tx.as_ref().map_or(String::new(), |tx| format!(", written by {tx}"));
    let (run_a, hold_a) = tmc_range::made_a((tmc.run_a, tmc.hold_a()), *sense_ohm);
    let (full_steps, steps) = (file.motor.full_steps_per_rev.max(1), file.motor.steps_per_rev);
    Some(format!(
        "TMC2209 at {uart}{written}, address {address}; {run_a:.3} A (RMS) of run_a = {} A while the motor turns, \
         {hold_a:.3} A at rest, by the chip's scale with {sense_ohm} Ohm; {} microsteps of {full_steps} full steps, \
         which the board sets",
        tmc.run_a,
        steps / full_steps
    ))
}

/// Returns the most steps a second that the motor makes by its file, for a pump at a Klipper board.
pub(super) fn fastest_text(file: &PumpFile) -> Option<String> {
    klipper(file)?;
    let motor = file.limits().motor;
    Some(format!(", {} steps/s", significant(motor.max_speed_rad_s / motor.step_rad(), 4)))
}
