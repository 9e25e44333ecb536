//! A pump file from a drawing, for a pump of which at most a roller's volume was measured.

use libm::{ceil, floor, pow, sqrt};
use pump_model::units::{degrees, rad_s};
use pump_model::{Fluid, Geometry, ModelError};

use super::remarks::{ambient_remark, motor_remark};
use crate::catalogue::built_in;
use crate::notice::{Remedy, Wording};
use crate::pump_file::{
    AmbientTable, BackplateTable, HoseTable, LineTable, PumpFile, RollerVolumeTable, UncertaintyTable,
    Unweighed,
};

/// Temperature of the fluid, in °C. A drawing does not tell it.
const TEMPERATURE_DEGC: f64 = 25.0;

/// Largest speed of the pump head, in r/min. A drawing does not tell it.
pub(super) const MAX_SPEED_RPM: f64 = 100.0;

/// A pump as its drawing gives it.
#[derive(Debug, Clone, PartialEq)]
pub struct DrawnPump {
    /// Identifier of the pump. It names the folder of the pump's record.
    pub id: String,
    /// Dimensions of the pump head.
    pub geometry: Geometry,
    /// Length of the hose on either side, in mm.
    pub hose_length_mm: f64,
    /// Volume of a roller, from the drawing or measured.
    pub roller_volume: RollerVolumeTable,
}

impl DrawnPump {
    /// Returns the pump file.
    ///
    /// The roller volume stands in it as it is known. The lines are hoses of the pump's own tube. The rest is
    /// as in the built-in pumps.
    ///
    /// # Errors
    /// Returns the [`ModelError`] of a pump that cannot work.
    pub fn pump_file(&self) -> Result<PumpFile, ModelError> {
        let geometry = &self.geometry;
        let curve = self.roller_volume.curve(geometry)?;
        let revolution_ml = core::f64::consts::TAU * geometry.nominal_ml_rad()
            - f64::from(geometry.rollers) * curve.total_ml();
        let Some(mut file) = built_in("three-roller") else { unreachable!("it is built in") };
        file.pump.id.clone_from(&self.id);
        file.pump.name = match self.roller_volume.is_estimated() {
            true => format!("{} rollers, from a drawing", geometry.rollers),
            false => format!("{} rollers, from a drawing and a measured roller volume", geometry.rollers),
        };
        self.set_dimensions(&mut file);
        file.roller_volume = Some(self.roller_volume.clone());
        let line = self.line();
        file.inlet = line.clone();
        file.outlet = line.into();
        file.motor.max_speed_rpm = MAX_SPEED_RPM;
        // A head whose rollers take more than its bore delivers is refused below, by its model.
        file.pump.default_rate_ml_s =
            two_digits(0.25 * revolution_ml.abs() * rad_s(MAX_SPEED_RPM) / core::f64::consts::TAU);
        file.fluid.temperature_degc = TEMPERATURE_DEGC;
        file.fluid.density_kg_m3 = floor(10.0 * Fluid::water(TEMPERATURE_DEGC)?.density_kg_m3 + 0.5) / 10.0;
        file.ambient = AmbientTable::default();
        file.uncertainty = match &self.roller_volume {
            RollerVolumeTable::Measured { fit, points } => {
                measured_uncertainty(geometry, curve.total_ml(), fit.of(points)?.rms_ml(), &file.uncertainty)
            }
            _ => uncertainty(geometry, curve.total_ml(), &file.uncertainty),
        };
        file.model()?;
        Ok(file)
    }

    /// Writes the dimensions of the pump head into a pump file.
    fn set_dimensions(&self, file: &mut PumpFile) {
        let geometry = &self.geometry;
        file.tube.bore_radius_mm = Some(geometry.bore_radius_mm);
        file.tube.outer_radius_mm = Some(geometry.tube_outer_radius_mm);
        // A drawing does not tell the material of the tube.
        (file.tube.modulus_mpa, file.tube.poisson_ratio) = (None, None);
        file.rollers.count = geometry.rollers;
        file.rollers.radius_mm = Some(geometry.roller_radius_mm);
        file.rollers.offset_mm = Some(geometry.roller_offset_mm);
        file.backplate = Some(BackplateTable {
            radius_mm: geometry.backplate_radius_mm,
            // Rounding turns 30 degrees into 30 again and not into a neighbouring number.
            contact_angle_deg: floor(1e9 * degrees(geometry.contact_angle_rad) + 0.5) / 1e9,
        });
    }

