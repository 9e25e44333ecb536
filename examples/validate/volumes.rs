//! Sets the volume of ten revolutions over the speed side by side: measured mean, linear model and speed law.

use std::error::Error;

use libm::sqrt;
use pump_bench::built_in;
use pump_model::metrics::{nrmse, pearson, rmse};
use pump_model::units::rad_s;
use pump_model::{Pump, SpeedLaw, Variant};

use crate::page::Section;
use crate::paper::{FLOW_RESULTS, MEASURED, Measured, REFERENCE, TABLE_2};
use crate::row::{Bound, Row, figure};

/// Volumes of ten revolutions at the paper's speeds.
pub(crate) struct Volumes {
    pub rpm: Vec<f64>,
    /// Volume by the linear model with V_r as measured, mL. It does not depend on the speed.
    pub linear_ml: f64,
    /// Volume by the linear model with V_r of 2.06 mL, mL.
    pub published_ml: f64,
    /// Volume by the speed law at each speed, mL.
    pub law_ml: Vec<f64>,
    /// Largest inlet pressure of the steady state at each speed, kPa.
    pub inlet_max_kpa: Vec<f64>,
}

impl Volumes {
    /// Computes the volumes at every 10 r/min between two speeds, r/min.
    pub(crate) fn of(rollers: u32, slowest_rpm: u32, fastest_rpm: u32) -> Result<Self, Box<dyn Error>> {
        let pump = Pump::preset(rollers, Variant::Measured)?;
        let rpm: Vec<f64> = (slowest_rpm..=fastest_rpm).step_by(10).map(f64::from).collect();
        let law = |rpm: &f64| {
            Ok::<_, Box<dyn Error>>(10.0 * SpeedLaw::PUBLISHED.revolution_ml(&pump, rad_s(*rpm))?)
        };
        let peak = |rpm: &f64| Ok::<_, Box<dyn Error>>(pump.steady_state(rad_s(*rpm))?.inlet.max_kpa);
        Ok(Self {
            linear_ml: 10.0 * pump.revolution_ml(),
            published_ml: 10.0 * Pump::preset(rollers, Variant::Published)?.revolution_ml(),
            law_ml: rpm.iter().map(law).collect::<Result<_, _>>()?,
            inlet_max_kpa: rpm.iter().map(peak).collect::<Result<_, _>>()?,
            rpm,
        })
    }

    /// Returns the linear model (V_r of 2.06 mL) beside the law, mL.
    pub(crate) fn pairs(&self) -> impl Iterator<Item = (f64, f64)> + Clone {
        self.law_ml.iter().map(|law_ml| (self.published_ml, *law_ml))
    }

    /// Returns the mean of the law over the speeds, mL.
    pub(crate) fn law_mean_ml(&self) -> f64 {
        self.law_ml.iter().sum::<f64>() / self.law_ml.len() as f64
    }

    /// Returns the largest deviation of the linear model from the law, %.
    pub(crate) fn largest_percent(&self) -> f64 {
        self.pairs().map(|(linear, law)| 100.0 * (linear / law - 1.0).abs()).fold(0.0, f64::max)
    }

    /// Returns the RMSE of the linear model against the law, over the range of the law, %.
    pub(crate) fn rmse_over_range_percent(&self) -> Option<f64> {
        let (low, high) = self
            .law_ml
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), ml| (low.min(*ml), high.max(*ml)));
        Some(100.0 * rmse(self.pairs())? / (high - low))
    }
}

/// Adds the rows of one pump, and returns the text about its scatter.
fn rows(measured: &Measured, rows: &mut Vec<Row>) -> Result<String, Box<dyn Error>> {
    let Measured { rollers, fastest_rpm, ten_revolutions_ml, nrmse_percent, largest_percent, .. } = *measured;
    let volumes = Volumes::of(rollers, 10, fastest_rpm)?;
    let name = |what: &str| format!("{rollers} rollers: {what}");
    let file = built_in(if rollers == 3 { "three-roller" } else { "two-roller" }).ok_or("it is built in")?;
    let fastest = (f64::from(fastest_rpm), TABLE_2);
    rows.push(Row::input(
        name("fastest speed of the flow tests"),
        "r/min",
        fastest,
        file.motor.max_speed_rpm,
    ));
    let mean = (ten_revolutions_ml, FLOW_RESULTS);
    rows.push(Row::computed(
        name(&format!("ten revolutions, mean over 10 to {fastest_rpm} r/min, linear model")),
        "mL",
        mean,
        volumes.linear_ml,
        Bound::Percent(1.1),
    ));
    rows.push(Row::computed(
        name(&format!(
            "ten revolutions, mean over 10 to {fastest_rpm} r/min, linear model with V_r of 2.06 mL"
        )),
        "mL",
        mean,
        volumes.published_ml,
        Bound::Percent(1.5),
    ));
    let bias_percent = 100.0 * (volumes.published_ml / ten_revolutions_ml - 1.0);
    rows.push(Row::computed(
        name("deviation of the mean with V_r of 2.06 mL, a lower bound of the NRMSE"),
        "%",
        (nrmse_percent, FLOW_RESULTS),
        bias_percent,
        Bound::AtMost,
    ));
    rows.push(Row::unchecked(
        name(if rollers == 3 {
            "NRMSE of the linear model against V_avg_3r, the average of the three-roller tests"
        } else {
            "NRMSE of the linear model"
        }),
        "%",
        (nrmse_percent, FLOW_RESULTS),
        "needs raw data",
    ));
    rows.push(Row::unchecked(
        name("largest deviation of the linear model, roughly"),
        "%",
        (largest_percent, FLOW_RESULTS),
        "needs raw data",
    ));
    law_rows(measured, &volumes, rows)?;
    let scatter = sqrt(nrmse_percent * nrmse_percent - bias_percent * bias_percent);
    Ok(format!(
        "With {rollers} rollers the published NRMSE is {nrmse_percent} %, and our mean deviates by {} %. The \
         difference leaves {} % of scatter over the speeds. ",
        figure(bias_percent, 3),
        figure(scatter, 3)
    ))
}

