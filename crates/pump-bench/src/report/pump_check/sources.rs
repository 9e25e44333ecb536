//! The sources of a pump's values: measured, given, estimated or assumed.

use super::pins::pins_given;
use crate::calibration::Calibration;
use crate::catalogue::is_of_drawing;
use crate::pump_file::{AmbientSource, LineSource, LineTable, PumpFile, Reservoir, RollerVolumeTable};

/// Source of a value in a pump file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Source {
    /// Somebody measured it.
    Measured,
    /// The file gives it.
    Given,
    /// It is computed from other values.
    Estimated,
    /// The program assumes it.
    Assumed,
    /// Nobody knows it, and nothing is computed from it.
    Unknown,
}

/// Returns a line for each source, with the values that it has.
pub(super) fn source_lines(file: &PumpFile, used: Option<&Calibration>) -> Vec<(&'static str, String)> {
    let pins = pins_given(file).into_iter();
    let pins = pins.map(|(value, is_given)| (value, if is_given { Source::Given } else { Source::Assumed }));
    let values: Vec<_> = values(file, used).into_iter().chain(pins).collect();
    let line = |(source, name): (Source, &'static str)| {
        let of: Vec<&str> = values.iter().filter(|(_, of)| *of == source).map(|(value, _)| *value).collect();
        (!of.is_empty()).then(|| (name, of.join(", ")))
    };
    let sources = [
        (Source::Measured, "measured"),
        (Source::Given, "given"),
        (Source::Estimated, "estimated"),
        (Source::Assumed, "assumed"),
        (Source::Unknown, "unknown"),
    ];
    sources.into_iter().filter_map(line).collect()
}

/// Returns the values of a pump file, each with its source. A calibration has measured some of them.
fn values(file: &PumpFile, used: Option<&Calibration>) -> [(&'static str, Source); 12] {
    let given_or = |is_given: bool, otherwise| if is_given { Source::Given } else { otherwise };
    let line = |table: &LineTable| match table.source {
        LineSource::Unknown => Source::Unknown,
        LineSource::Given { .. } => Source::Given,
        LineSource::Hose(_) => Source::Estimated,
    };
    let is_directed = file.drive.is_some() && !file.motor.has_assumed_direction();
    let lines = [&file.inlet, &file.outlet.line];
    let is_open = |line: &&LineTable| line.is_unknown() && line.reservoir == Reservoir::OPEN;
    let reservoirs = if lines.iter().any(is_open) {
        Source::Assumed
    } else if lines.iter().all(|line| matches!(line.reservoir, Reservoir::Pressure(_))) {
        Source::Given
    } else {
        Source::Estimated
    };
    let head = match &file.head {
        Some(_) => "volume of a revolution",
        None => "head's dimensions",
    };
    let is_drawn = matches!(file.roller_volume, Some(RollerVolumeTable::Drawing));
    let geometry = file.model().ok().map(|model| *model.geometry()).filter(|_| is_drawn);
    let uncertainties = match geometry {
        _ if file.uncertainty.is_assumed() || file.uncertainty.replaces_papers => Source::Assumed,
        Some(geometry) if is_of_drawing(&file.uncertainty, &geometry) => Source::Estimated,
        _ => Source::Given,
    };
    let is_weighed = used.is_some_and(|used| used.displacement.is_some());
    let volume = if is_weighed { Source::Measured } else { Source::Given };
    let roller = match &file.roller_volume {
        _ if used.is_some_and(|used| used.pulse.is_some()) => Source::Measured,
        Some(RollerVolumeTable::Measured { .. }) => Source::Measured,
        Some(RollerVolumeTable::Polynomial { .. }) => Source::Given,
        Some(RollerVolumeTable::Drawing) => Source::Estimated,
        // The default pulse of a bought head.
        None => Source::Assumed,
    };
    [
        (head, if file.head.is_some() { volume } else { Source::Given }),
        ("volume of a roller", roller),
        ("R, C and L of the inlet", line(&file.inlet)),
        ("R, C and L of the outlet", line(&file.outlet.line)),
        ("pressures of the reservoirs", reservoirs),
        ("steps of the motor", given_or(!file.motor.has_assumed_steps(), Source::Assumed)),
        ("direction of the motor", given_or(is_directed, Source::Assumed)),
        ("density of the fluid", Source::Given),
        ("ambient pressure", given_or(file.ambient.source() != AmbientSource::SeaLevel, Source::Assumed)),
        ("nozzle's end", given_or(file.outlet.end.is_some(), Source::Assumed)),
        ("nozzle's bore", given_or(file.outlet.nozzle_bore_mm.is_some(), Source::Assumed)),
        ("uncertainties", uncertainties),
    ]
}

/// Returns the ambient pressure and its source.
pub(super) fn ambient_text(file: &PumpFile) -> String {
    let kpa = format!("{:.3}", file.ambient.pressure_kpa);
    let kpa = kpa.trim_end_matches('0').trim_end_matches('.');
    match file.ambient.source() {
        AmbientSource::Pressure => format!("{kpa} kPa, as given"),
        AmbientSource::Altitude(altitude_m) => format!("{kpa} kPa at {altitude_m} m (ISO 2533)"),
        AmbientSource::SeaLevel => {
            format!(
                "{kpa} kPa, assumed: sea level (ISO 2533); [ambient] altitude_m or pressure_kpa says otherwise"
            )
        }
    }
}

/// Returns the steps of the motor, and whether anybody has said them.
pub(super) fn motor_text(file: &PumpFile) -> String {
    let motor = &file.motor;
    let said = match motor.confirmed {
        Some(false) => "assumed: a real motor does not move until they are said ([motor] confirmed is false)",
        Some(true) => "confirmed",
        None => "as given",
    };
    format!("{} steps per revolution, gear {}, {said}", motor.steps_per_rev, motor.gear)
}

/// Returns the pressure of a reservoir and its source.
pub(super) fn reservoir_text(reservoir: Reservoir, reservoir_kpa: f64) -> String {
    match reservoir {
        Reservoir::Pressure(kpa) => format!("reservoir {kpa} kPa"),
        Reservoir::Lift(lift_mm) => format!("reservoir {reservoir_kpa:.3} kPa by a lift of {lift_mm} mm"),
    }
}
