//! The flow-centric model of one port as a differential equation (McIntyre et al.).

use nalgebra::{SMatrix, SVector};

use crate::flow_curve::Port;
#[cfg(feature = "identification")]
use crate::friction::Friction;
use crate::integrator::{Ode, Options};
use crate::line::Line;
use crate::stretches::Stretch;

/// What flows at the rollers into or out of a line.
pub trait Forcing {
    /// Flow at the rollers at time `t_s`, mL/s, positive from inlet to outlet.
    fn flow_ml_s(&self, t_s: f64) -> f64;
    /// Its time derivative, mL/s².
    fn flow_rate_ml_s2(&self, t_s: f64) -> f64;
}

impl Forcing for Stretch {
    fn flow_ml_s(&self, t_s: f64) -> f64 {
        Stretch::flow_ml_s(self, t_s)
    }
    fn flow_rate_ml_s2(&self, t_s: f64) -> f64 {
        Stretch::flow_rate_ml_s2(self, t_s)
    }
}

/// Rollers that do not move.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct NoFlow;

impl Forcing for NoFlow {
    fn flow_ml_s(&self, _t_s: f64) -> f64 {
        0.0
    }
    fn flow_rate_ml_s2(&self, _t_s: f64) -> f64 {
        0.0
    }
}

/// How a line slows the flow in it.
pub trait Resistance {
    /// The resisting pressure over L, mL/s².
    fn deceleration_ml_s2(&self, flow_ml_s: f64) -> f64;
    /// Its derivative over the flow, 1/s.
    fn damping_per_s(&self, flow_ml_s: f64) -> f64;
}

/// A resistance that is the same at every flow: that of [`Line`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Linear {
    /// R/L, 1/s.
    damping_per_s: f64,
}

impl Linear {
    /// Of a valid line.
    pub fn of(line: &Line) -> Self {
        Self { damping_per_s: line.resistance_kpa_s_ml / line.inertance_kpa_s2_ml }
    }
}

impl Resistance for Linear {
    #[inline]
    fn deceleration_ml_s2(&self, flow_ml_s: f64) -> f64 {
        self.damping_per_s * flow_ml_s
    }
    #[inline]
    fn damping_per_s(&self, _flow_ml_s: f64) -> f64 {
        self.damping_per_s
    }
}

/// A hose's friction, which grows with the flow, in place of a line's R.
#[cfg(feature = "identification")]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rough {
    friction: Friction,
    /// 1/L, mL/(s² kPa).
    per_inertance: f64,
}

#[cfg(feature = "identification")]
impl Rough {
    /// Of a hose whose L is that of the line.
    pub fn new(friction: Friction, line: &Line) -> Self {
        Self { friction, per_inertance: 1.0 / line.inertance_kpa_s2_ml }
    }
}

#[cfg(feature = "identification")]
impl Resistance for Rough {
    fn deceleration_ml_s2(&self, flow_ml_s: f64) -> f64 {
        self.per_inertance * self.friction.drop_kpa(flow_ml_s)
    }
    fn damping_per_s(&self, flow_ml_s: f64) -> f64 {
        self.per_inertance * self.friction.slope_kpa_s_ml(flow_ml_s)
    }
}

/// What a line resists, chosen when running.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Loss {
    /// R.
    Linear(Linear),
    /// A hose's friction.
    #[cfg(feature = "identification")]
    Rough(Rough),
}

impl Loss {
    /// R of a valid line.
    pub fn of(line: &Line) -> Self {
        Self::Linear(Linear::of(line))
    }

    /// The friction of the hose that is the line, or R of the line where there is none.
    #[cfg(feature = "identification")]
    pub fn with_friction(line: &Line, friction: Option<Friction>) -> Self {
        friction.map_or(Self::of(line), |friction| Self::Rough(Rough::new(friction, line)))
    }
}