    /// Returns a line that is a hose of the pump's own tube.
    fn line(&self) -> LineTable {
        let hose = HoseTable {
            bore_radius_mm: self.geometry.bore_radius_mm,
            outer_radius_mm: self.geometry.tube_outer_radius_mm,
            length_mm: self.hose_length_mm,
            // Modulus of a peristaltic tube, as assumed for the hose of McIntyre et al.
            modulus_mpa: 3.5,
            poisson_ratio: 0.5,
            // This loss gives the resistance that McIntyre et al. measured.
            minor_loss: 5.75,
            resistance_at_ml_s: None,
        };
        // Supply and vessel stand as high as the pump unless their heights are stated.
        LineTable::of_hose_with_lift(0.0, hose)
    }

    /// Returns [`Self::pump_file`] as TOML, when its owner has stated more of it too. A remark on each table says if it
    /// is given, measured, estimated or assumed. A front end words what checks the file and what makes it surer.
    pub fn toml_of(&self, file: &PumpFile, words: Wording) -> String {
        let is_estimated = self.roller_volume.is_estimated();
        let check = words(Remedy::CheckPump);
        let mut text = match is_estimated {
            true => format!(
                "# Written from a drawing: nobody has measured this pump.\n\
                 # The model follows from the dimensions alone; {check}.\n\n"
            ),
            false => format!(
                "# Written from a drawing and measured roller volumes.\n\
                 # {check}.\n\n"
            ),
        };
        for line in file.to_toml().lines() {
            let remark = match line {
                "[motor]" => motor_remark(file, "drawing"),
                "[ambient]" => ambient_remark(file).to_owned(),
                _ => remark(line, is_estimated).replace(SURER, words(Remedy::WeighToBeSurer)),
            };
            if !remark.is_empty() {
                text.push_str(&remark);
                text.push('\n');
            }
            text.push_str(line);
            text.push('\n');
        }
        text
    }
}

/// Place in a remark of the words that say how an uncertainty is made smaller.
const SURER: &str = "{surer}";

/// Returns the remark above a line of a pump file, or nothing. `is_estimated` is true for a roller volume
/// from the drawing.
fn remark(line: &str, is_estimated: bool) -> &'static str {
    match line {
        "[tube]" | "[rollers]" | "[backplate]" => "# As given.",
        "[roller_volume]" if !is_estimated => "# Measured.",
        "[roller_volume]" => {
            "# Estimated from the dimensions. Points that you measured would take its place:\n\
             # source = \"measured\"."
        }
        "[inlet]" => {
            "# Estimated: a hose of the pump's tube, with the modulus and the fittings of McIntyre et al.\n\
             # Change it to your hose, or replace it by measured R, C and L.\n\
             # lift_mm: height of the pump above the supply's surface; negative where the supply stands above."
        }
        "[outlet]" => {
            "# Estimated as the inlet. Say where its nozzle ends: end = \"air\" or \"immersed\", and nozzle_bore_mm.\n\
             # Without them it is in air, and a drop hangs from the hose's bore.\n\
             # lift_mm: height of the vessel's end above the pump; negative where it lies below."
        }
        "[speed_law]" | "[fluid]" => "# Assumed.",
        "[uncertainty]" if !is_estimated => {
            "# For a pump that nobody has weighed; {surer}.\n\
             # Model: pumps and tubes of one kind differ by limits that a maker states by the bore (Omega FPU5MT,\n\
             # table 9-3: pumps 10 to 25 %, tubes 5 to 20 %; rectangular), and a bore known to 0.1 mm.\n\
             # Speed: limits by the bore of the same table, 5 to 15 %; rectangular.\n\
             # Roller volume: 2.1 %, by which two figures of McIntyre et al. differ, and the residuals of\n\
             # the fit.\n\
             # Repeatability: as McIntyre et al. measured over ten revolutions."
        }
        "[uncertainty]" => {
            "# For a pump that nobody has measured; {surer}.\n\
             # Model: pumps and tubes of one kind differ by limits that a maker states by the bore (Omega FPU5MT,\n\
             # table 9-3: pumps 10 to 25 %, tubes 5 to 20 %; rectangular), the drawing against measured\n\
             # volumes (1.4 %), and a bore known to 0.1 mm.\n\
             # Speed: limits by the bore of the same table, 5 to 15 %; rectangular.\n\
             # Roller volume: 5.8 %, by which the drawing differed from the measured volume.\n\
             # Repeatability: as McIntyre et al. measured over ten revolutions."
        }
        _ => "",
    }
}

