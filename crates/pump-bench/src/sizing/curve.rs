//! The pump's curve: flow and pressures over its speed, with the operating point.

use pump_model::units::{rad_s, rpm};
use pump_model::{Extremes, Friction, Line, Port};

use super::error::SizingError;
use super::operating::Operating;

/// Points of a curve at equal distances.
const POINTS: u32 = 48;

/// Harmonics of the pulses whose resonance with a line a curve shows. Higher ones are small beside them.
const HARMONICS: u32 = 5;

/// Points on each side of a resonance. They are denser near its peak.
const ASIDE: i32 = 12;

/// Damping ratios between which a resonance is seen. A larger one makes no peak, and the peak of a smaller one has no
/// width that a point could hit.
const SEEN: [f64; 2] = [1e-3, 0.7];

/// Part of the speed of the duty up to which a curve goes where no largest speed is known.
const BEYOND: f64 = 2.0;

/// A point of the pump's curve.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct CurvePoint {
    /// Speed, in r/min.
    pub speed_rpm: f64,
    /// Mean flow, in mL/s.
    pub flow_ml_s: f64,
    /// Range of the inlet pressure, in kPa absolute.
    pub inlet: Extremes,
    /// Mean inlet pressure, in kPa absolute.
    pub inlet_mean_kpa: f64,
    /// Range of the outlet pressure, in kPa absolute.
    pub outlet: Extremes,
    /// Mean outlet pressure, in kPa absolute.
    pub outlet_mean_kpa: f64,
}

/// Returns the curve of a pump up to its largest speed in r/min. Each point has the resistance of its own flow.
pub(super) fn points(at: &Operating, most_rpm: Option<f64>) -> Result<Vec<CurvePoint>, SizingError> {
    let top_rad_s = most_rpm.map_or(BEYOND * at.speed_rad_s, |most_rpm| rad_s(most_rpm).max(at.speed_rad_s));
    let frictions = at.file.frictions()?;
    let line = |port: Port, friction: Option<Friction>, flow_ml_s: f64| {
        let line = *at.pump.line(port);
        friction.map_or(line, |friction| Line {
            resistance_kpa_s_ml: friction.resistance_kpa_s_ml(flow_ml_s),
            ..line
        })
    };
    let lines = |speed_rad_s: f64| {
        let flow_ml_s = at.pump.average_flow_ml_s(speed_rad_s);
        [line(Port::Inlet, frictions[0], flow_ml_s), line(Port::Outlet, frictions[1], flow_ml_s)]
    };
    speeds(at.file.rollers.count, top_rad_s, lines)
        .into_iter()
        .map(|speed_rad_s| {
            let flow_ml_s = at.pump.average_flow_ml_s(speed_rad_s);
            let [inlet, outlet] = lines(speed_rad_s);
            let steady = at.pump.with_lines(inlet, outlet)?.steady_state(speed_rad_s)?;
            Ok(CurvePoint {
                speed_rpm: rpm(speed_rad_s),
                flow_ml_s,
                inlet: steady.inlet,
                inlet_mean_kpa: steady.inlet_mean_kpa,
                outlet: steady.outlet,
                outlet_mean_kpa: steady.outlet_mean_kpa,
            })
        })
        .collect()
}

/// Returns the speeds of a curve in rad/s, in rising order up to the largest one. They are at equal distances, and
/// denser where a harmonic of the pulses meets the natural frequency of a line: a peak may lie between two others.
fn speeds(rollers: u32, top_rad_s: f64, lines: impl Fn(f64) -> [Line; 2]) -> Vec<f64> {
    let mut speeds: Vec<f64> = (1..=POINTS).map(|n| top_rad_s * f64::from(n) / f64::from(POINTS)).collect();
    for (port, harmonic) in (0..2).flat_map(|port| (1..=HARMONICS).map(move |harmonic| (port, harmonic))) {
        let centre_rad_s = lines(top_rad_s)[port].natural_rad_s() / f64::from(rollers * harmonic);
        let damping = lines(centre_rad_s)[port].damping_ratio();
        if !(SEEN[0]..SEEN[1]).contains(&damping) {
            continue;
        }
        // In half widths of the peak, which are its speed times the damping ratio: 0.38, 0.92 and so on up to 15.
        let away = |n: f64| 0.3 * n + 0.08 * n * n.abs();
        let aside = |n: i32| centre_rad_s * (1.0 + damping * away(f64::from(n)));
        speeds.extend((-ASIDE..=ASIDE).map(aside).filter(|speed| (0.0..top_rad_s).contains(speed)));
    }
    speeds.retain(|speed| *speed > 0.0);
    speeds.sort_unstable_by(f64::total_cmp);
    speeds.dedup();
    speeds
}

