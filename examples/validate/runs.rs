//! Repeats the paper's tests as runs of the model, each by its name.

use std::error::Error;

use pump_model::units::rad_s;
use pump_model::{Line, Pump, Variant, VolumeFit};

use crate::line::{HOSE, water};
use crate::paper::{MEASURED, WATER};
use crate::pressures::steady_kpa;
use crate::roller_volume::points;
use crate::row::figure;
use crate::volumes::Volumes;

/// Order of the speeds of a test.
#[derive(Clone, Copy)]
enum Order {
    /// Rising, S in Table 2.
    Systematic,
    /// Random, R in Table 2.
    Random,
}

/// Quantity that a test measures.
#[derive(Clone, Copy)]
enum Quantity {
    /// Volume of ten revolutions at each speed.
    Volume,
    /// Pressures at inlet and outlet, some 10 s at each speed.
    Pressures,
}

/// A test of the paper's Table 2. Its speeds rise by 10 r/min (Section 4.1).
struct Test {
    name: &'static str,
    quantity: Quantity,
    rollers: u32,
    /// Temperature of the water, °C, and its density, kg/m³.
    water: (f64, f64),
    slowest_rpm: u32,
    fastest_rpm: u32,
    order: Order,
}

#[rustfmt::skip]
const TESTS: [Test; 7] = {
    use Order::{Random, Systematic};
    use Quantity::{Pressures, Volume};
    const fn test(
        name: &'static str,
        quantity: Quantity,
        rollers: u32,
        water: (f64, f64),
        [slowest_rpm, fastest_rpm]: [u32; 2],
        order: Order,
    ) -> Test {
        Test { name, quantity, rollers, water, slowest_rpm, fastest_rpm, order }
    }
    [
        test("FT1", Volume, 3, WATER[0], [10, 170], Systematic),
        test("FT2", Volume, 3, WATER[0], [15, 165], Systematic),
        test("FT3", Volume, 3, WATER[0], [10, 170], Random),
        test("FT4", Volume, 3, WATER[1], [10, 170], Random),
        test("FT5", Volume, 2, WATER[0], [10, 300], Systematic),
        test("PT1", Pressures, 3, WATER[0], [10, 200], Systematic),
        test("PT2", Pressures, 2, WATER[0], [10, 200], Systematic),
    ]
};

impl Test {
    /// Returns rollers, temperature, speeds and order of the test.
    fn specification(&self) -> [String; 4] {
        [
            self.rollers.to_string(),
            format!("{} °C", self.water.0),
            format!("{} to {} r/min", self.slowest_rpm, self.fastest_rpm),
            match self.order {
                Order::Systematic => "S",
                Order::Random => "R",
            }
            .to_owned(),
        ]
    }

    /// Returns the results of the test as a table.
    fn run(&self) -> Result<String, Box<dyn Error>> {
        let [rollers, temperature, speeds, order] = self.specification();
        let results = match self.quantity {
            Quantity::Volume => self.volumes()?,
            Quantity::Pressures => self.pressures()?,
        };
        Ok(format!(
            "{} (Table 2): {rollers} rollers, {temperature}, {speeds} in steps of 10 r/min ({order})\n\n{results}",
            self.name
        ))
    }

    fn volumes(&self) -> Result<String, Box<dyn Error>> {
        let measured =
            MEASURED.iter().find(|pump| pump.rollers == self.rollers).ok_or("the pump was measured")?;
        let volumes = Volumes::of(self.rollers, self.slowest_rpm, self.fastest_rpm)?;
        let mut text = format!(
            "ten revolutions; the paper weighs them, and its mean with {} rollers is {} mL (Section 5.1)\n\
             speed_rpm  time_s  linear_ml  linear_g  speed_law_ml\n",
            self.rollers, measured.ten_revolutions_ml
        );
        let linear_ml = volumes.linear_ml;
        // V = m/rho, Eq. 19.
        let linear_g = 1e-3 * self.water.1 * linear_ml;
        for (rpm, law_ml) in volumes.rpm.iter().zip(&volumes.law_ml) {
            // t_test = Rev/(N/60), Eq. 16.
            let time_s = 10.0 / (rpm / 60.0);
            text += &format!("{rpm:9}  {time_s:6.2}  {linear_ml:9.3}  {linear_g:8.3}  {law_ml:12.3}\n");
        }
        Ok(text)
    }

