//! Refusal of pump files whose contents contradict one another or cannot work.

use crate::displacement::DisplacementError;
use crate::numbers::short;

use super::error::PumpFileError;
use super::file::{PumpFile, SCHEMA};
use super::head::HeadTable;
use super::line::reservoir::Side;
use super::range::{WrongValue, allow};
use super::speed_law::SpeedLawTable;

/// Smallest default rate, mL/s: the longest dose, 5e6 s, delivers 5 mL at this rate.
const LEAST_RATE_ML_S: f64 = 1e-6;

/// Keys of the dimensions, as messages say them.
const DIMENSIONS: &str = "[tube], [backplate], [roller_volume], and [rollers] radius_mm and offset_mm";

impl PumpFile {
    /// Refuses contents that contradict one another or cannot work. `origin` names the file in errors.
    ///
    /// # Errors
    /// [`PumpFileError::Schema`] or [`PumpFileError::Value`] for a schema or a value that is not allowed.
    /// [`PumpFileError::Limits`], [`PumpFileError::Model`] or [`PumpFileError::Displacement`] for a pump that
    /// cannot work.
    pub fn check(&self, origin: &str) -> Result<(), PumpFileError> {
        if self.schema != SCHEMA {
            return Err(PumpFileError::Schema { origin: origin.to_owned(), schema: self.schema.clone() });
        }
        self.check_tables().map_err(|wrong| wrong.in_file(origin))?;
        self.check_pump(origin)
    }

    /// Refuses a file whose drive needs a port and that names none. `origin` names the file in errors.
    ///
    /// Commands may give the port, so that [`PumpFile::check`] does not ask for it.
    ///
    /// # Errors
    /// [`PumpFileError::Value`] for a port that is missing.
    pub fn check_port(&self, origin: &str) -> Result<(), PumpFileError> {
        let checked = self.drive.as_ref().map_or(Ok(()), |drive| drive.check_port());
        checked.map_err(|wrong| wrong.in_file(origin))
    }

    /// Refuses the first value that is wrong by itself or beside others.
    fn check_tables(&self) -> Result<(), WrongValue> {
        self.pump.check()?;
        self.check_catalogued()?;
        self.check_head()?;
        self.tube.check()?;
        self.outlet.check()?;
        self.motor.check()?;
        self.speed_law.check()?;
        self.drive.as_ref().map_or(Ok(()), |drive| drive.check(&self.motor))?;
        let has_hose = self.inlet.is_estimated() || self.outlet.line.is_estimated();
        self.fluid.check(has_hose)?;
        self.ambient.check()?;
        self.check_lifts()?;
        self.safety.check()?;
        self.uncertainty.check()
    }

    /// Refuses lifts at which the fluid would boil.
    fn check_lifts(&self) -> Result<(), WrongValue> {
        let (density, ambient) = (self.fluid.density_kg_m3, self.ambient.pressure_kpa);
        let vapour_kpa = self.fluid.vapour_kpa();
        self.inlet.reservoir.check(Side::Inlet, density, ambient, vapour_kpa)?;
        self.outlet.line.reservoir.check(Side::Outlet, density, ambient, vapour_kpa)
    }

    /// Refuses limits, a model, a law of the displacement or a default rate that cannot work.
    fn check_pump(&self, origin: &str) -> Result<(), PumpFileError> {
        let origin_name = || origin.to_owned();
        let limits = self.limits();
        let absolute = format!(
            "more than 0: it is absolute, so add the ambient pressure, {} kPa, to a gauge one",
            short(self.ambient.pressure_kpa)
        );
        let max_outlet_kpa = self.limits.max_outlet_kpa.unwrap_or(f64::INFINITY);
        allow(max_outlet_kpa > 0.0, "[limits] max_outlet_kpa", max_outlet_kpa, &absolute)
            .map_err(|wrong| wrong.in_file(origin))?;
        limits.validate().map_err(|source| PumpFileError::Limits { origin: origin_name(), source })?;
        let of_model = |source| PumpFileError::Model { origin: origin_name(), source };
        let pump = self.speed_dependent_pump().map_err(of_model)?;
        let rate = self.pump.default_rate_ml_s;
        match pump.up_to(self.motor.max_speed_rpm).speed_for_flow(rate) {
            Ok(_) => {}
            Err(DisplacementError::Model(source)) => return Err(of_model(source)),
            Err(source) => return Err(PumpFileError::Displacement { origin: origin_name(), source }),
        }
        let fastest = pump.base().average_flow_ml_s(limits.motor.max_speed_rad_s);
        allow(
            rate >= LEAST_RATE_ML_S && rate <= fastest,
            "[pump] default_rate_ml_s",
            rate,
            "1e-6 or more, and no more than the flow at [motor] max_speed_rpm",
        )
        .map_err(|wrong| wrong.in_file(origin))
    }

