//! A pump file for a bought head, of which the volume per revolution is known and no dimension.

use pump_model::units::rad_s;

use super::built_in;
use super::drawn_pump::{MAX_SPEED_RPM, two_digits};
use crate::notice::{Remedy, Wording};
use crate::pump_file::{AmbientTable, HeadTable, LineTable, PumpFile, TubeTable, UncertaintyTable};

/// A bought head as its data sheet gives it.
///
/// ```
/// use pump_bench::catalogue::BoughtPump;
/// use pump_bench::pump_file::HeadTable;
///
/// let bought = BoughtPump { id: "acid".to_owned(), head: HeadTable::new(0.5), rollers: 4 };
/// let file = bought.pump_file();
/// file.check("acid.toml")?;
/// assert!((file.model()?.revolution_ml() - 0.5).abs() < 1e-15);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct BoughtPump {
    /// Identifier of the pump. It names the folder of the pump's record.
    pub id: String,
    /// Volume of a revolution, with what else is known of the head.
    pub head: HeadTable,
    /// Number of rollers.
    pub rollers: u32,
}

impl BoughtPump {
    /// Returns the pump file. [`PumpFile::check`] checks it.
    ///
    /// Nothing is known of the lines. The motor is as in the built-in pumps, with 100 r/min at most, and the default
    /// rate is the flow at a quarter of that. The ambient pressure is the standard atmosphere.
    pub fn pump_file(&self) -> PumpFile {
        let Some(mut file) = built_in("three-roller") else { unreachable!("it is built in") };
        file.pump.id.clone_from(&self.id);
        file.pump.name = format!("{} rollers, {} mL per revolution", self.rollers, self.head.ml_per_rev);
        file.head = Some(self.head.clone());
        (file.tube, file.backplate, file.roller_volume) = (TubeTable::default(), None, None);
        file.rollers.count = self.rollers;
        (file.rollers.radius_mm, file.rollers.offset_mm) = (None, None);
        (file.inlet, file.outlet) = (LineTable::UNKNOWN, LineTable::UNKNOWN.into());
        file.motor.max_speed_rpm = MAX_SPEED_RPM;
        let quarter_ml_s = 0.25 * self.head.ml_per_rev * rad_s(MAX_SPEED_RPM) / core::f64::consts::TAU;
        file.pump.default_rate_ml_s =
            if quarter_ml_s > 0.0 { two_digits(quarter_ml_s) } else { quarter_ml_s };
        file.ambient = AmbientTable::default();
        file.uncertainty = UncertaintyTable::default();
        file.with_assumptions()
    }

    /// Returns [`Self::pump_file`] as TOML after its owner has stated more of it. A front end words what checks the
    /// file and what makes it surer.
    pub fn toml_of(&self, file: &PumpFile, words: Wording) -> String {
        let (check, surer) = (words(Remedy::CheckPump), words(Remedy::WeighToBeSurer));
        format!(
            "# Written from what its owner said: nobody has measured this pump.\n# {check}; {surer}.\n\n{}",
            file.to_toml()
        )
    }
}
