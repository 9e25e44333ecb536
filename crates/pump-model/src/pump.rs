//! A pump: dimensions, roller volume and lines, with the flow curves that follow from them.

use crate::error::ModelError;
use crate::flow_curve::{FlowCurve, Port};
use crate::geometry::Geometry;
use crate::line::Line;
use crate::roller_volume::RollerVolume;

/// A validated pump with its two lines. Immutable; build another to change it.
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
    /// Checks everything and derives the flow curves.
    pub fn new(
        geometry: Geometry,
        roller_volume: RollerVolume,
        inlet: Line,
        outlet: Line,
    ) -> Result<Self, ModelError> {
        geometry.validate()?;
        inlet.validate()?;
        outlet.validate()?;
        geometry.inlet_phase_rad(roller_volume.engagement_rad())?;
        let pump = Self::of_valid(geometry, roller_volume, inlet, outlet);
        pump.inlet_curve.validate(geometry.rollers, Port::Inlet)?;
        pump.outlet_curve.validate(geometry.rollers, Port::Outlet)?;
        Ok(pump)
    }

    /// Derives the flow curves of what is known to make a valid pump.
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

    /// A pump from its parts with curves that were computed before: what `dose pumps show --format rust` writes, so that a
    /// pump can be a constant. Nothing is checked; [`Self::new`] of the parts gives the same pump.
    pub const fn precomputed(
        geometry: Geometry,
        roller_volume: RollerVolume,
        [inlet, outlet]: [Line; 2],
        [inlet_curve, outlet_curve]: [FlowCurve; 2],
    ) -> Self {
        Self { geometry, roller_volume, inlet, outlet, inlet_curve, outlet_curve }
    }

    /// Dimensions.
    pub fn geometry(&self) -> &Geometry {
        &self.geometry
    }

    /// V(x) of one roller.
    pub fn roller_volume(&self) -> &RollerVolume {
        &self.roller_volume
    }

    /// The line on the inlet side.
    pub fn inlet(&self) -> &Line {
        &self.inlet
    }

    /// The line on the outlet side.
    pub fn outlet(&self) -> &Line {
        &self.outlet
    }

    /// Flow per radian and volume at the inlet rollers.
    pub fn inlet_curve(&self) -> &FlowCurve {
        &self.inlet_curve
    }

    /// Flow per radian and volume at the outlet rollers.
    pub fn outlet_curve(&self) -> &FlowCurve {
        &self.outlet_curve
    }

    /// The line of a port.
    pub fn line(&self, port: Port) -> &Line {
        match port {
            Port::Inlet => &self.inlet,
            Port::Outlet => &self.outlet,
        }
    }

    /// The flow curve of a port.
    pub fn curve(&self, port: Port) -> &FlowCurve {
        match port {
            Port::Inlet => &self.inlet_curve,
            Port::Outlet => &self.outlet_curve,
        }
    }

    /// (Flow per radian at the inlet, at the outlet, mL/rad; volume at the outlet since angle 0, mL) at `angle_rad`: what
    /// the two curves say, for less than asking each.
    pub fn at_angle(&self, angle_rad: f64) -> (f64, f64, f64) {
        // Both curves have the same pitch.
        let place = self.outlet_curve.split(angle_rad);
        let (inlet_ml_rad, _) = self.inlet_curve.flow_and_volume_at(place);
        let (outlet_ml_rad, outlet_ml) = self.outlet_curve.flow_and_volume_at(place);
        (inlet_ml_rad, outlet_ml_rad, outlet_ml)
    }

    /// Angle between rollers, rad.
    pub fn pitch_rad(&self) -> f64 {
        self.outlet_curve.pitch_rad()
    }

    /// V_rot = V_nom - NU V_r, mL per revolution (McIntyre et al., with pulses and mean in agreement).
    pub fn revolution_ml(&self) -> f64 {
        self.outlet_curve.pitch_ml() * f64::from(self.geometry.rollers)
    }
}
