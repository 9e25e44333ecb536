//! The pins of a step driver at a node, and which of their values the pump file gives.

use crate::pump_file::{DriverFault, DriverName, Pins, PumpFile};

/// Returns the times and the polarity of the pins, for a pump at a node.
pub(super) fn pins_text(file: &PumpFile) -> Option<String> {
    let drive = file.drive.as_ref().filter(|drive| drive.driver == DriverName::Node)?;
    let pins = drive.pins_or_usual();
    let Pins { step_pulse_us, step_pause_us, direction_setup_us, direction_hold_us, enable_setup_ms, .. } =
        pins;
    let level = |is_low: bool| if is_low { "low" } else { "high" };
    let [step, enable, index] =
        [pins.step_active_low, pins.enable_active_low, pins.index_active_low].map(level);
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