/// Adds the rows of the speed law for one pump.
fn law_rows(measured: &Measured, volumes: &Volumes, rows: &mut Vec<Row>) -> Result<(), Box<dyn Error>> {
    let Measured { rollers, ten_revolutions_ml, nrmse_percent, largest_percent, .. } = *measured;
    let name = |what: &str| format!("{rollers} rollers: {what}");
    let mean = (ten_revolutions_ml, FLOW_RESULTS);
    let (law_mean, law_nrmse, law_correlation) =
        if rollers == 3 { (211.37, 1.90, 0.87) } else { (232.35, 2.01, 0.97) };
    let law_percent = 100.0 * nrmse(volumes.pairs()).ok_or("volumes have a mean")?;
    rows.push(
        Row::computed(name("speed law, mean"), "mL", mean, volumes.law_mean_ml(), Bound::Percent(0.6))
            .fitted(),
    );
    rows.push(Row::computed(
        name("speed law, mean"),
        "mL",
        (law_mean, REFERENCE),
        volumes.law_mean_ml(),
        Bound::Absolute(0.006),
    ));
    rows.push(
        Row::computed(
            name("NRMSE of the linear model with V_r of 2.06 mL against the speed law"),
            "%",
            (nrmse_percent, FLOW_RESULTS),
            law_percent,
            Bound::Absolute(0.5),
        )
        .fitted(),
    );
    rows.push(Row::computed(
        name("NRMSE of the linear model with V_r of 2.06 mL against the speed law"),
        "%",
        (law_nrmse, REFERENCE),
        law_percent,
        Bound::Absolute(0.006),
    ));
    rows.push(Row::computed(
        name(
            "largest deviation of the linear model with V_r of 2.06 mL from the speed law (the published one is not \
             reproduced)",
        ),
        "%",
        (largest_percent, FLOW_RESULTS),
        volumes.largest_percent(),
        Bound::Open,
    ));
    let pairs = volumes.law_ml.iter().copied().zip(volumes.inlet_max_kpa.iter().copied());
    rows.push(Row::computed(
        name("correlation of the speed law's volume with the largest inlet pressure"),
        "",
        (law_correlation, REFERENCE),
        pearson(pairs).ok_or("pressures differ")?,
        Bound::Absolute(0.006),
    ));
    Ok(())
}

/// Returns the section of the page about volumes.
pub(crate) fn section() -> Result<Section, Box<dyn Error>> {
    let mut all = Vec::new();
    let mut after = String::new();
    for measured in &MEASURED {
        after += &rows(measured, &mut all)?;
    }
    all.push(Row::unchecked(
        "standard deviation at room temperature under 160 r/min, less than",
        "mL",
        (1.0, FLOW_RESULTS),
        "needs raw data",
    ));
    let [three, _] = &MEASURED;
    let uncertainty = built_in("three-roller").ok_or("it is built in")?.uncertainty;
    all.push(
        Row::computed(
            "NRMSE of three rollers, as the built-in pumps' uncertainty of the model",
            "%",
            (three.nrmse_percent, FLOW_RESULTS),
            uncertainty.model_percent,
            Bound::Absolute(0.05),
        )
        .taken(),
    );
    all.push(
        Row::computed(
            "largest standard deviation under 160 r/min, as the built-in pumps' repeatability",
            "mL",
            (1.0, FLOW_RESULTS),
            1e-2 * uncertainty.repeatability_percent * three.ten_revolutions_ml,
            Bound::Percent(0.2),
        )
        .taken(),
    );
    after += "The paper draws the volumes at each speed (Fig. 12) and prints no numbers for them. The picture \
              therefore shows only the mean of the measured volumes.\n\n![Volume of ten revolutions over speed: \
              measured mean, linear model, speed law](validation/volumes.svg)\n";
    let before = "The linear model gives the same volume of a revolution at every speed. In the speed law, the \
                  volume of a segment of tube depends on the inlet pressure at the moment when a roller cuts the \
                  segment off. The law's two parameters were fitted to the published means, NRMSE and deviations. \
                  Its agreement with them is therefore no evidence. The NRMSE here is relative to the mean.\n\nThe \
                  built-in pumps turn no faster than in the paper's flow tests (Table 2). The paper's pressure tests \
                  reach 200 r/min. The paper says that it uses the largest of ten volumes for each speed, see \
                  [below](#where-the-paper-contradicts-itself).\n\n";
    Ok(Section { title: "Volume against speed", before: before.into(), rows: all, after })
}
