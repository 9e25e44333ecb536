//! Sets the lines beside the paper's: R, C and L, their consequences, and a hose with these values.

use std::error::Error;

use libm::{log, sqrt};
use pump_model::units::TURN_RAD;
use pump_model::{Fluid, Hose, Line, paper};

use crate::page::Section;
use crate::paper::{
    CODE, COMPLIANCE_TEST, DENSITIES, INERTANCE_TEST, LINE, REFERENCE, RESISTANCE_TEST, TABLE_3, WATER,
};
use crate::row::{Bound, Row};

/// Hose that meets R and L of the paper's line. Its bore is that of the pump's tube. Length and K are chosen.
/// The modulus of 3.5 MPa and nu = 0.5 are those of silicone rubber.
pub(crate) const HOSE: Hose = Hose {
    bore_radius_mm: 5.0,
    outer_radius_mm: 7.0,
    length_mm: 331.0,
    modulus_mpa: 3.5,
    poisson_ratio: 0.5,
    minor_loss: 5.75,
};

/// Returns the paper's water: 997 kg/m³ at 25 °C.
pub(crate) fn water() -> Result<Fluid, Box<dyn Error>> {
    let (degc, density_kg_m3) = WATER[0];
    Ok(Fluid { density_kg_m3, ..Fluid::water(degc)? })
}

/// Returns the section of the page about lines.
pub(crate) fn section() -> Result<Section, Box<dyn Error>> {
    let line = Line::PUBLISHED;
    let ours =
        [line.reservoir_kpa, line.resistance_kpa_s_ml, line.compliance_ml_kpa, line.inertance_kpa_s2_ml];
    let reference = |value| (value, REFERENCE);
    let mut rows = Vec::new();
    for ((name, unit, table, code), ours) in LINE.into_iter().zip(ours) {
        rows.push(Row::input(name, unit, (table, TABLE_3), ours));
        rows.push(Row::computed(name, unit, (code, CODE), ours, Bound::Percent(0.03)));
    }
    // 997 kg/m³ and 9.80665 m/s² over 0.3 m are 2.933 kPa.
    rows.push(
        Row::computed(
            "ambient pressure P_atm, P_res less 30 cm of water",
            "kPa",
            reference(85.704),
            paper::AMBIENT_KPA,
            Bound::Absolute(5e-3),
        )
        .taken(),
    );
    let damping = line.damping_ratio();
    let hertz = line.natural_rad_s() * sqrt(1.0 - damping * damping) / TURN_RAD;
    let decay = line.slowest_decay_per_s();
    rows.push(Row::computed("damped frequency", "Hz", reference(12.75), hertz, Bound::Absolute(5e-3)));
    rows.push(Row::computed("damping ratio", "", reference(0.162), damping, Bound::Absolute(5e-4)));
    rows.push(Row::computed("decay R/2L", "1/s", reference(13.19), decay, Bound::Absolute(5e-3)));
    let fall_s = log(1000.0) / decay;
    rows.push(Row::computed("fall to 0.1 %", "s", reference(0.52), fall_s, Bound::Absolute(5e-3)));
    rows.extend(hose_rows(&line)?);
    for (degc, compared) in WATER {
        let ours = Fluid::water(degc)?.density_kg_m3;
        let name = format!("density of water at {degc} °C");
        rows.push(Row::computed(name, "kg/m³", (compared, DENSITIES), ours, Bound::Percent(0.03)));
    }
    rows.push(Row::missing("points (flow, pressure) behind R", RESISTANCE_TEST, "needs raw data"));
    rows.push(Row::missing("points (volume, pressure) behind C", COMPLIANCE_TEST, "needs raw data"));
    rows.push(Row::missing("waveform at 100 r/min behind L", INERTANCE_TEST, "needs raw data"));
    let before = "The hose is our own. We chose its bore of 10 mm, its length of 0.331 m and its K = 5.75 so that it \
                  has the paper's L, and the paper's R at 210 mL/s. The paper measured R at roughly 210 mL/s \
                  (Section 5.2) with a kinetic pump over one minute (Section 4.2). Its inlet and outlet lines have \
                  equal dimensions (Section 4.1). The paper states neither a length nor a Reynolds number.\n\nThe \
                  paper does not state the ambient pressure either. We compute it from P_res (Table 3), which \
                  includes the water in the reservoir (Section 2), and from the level of 30 cm (Section 4.1).\n\n";
    let after = "The authors found R from flows and pressures (Eq. 17), C with a syringe (Eqs. 20 and 21), and L \
                 from the simulation closest to the test at 100 r/min (Section 4.2). `dose identify` finds them from \
                 your data by the same methods ([identification.md](identification.md)).\n";
    Ok(Section { title: "Lines", before: before.into(), rows, after: after.into() })
}

/// Returns the rows of a hose that makes the paper's line.
fn hose_rows(line: &Line) -> Result<Vec<Row>, Box<dyn Error>> {
    let reference = |value| (value, REFERENCE);
    let water = water()?;
    let mut rows = Vec::new();
    let friction = HOSE.friction(&water)?;
    let bound = Bound::Percent(1.1);
    rows.push(
        Row::computed(
            "L of the hose",
            "kPa s²/mL",
            (line.inertance_kpa_s2_ml, TABLE_3),
            HOSE.inertance_kpa_s2_ml(&water),
            Bound::Percent(0.1),
        )
        .fitted(),
    );
    for (flow_ml_s, compared) in [(3.5, 0.0028), (35.0, 0.020)] {
        let ours = friction.resistance_kpa_s_ml(flow_ml_s);
        let name = format!("R of the hose at {flow_ml_s} mL/s");
        rows.push(Row::computed(name, "kPa s/mL", reference(compared), ours, bound));
    }
    rows.push(
        Row::computed(
            "R of the hose at 210 mL/s",
            "kPa s/mL",
            (line.resistance_kpa_s_ml, TABLE_3),
            friction.resistance_kpa_s_ml(210.0),
            Bound::Percent(0.1),
        )
        .fitted(),
    );
    for flow_ml_s in [3.5, 35.0, 210.0] {
        let name = format!("Reynolds number in the hose at {flow_ml_s} mL/s");
        rows.push(Row::ours(name, "", friction.reynolds(flow_ml_s)));
    }
    rows.push(Row::computed(
        "C of the hose, thick wall",
        "mL/kPa",
        reference(0.0455),
        HOSE.compliance_ml_kpa(&water),
        Bound::Absolute(5e-5),
    ));
    rows.push(Row::computed(
        "C of the hose against the measured C",
        "mL/kPa",
        (line.compliance_ml_kpa, TABLE_3),
        HOSE.compliance_ml_kpa(&water),
        Bound::Percent(27.0),
    ));
    Ok(rows)
}
