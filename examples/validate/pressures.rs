//! Sets pressures beside their references: periodic steady states, start-up, and the paper's correlations.

use std::error::Error;

use pump_model::units::rad_s;
use pump_model::{ExactRun, Leg, Port, Pump, Variant};

use crate::page::Section;
use crate::paper::{MEASURED, PRESSURE_RESULTS, REFERENCE, START_KPA, STEADY_KPA};
use crate::row::{Bound, Row};

/// Returns max, min, mean of P_in, then of P_out, in the periodic steady state, kPa absolute.
pub(crate) fn steady_kpa(rollers: u32, rpm: f64) -> Result<[f64; 6], Box<dyn Error>> {
    let steady = Pump::preset(rollers, Variant::Measured)?.steady_state(rad_s(rpm))?;
    Ok([
        steady.inlet.max_kpa,
        steady.inlet.min_kpa,
        steady.inlet_mean_kpa,
        steady.outlet.max_kpa,
        steady.outlet.min_kpa,
        steady.outlet_mean_kpa,
    ])
}

/// Returns the pressure of a port over one pitch of the steady state from angle 0, at `count` equal steps,
/// kPa absolute.
pub(crate) fn pitch_kpa(pump: &Pump, port: Port, rpm: f64, count: u32) -> Result<Vec<f64>, Box<dyn Error>> {
    let state = pump.periodic_state(port, rad_s(rpm))?;
    let mut run = ExactRun::new(pump, port, [Leg::constant_speed(0.0, rad_s(rpm))], state);
    let pitch_s = pump.pitch_rad() / rad_s(rpm);
    Ok((0..count).map(|n| run.pressure_kpa(pitch_s * f64::from(n) / f64::from(count))).collect())
}

/// Returns the section of the page about pressures.
pub(crate) fn section() -> Result<Section, Box<dyn Error>> {
    const NAMES: [&str; 6] =
        ["P_in largest", "P_in smallest", "P_in mean", "P_out largest", "P_out smallest", "P_out mean"];
    let mut rows = Vec::new();
    for (rollers, rpm, compared) in STEADY_KPA {
        for ((compared, ours), name) in compared.into_iter().zip(steady_kpa(rollers, rpm)?).zip(NAMES) {
            let name = format!("{rollers} rollers, {rpm} r/min: {name}");
            rows.push(Row::computed(name, "kPa", (compared, REFERENCE), ours, Bound::Absolute(6e-5)));
        }
    }
    let pump = Pump::three_roller();
    let start =
        |port| ExactRun::from_rest(&pump, port, [Leg::constant_speed(0.0, rad_s(100.0))]).extremes(10.0);
    let (inlet, outlet) = (start(Port::Inlet), start(Port::Outlet));
    let ours = [inlet.min_kpa, inlet.max_kpa, outlet.min_kpa, outlet.max_kpa];
    let names = ["P_in smallest", "P_in largest", "P_out smallest", "P_out largest"];
    for ((compared, ours), name) in START_KPA.into_iter().zip(ours).zip(names) {
        let name = format!("3 rollers, from rest to 100 r/min at once: {name}");
        rows.push(Row::computed(name, "kPa", (compared, REFERENCE), ours, Bound::Absolute(6e-4)));
    }
    for measured in &MEASURED {
        for (port, compared) in ["inlet", "outlet"].into_iter().zip(measured.pearson) {
            let name = format!("{} rollers: mean Pearson correlation at the {port}", measured.rollers);
            rows.push(Row::unchecked(name, "", (compared, PRESSURE_RESULTS), "needs raw data"));
        }
    }
    rows.push(Row::unchecked(
        "Pearson correlation above 50 r/min, more than",
        "",
        (0.7, PRESSURE_RESULTS),
        "needs raw data",
    ));
    let before = "The paper draws measured waveforms (Figs. 15 and 16) and prints no numbers for them. The rows \
                  below only check that this code solves the model's equations correctly. The references were \
                  computed to 1e-4 kPa outside this code. Pressures are absolute. The extremes are true extremes, \
                  found between the samples. The paper solves the equations with ode15s in steps of at most h = \
                  0.001 s, and also samples the pulses at h (Section 2). This model solves them in closed \
                  form.\n\nThe paper states its correlations as means over all speeds in Section 5.2, and for each \
                  speed in Fig. 14. Section 5.2 calls the simulation less accurate at 10 to 40 r/min.\n\n";
    let after = "![Pressures at 50, 100 and 150 r/min, three rollers](validation/pressures-three.svg)\n\n\
                 ![Pressures at 50, 100 and 150 r/min, two rollers](validation/pressures-two.svg)\n";
    Ok(Section { title: "Pressures", before: before.into(), rows, after: after.into() })
}
