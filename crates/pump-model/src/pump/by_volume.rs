//! A pump of which only the volume of a revolution, the number of rollers and a default pulse are known.

use crate::error::{Allowed, ModelError, Parameter, within};
use crate::head::default_pulse::{DefaultPulse, mirror_psi_rad};
use crate::head::flow_curve::FlowCurve;
use crate::head::geometry::Geometry;
use crate::head::roller_volume::RollerVolume;
use crate::line::line::Line;
use crate::port::Port;

use super::pump::Pump;

impl DefaultPulse {
    /// Returns the pulse of a pump's roller.
    pub fn of(pump: &Pump) -> Self {
        let roller = pump.roller_volume();
        let pitch_ml = pump.outlet_curve().pitch_ml();
        let share = roller.total_ml() / (pitch_ml + roller.total_ml());
        Self::new(share, roller.engagement_deg())
    }
}

impl Pump {
    /// Builds a pump from its volume per revolution, mL, and its number of rollers, as a data sheet gives them.
    ///
    /// Whole pitches are exact. Within a pitch the flow is the bore's less the pulse's: a = (V_rot + NU V_r)/(2 pi)
    /// (McIntyre et al.). The inlet is the mirror of the outlet. Dimensions stay unknown: [`Geometry::is_known`] is
    /// false, and a model that needs them is refused.
    ///
    /// # Errors
    ///
    /// Refuses a volume that is not finite and positive, a number of rollers outside 1 to 1000, a pulse or a line
    /// that is out of range, and a pulse that takes as much as the bore delivers.
    ///
    /// # Examples
    ///
    /// ```
    /// use pump_model::{DefaultPulse, Line, Pump};
    /// let pulse = DefaultPulse::new(0.23, 50.0);
    /// let pump = Pump::from_ml_per_rev(0.5, 4, pulse, Line::PUBLISHED, Line::PUBLISHED)?;
    /// let curve = pump.outlet_curve();
    /// assert!((curve.volume_ml(1.0 + pump.pitch_rad()) - curve.volume_ml(1.0) - 0.125).abs() < 1e-15);
    /// assert!(!pump.geometry().is_known());
    /// # Ok::<(), pump_model::ModelError>(())
    /// ```
    pub fn from_ml_per_rev(
        ml_per_rev: f64,
        rollers: u32,
        pulse: DefaultPulse,
        inlet: Line,
        outlet: Line,
    ) -> Result<Self, ModelError> {
        within(Parameter::MlPerRevolution, ml_per_rev, Allowed::POSITIVE)?;
        let geometry = Geometry::of_rollers(rollers);
        geometry.validate_rollers()?;
        let pitch_ml = ml_per_rev / f64::from(rollers);
        let roller = pulse.roller_volume(pitch_ml)?;
        let nominal_ml_rad = (pitch_ml + roller.total_ml()) / geometry.pitch_rad();
        Self::of_nominal(geometry, nominal_ml_rad, roller, [inlet, outlet])
    }

    /// Returns this pump with another roller volume in the same bore and with the same lines.
    ///
    /// # Errors
    ///
    /// Refuses a roller volume that this pump cannot have, as [`Pump::new`] does.
    pub fn with_roller_volume(&self, roller: RollerVolume) -> Result<Self, ModelError> {
        if self.geometry().is_known() {
            return Self::new(*self.geometry(), roller, *self.inlet(), *self.outlet());
        }
        Self::of_nominal(*self.geometry(), self.nominal_ml_rad(), roller, [*self.inlet(), *self.outlet()])
    }

    /// Returns this pump with other lines.
    ///
    /// # Errors
    ///
    /// Refuses lines that are out of range.
    pub fn with_lines(&self, inlet: Line, outlet: Line) -> Result<Self, ModelError> {
        inlet.validate()?;
        outlet.validate()?;
        let curves = [*self.inlet_curve(), *self.outlet_curve()];
        Ok(Self::of_curves(*self.geometry(), *self.roller_volume(), [inlet, outlet], curves))
    }

