//! A pump file with a head of the catalogue.

use pump_model::units::rad_s;
use pump_model::{Fluid, ModelError};

use super::built_in;
use super::drawn_pump::two_digits;
use super::remarks::{ambient_remark, motor_remark};
use crate::heads::BoughtHead;
use crate::notice::{Remedy, Wording};
use crate::pump_file::{
    AmbientTable, HeadTable, LineTable, PumpFile, RollersTable, TubeTable, UncertaintyTable,
};

/// Temperature of the fluid, in °C. A catalogue does not tell it.
const TEMPERATURE_DEGC: f64 = 25.0;

/// Largest speed of the pump head, in r/min. A catalogue tells that of the maker's motor, not of yours.
const MAX_SPEED_RPM: f64 = 100.0;

/// A pump with a head of the catalogue.
///
/// ```
/// use pump_bench::catalogue::CataloguedPump;
///
/// let pump = CataloguedPump::new("ph-down", pump_bench::heads::bought_head("kamoer-kphm400-25").unwrap(), 3);
/// let file = pump.pump_file()?;
/// assert!((file.model()?.revolution_ml() - 1.0).abs() < 1e-12);
/// # Ok::<(), pump_model::ModelError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct CataloguedPump {
    id: String,
    head: BoughtHead,
    rollers: u32,
}

impl CataloguedPump {
    /// Returns the pump of an id, with a head of the catalogue that has so many rollers.
    pub fn new(id: impl Into<String>, head: &BoughtHead, rollers: u32) -> Self {
        Self { id: id.into(), head: head.clone(), rollers }
    }

    /// Returns the pump file.
    ///
    /// Its lines are unknown, as no catalogue tells them. The rest is as in the built-in pumps.
    ///
    /// # Errors
    /// Returns the [`ModelError`] of a pump that cannot work.
    pub fn pump_file(&self) -> Result<PumpFile, ModelError> {
        let Some(mut file) = built_in("three-roller") else { unreachable!("it is built in") };
        file.pump.id.clone_from(&self.id);
        file.pump.name = format!("{} {}, {}", self.head.maker, self.head.head, self.head.tubing);
        file.head = Some(HeadTable::catalogued(&self.head));
        file.tube = TubeTable::default();
        file.rollers = RollersTable { count: self.rollers, radius_mm: None, offset_mm: None };
        (file.backplate, file.roller_volume) = (None, None);
        (file.inlet, file.outlet) = (LineTable::UNKNOWN, LineTable::UNKNOWN.into());
        file.motor.max_speed_rpm = MAX_SPEED_RPM;
        let fastest_ml_s = self.head.ml_per_rev * rad_s(MAX_SPEED_RPM) / core::f64::consts::TAU;
        file.pump.default_rate_ml_s = two_digits(0.25 * fastest_ml_s);
        file.fluid.temperature_degc = TEMPERATURE_DEGC;
        file.fluid.density_kg_m3 = (10.0 * Fluid::water(TEMPERATURE_DEGC)?.density_kg_m3).round() / 10.0;
        file.ambient = AmbientTable::default();
        file.uncertainty = UncertaintyTable::of_bought(self.head.bore_mm);
        file.model()?;
        Ok(file)
    }

    /// Returns [`Self::pump_file`] as TOML after its owner has stated more of it. A remark on each table says if it is
    /// published, given or assumed.
    ///
    /// The head stands in it by its name. The catalogue gives its figures, and a remark repeats them. A front end words
    /// what checks the file and what makes it surer.
    pub fn toml_of(&self, file: &PumpFile, words: Wording) -> String {
        let (check, surer) = (words(Remedy::CheckPump), words(Remedy::WeighToBeSurer));
        let mut text = format!(
            "# Written from the catalogue: nobody has measured this pump.\n\
             # {check}; {surer}.\n\n"
        );
        for line in file.to_toml().lines() {
            if line.starts_with("ml_per_rev =") || line.starts_with("tube_bore_mm =") {
                continue;
            }
            text.push_str(&self.remark(line, file));
            text.push_str(line);
            text.push('\n');
        }
        text
    }

    /// Returns the remark above a line of the file, or nothing.
    fn remark(&self, line: &str, file: &PumpFile) -> String {
        match line {
            "[head]" => {
                let bore = self.head.bore_mm.map_or(String::new(), |bore| format!(", bore {bore} mm"));
                let source = &self.head.source;
                format!(
                    "# As published: {}{bore}\n# ({}: {}).\n",
                    self.head.published,
                    source.kind,
                    source.cited()
                )
            }
            "[rollers]" if self.head.rollers == Some(self.rollers) => "# As published.\n".to_owned(),
            "[rollers]" => "# As given.\n".to_owned(),
            "[inlet]" => {
                "# As given; lift_mm: height of the pump above the supply's surface. Nothing is known of the \
                line:\n# give its hose, or R, C and L.\n"
                    .to_owned()
            }
            "[outlet]" => {
                "# As given; lift_mm: height of the vessel's end above the pump. Nothing is known of the \
                line:\n# give its hose, or R, C and L.\n"
                    .to_owned()
            }
            "[motor]" => format!("{}\n", motor_remark(file, "catalogue")),
            "[ambient]" => format!("{}\n", ambient_remark(file)),
            "[speed_law]" | "[fluid]" => "# Assumed.\n".to_owned(),
            _ => String::new(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::heads::bought_heads;

    #[test]
    fn every_head_of_the_catalogue_makes_a_pump_file_that_is_read_again() {
        for head in bought_heads() {
            let pump = CataloguedPump::new("bought", head, head.rollers.unwrap_or(3));
            let file = pump.pump_file().unwrap();
            let text = pump.toml_of(&file, |_| "weigh it");
            assert_eq!(PumpFile::parse(&text, &head.name).unwrap(), file, "{text}");
            assert!(
                (file.model().unwrap().revolution_ml() / head.ml_per_rev - 1.0).abs() < 1e-12,
                "{}",
                head.name
            );
        }
    }
}
