//! The two pictures of the README: what the start angle does to a small dose, and what `--smooth` does to the flow.

use std::error::Error;

use pump_bench::export::{BLUE, Chart, Curve, GREEN, Panel, Style, VERMILION};
use pump_bench::simulation::{Method, Waveform, times};
use pump_bench::{Bench, DoseReport, DoseRequest, built_in};
use pump_model::units::{degrees, radians};

use crate::dose_error::DoseError;
use crate::trial::Trial;

/// Volume of the dose whose error is drawn, mL.
const VOLUME_ML: f64 = 1.0;

/// Error with which the start angle is read by eye, degrees.
const READ_DEG: f64 = 1.0;

/// Start angles over a pitch.
const ANGLES: u32 = 120;

/// Time between the points of a flow, s.
const DT_S: f64 = 1e-3;

/// A bench of the built-in pump that records nothing: it plans.
fn bench(folder: &tempfile::TempDir) -> Result<Bench, Box<dyn Error>> {
    let file = built_in("three-roller").ok_or("three-roller is built in")?;
    Ok(Bench::new(file, None, folder.path())?)
}

/// Draws the error of 1 mL over the start angle: by one constant, planned, and the interval that the dose states.
pub(crate) fn error_of_a_small_dose(trial: &Trial) -> Result<String, Box<dyn Error>> {
    let folder = tempfile::tempdir()?;
    let bench = bench(&folder)?;
    let errors = DoseError::new(trial, VOLUME_ML, ANGLES)?;
    let percent =
        |points: &[(f64, f64)]| points.iter().map(|(deg, ml)| (*deg, 100.0 * ml / VOLUME_ML)).collect();
    let mut stated: [Vec<(f64, f64)>; 2] = [Vec::new(), Vec::new()];
    for start_rad in trial.start_angles(ANGLES) {
        let request = DoseRequest::dose(VOLUME_ML).with_start_angle(start_rad, radians(READ_DEG));
        let report = DoseReport::new(&bench, &bench.prepare(request)?, None);
        let percent = 100.0 * report.expanded_uncertainty_ml / VOLUME_ML;
        for (points, percent) in stated.iter_mut().zip([percent, -percent]) {
            points.push((degrees(start_rad), percent));
        }
    }
    let curve = |label, colour, points| Curve { label, colour, style: Style::Line, points };
    let [upper, lower] = stated;
    let naive: Vec<(f64, f64)> = percent(&errors.one_constant);
    let farthest = naive.iter().copied().max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
    let panel = Panel {
        label: "error, %",
        curves: vec![
            curve("by one constant", VERMILION, naive),
            curve("planned, at the rollers", BLUE, percent(&errors.planned)),
            curve("its interval in the vessel", GREEN, upper),
            curve("", GREEN, lower),
            Curve { style: Style::Values, ..curve(" %", VERMILION, farthest.into_iter().collect()) },
        ],
    };
    let chart = Chart {
        title: "Error of 1 mL, three rollers, not calibrated",
        label: "angle of the rollers at the start, deg",
        range: 0.0..degrees(trial.pump.pitch_rad()),
        mark: None,
        panel_height: 360,
        panels: vec![panel],
    };
    Ok(chart.narrow_svg()?)
}

/// Draws the flow into the vessel of one dose at constant speed and of the same dose with `--smooth`.
pub(crate) fn smooth_beside_pulsating() -> Result<String, Box<dyn Error>> {
    let folder = tempfile::tempdir()?;
    let bench = bench(&folder)?;
    let mut curves = Vec::new();
    for (label, colour, smooth) in [("constant speed", VERMILION, false), ("--smooth", BLUE, true)] {
        let request = DoseRequest::dose(25.0).with_start_angle(0.0, 0.0).with_smooth(smooth);
        let prepared = bench.prepare(request)?;
        let (motion_s, end_s) = (prepared.motion_s(), prepared.settled_s());
        let times = times(DT_S, motion_s, end_s);
        let points = Waveform::new(&prepared.model, prepared.legs(), Method::Exact, times)?
            .map(|sample| sample.map(|sample| (sample.time_s, sample.q_out_ml_s)))
            .collect::<Result<Vec<_>, _>>()?;
        curves.push(Curve { label, colour, style: Style::Line, points });
    }
    let end_s =
        curves.iter().filter_map(|curve| curve.points.last()).fold(0.0, |end: f64, last| end.max(last.0));
    let chart = Chart {
        title: "25 mL at 5 mL/s",
        label: "time, s",
        range: 0.0..end_s,
        mark: None,
        panel_height: 350,
        panels: vec![Panel { label: "flow at the rollers, mL/s", curves }],
    };
    Ok(chart.narrow_svg()?)
}
