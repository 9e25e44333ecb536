//! The check of a pump file in words: what the pump gives.

mod pins;
mod sources;

use pump_model::units::{degrees, rad_s};
use pump_model::{Line, Pump, RollerVolume};

use crate::calibration::Stored;
use crate::catalogue::{unusual, with_own_uncertainty};
use crate::displacement::{DisplacementError, PulsePrior, SpeedDependentPump};
use crate::dosing::{copied_uncertainty, drop_ml};
use crate::heads::bought_head;
use crate::numbers::significant;
use crate::pump_file::{LineSource, LineTable, OutletEnd, PumpFile, Reservoir, RollerVolumeTable};

/// Says what the pump of a file gives, a line each: volumes, flows, speeds, fluid, lines and uncertainty. `used` is the
/// calibration that its doses use, if there is one: what that has measured counts in place of the file's values.
///
/// # Errors
///
/// A pump that cannot be modelled, or a law of its displacement that does not hold for it.
pub fn pump_check(file: &PumpFile, used: Option<&Stored>) -> Result<String, DisplacementError> {
    let file = &with_own_uncertainty(file.clone());
    let by_speed = file.speed_dependent_pump()?;
    let pump = *by_speed.base();
    let lines = [
        ("head", head_text(file)),
        ("roller", roller_text(file, pump.roller_volume())?),
        ("volume", volume_text(&pump)),
        ("flow", flow_text(&pump)),
        ("speed law", law_text(&by_speed)?),
        ("fastest", fastest_text(file, &by_speed)?),
        ("step", step_text(file, &pump)),
        ("motor", sources::motor_text(file)),
        ("fluid", fluid_text(file)),
        ("ambient", sources::ambient_text(file)),
        ("inlet", line_text(file, &file.inlet, pump.inlet())),
        ("outlet", line_text(file, &file.outlet.line, pump.outlet())),
        ("nozzle", nozzle_text(file)?),
        ("unsure", uncertainty_text(file)),
    ];
    let calibration = used.map(|used| ("weighed", calibration_text(&pump, used)));
    let used = used.filter(|used| suits(used, &pump));
    let lines = lines
        .into_iter()
        .chain(calibration)
        .chain(pins::pins_text(file).map(|text| ("pins", text)))
        .chain(pins::driver_text(file).map(|text| ("stepper", text)))
        .chain(sources::source_lines(file, used.map(|used| &used.calibration)))
        .map(|(name, text)| format!("  {name:<9} {text}\n"));
    let text: String = catalogue_line(file).into_iter().chain(lines).chain(warnings(file, used)).collect();
    Ok(format!("{} ({}): ok\n\n{text}", file.pump.id, file.pump.name))
}

/// The dimensions of the head, as the file gives them.
fn head_text(file: &PumpFile) -> String {
    if let Some(head) = &file.head {
        let bore = head.tube_bore_mm.map_or("unknown bore".to_owned(), |mm| format!("bore of {mm} mm"));
        return format!("{} mL per revolution, {} rollers, {bore}", head.ml_per_rev, file.rollers.count);
    }
    let radii = [file.tube.bore_radius_mm, file.tube.outer_radius_mm];
    let diameters = radii.map(|mm| mm.map_or("?".to_owned(), |mm| significant(2.0 * mm, 6))).join(" x ");
    let radii = [("roller", file.rollers.radius_mm), ("offset", file.rollers.offset_mm)];
    let radii = radii.into_iter().filter_map(|(name, mm)| mm.map(|mm| format!(", {name} {mm} mm")));
    let backplate = file.backplate.as_ref().map_or(String::new(), |plate| {
        format!(", backplate {} mm, contact {}°", plate.radius_mm, plate.contact_angle_deg)
    });
    format!("tube {diameters} mm{backplate}{}", radii.collect::<String>())
}

/// The head's row of the catalogue, and how far its figures are from the maker's own words.
fn catalogue_line(file: &PumpFile) -> Option<String> {
    let row = bought_head(file.head.as_ref()?.catalogue.as_deref()?)?;
    let (maker, head, tubing, published) = (&row.maker, &row.head, &row.tubing, &row.published);
    Some(format!("  {:<9} {maker} {head}, {tubing}: {published} ({})\n", "catalogue", row.source.kind))
}