    /// Refuses a head that is given twice, by its volume of a revolution and by its dimensions, and one of which
    /// something is missing.
    fn check_head(&self) -> Result<(), WrongValue> {
        let dimensions = [
            ("[tube] bore_radius_mm", self.tube.bore_radius_mm.is_some()),
            ("[tube] outer_radius_mm", self.tube.outer_radius_mm.is_some()),
            ("[backplate]", self.backplate.is_some()),
            ("[roller_volume]", self.roller_volume.is_some()),
            ("[rollers] radius_mm", self.rollers.radius_mm.is_some()),
            ("[rollers] offset_mm", self.rollers.offset_mm.is_some()),
        ];
        match &self.head {
            Some(head) => self.check_bought(head, dimensions),
            None => self.check_drawn(dimensions),
        }
    }

    /// Refuses dimensions beside the volume of a revolution, and whatever needs them.
    fn check_bought(&self, head: &HeadTable, dimensions: [(&str, bool); 6]) -> Result<(), WrongValue> {
        head.check()?;
        let material = ("[tube] modulus_mpa", self.tube.modulus_mpa.or(self.tube.poisson_ratio).is_some());
        if let Some((key, _)) = dimensions.into_iter().chain([material]).find(|(_, is_given)| *is_given) {
            let value = format!("{} beside {key}", head.ml_per_rev);
            let allowed = format!("either [head] ml_per_rev with [rollers] count, or {DIMENSIONS}");
            allow(false, "[head] ml_per_rev", value, &allowed)?;
        }
        let law = "none: the law needs the dimensions of the head, and [head] has none";
        allow(self.speed_law == SpeedLawTable::default(), "[speed_law]", "given", law)?;
        let lines = "nothing, unless [inlet] and [outlet] say what the lines are: pressures follow from them";
        let given = [
            ("[limits] max_outlet_kpa", self.limits.max_outlet_kpa),
            ("[limits] min_inlet_kpa", self.limits.min_inlet_kpa),
        ];
        if self.inlet.is_unknown() || self.outlet.line.is_unknown() {
            for (key, kpa) in given {
                allow(kpa.is_none(), key, kpa.unwrap_or_default(), lines)?;
            }
        }
        let roller_ml = self.uncertainty.roller_volume_ml;
        let pulse = "nothing: the default pulse of a [head] has its own uncertainty";
        allow(roller_ml.is_none(), "[uncertainty] roller_volume_ml", roller_ml.unwrap_or_default(), pulse)
    }

    /// Refuses a head without one of its dimensions, its lines or its uncertainty.
    fn check_drawn(&self, dimensions: [(&'static str, bool); 6]) -> Result<(), WrongValue> {
        if let Some((key, _)) = dimensions.into_iter().find(|(_, is_given)| !is_given) {
            let allowed = format!("a head as its drawing gives it: {DIMENSIONS}; or [head] ml_per_rev");
            return Err(WrongValue::missing(key, &allowed));
        }
        let lines = [("[inlet]", &self.inlet), ("[outlet]", &self.outlet.line)];
        if let Some((key, _)) = lines.into_iter().find(|(_, line)| line.is_unknown()) {
            return Err(WrongValue::missing(key, "R, C and L, or a hose, and reservoir_kpa or lift_mm"));
        }
        if self.uncertainty.is_assumed() {
            return Err(WrongValue::missing("[uncertainty]", "model_percent and the rest of the table"));
        }
        if self.uncertainty.roller_volume_ml.is_none() {
            return Err(WrongValue::missing("[uncertainty] roller_volume_ml", "0 to 10000"));
        }
        Ok(())
    }
}