    /// Builds a pump of unknown dimensions from the flow between its pulses, mL/rad.
    fn of_nominal(
        geometry: Geometry,
        nominal_ml_rad: f64,
        roller: RollerVolume,
        [inlet, outlet]: [Line; 2],
    ) -> Result<Self, ModelError> {
        inlet.validate()?;
        outlet.validate()?;
        let (rollers, pitch_rad) = (geometry.rollers, geometry.pitch_rad());
        let psi_rad = mirror_psi_rad(rollers, roller.engagement_rad());
        let curve = |port| FlowCurve::of_pulses(pitch_rad, nominal_ml_rad, psi_rad, &roller, port);
        let curves = [curve(Port::Inlet), curve(Port::Outlet)];
        Self::of_curves(geometry, roller, [inlet, outlet], curves).pumping(nominal_ml_rad)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::radians;

    fn head(ml_per_rev: f64, rollers: u32, share: f64, engagement_deg: f64) -> Result<Pump, ModelError> {
        let pulse = DefaultPulse::new(share, engagement_deg);
        Pump::from_ml_per_rev(ml_per_rev, rollers, pulse, Line::PUBLISHED, Line::PUBLISHED)
    }

    #[test]
    fn whole_pitches_are_exact_whatever_the_pulse() {
        for (ml_per_rev, rollers) in [(0.5, 4), (21.3, 3), (0.02, 12), (800.0, 2), (3.0, 1)] {
            for (share, part) in [(0.05, 0.3), (0.2, 0.7), (0.3, 0.99), (0.3, 1.4)] {
                let engagement_deg = part * 360.0 / f64::from(rollers);
                if engagement_deg >= 360.0 {
                    continue;
                }
                let pump = head(ml_per_rev, rollers, share, engagement_deg).unwrap();
                let turn_rad = 7.0 * pump.pitch_rad();
                for start_rad in [0.0, 0.31, 2.0, -5.0] {
                    let curve = pump.outlet_curve();
                    let ml = curve.volume_ml(start_rad + turn_rad) - curve.volume_ml(start_rad);
                    let expected_ml = 7.0 * ml_per_rev / f64::from(rollers);
                    assert!((ml / expected_ml - 1.0).abs() < 1e-12, "{rollers} {share} {part}: {ml}");
                }
                assert!((pump.revolution_ml() / ml_per_rev - 1.0).abs() < 1e-13);
                let found = DefaultPulse::of(&pump);
                assert!((found.share - share).abs() < 1e-12);
                assert!((found.engagement_deg() - engagement_deg).abs() < 1e-10);
            }
        }
    }

    #[test]
    fn the_inlet_is_the_mirror_of_the_outlet() {
        let pump = head(0.5, 4, 0.2, 60.0).unwrap();
        for n in 0..360 {
            let angle_rad = radians(f64::from(n) + 0.37);
            let (inlet, outlet) =
                (pump.inlet_curve().flow_ml_rad(angle_rad), pump.outlet_curve().flow_ml_rad(-angle_rad));
            assert!((inlet - outlet).abs() < 1e-13, "{n}: {inlet} {outlet}");
        }
    }

    #[test]
    fn a_pump_of_known_dimensions_keeps_its_bore_and_takes_the_roller_volume() {
        let three = Pump::three_roller();
        let roller = three.roller_volume().scaled_to(2.0).unwrap();
        let known = Pump::new(*three.geometry(), roller, *three.inlet(), *three.outlet()).unwrap();
        assert_eq!(three.with_roller_volume(roller).unwrap(), known);
        // The bore's volume of a revolution stays: V_rot + NU V_r.
        let pump = head(0.5, 4, 0.2, 60.0).unwrap();
        let before_ml = pump.roller_volume().total_ml();
        let smaller =
            pump.with_roller_volume(pump.roller_volume().scaled_to(0.5 * before_ml).unwrap()).unwrap();
        assert!((smaller.revolution_ml() - 0.5 - 4.0 * 0.5 * before_ml).abs() < 1e-14);
        assert_eq!(smaller.with_roller_volume(*pump.roller_volume()).unwrap().geometry(), pump.geometry());
    }

    #[test]
    fn a_request_that_needs_dimensions_says_so() {
        let refused = head(0.5, 4, 0.2, 60.0).unwrap().geometry().validate().unwrap_err();
        assert_eq!(refused, ModelError::DimensionsUnknown { rollers: 4 });
    }

    #[test]
    fn heads_that_cannot_be_are_refused() {
        for (ml_per_rev, rollers, share, engagement_deg) in [
            (0.0, 4, 0.2, 60.0),
            (f64::NAN, 4, 0.2, 60.0),
            (f64::INFINITY, 4, 0.2, 60.0),
            (0.5, 0, 0.2, 60.0),
            (0.5, 1001, 0.2, 60.0),
            (0.5, 4, 0.0, 60.0),
            (0.5, 4, 1.0, 60.0),
            (0.5, 4, f64::NAN, 60.0),
            (0.5, 4, 0.2, 0.0),
            (0.5, 4, 0.2, 360.0),
            (0.5, 4, 0.2, f64::NAN),
        ] {
            assert!(
                head(ml_per_rev, rollers, share, engagement_deg).is_err(),
                "{ml_per_rev} {rollers} {share}"
            );
        }
        let line = Line { compliance_ml_kpa: 0.0, ..Line::PUBLISHED };
        assert!(Pump::three_roller().with_lines(line, Line::PUBLISHED).is_err());
    }
}
