//! Lists the contradictions between the paper's figures, with the cost of each, and the figure that is used.

use std::error::Error;

use libm::{erf, pow, sqrt};
use pump_model::metrics::{nrmse, rmse};
use pump_model::units::rad_s;
use pump_model::{Line, Pump, Variant};

use crate::flow::{RPM, pulses};
use crate::line::HOSE;
use crate::paper::{DIMENSIONS, ENGAGEMENT_DEG, MEASURED, POINTS, POLYNOMIAL, ROLLER_ML};
use crate::roller_volume::at;
use crate::row::figure;
use crate::volumes::Volumes;

/// Returns all contradictions as a Markdown list.
pub(crate) fn markdown() -> Result<String, Box<dyn Error>> {
    Ok([
        roller_volume()?,
        bulk_modulus(),
        times(),
        interpolation(),
        mean_flow()?,
        largest_of_ten(),
        normaliser()?,
        angle_steps(),
        pressure_speeds(),
        conclusion(),
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
        "**V_r, {ROLLER_ML} mL against {} mL (Table 1 and Eq. 11 against Fig. 9).** Table 1 gives {ROLLER_ML} mL for \
         Eq. 11. The measured means of the authors' code end at {} mL. The polynomial through them, whose curve \
         Fig. 9 draws, has {} mL at phi. The flow that a roller displaces adds up to {} mL. By Table 1 a revolution \
         of three rollers delivers {} mL. By the integral it delivers {} mL, {} % less. This \
         model \
         uses the integral, so that the pulses agree with the volume per revolution. The variant `published` scales \
         it \
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
        "**C = 1/B_e (Eq. 21 against Table 3).** 1/B_e is in 1/kPa, but C is in mL/kPa in Table 3. The volume is \
         missing: by Eq. 20, C = V_total/B_e = dV/dP. Section 4.2 describes V_total, before Eq. 21, as the volume of \
         the inlet line and the syringe, and states no value. With the {} mL of our hose, C = {compliance} mL/kPa \
         means a B_e of {} kPa, and 1/B_e would be {} /kPa. This model uses C as printed, and V_total/B_e \
         wherever one follows from the other (`dose identify compliance`).",
        figure(HOSE.volume_ml(), 4),
        figure(modulus_kpa, 3),
        figure(1.0 / modulus_kpa, 3)
    )
}

fn times() -> String {
    let pulse_ms = |rpm: f64| 1000.0 * ENGAGEMENT_DEG / (6.0 * rpm);
    format!(
        "**470.4 ms for 42.1 ms (Section 4.2).** The paper expects the motor to take 470.4 ms for the \
         {ENGAGEMENT_DEG} \
         deg of phi at 200 r/min. It takes {} ms. A time of 470.4 ms belongs to {} r/min, at which no test ran. \
         Samples every 0.2 ms are enough for both times. The paper also calls the sensors' response time of 2 ms \
         short enough: it is {} % of the 42.11 ms, and {} % of the 470.4 ms. This model uses neither time, because \
         every time follows from the angles and the speed.",
        figure(pulse_ms(200.0), 4),
        figure(ENGAGEMENT_DEG / (6.0 * 0.4704), 3),
        figure(200.0 / pulse_ms(200.0), 2),
        figure(200.0 / 470.4, 2)
    )
}

fn interpolation() -> String {
    "**A cubic of the fifth order (Section 2.1.2 and Fig. 9).** The paper says that the volume of a roller is \
         cubically interpolated as a polynomial of the fifth order. Fig. 9 calls its curve a cubically interpolated \
         polynomial. A cubic has four coefficients, but the authors' code has six. They are a least-squares fit, \
         which passes through none of the means. This model uses the six."
        .to_owned()
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
        "**The mean flow without 1/T (Eq. 13).** Eq. 13 takes the integral of a pulse from Q_nom, that is mL from \
         mL/s. At {RPM} \
         r/min with three rollers Q_nom is {} mL/s and the integral {} mL. Without the 1/T the mean flow is then {} \
         mL/s. With T = T1 it is {} mL/s, which equals V_rot omega/(2 pi) = {} mL/s. The first is {} % too high. \
         This model uses the 1/T.",
        figure(nominal, 5),
        figure(taken_ml, 5),
        figure(without, 5),
        figure(with, 5),
        figure(ours, 5),
        figure(100.0 * (without / ours - 1.0), 3)
    ))
}

