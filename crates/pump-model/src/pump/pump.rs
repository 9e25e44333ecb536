//! A pump: dimensions, roller volume and lines, with the flow curves that follow from them.

use crate::error::{Allowed, ModelError, Parameter, refused, within};
use crate::head::flow_curve::FlowCurve;
use crate::head::geometry::Geometry;
use crate::head::roller_volume::RollerVolume;
use crate::line::line::Line;
use crate::math::polynomial::Polynomial;
use crate::port::Port;
use crate::units::TURN_RAD;

/// Part of the volume between rollers that a pitch delivers at least. Less is not told from rounding.
const LEAST_PART: f64 = 1e-9;

/// A validated pump with its two lines. A pump is immutable; build another to change it.
///
/// ```
/// use pump_model::{Geometry, Line, Pump, RollerVolume, Variant};
/// let geometry = Geometry::published(3, Variant::Measured);
/// let pump = Pump::new(geometry, RollerVolume::measured()?, Line::PUBLISHED, Line::PUBLISHED)?;
/// assert!((pump.revolution_ml() - 21.3185).abs() < 1e-4);
/// assert_eq!(pump, Pump::three_roller());
/// # Ok::<(), pump_model::ModelError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pump {
    geometry: Geometry,
    roller_volume: RollerVolume,
    inlet: Line,
    outlet: Line,
    inlet_curve: FlowCurve,
    outlet_curve: FlowCurve,
}

impl Pump {
    /// Checks all parts and derives the flow curves.
    ///
    /// # Errors
    ///
    /// Refuses dimensions and lines that are not allowed, and rollers that do not seal at some angle or
    /// engage for too long. Also refuses a pump that delivers nothing over a revolution.
    pub fn new(
        geometry: Geometry,
        roller_volume: RollerVolume,
        inlet: Line,
        outlet: Line,
    ) -> Result<Self, ModelError> {
        geometry.validate()?;
        inlet.validate()?;
        outlet.validate()?;
        geometry.validate_seal(roller_volume.inset_rad())?;
        geometry.inlet_phase_rad(&roller_volume)?;
        Self::of_valid(geometry, roller_volume, inlet, outlet).pumping(geometry.nominal_ml_rad())
    }

    /// Returns this pump if its rollers take less than the bore delivers, `nominal_ml_rad` per radian.
    pub(super) fn pumping(self, nominal_ml_rad: f64) -> Result<Self, ModelError> {
        // Both curves have the same volume of a pitch, up to rounding.
        let least_ml = LEAST_PART * nominal_ml_rad * self.geometry.pitch_rad();
        let pitches_ml = [&self.inlet_curve, &self.outlet_curve].map(FlowCurve::pitch_ml);
        if pitches_ml.iter().all(|pitch_ml| *pitch_ml > least_ml) {
            return Ok(self);
        }
        Err(ModelError::NotPumping {
            rollers: self.geometry.rollers,
            nominal_ml: TURN_RAD * nominal_ml_rad,
            roller_ml: self.roller_volume.total_ml(),
            revolution_ml: self.revolution_ml(),
        })
    }

    /// Derives the flow curves of parts that are known to make a valid pump.
    pub(crate) fn of_valid(
        geometry: Geometry,
        roller_volume: RollerVolume,
        inlet: Line,
        outlet: Line,
    ) -> Self {
        let inlet_curve = FlowCurve::new(&geometry, &roller_volume, Port::Inlet);
        let outlet_curve = FlowCurve::new(&geometry, &roller_volume, Port::Outlet);
        Self { geometry, roller_volume, inlet, outlet, inlet_curve, outlet_curve }
    }

    /// Builds a pump from its parts and from curves that were computed before. Nothing is checked.
    pub(crate) const fn of_curves(
        geometry: Geometry,
        roller_volume: RollerVolume,
        [inlet, outlet]: [Line; 2],
        [inlet_curve, outlet_curve]: [FlowCurve; 2],
    ) -> Self {
        Self { geometry, roller_volume, inlet, outlet, inlet_curve, outlet_curve }
    }

    /// Returns this pump with `factor` times the displacement at every angle.
    ///
    /// The factor applies to flows and volumes of both ports, of a revolution and of a roller. Dimensions and
    /// lines stay as they are.
    ///
    /// # Errors
    ///
    /// Refuses a factor that is not finite and positive.
    ///
    /// # Examples
    ///
    /// ```
    /// let pump = pump_model::Pump::three_roller();
    /// let calibrated = pump.scaled(1.02)?;
    /// assert!((calibrated.revolution_ml() / pump.revolution_ml() - 1.02).abs() < 1e-15);
    /// assert!(pump.scaled(0.0).is_err());
    /// # Ok::<(), pump_model::ModelError>(())
    /// ```
    pub fn scaled(&self, factor: f64) -> Result<Self, ModelError> {
        within(Parameter::DisplacementFactor, factor, Allowed::POSITIVE)?;
        Ok(Self {
            roller_volume: self.roller_volume.scaled(factor),
            inlet_curve: self.inlet_curve.scaled(factor),
            outlet_curve: self.outlet_curve.scaled(factor),
            ..*self
        })
    }

