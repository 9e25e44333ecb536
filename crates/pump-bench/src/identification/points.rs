//! R and C from points, with their warnings.

use pump_model::identification::{
    ComplianceFit, FlowPoint, IdentificationError, InjectionPoint, Readings, ResistanceFit,
};
use pump_model::{Line, Port};

use super::identified::{Identified, Parameter};
use crate::export::Fitted;
use crate::notice::{Notice, Remedy};

/// Identifies R of the line of a port from steady flows, with or without an offset, the drop at no flow.
///
/// If the resistance changes with the flow, a warning gives it at `rate_ml_s`, the pump's usual rate.
///
/// # Errors
/// Returns the [`IdentificationError`] of points that determine no resistance.
pub fn identified_resistance(
    points: &[FlowPoint],
    with_offset: bool,
    (port, line): (Port, &Line),
    rate_ml_s: f64,
) -> Result<Identified, IdentificationError> {
    let fit = ResistanceFit::of(points, with_offset)?;
    let mut parameters =
        vec![Parameter::found("resistance_kpa_s_ml", "resistance", "kPa s/mL", fit.resistance_kpa_s_ml)];
    parameters.extend(fit.offset_kpa.map(|offset| Parameter::found("offset_kpa", "offset", "kPa", offset)));
    let mut warnings: Vec<_> = fit.missed_offset_kpa.iter().map(|offset| {
        format!(
            "the points do not lead through the origin: with an offset it is {:.4} ± {:.4} kPa; seek it too, \
             and check reservoir and sensor",
            offset.value,
            2.0 * offset.standard,
        )
    }).map(|text| Notice::from(text).with_remedy(Remedy::SeekOffset)).collect();
    warnings.extend(fit.bend.filter(|_| warnings.is_empty()).map(|bend| {
        format!(
            "the resistance changes with the flow: {:.5} + {:.6} per mL/s, {:.5} kPa s/mL at the pump's \
             {rate_ml_s} mL/s; measure at flows like those of doses",
            bend.at_no_flow_kpa_s_ml.value,
            bend.per_flow_kpa_s2_ml2.value,
            bend.resistance_kpa_s_ml(rate_ml_s),
        )
        .into()
    }));
    warnings.extend(scattered(points, &fit, with_offset).map(Notice::from));
    let mean_ml_s = weighted_mean(points.iter().map(|point| (point.flow_ml_s, point.standard_kpa)));
    let variance = fit.resistance_kpa_s_ml.standard * fit.resistance_kpa_s_ml.standard;
    let covariance = match fit.offset_kpa {
        None => vec![variance],
        // The line goes through the mean of the points, so a larger slope comes with a smaller offset.
        Some(offset) => {
            vec![variance, -mean_ml_s * variance, -mean_ml_s * variance, offset.standard * offset.standard]
        }
    };
    let fitted = points.iter().map(|point| Fitted {
        x: point.flow_ml_s,
        measured: point.drop_kpa,
        fitted: fit.drop_kpa(point.flow_ml_s),
    });
    let fitted = in_order(fitted, Readings::FlowPoints)?;
    Ok(Identified {
        kind: "resistance",
        port,
        headline: format!("{} line, dP = R Q over {} points", port.name(), points.len()),
        parameters,
        rows: points.len(),
        independent: points.len() as f64,
        points: fitted,
        covariance,
        warnings,
        line: Line { resistance_kpa_s_ml: fit.resistance_kpa_s_ml.value, ..*line },
        nozzle: None,
    }
    .with_weak_correlation(with_offset))
}

/// Returns the mean of numbers, each with the weight of its standard uncertainty.
fn weighted_mean(numbers: impl Iterator<Item = (f64, f64)>) -> f64 {
    let (mut weights, mut moments) = (0.0, 0.0);
    for (number, standard) in numbers {
        let weight = 1.0 / (standard * standard);
        weights += weight;
        moments += weight * number;
    }
    moments / weights
}

