//! Sets dimensions, roller volume and engagement angle beside the paper's.

use std::error::Error;

use pump_model::units::{TURN_RAD, degrees};
use pump_model::{Geometry, Pump, Variant, VolumeFit, VolumePoint};

use crate::page::Section;
use crate::paper::{
    CODE, DIMENSIONS, ENGAGEMENT_DEG, POINTS, POLYNOMIAL, REFERENCE, ROLLER_ML, ROLLER_TEST, ROLLERS, TABLE_1,
};
use crate::row::{Bound, Row, figure};

/// Returns the measured points.
pub(crate) fn points() -> [VolumePoint; 15] {
    POINTS.map(|(angle_deg, volume_ml)| VolumePoint { angle_deg, volume_ml })
}

/// Returns the value of a polynomial at `x`, highest order first.
pub(crate) fn at(coefficients: &[f64; 6], x: f64) -> f64 {
    coefficients.iter().fold(0.0, |sum, c| sum * x + c)
}

/// Returns the section of the page about Table 1 and the dimensions of the authors' code.
pub(crate) fn dimensions() -> Result<Section, Box<dyn Error>> {
    let values = |variant| {
        let g = Geometry::published(3, variant);
        let beta_deg = degrees(g.contact_angle_rad);
        [
            g.bore_radius_mm,
            g.tube_outer_radius_mm,
            g.backplate_radius_mm,
            beta_deg,
            g.roller_radius_mm,
            g.roller_offset_mm,
        ]
    };
    let mut rows = Vec::new();
    for (pump, rollers) in [(Pump::three_roller(), 3.0), (Pump::two_roller(), 2.0)] {
        rows.push(Row::input(
            "number of rollers NU",
            "",
            (rollers, ROLLERS),
            f64::from(pump.geometry().rollers),
        ));
    }
    for (variant, source, name) in
        [(Variant::Measured, TABLE_1, ""), (Variant::AsBuilt, CODE, " (variant `as-built`)")]
    {
        for ((what, unit, table, code), ours) in DIMENSIONS.into_iter().zip(values(variant)) {
            let compared = if source == CODE { code } else { table };
            // A conversion from degrees to radians and back rounds the last bit.
            let bound = if unit == "deg" { Bound::Absolute(1e-12) } else { Bound::Equal };
            rows.push(Row::input(format!("{what}{name}"), unit, (compared, source), ours).bounded(bound));
        }
    }
    let pump = Pump::three_roller();
    let a = pump.nominal_ml_rad();
    rows.push(Row::computed(
        "a = pi r_i² (r_b - r_o)",
        "mL/rad",
        (4.3982297, REFERENCE),
        a,
        Bound::Absolute(5e-8),
    ));
    rows.push(Row::computed(
        "V_nom = 2 pi a",
        "mL",
        (27.63489, REFERENCE),
        TURN_RAD * a,
        Bound::Absolute(5e-6),
    ));
    Ok(Section { title: "Dimensions", before: String::new(), rows, after: String::new() })
}

/// Returns a table of our fit, mL/deg^n with the highest order first, beside each measured mean.
fn beside_the_means(found: &[f64; 6]) -> String {
    let mut text = String::from(
        "The paper measured seven times (Section 3.3) and draws the curve of V (Fig. 9). It prints neither points \
         nor coefficients. Its theta is the angle by which a roller is engaged, our x. The seven measurements' means \
         and the coefficients come from the data of the authors' code. This page rounds the means to seven decimals, \
         so a new fit differs from the coefficients by the deviations above. The table shows our fit beside each \
         mean, in mL:\n\n| x, deg | measured | fit | fit - measured |\n| --- | --- | --- | --- |\n",
    );
    for point in points() {
        let fitted = at(found, point.angle_deg);
        text += &format!(
            "| {} | {} | {} | {} |\n",
            point.angle_deg,
            point.volume_ml,
            figure(fitted, 5),
            figure(fitted - point.volume_ml, 2)
        );
    }
    text += "\n![Roller volume over angle: measured points, fit, drawing; fitted less measured]\
              (validation/roller-volume.svg)\n";
    text
}

/// Returns the section of the page about V(x), V_r and phi.
pub(crate) fn section() -> Result<Section, Box<dyn Error>> {
    let points = points();
    let fit = VolumeFit::quintic(&points)?;
    let found = fit.polynomial_ml_deg().ok_or("a quintic has a polynomial")?;
    let curve = *Pump::three_roller().roller_volume();
    let phi_deg = curve.engagement_deg();
    let mut rows = vec![
        Row::input("engagement angle phi", "deg", (ENGAGEMENT_DEG, ROLLER_TEST), phi_deg)
            .bounded(Bound::Absolute(1e-12)),
        Row::computed(
            "roller volume V_r, integral of g",
            "mL",
            (ROLLER_ML, TABLE_1),
            curve.total_ml(),
            Bound::Percent(2.3),
        ),
        Row::computed(
            "roller volume V_r, integral of g",
            "mL",
            (2.105466, REFERENCE),
            curve.total_ml(),
            Bound::Absolute(5e-7),
        ),
        Row::computed(
            "roller volume V_r against the largest measured mean",
            "mL",
            (POINTS[14].1, CODE),
            curve.total_ml(),
            Bound::Percent(0.1),
        ),
        Row::computed(
            "RMS of measured less fitted volumes",
            "mL",
            (0.0074, REFERENCE),
            fit.rms_ml(),
            Bound::Absolute(5e-5),
        ),
    ];
    for (order, (compared, ours)) in POLYNOMIAL.into_iter().zip(found).enumerate() {
        let name = format!("coefficient of x^{}, fitted again", 5 - order);
        rows.push(Row::computed(name, "mL/deg^n", (compared, CODE), ours, Bound::Percent(2e-3)));
    }
    let after = beside_the_means(&found);
    Ok(Section { title: "Roller volume", before: String::new(), rows, after })
}
