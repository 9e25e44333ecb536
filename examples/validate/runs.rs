//! Repeats the paper's tests as runs of the model, each by its name.

use std::error::Error;

use pump_model::units::rad_s;
use pump_model::{Line, Pump, Variant, VolumeFit};

use crate::line::{HOSE, water};
use crate::paper::MEASURED;
use crate::pressures::steady_kpa;
use crate::roller_volume::points;
use crate::row::figure;
use crate::volumes::Volumes;

/// A test of the paper.
struct Test {
    name: &'static str,
    /// Assumption about the quantity that the test measured.
    assumed: &'static str,
    run: fn() -> Result<String, Box<dyn Error>>,
}

const TESTS: [Test; 7] = [
    Test { name: "FT1", assumed: "roller volume over angle, 15 angles to phi", run: roller_volume },
    Test {
        name: "FT2",
        assumed: "volume of ten revolutions, three rollers, 10 to 170 r/min",
        run: || volumes(0),
    },
    Test {
        name: "FT3",
        assumed: "volume of ten revolutions, two rollers, 10 to 300 r/min",
        run: || volumes(1),
    },
    Test { name: "FT4", assumed: "resistance of the line, R = dP/Q at steady flows", run: resistance },
    Test { name: "FT5", assumed: "compliance of the line, C = V_total/B_e = dV/dP", run: compliance },
    Test { name: "PT1", assumed: "pressures at inlet and outlet, three rollers", run: || pressures(3, 170) },
    Test { name: "PT2", assumed: "pressures at inlet and outlet, two rollers", run: || pressures(2, 300) },
];

/// Returns the results of a test as a table, or an error if no test has this name.
pub(crate) fn run(name: &str) -> Result<String, Box<dyn Error>> {
    let Some(test) = TESTS.iter().find(|test| test.name.eq_ignore_ascii_case(name)) else {
        let names = TESTS.map(|test| test.name).join(", ");
        return Err(format!("no test is named {name:?}; allowed: {names}").into());
    };
    Ok(format!("{} (assumed: {})\n\n{}", test.name, test.assumed, (test.run)()?))
}

/// Returns the tests and their commands as Markdown.
pub(crate) fn markdown() -> String {
    let mut text = String::from(
        "The paper names its tests FT1 to FT5, PT1 and PT2. Their definitions could not be looked up. The \
         assignment below is ours, one test for each quantity that the paper is known to have measured. A run \
         prints the model's results.\n\n| test | assumed to be | command |\n| --- | --- | --- |\n",
    );
    for Test { name, assumed, .. } in TESTS {
        text += &format!("| {name} | {assumed} | `cargo run --example validate -- {name}` |\n");
    }
    text + "\nThis command gives the waveform of PT1, every millisecond, with a plot: `dose simulate --speed \
            100rpm --duration 10s --trace pt1.csv --plot pt1.svg`. Add `--pump two-roller` for PT2.\n"
}

fn roller_volume() -> Result<String, Box<dyn Error>> {
    let points = points();
    let fit = VolumeFit::quintic(&points)?;
    let mut text = String::from("theta_deg  measured_ml  fit_ml\n");
    for (point, residual) in points.iter().zip(fit.residuals_ml()) {
        text += &format!(
            "{:9.2}  {:11.7}  {:6.4}\n",
            point.angle_deg,
            point.volume_ml,
            point.volume_ml + residual
        );
    }
    Ok(text)
}

fn volumes(number: usize) -> Result<String, Box<dyn Error>> {
    let measured = &MEASURED[number];
    let volumes = Volumes::of(measured.rollers, measured.fastest_rpm)?;
    let mut text = format!(
        "measured mean {} mL\nspeed_rpm  time_s  linear_ml  speed_law_ml\n",
        measured.ten_revolutions_ml
    );
    for (rpm, law_ml) in volumes.rpm.iter().zip(&volumes.law_ml) {
        // t_test = Rev/(N/60), McIntyre et al.
        let time_s = 10.0 / (rpm / 60.0);
        text += &format!("{rpm:9}  {time_s:6.2}  {:9.3}  {law_ml:12.3}\n", volumes.linear_ml);
    }
    Ok(text)
}

fn resistance() -> Result<String, Box<dyn Error>> {
    let friction = HOSE.friction(&water()?)?;
    let r = Line::PUBLISHED.resistance_kpa_s_ml;
    let mut text = String::from("flow_ml_s  Reynolds  line_kpa  hose_kpa  hose_R\n");
    for flow_ml_s in [3.5, 10.0, 20.0, 35.0, 60.0, 100.0, 150.0, 210.0] {
        text += &format!(
            "{flow_ml_s:9}  {:8.0}  {:8.4}  {:8.4}  {:6.4}\n",
            friction.reynolds(flow_ml_s),
            r * flow_ml_s,
            friction.drop_kpa(flow_ml_s),
            friction.resistance_kpa_s_ml(flow_ml_s)
        );
    }
    Ok(text)
}

fn compliance() -> Result<String, Box<dyn Error>> {
    let total_ml = HOSE.volume_ml();
    let mut text = format!(
        "V_total {} mL (the hose of section Lines)\n         C_ml_kpa  B_e_kpa\n",
        figure(total_ml, 5)
    );
    for (name, c) in
        [("measured", Line::PUBLISHED.compliance_ml_kpa), ("hose", HOSE.compliance_ml_kpa(&water()?))]
    {
        text += &format!("{name:8} {c:9.4} {:8.1}\n", total_ml / c);
    }
    Ok(text)
}

fn pressures(rollers: u32, fastest_rpm: u32) -> Result<String, Box<dyn Error>> {
    let pump = Pump::preset(rollers, Variant::Measured)?;
    let mut text =
        String::from("speed_rpm  flow_ml_s  in_max  in_min  in_mean  out_max  out_min  out_mean\n");
    for n in 1..=fastest_rpm / 10 {
        let rpm = f64::from(10 * n);
        let [in_max, in_min, in_mean, out_max, out_min, out_mean] = steady_kpa(rollers, rpm)?;
        let flow_ml_s = pump.average_flow_ml_s(rad_s(rpm));
        text += &format!(
            "{rpm:9}  {flow_ml_s:9.3}  {in_max:6.2}  {in_min:6.2}  {in_mean:7.2}  {out_max:7.2}  \
             {out_min:7.2}  {out_mean:8.2}\n"
        );
    }
    Ok(text + "kPa absolute, periodic steady state\n")
}
