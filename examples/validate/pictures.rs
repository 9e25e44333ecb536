//! Draws the pictures of the page.

use std::error::Error;

use pump_bench::export::{BLUE, Chart, Colour, Curve, GREEN, PURPLE, Panel, Style, VERMILION};
use pump_model::units::{TURN_RAD, rad_s, radians};
use pump_model::{Drawing, Geometry, Port, Pump, Variant, VolumeFit};

use crate::flow::RPM;
use crate::paper::{ENGAGEMENT_DEG, MEASURED};
use crate::pressures::pitch_kpa;
use crate::roller_volume::{at, points};
use crate::volumes::Volumes;

/// Number of points of a curve.
const POINTS: u32 = 400;

/// Returns names and SVGs of all pictures.
pub(crate) fn all() -> Result<Vec<(&'static str, String)>, Box<dyn Error>> {
    Ok(vec![
        ("roller-volume", roller_volume()?),
        ("flows", flows()?),
        ("volumes", volumes()?),
        ("pressures-three", pressures(3, "Three rollers, steady state, two pitches from angle 0")?),
        ("pressures-two", pressures(2, "Two rollers, steady state, two pitches from angle 0")?),
    ])
}

fn line(label: &'static str, colour: Colour, points: Vec<(f64, f64)>) -> Curve {
    Curve { label, colour, style: Style::Line, points }
}

/// Returns equal steps from 0 to `end`, both included.
fn steps(end: f64) -> impl Iterator<Item = f64> {
    (0..=POINTS).map(move |n| end * f64::from(n) / f64::from(POINTS))
}

fn roller_volume() -> Result<String, Box<dyn Error>> {
    let points = points();
    let fit = VolumeFit::quintic(&points)?;
    let polynomial = fit.polynomial_ml_deg().ok_or("a quintic has a polynomial")?;
    let drawn = |variant| {
        let drawing = Drawing::new(&Geometry::published(3, variant))?;
        let curve = steps(ENGAGEMENT_DEG).map(|deg| (deg, drawing.volume_ml(radians(deg)))).collect();
        Ok::<Vec<_>, Box<dyn Error>>(curve)
    };
    let measured = points.iter().map(|point| (point.angle_deg, point.volume_ml)).collect();
    let left = points.iter().zip(fit.residuals_ml()).map(|(point, left)| (point.angle_deg, left)).collect();
    let as_points = |label, points| Curve { label, colour: BLUE, style: Style::Points, points };
    let chart = Chart {
        title: "Roller volume: measured by McIntyre et al., fitted, and from the drawing",
        label: "angle since first contact, deg",
        range: -1.0..ENGAGEMENT_DEG + 1.0,
        mark: None,
        panel_height: 320,
        panels: vec![
            Panel {
                label: "volume, mL",
                curves: vec![
                    line(
                        "fit of 5th order",
                        VERMILION,
                        steps(ENGAGEMENT_DEG).map(|deg| (deg, at(&polynomial, deg))).collect(),
                    ),
                    line("drawing, Table 1", GREEN, drawn(Variant::Measured)?),
                    line("drawing, as built", PURPLE, drawn(Variant::AsBuilt)?),
                    as_points("measured, mean of seven", measured),
                ],
            },
            Panel { label: "fitted less measured, mL", curves: vec![as_points("left over", left)] },
        ],
    };
    Ok(chart.svg()?)
}

fn flows() -> Result<String, Box<dyn Error>> {
    let omega = rad_s(RPM);
    let panel = |pump: Pump, label| {
        let curve = |name, colour, port| {
            let flow = |t_s: f64| (t_s, pump.curve(port).flow_ml_rad(omega * t_s) * omega);
            line(name, colour, steps(TURN_RAD / omega).map(flow).collect())
        };
        // Where both flows are equal, the inlet's band stays visible under the outlet's line.
        let inlet = Curve { style: Style::Band, ..curve("inlet", BLUE, Port::Inlet) };
        let curves = vec![inlet, curve("outlet", VERMILION, Port::Outlet)];
        Panel { label, curves }
    };
    let chart = Chart {
        title: "Flow at the rollers over one revolution at 60 r/min",
        label: "time, s",
        range: 0.0..TURN_RAD / omega,
        mark: None,
        panel_height: 280,
        panels: vec![
            panel(Pump::three_roller(), "three rollers, mL/s"),
            panel(Pump::two_roller(), "two rollers, mL/s"),
        ],
    };
    Ok(chart.svg()?)
}

fn volumes() -> Result<String, Box<dyn Error>> {
    let mut panels = Vec::new();
    for (measured, label) in MEASURED.iter().zip(["three rollers, mL", "two rollers, mL"]) {
        let volumes = Volumes::of(measured.rollers, 10, measured.fastest_rpm)?;
        let level = |ml: f64| volumes.rpm.iter().map(|rpm| (*rpm, ml)).collect();
        let law = volumes.rpm.iter().copied().zip(volumes.law_ml.iter().copied()).collect();
        panels.push(Panel {
            label,
            curves: vec![
                line("measured, mean over these speeds", BLUE, level(measured.ten_revolutions_ml)),
                line("linear, V_r as measured", VERMILION, level(volumes.linear_ml)),
                line("linear, V_r of Table 1", PURPLE, level(volumes.published_ml)),
                line("speed law (fitted)", GREEN, law),
            ],
        });
    }
    let chart = Chart {
        title: "Volume of ten revolutions",
        label: "speed, r/min",
        range: 0.0..310.0,
        mark: None,
        panel_height: 330,
        panels,
    };
    Ok(chart.svg()?)
}

fn pressures(rollers: u32, title: &str) -> Result<String, Box<dyn Error>> {
    let pump = Pump::preset(rollers, Variant::Measured)?;
    let mut panels = Vec::new();
    for (rpm, label) in [(50.0, "50 r/min, kPa"), (100.0, "100 r/min, kPa"), (150.0, "150 r/min, kPa")] {
        let curve = |name, colour, port| {
            let pitch = pitch_kpa(&pump, port, rpm, POINTS)?;
            let twice = pitch.iter().chain(&pitch).chain(pitch.first());
            let points = twice.enumerate().map(|(n, kpa)| (n as f64 / f64::from(POINTS), *kpa)).collect();
            Ok::<_, Box<dyn Error>>(line(name, colour, points))
        };
        panels.push(Panel {
            label,
            curves: vec![curve("inlet", BLUE, Port::Inlet)?, curve("outlet", VERMILION, Port::Outlet)?],
        });
    }
    let chart =
        Chart { title, label: "angle, pitches", range: 0.0..2.0, mark: None, panel_height: 240, panels };
    Ok(chart.svg()?)
}