/// True if doses of this pump may use a calibration. A zero alone suits any pump.
fn suits(used: &Stored, base: &Pump) -> bool {
    let Stored { calibration, .. } = used;
    used.is_of(base) || calibration.displacement.is_none() && calibration.pulse.is_none()
}

/// The calibration that doses use, and its factor on the volume of the file.
fn calibration_text(base: &Pump, used: &Stored) -> String {
    let Stored { version, calibration } = used;
    if !suits(used, base) {
        let then_ml = significant(calibration.revolution_ml, 5);
        return format!("calibration {version} is of a pump of {then_ml} mL per revolution: doses refuse it");
    }
    let factor = calibration.displacement.as_ref().and_then(|found| {
        let rpm = found.reference_rpm;
        Some((rpm, found.factor_at(base, rpm).ok()?, found.whole_standard_at(base, rpm).ok()?))
    });
    let told = factor.map_or(String::new(), |(rpm, factor, standard)| {
        format!(
            "model volume times {factor:.4} ± {:.4} (k = 2) at {} r/min, ",
            2.0 * standard,
            significant(rpm, 4)
        )
    });
    format!("{told}by calibration {version} of {}", calibration.date)
}

fn volume_text(pump: &Pump) -> String {
    let (pitch_ml, pitch_deg) = (pump.outlet_curve().pitch_ml(), degrees(pump.pitch_rad()));
    let revolution_ml = pump.revolution_ml();
    format!("{revolution_ml:.4} mL per revolution, {pitch_ml:.4} mL per pitch of {pitch_deg:.2}°")
}

fn flow_text(pump: &Pump) -> String {
    let (low, high) = pump.outlet_curve().flow_range_ml_rad();
    let reverses = if low < 0.0 {
        "; it reverses while a roller leaves, so every pitch takes a part of its volume back"
    } else {
        ""
    };
    format!("{low:.4} to {high:.4} mL/rad at the outlet rollers{reverses}")
}

fn step_text(file: &PumpFile, pump: &Pump) -> String {
    let steps_per_rev = file.limits().motor.steps_per_rev;
    format!("{steps_per_rev} per revolution, {:.3} µL on average", 1e3 * pump.revolution_ml() / steps_per_rev)
}

fn fluid_text(file: &PumpFile) -> String {
    let fluid = &file.fluid;
    format!("{} at {} °C, {} kg/m³", fluid.name, fluid.temperature_degc, fluid.density_kg_m3)
}

/// The place of the nozzle's end, and the drop that falls from it.
fn nozzle_text(file: &PumpFile) -> Result<String, DisplacementError> {
    let place = match file.outlet.end {
        Some(OutletEnd::Immersed) => return Ok("immersed".to_owned()),
        Some(OutletEnd::Air) => "in air",
        None => "in air unless [outlet] end says otherwise",
    };
    let (mm, drop_ml) = (file.outlet.nozzle_mm(), drop_ml(file)?);
    Ok(format!("{place}; a drop from {} mm has {} µL", significant(mm, 3), significant(1e3 * drop_ml, 2)))
}

fn uncertainty_text(file: &PumpFile) -> String {
    let stated = &file.uncertainty;
    let of_volume = match (file.law_standard(), stated.speed_percent) {
        (Some(law), _) => format!("{} % of the volume (the speed law's)", 100.0 * law),
        (None, Some(percent)) => {
            format!("{} % of the volume, {percent} % of it at a speed,", stated.model_percent)
        }
        (None, None) => format!("{} % of the volume", stated.model_percent),
    };
    match &file.head {
        Some(_) => {
            let of_volume = of_volume.trim_end_matches(',');
            let scatter = stated.repeatability_percent;
            format!("{of_volume}; a dose scatters by {scatter} % (standard uncertainties)")
        }
        None => {
            format!("{of_volume} and {} mL of a roller (standard uncertainty)", stated.roller_standard_ml())
        }
    }
}