#[cfg(feature = "plot")]
pub use picture::curve_svg;

#[cfg(feature = "plot")]
mod picture {
    use super::CurvePoint;
    use crate::export::{BLUE, Chart, Curve, GREEN, GREY, PURPLE, Panel, PlotError, Style, VERMILION};
    use crate::sizing::Sizing;

    /// Distance of a limit from the pressures, over their range, up to which it is drawn.
    const FAR: f64 = 2.0;

    /// Draws the curve of a sizing as SVG: flow and pressures over the speed, with the operating point.
    ///
    /// # Errors
    /// Returns the [`PlotError`] of a picture that cannot be drawn.
    pub fn curve_svg(sizing: &Sizing, title: &str) -> Result<String, PlotError> {
        let over = |label, colour, value: &dyn Fn(&CurvePoint) -> f64| {
            let points = sizing.curve.iter().map(|point| (point.speed_rpm, value(point))).collect();
            Curve { label, colour, style: Style::Line, points }
        };
        let end_rpm = sizing.curve.last().map_or(sizing.speed_rpm, |point| point.speed_rpm);
        let here = |value: f64| Curve {
            label: "operating point",
            colour: GREEN,
            style: Style::Points,
            points: vec![(sizing.speed_rpm, value)],
        };
        let mut flow = over("pump", BLUE, &|point| 60.0 * point.flow_ml_s);
        flow.points.insert(0, (0.0, 0.0));
        let pressures = |value: [&dyn Fn(&CurvePoint) -> f64; 3], limit_kpa: Option<f64>, mean_kpa: f64| {
            let [largest, mean, smallest] = value;
            let mut curves = vec![
                over("largest", VERMILION, largest),
                over("mean", BLUE, mean),
                over("smallest", PURPLE, smallest),
            ];
            curves.extend(limit_kpa.and_then(|kpa| limit(&curves, kpa, end_rpm)));
            curves.push(here(mean_kpa));
            curves
        };
        let suction = pressures(
            [&|point| point.inlet.max_kpa, &|point| point.inlet_mean_kpa, &|point| point.inlet.min_kpa],
            sizing.suction.limit_kpa,
            sizing.steady.inlet_mean_kpa,
        );
        let discharge = pressures(
            [&|point| point.outlet.max_kpa, &|point| point.outlet_mean_kpa, &|point| point.outlet.min_kpa],
            sizing.largest.map(|most| most.kpa),
            sizing.steady.outlet_mean_kpa,
        );
        let chart = Chart {
            title,
            label: "speed, r/min",
            range: 0.0..end_rpm,
            mark: None,
            panel_height: 275,
            panels: vec![
                Panel { label: "flow, mL/min", curves: vec![flow, here(60.0 * sizing.flow_ml_s)] },
                Panel { label: "inlet, kPa absolute", curves: suction },
                Panel { label: "outlet, kPa absolute", curves: discharge },
            ],
        };
        chart.svg()
    }

    /// Returns the line of a limit in kPa absolute. `None` for one so far away that nothing else could be seen beside
    /// it.
    fn limit(curves: &[Curve], kpa: f64, end_rpm: f64) -> Option<Curve> {
        let values = || curves.iter().flat_map(|curve| curve.points.iter().map(|point| point.1));
        let (least, most) =
            (values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max));
        let away = (least - kpa).max(kpa - most);
        (away < FAR * (most - least)).then(|| Curve {
            label: "limit",
            colour: GREY,
            style: Style::Line,
            points: vec![(0.0, kpa), (end_rpm, kpa)],
        })
    }
}
