//! Lists the contradictions between the paper's figures, with the cost of each, and the figure that is used.

use std::error::Error;

use pump_model::metrics::{nrmse, rmse};
use pump_model::units::rad_s;
use pump_model::{Line, Port, Pump, Variant};

use crate::flow::{RPM, pulses};
use crate::line::HOSE;
use crate::paper::{DIMENSIONS, ENGAGEMENT_DEG, MEASURED, POINTS, POLYNOMIAL, ROLLER_ML};
use crate::pressures::pitch_kpa;
use crate::roller_volume::at;
use crate::row::figure;
use crate::volumes::Volumes;

/// Returns all contradictions as a Markdown list.
pub(crate) fn markdown() -> Result<String, Box<dyn Error>> {
    Ok([
        roller_volume()?,
        bulk_modulus(),
        times(),
        mean_flow()?,
        ten_samples()?,
        normaliser()?,
        dimensions()?,
    ]
    .map(|text| format!("- {text}\n"))
    .concat())
}

fn roller_volume() -> Result<String, Box<dyn Error>> {
    let [measured, published] =
        [Variant::Measured, Variant::Published].map(|variant| Pump::preset(3, variant));
    let (measured, published) = (measured?, published?);
    Ok(format!(
        "**V_r, {ROLLER_ML} mL against {} mL.** Table 1 says {ROLLER_ML}. The measured means end at {} mL, \
         the paper's polynomial has {} mL at phi, and the flow that a roller displaces adds up to {} mL. With \
         Table 1 a revolution of three rollers is {} mL. With the integral it is {} mL, {} % less. This model \
         uses the integral, so that pulses and volume per revolution agree. The variant `published` scales it \
         to {ROLLER_ML} mL.",
        figure(measured.roller_volume().total_ml(), 5),
        figure(POINTS[POINTS.len() - 1].1, 5),
        figure(at(&POLYNOMIAL, ENGAGEMENT_DEG), 5),
        figure(measured.roller_volume().total_ml(), 5),
        figure(published.revolution_ml(), 6),
        figure(measured.revolution_ml(), 6),
        figure(100.0 * (1.0 - measured.revolution_ml() / published.revolution_ml()), 2)
    ))
}

fn bulk_modulus() -> String {
    let compliance = Line::PUBLISHED.compliance_ml_kpa;
    let modulus_kpa = HOSE.volume_ml() / compliance;
    format!(
        "**C = 1/B_e.** 1/B_e is in 1/kPa, but C is in mL/kPa. The volume is missing: C = V_total/B_e = \
         dV/dP. The measured V_total is not available here. With the {} mL of our hose, C = {compliance} \
         mL/kPa is a B_e of {} kPa, and 1/B_e would be {} /kPa. This model uses C as printed, and V_total/B_e \
         wherever one follows from the other (`dose identify compliance`).",
        figure(HOSE.volume_ml(), 4),
        figure(modulus_kpa, 3),
        figure(1.0 / modulus_kpa, 3)
    )
}

fn times() -> String {
    let pulse_ms = |rpm: f64| 1000.0 * ENGAGEMENT_DEG / (6.0 * rpm);
    format!(
        "**470.4 ms for 42.1 ms.** The meaning of this time is not available here. A roller takes {} ms for \
         phi at 200 r/min and {} ms at 60 r/min. We infer that 42.1 ms is a pulse at 200 r/min. A pulse of \
         470.4 ms would be at {} r/min, a speed of which no test is known. This model uses neither, since \
         every time follows from the angles and the speed.",
        figure(pulse_ms(200.0), 4),
        figure(pulse_ms(RPM), 5),
        figure(ENGAGEMENT_DEG / (6.0 * 0.4704), 3)
    )
}