/// Returns the uncertainty of a pump that nobody has measured.
///
/// The model's uncertainty combines three shares:
///
/// - The first is that between pumps and tubes of one kind, see [`Unweighed`]. The 2.4 % of McIntyre
///   et al. are those of one pump, measured by its makers.
/// - The second is 1.4 %, the largest difference between volumes from the drawing and volumes measured over
///   ten revolutions. It counts as a standard uncertainty, since one pump alone was compared.
/// - The third is the bore, whose diameter a caliper gives to 0.1 mm on soft tube, rectangular. So the volume
///   is known to 2 x 0.1/(d sqrt(3)).
///
/// A roller's volume came out 5.8 % larger from the drawing than measured (2.2267 and 2.1055 mL).
fn uncertainty(geometry: &Geometry, roller_ml: f64, measured: &UncertaintyTable) -> UncertaintyTable {
    const DRAWING_PERCENT: f64 = 1.4;
    const ROLLER: f64 = 0.058;
    let unweighed = unweighed(geometry);
    let shares = [unweighed.model_percent, DRAWING_PERCENT, bore_percent(geometry)];
    let model_percent = sqrt(shares.iter().map(|share| share * share).sum());
    UncertaintyTable {
        model_percent: ceil(10.0 * model_percent) / 10.0,
        speed_percent: Some(two_digits(unweighed.speed_percent)),
        roller_volume_ml: Some(two_digits(ROLLER * roller_ml)),
        ..measured.clone()
    }
}

/// Returns true if a table states what the program estimates of a pump by its drawing: nobody has measured it.
pub(crate) fn is_of_drawing(table: &UncertaintyTable, geometry: &Geometry) -> bool {
    let estimated = uncertainty(geometry, 0.0, table);
    (table.model_percent, table.speed_percent) == (estimated.model_percent, estimated.speed_percent)
}

/// Returns the uncertainty of a pump whose roller volume was measured.
///
/// The model's uncertainty combines the shares between pumps and of the bore, see [`bore_percent`]. A
/// roller's volume combines two shares: 2.1 %, by which two figures of McIntyre et al. for their rollers
/// differ (2.06 and 2.1055 mL), and the root mean square of the residuals.
pub(super) fn measured_uncertainty(
    geometry: &Geometry,
    roller_ml: f64,
    rms_ml: f64,
    measured: &UncertaintyTable,
) -> UncertaintyTable {
    const ROLLER: f64 = 0.021;
    let unweighed = unweighed(geometry);
    let shares = [unweighed.model_percent, bore_percent(geometry)];
    let model_percent = sqrt(shares.iter().map(|share| share * share).sum());
    let figures_ml = ROLLER * roller_ml;
    UncertaintyTable {
        model_percent: ceil(10.0 * model_percent) / 10.0,
        speed_percent: Some(two_digits(unweighed.speed_percent)),
        roller_volume_ml: Some(two_digits(sqrt(figures_ml * figures_ml + rms_ml * rms_ml))),
        ..measured.clone()
    }
}

/// Returns the uncertainty of pumps and tubes of one kind that nobody has weighed.
fn unweighed(geometry: &Geometry) -> Unweighed {
    Unweighed::of_bore(Some(2.0 * geometry.bore_radius_mm))
}

/// Returns the uncertainty of the volume in percent that comes from the bore. A caliper gives the bore of a
/// soft tube to 0.1 mm, rectangular.
fn bore_percent(geometry: &Geometry) -> f64 {
    const BORE_MM: f64 = 0.1;
    100.0 * 2.0 * BORE_MM / (2.0 * geometry.bore_radius_mm) / sqrt(3.0)
}

/// Rounds a positive number to two significant digits.
pub(super) fn two_digits(value: f64) -> f64 {
    let place = pow(10.0, floor(libm::log(value) / core::f64::consts::LN_10) - 1.0);
    // Passing through text makes 0.13 exactly the number that is written 0.13.
    let rounded = floor(value / place + 0.5) * place;
    format!("{rounded:.6e}").parse().unwrap_or(rounded)
}

#[cfg(test)]
mod tests {
    use super::*;
    use pump_model::Variant;