impl Resistance for Loss {
    fn deceleration_ml_s2(&self, flow_ml_s: f64) -> f64 {
        match self {
            Self::Linear(linear) => linear.deceleration_ml_s2(flow_ml_s),
            #[cfg(feature = "identification")]
            Self::Rough(rough) => rough.deceleration_ml_s2(flow_ml_s),
        }
    }
    fn damping_per_s(&self, flow_ml_s: f64) -> f64 {
        match self {
            Self::Linear(linear) => linear.damping_per_s(flow_ml_s),
            #[cfg(feature = "identification")]
            Self::Rough(rough) => rough.damping_per_s(flow_ml_s),
        }
    }
}

/// One port of the pump between the rollers and its reservoir.
///
/// State: p = P - P_res, kPa; the line's flow Q_L, mL/s, positive from inlet to outlet; and with `N = 3` the
/// volume that has passed the line, mL. With s = 1 at the outlet and -1 at the inlet:
///
/// C dp/dt = s (Q - Q_L), L dQ_L/dt = s p - dP(Q_L), dV/dt = Q_L
///
/// dP(Q_L) is R Q_L for a [`Linear`] resistance.
#[derive(Debug, Clone, Copy)]
pub struct Circuit<F, R = Linear> {
    /// s/C, kPa/mL.
    pressure_per_volume: f64,
    /// s/L, mL/(s² kPa).
    flow_rate_per_pressure: f64,
    resistance: R,
    /// Q, the flow at the rollers.
    forcing: F,
}

impl<F: Forcing, R: Resistance> Circuit<F, R> {
    /// The circuit of a valid line at a port. Of the line C and L count; what it resists is `resistance`.
    pub fn new(line: &Line, resistance: R, port: Port, forcing: F) -> Self {
        let sign = match port {
            Port::Inlet => -1.0,
            Port::Outlet => 1.0,
        };
        Self {
            pressure_per_volume: sign / line.compliance_ml_kpa,
            flow_rate_per_pressure: sign / line.inertance_kpa_s2_ml,
            resistance,
            forcing,
        }
    }
}

impl<F: Forcing, R: Resistance, const N: usize> Ode<N> for Circuit<F, R> {
    fn derivative(&self, t: f64, y: &SVector<f64, N>) -> SVector<f64, N> {
        const { assert!(N == 2 || N == 3, "pressure and flow, or these and the volume") };
        let (pressure, flow) = (y[0], y[1]);
        let mut dy = SVector::zeros();
        dy[0] = self.pressure_per_volume * (self.forcing.flow_ml_s(t) - flow);
        dy[1] = self.flow_rate_per_pressure * pressure - self.resistance.deceleration_ml_s2(flow);
        if N == 3 {
            dy[2] = flow;
        }
        dy
    }

    fn jacobian(&self, _t: f64, y: &SVector<f64, N>) -> SMatrix<f64, N, N> {
        let mut j = SMatrix::zeros();
        j[(0, 1)] = -self.pressure_per_volume;
        j[(1, 0)] = self.flow_rate_per_pressure;
        j[(1, 1)] = -self.resistance.damping_per_s(y[1]);
        if N == 3 {
            j[(2, 1)] = 1.0;
        }
        j
    }

    fn time_derivative(&self, t: f64, _y: &SVector<f64, N>) -> SVector<f64, N> {
        let mut ft = SVector::zeros();
        ft[0] = self.pressure_per_volume * self.forcing.flow_rate_ml_s2(t);
        ft
    }
}

/// Errors allowed in a step of a [`Circuit`]: `tolerance` times `scale_kpa` + |P - P_res|, and the flow
/// and volume that carry the same energy. The volume's error is that of the flow it integrates, so it has no part
/// relative to the volume itself.
pub fn options<const N: usize>(line: &Line, tolerance: f64, scale_kpa: f64) -> Options<N> {
    let mut options = Options::uniform(tolerance);
    options.absolute[0] = tolerance * scale_kpa;
    options.absolute[1] = tolerance * scale_kpa * line.flow_scale_ml_s();
    if N == 3 {
        options.absolute[2] = tolerance * scale_kpa * line.compliance_ml_kpa;
        options.relative[2] = 0.0;
    }
    options
}
