//! How a line resists the flow in it: by its R, or by the friction of a hose.

use crate::line::friction::Friction;
use crate::line::line::Line;

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
    /// Resistance of a valid line.
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
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rough {
    friction: Friction,
    /// 1/L, mL/(s² kPa).
    per_inertance: f64,
}

impl Rough {
    /// Friction of a hose whose L is that of the line.
    pub fn new(friction: Friction, line: &Line) -> Self {
        Self { friction, per_inertance: 1.0 / line.inertance_kpa_s2_ml }
    }
}

impl Resistance for Rough {
    fn deceleration_ml_s2(&self, flow_ml_s: f64) -> f64 {
        self.per_inertance * self.friction.drop_kpa(flow_ml_s)
    }
    fn damping_per_s(&self, flow_ml_s: f64) -> f64 {
        self.per_inertance * self.friction.slope_kpa_s_ml(flow_ml_s)
    }
}

/// Resistance of a line, chosen when running.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Loss {
    /// R.
    Linear(Linear),
    /// A hose's friction.
    Rough(Rough),
}

impl Loss {
    /// R of a valid line.
    pub fn of(line: &Line) -> Self {
        Self::Linear(Linear::of(line))
    }

    /// The friction of the hose that is the line, or R of the line where there is none.
    pub fn with_friction(line: &Line, friction: Option<Friction>) -> Self {
        friction.map_or(Self::of(line), |friction| Self::Rough(Rough::new(friction, line)))
    }
}

impl Resistance for Loss {
    fn deceleration_ml_s2(&self, flow_ml_s: f64) -> f64 {
        match self {
            Self::Linear(linear) => linear.deceleration_ml_s2(flow_ml_s),
            Self::Rough(rough) => rough.deceleration_ml_s2(flow_ml_s),
        }
    }
    fn damping_per_s(&self, flow_ml_s: f64) -> f64 {
        match self {
            Self::Linear(linear) => linear.damping_per_s(flow_ml_s),
            Self::Rough(rough) => rough.damping_per_s(flow_ml_s),
        }
    }
}