    /// Returns this pump with its angles counted from `zero_rad` of this one.
    ///
    /// # Errors
    ///
    /// Refuses an angle that is not finite, and a second shift for which the curves have no room.
    pub fn shifted(&self, zero_rad: f64) -> Result<Self, ModelError> {
        const SHIFT: Parameter = Parameter::ZeroShift;
        within(SHIFT, zero_rad, Allowed::FINITE)?;
        match [&self.inlet_curve, &self.outlet_curve].map(|curve| curve.shifted(zero_rad)) {
            [Some(inlet_curve), Some(outlet_curve)] => Ok(Self { inlet_curve, outlet_curve, ..*self }),
            _ => Err(refused(SHIFT, zero_rad, "at most one shift of a pump with so many edges")),
        }
    }

    /// Returns the dimensions.
    pub fn geometry(&self) -> &Geometry {
        &self.geometry
    }

    /// Returns the volume V(x) of one roller.
    pub fn roller_volume(&self) -> &RollerVolume {
        &self.roller_volume
    }

    /// Returns the line at the inlet.
    pub fn inlet(&self) -> &Line {
        &self.inlet
    }

    /// Returns the line at the outlet.
    pub fn outlet(&self) -> &Line {
        &self.outlet
    }

    /// Returns flow per radian and volume at the inlet rollers.
    pub fn inlet_curve(&self) -> &FlowCurve {
        &self.inlet_curve
    }

    /// Returns flow per radian and volume at the outlet rollers.
    pub fn outlet_curve(&self) -> &FlowCurve {
        &self.outlet_curve
    }

    /// Returns the line of a port.
    pub fn line(&self, port: Port) -> &Line {
        match port {
            Port::Inlet => &self.inlet,
            Port::Outlet => &self.outlet,
        }
    }

    /// Returns the flow curve of a port.
    pub fn curve(&self, port: Port) -> &FlowCurve {
        match port {
            Port::Inlet => &self.inlet_curve,
            Port::Outlet => &self.outlet_curve,
        }
    }

    /// Returns the flow per radian at the inlet and at the outlet, mL/rad, and the volume at the outlet since
    /// angle 0, mL. One look-up serves both curves, so it costs less than asking each.
    pub fn at_angle(&self, angle_rad: f64) -> (f64, f64, f64) {
        // Both curves have the same pitch.
        let place = self.outlet_curve.split(angle_rad);
        let (inlet_ml_rad, _) = self.inlet_curve.flow_and_volume_at(place);
        let (outlet_ml_rad, outlet_ml) = self.outlet_curve.flow_and_volume_at(place);
        (inlet_ml_rad, outlet_ml_rad, outlet_ml)
    }

    /// Writes flows and volumes of [`Self::at_angle`] at many angles.
    ///
    /// Neighbours in one piece of both curves need one look-up, so this costs less. The slices should be of
    /// one length; the excess of a longer slice is left as it is.
    pub fn at_angles(
        &self,
        angle_rad: &[f64],
        inlet_ml_rad: &mut [f64],
        outlet_ml_rad: &mut [f64],
        outlet_ml: &mut [f64],
    ) {
        let lengths = [inlet_ml_rad.len(), outlet_ml_rad.len(), outlet_ml.len()];
        let angle_rad = &angle_rad[..lengths.into_iter().fold(angle_rad.len(), usize::min)];
        let pitch_rad = self.pitch_rad();
        let mut next = 0;
        while let Some(&first_rad) = angle_rad.get(next) {
            let (pitches, local_rad) = self.outlet_curve.split(first_rad);
            let (inlet, inlet_end_rad) = self.inlet_curve.piece_to_its_end(local_rad);
            let (outlet, outlet_end_rad) = self.outlet_curve.piece_to_its_end(local_rad);
            let both = inlet.start_rad.max(outlet.start_rad)..inlet_end_rad.min(outlet_end_rad);
            let neighbours = angle_rad[next..]
                .iter()
                .take_while(|angle_rad| self.outlet_curve.is_within(**angle_rad, pitches, &both));
            let run = next..next + neighbours.count();
            let fill = |to: &mut [f64], base: f64, piece_rad: f64, polynomial: Polynomial| {
                for (to, angle_rad) in to[run.clone()].iter_mut().zip(&angle_rad[run.clone()]) {
                    *to = base + polynomial.at(angle_rad - pitches * pitch_rad - piece_rad);
                }
            };
            fill(inlet_ml_rad, 0.0, inlet.start_rad, inlet.flow);
            fill(outlet_ml_rad, 0.0, outlet.start_rad, outlet.flow);
            fill(outlet_ml, pitches * self.outlet_curve.pitch_ml(), outlet.start_rad, outlet.volume);
            next = run.end;
            if run.is_empty() {
                // The angle is on a seam, or the run would have one angle at least.
                (inlet_ml_rad[next], outlet_ml_rad[next], outlet_ml[next]) = self.at_angle(first_rad);
                next += 1;
            }
        }
    }

