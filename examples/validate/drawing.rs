//! Sets the roller volume from the drawing alone beside the measured one.

use std::error::Error;

use pump_model::metrics::rmse;
use pump_model::units::{degrees, radians};
use pump_model::{Drawing, Geometry, Line, Pump, RollerVolume, Variant};

use crate::page::Section;
use crate::paper::{CODE, FLOW_RESULTS, MEASURED, POINTS, REFERENCE};
use crate::row::{Bound, Row};

/// Returns the section of the page about drawings.
pub(crate) fn section() -> Result<Section, Box<dyn Error>> {
    let mut rows = Vec::new();
    // The references are full contact and closure, deg, and the deviation of V(50.53 deg) from the measured
    // volume, %. The last two are the RMSE over the points and V_r of the whole arc, mL.
    for (variant, name, [contact, closure, end, rms, arc]) in [
        (Variant::Measured, "Table 1", [66.8, 30.69, 2.6, 0.030, 2.2267]),
        (Variant::AsBuilt, "as built", [66.1, 32.91, -2.3, 0.060, 2.1147]),
    ] {
        let drawing = Drawing::new(&Geometry::published(3, variant))?;
        let reference = |value| (value, REFERENCE);
        let row = |what: &str, unit, compared, ours, bound| {
            Row::computed(format!("{name}: {what}"), unit, reference(compared), ours, Bound::Absolute(bound))
        };
        let (end_deg, end_ml) = POINTS[POINTS.len() - 1];
        let at_end_ml = drawing.volume_ml(radians(end_deg));
        let pairs = POINTS.iter().map(|(deg, ml)| (drawing.volume_ml(radians(*deg)), *ml));
        rows.push(row("full contact", "deg", contact, degrees(drawing.engagement_rad()), 0.05));
        rows.push(row("lumen closed", "deg", closure, degrees(drawing.closure_rad()), 0.005));
        let name_end = format!("{name}: V(50.53 deg)");
        rows.push(Row::computed(name_end, "mL", (end_ml, CODE), at_end_ml, Bound::Percent(2.65)));
        rows.push(row("deviation of V(50.53 deg)", "%", end, 100.0 * (at_end_ml / end_ml - 1.0), 0.05));
        let ours = rmse(pairs).ok_or("there are points")?;
        rows.push(row("RMSE over the measured points", "mL", rms, ours, 6e-4));
        rows.push(row("V_r of the whole arc", "mL", arc, drawing.volume_ml(drawing.engagement_rad()), 5e-5));
        for measured in &MEASURED {
            let geometry = Geometry::published(measured.rollers, variant);
            let volume = RollerVolume::from_drawing(&geometry)?;
            let ours = 10.0 * Pump::new(geometry, volume, Line::PUBLISHED, Line::PUBLISHED)?.revolution_ml();
            let name = format!("{name}: ten revolutions, {} rollers", measured.rollers);
            rows.push(Row::computed(
                name,
                "mL",
                (measured.ten_revolutions_ml, FLOW_RESULTS),
                ours,
                Bound::Percent(1.405),
            ));
        }
    }
    rows.push(Row::unchecked(
        "V(50.53 deg) by the authors' straight tube that becomes an ellipse, deviation",
        "%",
        (-11.0, REFERENCE),
        "not computed here",
    ));
    let before = "The paper leaves it to later work to find the roller volume without a measurement (Section 6). The \
                  rows below compute it from the drawing alone. They use no measured volume.\n\n";
    Ok(Section { title: "Roller volume from the drawing", before: before.into(), rows, after: String::new() })
}
