//! The pump's curve: flow and pressures over its speed, with the operating point.

use pump_model::units::{rad_s, rpm};
use pump_model::{Extremes, Friction, Line, Port};

use super::error::SizingError;
use super::operating::Operating;

/// Points of a curve.
const POINTS: u32 = 48;

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
    (1..=POINTS)
        .map(|n| {
            let speed_rad_s = top_rad_s * f64::from(n) / f64::from(POINTS);
            let flow_ml_s = at.pump.average_flow_ml_s(speed_rad_s);
            let inlet = line(Port::Inlet, frictions[0], flow_ml_s);
            let outlet = line(Port::Outlet, frictions[1], flow_ml_s);
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

#[cfg(feature = "plot")]
pub use picture::curve_svg;

#[cfg(feature = "plot")]
mod picture {
    use super::CurvePoint;
    use crate::export::{BLUE, Chart, Colour, Curve, GREEN, PURPLE, Panel, PlotError, Style, VERMILION};
    use crate::sizing::Sizing;

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
        let level = |label, colour: Colour, kpa: f64| Curve {
            label,
            colour,
            style: Style::Line,
            points: vec![(0.0, kpa), (end_rpm, kpa)],
        };
        let here = |value: f64| Curve {
            label: "operating point",
            colour: GREEN,
            style: Style::Points,
            points: vec![(sizing.speed_rpm, value)],
        };
        let mut flow = over("pump", BLUE, &|point| 60.0 * point.flow_ml_s);
        flow.points.insert(0, (0.0, 0.0));
        let mut suction = vec![
            over("mean", BLUE, &|point| point.inlet_mean_kpa),
            over("largest and smallest", VERMILION, &|point| point.inlet.max_kpa),
            over("", VERMILION, &|point| point.inlet.min_kpa),
        ];
        suction.extend(sizing.suction.limit_kpa.map(|kpa| level("limit", PURPLE, kpa)));
        suction.push(here(sizing.steady.inlet_mean_kpa));
        let mut discharge = vec![
            over("mean", BLUE, &|point| point.outlet_mean_kpa),
            over("largest and smallest", VERMILION, &|point| point.outlet.max_kpa),
            over("", VERMILION, &|point| point.outlet.min_kpa),
        ];
        discharge.extend(sizing.largest.map(|most| level("limit", PURPLE, most.kpa)));
        discharge.push(here(sizing.steady.outlet_mean_kpa));
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
}