/// Returns the mean of the largest of `count` samples of the standard normal distribution: the integral over x
/// above 0 of 1 - Phi(x)^n - Phi(-x)^n.
fn mean_of_largest(count: f64) -> f64 {
    const STEP: f64 = 1e-3;
    let below = |x: f64| 0.5 * (1.0 + erf(x / sqrt(2.0)));
    let rest = |x: f64| 1.0 - pow(below(x), count) - pow(below(-x), count);
    // Beyond 10 the rest is below 1e-22.
    (0..10_000).map(|n| STEP * rest(STEP * (f64::from(n) + 0.5))).sum()
}

fn largest_of_ten() -> String {
    let [three, _] = &MEASURED;
    let bias = mean_of_largest(10.0);
    format!(
        "**Largest of ten volumes (Section 5.1).** The paper measured ten volumes at each speed, and says that it \
         used the largest. Yet the NRMSE of three rollers refers to an average of the three-roller tests, V_avg_3r. \
         The paper does not say if this average is over the largest volumes or over all. On average, the largest of \
         ten normal samples lies {} standard deviations above their mean. The standard deviations \
         are below 1 mL at room temperature under 160 r/min. The largest volume is then too large by up to {} mL, \
         which is {} % of {} mL. This page compares with the published figures as they are.",
        figure(bias, 3),
        figure(bias, 3),
        figure(100.0 * bias / three.ten_revolutions_ml, 2),
        three.ten_revolutions_ml
    )
}

fn angle_steps() -> String {
    const STEP_DEG: f64 = 3.63;
    let steps = POINTS.windows(2).map(|pair| pair[1].0 - pair[0].0);
    let (low, high) =
        steps.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), step| (low.min(step), high.max(step)));
    format!(
        "**Steps of {STEP_DEG} deg to {ENGAGEMENT_DEG} deg (Section 3.3).** The paper says that the motor turns by \
         {STEP_DEG} deg at a time up to {ENGAGEMENT_DEG} deg, which makes {} steps. The data of the authors' code \
         have {} steps of {} to {} deg. This model uses the angles of the data.",
        figure(ENGAGEMENT_DEG / STEP_DEG, 4),
        POINTS.len() - 1,
        figure(low, 3),
        figure(high, 3)
    )
}

fn pressure_speeds() -> String {
    let [three, two] = &MEASURED;
    format!(
        "**Speeds of the pressure tests (Section 4.1 against Table 2).** The paper says that the pressure tests go \
         from 10 to 200 r/min, like the flow rate tests. Table 2 gives 200 r/min for PT1 and PT2, but {} r/min for \
         the flow tests of three rollers and {} r/min for that of two. This page repeats each test over the speeds \
         of Table 2.",
        three.fastest_rpm, two.fastest_rpm
    )
}

fn conclusion() -> String {
    "**Number of the conclusion (Section 1).** The paper announces the conclusion as Section 7. It is Section 6, and \
         this page cites it so."
        .to_owned()
}

fn normaliser() -> Result<String, Box<dyn Error>> {
    let mut texts = Vec::new();
    for measured in &MEASURED {
        let volumes = Volumes::of(measured.rollers, 10, measured.fastest_rpm)?;
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
        "**An NRMSE without its normaliser (Section 5).** Section 5 names the NRMSE, and Section 5.1 states two \
         values. Neither says by what the RMSE is divided. The RMSE of \
         the linear model (V_r of {ROLLER_ML} mL) against the speed law is {}. This model divides by the mean, \
         because only that comes close to the published figures.",
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
         model uses Table 1. The code's dimensions are the variant `as-built`.",
        differ.join(", "),
        texts.join(", ")
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_largest_of_ten_normal_samples_is_half_again_a_standard_deviation_above_their_mean() {
        // H. Leon Harter, Biometrika 48 (1961) 151-165, Table 1: 0.56419 of two, 1.53875 of ten.
        assert!((mean_of_largest(2.0) - 0.56419).abs() < 5e-6, "{}", mean_of_largest(2.0));
        assert!((mean_of_largest(10.0) - 1.53875).abs() < 5e-6, "{}", mean_of_largest(10.0));
    }
}