/// Warns of what is unusual, a line each, and of an uncertainty that is another pump's until `used` has measured it.
fn warnings(file: &PumpFile, used: Option<&Stored>) -> impl Iterator<Item = String> {
    let is_weighed = used.is_some_and(|used| used.calibration.displacement.is_some());
    let copied = copied_uncertainty(file).filter(|_| !is_weighed);
    unusual(file).into_iter().chain(copied).map(|warning| format!("  warning   {warning}\n"))
}

/// The dependence of the volume on the speed.
fn law_text(pump: &SpeedDependentPump) -> Result<String, DisplacementError> {
    let Some(law) = pump.law() else {
        return Ok("none: the same volume at every speed".to_owned());
    };
    let (least_rpm, most_rpm) = law.range_rpm();
    let factor = |rpm: f64| law.factor_at(pump.base(), rad_s(rpm));
    Ok(format!(
        "{law}: {least_rpm} to {most_rpm} r/min, times {:.4} to {:.4}; experimental",
        factor(least_rpm)?,
        factor(most_rpm)?,
    ))
}

/// The motor's fastest speed, and the largest mean flow up to it.
fn fastest_text(file: &PumpFile, pump: &SpeedDependentPump) -> Result<String, DisplacementError> {
    let most_rpm = file.motor.max_speed_rpm;
    let steps = pins::fastest_text(file).unwrap_or_default();
    Ok(format!("{most_rpm} r/min, {:.3} mL/s{steps}", pump.largest_flow_ml_s(most_rpm)?))
}

/// The volume of a roller, and its source.
fn roller_text(file: &PumpFile, curve: &RollerVolume) -> Result<String, DisplacementError> {
    let source = match &file.roller_volume {
        None => return Ok(default_pulse_text(file, curve)),
        Some(RollerVolumeTable::Polynomial { .. }) => "from its polynomial".to_owned(),
        Some(RollerVolumeTable::Drawing) => "estimated from the drawing".to_owned(),
        Some(RollerVolumeTable::Measured { fit, points }) => {
            let fit = fit.of(points)?;
            let mut source = format!("from {} measured points, {:.4} mL RMS off", points.len(), fit.rms_ml());
            for (from_deg, to_deg, fall_ml) in fit.falls().into_iter().flatten() {
                source += &format!("; they fall by {fall_ml:.4} mL from {from_deg:.2}° to {to_deg:.2}°");
            }
            source
        }
    };
    Ok(format!("{:.4} mL over {:.2}°, {source}", curve.total_ml(), curve.engagement_deg()))
}

/// The default pulse of a head that is known by its volume alone, with its uncertainty.
fn default_pulse_text(file: &PumpFile, curve: &RollerVolume) -> String {
    let prior = PulsePrior::of(file.rollers.count);
    let factor = libm::exp(2.0 * prior.engagement_spread);
    format!(
        "{} mL over {:.0}° by default, {:.0} % of the bore's pitch; as drawings of heads vary: {:.0} to {:.0}° (k = 2)",
        significant(curve.total_ml(), 2),
        curve.engagement_deg(),
        100.0 * prior.share(),
        prior.engagement_deg / factor,
        (prior.engagement_deg * factor).min(360.0),
    )
}

/// The constants of a line, and their source.
fn line_text(file: &PumpFile, table: &LineTable, line: &Line) -> String {
    let source = match &table.source {
        LineSource::Unknown => {
            let unknown = "not given: its pressures and its settling are not known";
            if table.reservoir == Reservoir::OPEN {
                return unknown.to_owned();
            }
            return format!("{unknown}; {}", sources::reservoir_text(table.reservoir, line.reservoir_kpa));
        }
        LineSource::Given { .. } => "as given".to_owned(),
        LineSource::Hose(hose) => {
            let at_ml_s = hose.resistance_at_ml_s.unwrap_or(file.pump.default_rate_ml_s);
            format!("estimated from its hose, R at {at_ml_s} mL/s")
        }
    };
    format!(
        "R {:.4} kPa s/mL, C {:.4} mL/kPa, L {:.5} kPa s²/mL, {source}; {}",
        line.resistance_kpa_s_ml,
        line.compliance_ml_kpa,
        line.inertance_kpa_s2_ml,
        sources::reservoir_text(table.reservoir, line.reservoir_kpa)
    )
}