    fn pressures(&self) -> Result<String, Box<dyn Error>> {
        let pump = Pump::preset(self.rollers, Variant::Measured)?;
        let mut text = String::from(
            "some 10 s at each speed, 30 cm of water in the reservoir\n\
             speed_rpm  flow_ml_s  in_max  in_min  in_mean  out_max  out_min  out_mean\n",
        );
        for rpm in (self.slowest_rpm..=self.fastest_rpm).step_by(10).map(f64::from) {
            let [in_max, in_min, in_mean, out_max, out_min, out_mean] = steady_kpa(self.rollers, rpm)?;
            let flow_ml_s = pump.average_flow_ml_s(rad_s(rpm));
            text += &format!(
                "{rpm:9}  {flow_ml_s:9.3}  {in_max:6.2}  {in_min:6.2}  {in_mean:7.2}  {out_max:7.2}  \
                 {out_min:7.2}  {out_mean:8.2}\n"
            );
        }
        Ok(text + "kPa absolute, periodic steady state\n")
    }
}

/// A measurement of the paper that has no name there.
struct Measurement {
    name: &'static str,
    about: &'static str,
    run: fn() -> Result<String, Box<dyn Error>>,
}

const MEASUREMENTS: [Measurement; 3] = [
    Measurement {
        name: "roller-volume",
        about: "roller volume over angle, 15 angles to phi (Section 3.3, Fig. 9)",
        run: roller_volume,
    },
    Measurement {
        name: "resistance",
        about: "resistance of the line, R = dP/Q at steady flows (Section 4.2, Eq. 17)",
        run: resistance,
    },
    Measurement {
        name: "compliance",
        about: "compliance of the line, C = V_total/B_e = dV/dP (Section 4.2, Eqs. 20 and 21)",
        run: compliance,
    },
];

/// Returns the results of a test or a measurement as a table, or an error if none has this name.
pub(crate) fn run(name: &str) -> Result<String, Box<dyn Error>> {
    if let Some(test) = TESTS.iter().find(|test| test.name.eq_ignore_ascii_case(name)) {
        return test.run();
    }
    if let Some(found) = MEASUREMENTS.iter().find(|found| found.name.eq_ignore_ascii_case(name)) {
        return Ok(format!("{}\n\n{}", found.about, (found.run)()?));
    }
    let names: Vec<&str> =
        TESTS.iter().map(|test| test.name).chain(MEASUREMENTS.iter().map(|found| found.name)).collect();
    Err(format!("no test is named {name:?}; allowed: {}", names.join(", ")).into())
}

/// Returns the tests and their commands as Markdown.
pub(crate) fn markdown() -> String {
    let mut text = String::from(
        "Table 2 of the paper specifies its tests. Their speeds rise in steps of 10 r/min (Section 4.1). FT1 to FT5 \
         weigh the water of ten revolutions, ten times at each speed (Section 5.1), and each test has a new tube. \
         PT1 and PT2 record both pressures every 0.2 ms (Section 4.2) for roughly 10 s at each speed, with 30 cm of \
         water in the reservoir. S means that the speeds rise systematically. R means a random order, which the \
         paper does not state.\n\nA run prints the model's results over the test's speeds, in rising order, because \
         no result depends on the speed before. In the model the temperature does not affect the volume. FT4 \
         therefore differs from FT3 in its mass alone: 992 kg/m³ instead of 997. The paper finds no significant \
         effect of the temperature on the volume either (Section 5.1). Pressures are those of the periodic steady \
         state.\n\n| test | rollers | water | speeds | order | command |\n| --- | --- | --- | --- | --- | --- |\n",
    );
    for test in TESTS {
        let name = test.name;
        text += &format!(
            "| {name} | {} | `cargo run --example validate -- {name}` |\n",
            test.specification().join(" | ")
        );
    }
    text += "\nThe paper gives no name to these measurements:\n\n| measurement | command |\n| --- | --- |\n";
    for Measurement { name, about, .. } in MEASUREMENTS {
        text += &format!("| {about} | `cargo run --example validate -- {name}` |\n");
    }
    text + "\nThis command gives the waveform of PT1 at 100 r/min, every millisecond, with a plot: `dose simulate \
            --pump three-roller --speed 100rpm --duration 10s --trace pt1.csv --plot pt1.svg`. PT2 has \
            `--pump two-roller`.\n"
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
