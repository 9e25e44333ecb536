//! The two pictures of the README: what the start angle does to a small dose, and what `--smooth` does to the flow.

use std::error::Error;

use pump_bench::export::{BLUE, Chart, Colour, Curve, GREEN, Panel, Style, VERMILION};
use pump_bench::simulation::{Method, Waveform, times};
use pump_bench::{Bench, DoseReport, DoseRequest, Prepared, built_in};
use pump_model::Pump;
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

/// Standard uncertainty of the engagement angle, in deg: read to 1 deg either way, rectangular, 1/sqrt(3) (GUM,
/// JCGM 100:2008, 4.3.7).
const ENGAGEMENT_DEG: f64 = 0.577;

/// Points over a horizontal axis.
type Points = Vec<(f64, f64)>;

/// A bench of the built-in pump that records nothing: it plans.
fn bench(folder: &tempfile::TempDir) -> Result<Bench, Box<dyn Error>> {
    let file = built_in("three-roller").ok_or("three-roller is built in")?;
    Ok(Bench::new(file, None, folder.path())?)
}

/// Returns the area between two curves.
fn area(label: &'static str, colour: Colour, upper: Points, lower: Points) -> Curve {
    let points = upper.into_iter().chain(lower.into_iter().rev()).collect();
    Curve { label, colour, style: Style::Area, points }
}

/// Draws the error of 1 mL over the start angle: by one constant, planned, and the interval that the dose states.
pub(crate) fn error_of_a_small_dose(trial: &Trial) -> Result<String, Box<dyn Error>> {
    let folder = tempfile::tempdir()?;
    let bench = bench(&folder)?;
    let errors = DoseError::new(trial, VOLUME_ML, ANGLES)?;
    let percent =
        |points: &[(f64, f64)]| points.iter().map(|(deg, ml)| (*deg, 100.0 * ml / VOLUME_ML)).collect();
    let [mut upper, mut lower] = [Vec::new(), Vec::new()];
    for start_rad in trial.start_angles(ANGLES) {
        let request = DoseRequest::dose(VOLUME_ML).with_start_angle(start_rad, radians(READ_DEG));
        let report = DoseReport::new(&bench, &bench.prepare(request)?, None);
        let percent = 100.0 * report.expanded_uncertainty_ml / VOLUME_ML;
        upper.push((degrees(start_rad), percent));
        lower.push((degrees(start_rad), -percent));
    }
    let curve = |label, colour, points| Curve { label, colour, style: Style::Line, points };
    let naive: Vec<(f64, f64)> = percent(&errors.one_constant);
    let farthest = naive.iter().copied().max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
    let panel = Panel {
        label: "error, %",
        curves: vec![
            area("range stated for the vessel", GREEN, upper, lower),
            curve("by one constant", VERMILION, naive),
            curve("planned, at the rollers", BLUE, percent(&errors.planned)),
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

/// Returns the flow of a pump at its outlet rollers while it makes the motion of a dose.
fn flow(pump: &Pump, prepared: &Prepared) -> Result<Points, Box<dyn Error>> {
    let times = times(DT_S, prepared.motion_s(), prepared.settled_s());
    Waveform::new(pump, prepared.legs(), Method::Exact, times)?
        .map(|sample| Ok(sample.map(|sample| (sample.time_s, sample.q_out_ml_s))?))
        .collect()
}

/// Returns the curves around a flow within which it is expected (k = 2): the motion stays, and the pump's roller volume
/// and engagement angle depart by their standard uncertainties.
fn expected(
    bench: &Bench,
    prepared: &Prepared,
    middle: &[(f64, f64)],
) -> Result<[Points; 2], Box<dyn Error>> {
    let pump = &prepared.model;
    let roller = pump.roller_volume();
    let more_ml = bench.file().uncertainty.roller_volume_ml.ok_or("the roller volume has an uncertainty")?;
    let larger = roller.scaled_to(roller.total_ml() + more_ml)?;
    let wider = roller
        .stretched_to(degrees(roller.engagement_rad()) + ENGAGEMENT_DEG)?
        .scaled_to(roller.total_ml())?;
    let larger = flow(&pump.with_roller_volume(larger)?, prepared)?;
    let wider = flow(&pump.with_roller_volume(wider)?, prepared)?;
    let mut around = [Vec::new(), Vec::new()];
    for ((&(time_s, ml_s), larger), wider) in middle.iter().zip(larger).zip(wider) {
        let half_width = 2.0 * (larger.1 - ml_s).hypot(wider.1 - ml_s);
        around[0].push((time_s, ml_s + half_width));
        around[1].push((time_s, ml_s - half_width));
    }
    Ok(around)
}

/// Draws the flow at the rollers of one dose at constant speed and of the same dose with `--smooth`, and where the
/// smooth flow is expected for what is known of the pulse.
pub(crate) fn smooth_beside_pulsating() -> Result<String, Box<dyn Error>> {
    let folder = tempfile::tempdir()?;
    let bench = bench(&folder)?;
    let prepared =
        |smooth| bench.prepare(DoseRequest::dose(25.0).with_start_angle(0.0, 0.0).with_smooth(smooth));
    let [constant, smooth] = [prepared(false)?, prepared(true)?];
    let [pulsating, even] = [flow(&constant.model, &constant)?, flow(&smooth.model, &smooth)?];
    let [upper, lower] = expected(&bench, &smooth, &even)?;
    let end_s = [&pulsating, &even].into_iter().filter_map(|points| points.last()).map(|last| last.0);
    let range = 0.0..end_s.fold(0.0, f64::max);
    let curve = |label, colour, points| Curve { label, colour, style: Style::Line, points };
    let curves = vec![
        area("range of such pumps (95 %)", BLUE, upper, lower),
        curve("constant speed", VERMILION, pulsating),
        curve("--smooth, as in the model", BLUE, even),
    ];
    let chart = Chart {
        title: "25 mL at 5 mL/s",
        label: "time, s",
        range,
        mark: None,
        panel_height: 350,
        panels: vec![Panel { label: "flow at the rollers, mL/s", curves }],
    };
    Ok(chart.narrow_svg()?)
}