/// Collects points in order of their place, and of their measured value at one place. Too many for the memory are an
/// error and end no process.
fn in_order(
    points: impl ExactSizeIterator<Item = Fitted>,
    of: Readings,
) -> Result<Vec<Fitted>, IdentificationError> {
    let mut fitted = Vec::new();
    let given = points.len();
    fitted.try_reserve_exact(given).map_err(|_| IdentificationError::NoMemory { given, of })?;
    fitted.extend(points);
    // A stable sort would take as much memory again.
    fitted.sort_unstable_by(|one, other| {
        one.x.total_cmp(&other.x).then(one.measured.total_cmp(&other.measured))
    });
    Ok(fitted)
}

/// Warns if the points lie farther from the line than their standard uncertainties allow.
///
/// The limit is a chi-square above its expectation by three of its standard deviations, sqrt(2 dof).
/// Uncertainties that are all 1 give no warning, since they are not known.
fn scattered(points: &[FlowPoint], fit: &ResistanceFit, with_offset: bool) -> Option<String> {
    let is_known = points.iter().any(|point| point.standard_kpa != 1.0);
    let degrees_of_freedom = points.len() as f64 - if with_offset { 2.0 } else { 1.0 };
    let most = (1.0 + 3.0 * (2.0 / degrees_of_freedom).sqrt()).sqrt();
    (is_known && fit.scatter > most).then(|| {
        format!(
            "the points scatter {:.1} times as far from the line as their standard uncertainties say; it \
             does not explain them",
            fit.scatter
        )
    })
}

/// Identifies C of the line of a port from an injection. If the volume that the line holds is known, its
/// effective bulk modulus follows too.
///
/// # Errors
/// Returns the [`IdentificationError`] of points that determine no compliance.
pub fn identified_compliance(
    points: &[InjectionPoint],
    total_ml: Option<f64>,
    (port, line): (Port, &Line),
) -> Result<Identified, IdentificationError> {
    let fit = ComplianceFit::of(points)?;
    let mut parameters = vec![
        Parameter::found("compliance_ml_kpa", "compliance", "mL/kPa", fit.compliance_ml_kpa),
        Parameter::found("start_kpa", "start", "kPa", fit.start_kpa),
    ];
    parameters.extend(total_ml.map(|total_ml| {
        Parameter::found("bulk_modulus_kpa", "bulk modulus", "kPa", fit.bulk_modulus_kpa(total_ml))
    }));
    let warnings = fit.bend.iter().map(|(slope, growth)| {
        format!(
            "the line {} as it fills: dP/dV is {:.3} kPa/mL at the start and changes by {:.3} per mL; inject \
             over pressures like those of doses",
            if growth.value > 0.0 { "stiffens (air does that)" } else { "softens" },
            slope.value,
            2.0 * growth.value,
        )
    });
    let mean_ml = weighted_mean(points.iter().map(|point| (point.volume_ml, 1.0)));
    let (compliance, start) = (fit.compliance_ml_kpa, fit.start_kpa);
    // The slope is 1/C, and the line goes through the mean of the points. The bulk modulus follows from C alone.
    let both = mean_ml * compliance.standard * compliance.standard / (compliance.value * compliance.value);
    let (of_c, of_start) = (compliance.standard * compliance.standard, start.standard * start.standard);
    let covariance = match total_ml.map(|total_ml| -total_ml / (compliance.value * compliance.value)) {
        None => vec![of_c, both, both, of_start],
        Some(per) => {
            vec![of_c, both, per * of_c, both, of_start, per * both, per * of_c, per * both, per * per * of_c]
        }
    };
    let fitted = points.iter().map(|point| Fitted {
        x: point.volume_ml,
        measured: point.pressure_kpa,
        fitted: fit.pressure_kpa(point.volume_ml),
    });
    let fitted = in_order(fitted, Readings::VolumePoints)?;
    Ok(Identified {
        kind: "compliance",
        port,
        headline: format!("{} line, C = dV/dP over {} points", port.name(), points.len()),
        parameters,
        rows: points.len(),
        independent: points.len() as f64,
        points: fitted,
        covariance,
        warnings: warnings.map(Notice::from).collect(),
        line: Line { compliance_ml_kpa: fit.compliance_ml_kpa.value, ..*line },
        nozzle: None,
    }
    .with_weak_correlation(true))
}