    /// Returns the angle between rollers, rad.
    pub fn pitch_rad(&self) -> f64 {
        self.outlet_curve.pitch_rad()
    }

    /// Returns the flow per radian between pulses, mL/rad: a = (V_rot + NU V_r)/(2 pi) (McIntyre et al.).
    ///
    /// It equals [`Geometry::nominal_ml_rad`] unless the pump was [scaled](Self::scaled).
    pub fn nominal_ml_rad(&self) -> f64 {
        let rollers_ml = f64::from(self.geometry.rollers) * self.roller_volume.total_ml();
        (self.revolution_ml() + rollers_ml) / TURN_RAD
    }

    /// Returns the volume of a revolution, mL: V_rot = V_nom - NU V_r (McIntyre et al., with pulses and mean
    /// in agreement).
    pub fn revolution_ml(&self) -> f64 {
        self.outlet_curve.pitch_ml() * f64::from(self.geometry.rollers)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ANGLES_RAD: [f64; 7] = [-7.3, -0.2, 0.0, 0.4, 0.8819, 2.0943951023931953, 12.6];

    #[test]
    fn a_scaled_pump_scales_every_flow_and_volume_and_nothing_else() {
        for pump in [Pump::three_roller(), Pump::two_roller()] {
            let scaled = pump.scaled(0.97).unwrap();
            for angle_rad in ANGLES_RAD {
                let (inlet, outlet, volume) = pump.at_angle(angle_rad);
                let (inlet_2, outlet_2, volume_2) = scaled.at_angle(angle_rad);
                for (one, other) in [(inlet, inlet_2), (outlet, outlet_2), (volume, volume_2)] {
                    assert!((0.97 * one - other).abs() < 1e-12, "{angle_rad}");
                }
                assert!((scaled.outlet_curve().angle_rad(0.97 * volume) - angle_rad).abs() < 1e-11);
            }
            assert!((scaled.nominal_ml_rad() / pump.nominal_ml_rad() - 0.97).abs() < 1e-15);
            assert!((pump.nominal_ml_rad() - pump.geometry().nominal_ml_rad()).abs() < 1e-14);
            assert!(
                (scaled.roller_volume().total_ml() / pump.roller_volume().total_ml() - 0.97).abs() < 1e-15
            );
            assert_eq!(scaled.geometry(), pump.geometry());
            assert_eq!(scaled.pitch_rad(), pump.pitch_rad());
        }
        for factor in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(Pump::three_roller().scaled(factor).is_err(), "{factor}");
        }
    }

    #[test]
    fn a_shifted_pump_has_at_each_angle_what_the_other_has_further_on() {
        for pump in [Pump::three_roller(), Pump::two_roller()] {
            for zero_rad in ANGLES_RAD {
                let shifted = pump.shifted(zero_rad).unwrap();
                let before_ml = pump.outlet_curve().volume_ml(zero_rad);
                for angle_rad in ANGLES_RAD.map(|angle_rad| angle_rad + 0.05) {
                    let (inlet, outlet, volume) = pump.at_angle(angle_rad + zero_rad);
                    let (inlet_2, outlet_2, volume_2) = shifted.at_angle(angle_rad);
                    assert!((inlet - inlet_2).abs() < 1e-10, "{zero_rad} {angle_rad}");
                    assert!((outlet - outlet_2).abs() < 1e-10, "{zero_rad} {angle_rad}");
                    assert!((volume - before_ml - volume_2).abs() < 1e-10, "{zero_rad} {angle_rad}");
                }
                assert_eq!(shifted.revolution_ml(), pump.revolution_ml());
                let range = |pump: &Pump| pump.outlet_curve().flow_range_ml_rad();
                assert!((range(&shifted).0 - range(&pump).0).abs() < 1e-12);
                let back = shifted.shifted(-zero_rad).unwrap();
                assert!(
                    (back.outlet_curve().volume_ml(1.3) - pump.outlet_curve().volume_ml(1.3)).abs() < 1e-12
                );
            }
            assert!(pump.shifted(f64::NAN).is_err());
        }
    }

    #[test]
    fn many_angles_give_the_bits_of_each() {
        let pump = Pump::three_roller();
        let mut angles = [0.0; 4000];
        // A pitch is 200 steps as nearly as rounding allows: seams are met and missed by a bit either way.
        for (n, angle_rad) in angles.iter_mut().enumerate() {
            *angle_rad = (n as f64 - 1500.0) * (pump.pitch_rad() / 200.0);
        }
        let check = |angles: &[f64]| {
            let [mut inlet, mut outlet, mut volume] = [[0.0; 4000]; 3];
            pump.at_angles(angles, &mut inlet, &mut outlet, &mut volume);
            for (n, angle_rad) in angles.iter().enumerate() {
                assert_eq!((inlet[n], outlet[n], volume[n]), pump.at_angle(*angle_rad), "{angle_rad}");
            }
        };
        check(&angles);
        angles.reverse();
        check(&angles);
        // The angles jump back and forth.
        angles.sort_unstable_by(|a, b| (a % 0.7).total_cmp(&(b % 0.7)));
        check(&angles);
    }
}