    fn drawn(rollers: u32, variant: Variant) -> PumpFile {
        let geometry = Geometry::published(rollers, variant);
        DrawnPump {
            id: "drawn".to_owned(),
            geometry,
            hose_length_mm: 331.0,
            roller_volume: RollerVolumeTable::Drawing,
        }
        .pump_file()
        .unwrap()
    }

    #[test]
    fn a_drawn_pump_covers_what_was_measured_of_that_pump() {
        for (rollers, measured_ml) in [(3, 212.53), (2, 231.75)] {
            for variant in [Variant::Measured, Variant::AsBuilt] {
                let file = drawn(rollers, variant);
                let drawn_ml = 10.0 * file.model().unwrap().revolution_ml();
                let standard_ml = file.uncertainty.model_percent / 100.0 * drawn_ml;
                assert!((drawn_ml - measured_ml).abs() < standard_ml, "{drawn_ml} for {measured_ml}");
            }
        }
        let file = drawn(3, Variant::Measured);
        let measured = built_in("three-roller").unwrap();
        let difference = file.model().unwrap().roller_volume().total_ml()
            - measured.model().unwrap().roller_volume().total_ml();
        assert!(difference.abs() < file.uncertainty.roller_standard_ml());
        assert!(file.uncertainty.model_percent > measured.uncertainty.model_percent);
    }

    #[test]
    fn a_measured_roller_volume_makes_the_paper_pump_from_its_drawing() {
        let points = pump_model::volume_fit::PUBLISHED_POINTS
            .map(|(angle_deg, volume_ml)| pump_model::VolumePoint { angle_deg, volume_ml });
        let measured = DrawnPump {
            id: "measured".to_owned(),
            geometry: Geometry::published(3, Variant::Measured),
            hose_length_mm: 331.0,
            roller_volume: RollerVolumeTable::Measured {
                fit: crate::pump_file::CurveFit::Quintic,
                points: points.to_vec(),
            },
        };
        let file = measured.pump_file().unwrap();
        assert!((file.model().unwrap().revolution_ml() - 21.3185).abs() < 1e-4);
        // sqrt((20² + 10²)/3 + 1.155²); sqrt((0.021 x 2.1055)² + 0.0074²); 15/sqrt(3)
        assert_eq!((file.uncertainty.model_percent, file.uncertainty.roller_volume_ml), (13.0, Some(0.045)));
        assert_eq!(file.uncertainty.speed_percent, Some(8.7));
        assert!(!file.is_estimated());
        let text = measured.toml_of(&measured.pump_file().unwrap(), |_| "weigh it");
        assert_eq!(PumpFile::parse(&text, "text").unwrap(), file);
        assert!(text.contains("# Measured.\n[roller_volume]") && !text.contains("nobody has measured"));
    }

    #[test]
    fn the_bore_of_a_thin_tube_is_less_sure() {
        let thin = Geometry {
            bore_radius_mm: 1.6,
            tube_outer_radius_mm: 3.2,
            backplate_radius_mm: 63.0,
            ..Geometry::published(3, Variant::Measured)
        };
        let table = built_in("three-roller").unwrap().uncertainty;
        // sqrt((10² + 5²)/3 + 1.4² + 3.608²)
        assert_eq!(uncertainty(&thin, 0.3, &table).model_percent, 7.6);
        assert_eq!(uncertainty(&thin, 0.3, &table).roller_volume_ml, Some(0.017));
    }

    #[test]
    fn numbers_are_rounded_to_two_digits() {
        for (value, rounded) in [(0.129_15, 0.13), (8.731, 8.7), (123.0, 120.0), (0.099_7, 0.1)] {
            assert_eq!(two_digits(value), rounded);
        }
    }

    #[test]
    fn its_text_is_a_pump_file_that_says_what_it_is() {
        let geometry = Geometry::published(3, Variant::Measured);
        let drawn = DrawnPump {
            id: "drawn".to_owned(),
            geometry,
            hose_length_mm: 331.0,
            roller_volume: RollerVolumeTable::Drawing,
        };
        let text = drawn.toml_of(&drawn.pump_file().unwrap(), |_| "weigh it");
        assert_eq!(PumpFile::parse(&text, "text").unwrap(), drawn.pump_file().unwrap());
        assert!(text.contains("# Estimated from the dimensions") && text.contains("source = \"drawing\""));
        assert!(drawn.pump_file().unwrap().is_estimated());
    }
}