fn mean_flow() -> Result<String, Box<dyn Error>> {
    let pump = Pump::three_roller();
    let omega = rad_s(RPM);
    let nominal = pump.nominal_ml_rad() * omega;
    let taken_ml = pump.roller_volume().total_ml();
    let [pitch_s, ..] = pulses(&pump)?;
    let without = nominal - taken_ml;
    let with = nominal - taken_ml / pitch_s;
    let ours = pump.average_flow_ml_s(omega);
    Ok(format!(
        "**The mean flow without 1/T.** Q_nom less the integral of a pulse subtracts mL from mL/s. At {RPM} \
         r/min with three rollers Q_nom is {} mL/s and the integral {} mL. The mean flow is then {} mL/s \
         without the 1/T. With T = T1 it is {} mL/s, which is V_rot omega/(2 pi) = {} mL/s. The first is {} % \
         too much. This model uses the 1/T.",
        figure(nominal, 5),
        figure(taken_ml, 5),
        figure(without, 5),
        figure(with, 5),
        figure(ours, 5),
        figure(100.0 * (without / ours - 1.0), 3)
    ))
}

fn ten_samples() -> Result<String, Box<dyn Error>> {
    const FINE: u32 = 2000;
    const SAMPLES: usize = 10;
    let mut missed = Vec::new();
    for rpm in [50.0, 100.0, 150.0] {
        let kpa = pitch_kpa(&Pump::three_roller(), Port::Outlet, rpm, FINE)?;
        let largest = |of: &mut dyn Iterator<Item = f64>| of.fold(f64::NEG_INFINITY, f64::max);
        let whole = largest(&mut kpa.iter().copied());
        let stride = kpa.len() / SAMPLES;
        let worst = (0..stride)
            .map(|start| whole - largest(&mut kpa.iter().skip(start).step_by(stride).copied()))
            .fold(0.0, f64::max);
        missed.push(figure(worst, 2));
    }
    Ok(format!(
        "**Maxima of ten samples.** It is not available here which maxima the paper took of ten samples. A \
         maximum of samples is never above the true one. Ten equally spaced samples a pitch miss the largest \
         outlet pressure of three rollers by up to {} kPa at 50, 100, 150 r/min. The miss depends on where \
         the first sample falls. This model uses true extremes, found between the samples.",
        missed.join(", ")
    ))
}

fn normaliser() -> Result<String, Box<dyn Error>> {
    let mut texts = Vec::new();
    for measured in &MEASURED {
        let volumes = Volumes::of(measured.rollers, measured.fastest_rpm)?;
        let (rmse_ml, mean) = (rmse(volumes.pairs()), nrmse(volumes.pairs()));
        let range = volumes.rmse_over_range_percent();
        let (Some(rmse_ml), Some(mean), Some(range)) = (rmse_ml, mean, range) else {
            return Err("volumes have a mean and a range".into());
        };
        texts.push(format!(
            "{} mL with {} rollers, which is {} % of the mean and {} % of the range (published: {} %)",
            figure(rmse_ml, 3),
            measured.rollers,
            figure(100.0 * mean, 3),
            figure(range, 3),
            measured.nrmse_percent
        ));
    }
    Ok(format!(
        "**An NRMSE without its normaliser.** The paper does not name the divisor of the RMSE. The RMSE of \
         the linear model (V_r of {ROLLER_ML} mL) against the speed law is {}. This model uses the mean, \
         since it alone comes near the published figures.",
        texts.join(", and ")
    ))
}

fn dimensions() -> Result<String, Box<dyn Error>> {
    let differ: Vec<String> = DIMENSIONS
        .iter()
        .filter(|(_, _, table, code)| table != code)
        .map(|(name, unit, table, code)| format!("{name} {table} against {code} {unit}"))
        .collect();
    let mut texts = Vec::new();
    for measured in &MEASURED {
        let ml = |variant| {
            Ok::<_, Box<dyn Error>>(10.0 * Pump::preset(measured.rollers, variant)?.revolution_ml())
        };
        texts.push(format!(
            "{} rollers {} and {} mL (measured {} mL)",
            measured.rollers,
            figure(ml(Variant::Measured)?, 5),
            figure(ml(Variant::AsBuilt)?, 5),
            measured.ten_revolutions_ml
        ));
    }
    Ok(format!(
        "**Table 1 against the published code.** The dimensions differ: {}. Ten revolutions become: {}. This \
         model uses Table 1. The code's dimensions are the variant `as-built`. The code also samples the \
         pulses at 1 ms.",
        differ.join(", "),
        texts.join(", ")
    ))
}
