//! Resistance of a line to its flow: R, or the friction of a hose.

use crate::line::friction::Friction;
use crate::line::line::Line;

/// Resistance of a line, as the deceleration of its flow.
pub trait Resistance {
    /// Resisting pressure over L at `flow_ml_s`, mL/s².
    fn deceleration_ml_s2(&self, flow_ml_s: f64) -> f64;
    /// Derivative of the deceleration over the flow at `flow_ml_s`, 1/s.
    fn damping_per_s(&self, flow_ml_s: f64) -> f64;
}

/// Resistance R of a [`Line`], which is constant over the flow.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Linear {
    /// R/L, 1/s.
    damping_per_s: f64,
}

impl Linear {
    /// Returns the resistance of a valid line.
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

/// Friction of a hose, which grows with the flow and replaces a line's R.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rough {
    friction: Friction,
    /// 1/L, mL/(s² kPa).
    per_inertance: f64,
}

impl Rough {
    /// Builds the friction of a hose whose inertance is that of the line.
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

/// Resistance of a line, chosen at run time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Loss {
    /// Constant resistance R.
    Linear(Linear),
    /// Friction of a hose.
    Rough(Rough),
}

impl Loss {
    /// Returns R of a valid line.
    pub fn of(line: &Line) -> Self {
        Self::Linear(Linear::of(line))
    }

    /// Returns the friction of the line's hose, or R of the line if `friction` is none.
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
