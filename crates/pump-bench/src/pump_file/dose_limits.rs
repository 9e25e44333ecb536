//! The limits of a dose by its pump file, and those of them that nobody checks.

use pump_ctl::plan::{Limits, Lowest, PressureLimits, Ramps, SetBy};

use super::error::PumpFileError;
use super::file::PumpFile;
use super::range::WrongValue;
use crate::words::words_of_reports;

/// A limit that nobody checks where no value of it is known.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum UncheckedLimit {
    /// The largest pressure at the discharge port: the outlet, and the inlet in reverse.
    DischargePressure,
    /// The smallest pressure at the suction port: the inlet, and the outlet in reverse.
    SuctionPressure,
    /// The pressure at which the tube collapses.
    TubeCollapse,
    /// The pressure at which the fluid boils.
    VapourPressure,
    /// The torque that the motor has.
    Torque,
    /// The settling of an outlet whose line is not known, and the volume that it holds back.
    Settling,
}

words_of_reports!(UncheckedLimit {
    DischargePressure = "discharge_pressure",
    SuctionPressure = "suction_pressure",
    TubeCollapse = "tube_collapse",
    VapourPressure = "vapour_pressure",
    Torque = "torque",
    Settling = "settling",
});

impl PumpFile {
    /// Returns the limits of motor, pressures and torque.
    pub fn limits(&self) -> Limits {
        self.limits_with(PressureLimits::NONE)
    }

    /// Returns the limits of motor, pressures and torque, with pressures in kPa absolute that replace those
    /// in `[limits]`.
    ///
    /// The lowest pressure for tube and fluid is the larger of two pressures: the one at which the tube
    /// collapses and the fluid's vapour pressure. It is not checked where a line is not known.
    pub fn limits_with(&self, pressures: PressureLimits) -> Limits {
        let bounds = [(self.fluid.vapour_kpa(), SetBy::Vapour), (self.collapse_kpa(), SetBy::TubeCollapse)];
        let known = bounds.into_iter().filter_map(|(kpa, set_by)| Some(Lowest { kpa: kpa?, set_by }));
        let of_file = PressureLimits {
            max_outlet_kpa: self.limits.max_outlet_kpa,
            min_inlet_kpa: self.limits.min_inlet_kpa,
        };
        let mut limits = Limits::new(self.motor.at_pump_head()).with_pressures(pressures.or(of_file));
        limits.lowest = known.max_by(|a, b| a.kpa.total_cmp(&b.kpa)).filter(|_| self.has_lines());
        limits.torque = self.motor.torque(self.ambient.pressure_kpa);
        limits
    }

    /// Refuses pressures that a dose should keep while nothing is known of the lines that they follow from.
    ///
    /// # Errors
    /// [`PumpFileError::Value`] for the line that is missing.
    pub(crate) fn check_pressure_limits(&self, pressures: PressureLimits) -> Result<(), PumpFileError> {
        let lines = [
            ("[inlet] resistance_kpa_s_ml", &self.inlet),
            ("[outlet] resistance_kpa_s_ml", &self.outlet.line),
        ];
        match lines.into_iter().find(|(_, line)| line.is_unknown()) {
            Some((key, _)) if pressures != PressureLimits::NONE => {
                let allowed = "a hose, or R, C and L, so that a pressure limit can be checked";
                Err(WrongValue::missing(key, allowed).in_file(&self.pump.id))
            }
            _ => Ok(()),
        }
    }

    /// Returns true if both lines are known, so that pressures follow from them.
    pub(crate) fn has_lines(&self) -> bool {
        !self.inlet.is_unknown() && !self.outlet.line.is_unknown()
    }

    /// Returns the ramps of a dose that names none: those that leave the outlet's line at rest, or the fastest if
    /// nothing is known of that line.
    pub(crate) fn usual_ramps(&self) -> Ramps {
        if self.outlet.line.is_unknown() { Ramps::Fastest } else { Ramps::default() }
    }

    /// Returns the limits that a dose within `limits` does not check, since no value is known.
    pub(crate) fn not_checked(&self, limits: &Limits) -> Vec<UncheckedLimit> {
        let no_line = !self.has_lines();
        let no_collapse = self.tube.collapse_below_ambient_kpa().is_none();
        let no_vapour = self.fluid.vapour_kpa().is_none();
        let nothing = no_collapse && no_vapour && limits.pressures.min_inlet_kpa.is_none();
        let all = [
            (UncheckedLimit::DischargePressure, no_line || limits.pressures.max_outlet_kpa.is_none()),
            (UncheckedLimit::SuctionPressure, no_line || nothing),
            (UncheckedLimit::TubeCollapse, no_line || (no_collapse && !nothing)),
            (UncheckedLimit::VapourPressure, no_line || (no_vapour && !nothing)),
            (UncheckedLimit::Torque, limits.torque.is_none()),
            (UncheckedLimit::Settling, self.outlet.line.is_unknown()),
        ];
        all.into_iter().filter_map(|(name, missing)| missing.then_some(name)).collect()
    }

    /// Returns the pressure in kPa absolute at which the tube collapses. Returns `None` if it is not known or
    /// the tube withstands a vacuum.
    fn collapse_kpa(&self) -> Option<f64> {
        let kpa = self.ambient.pressure_kpa - self.tube.collapse_below_ambient_kpa()?;
        Some(kpa).filter(|kpa| *kpa > 0.0)
    }
}
