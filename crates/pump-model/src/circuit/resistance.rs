//! Resistance of a line to its flow: R, or the friction of a hose.

use crate::line::friction::Friction;
use crate::line::line::Line;

/// Resistance of a line: the pressure that its flow takes.
pub trait Resistance {
    /// Returns the pressure that `flow_ml_s` takes, kPa, in the direction of the flow: negative at a negative
    /// flow.
    fn drop_kpa(&self, flow_ml_s: f64) -> f64;
    /// Returns the derivative of the drop over the flow at `flow_ml_s`, kPa s/mL.
    fn slope_kpa_s_ml(&self, flow_ml_s: f64) -> f64;
    /// Returns R, kPa s/mL, if the drop is R times the flow at every flow. A model divides such an R by the
    /// inertance once, not at every evaluation. None unless a resistance says so.
    fn constant_kpa_s_ml(&self) -> Option<f64> {
        None
    }
}

/// Resistance R of a [`Line`], which is constant over the flow.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Linear {
    /// Resistance R, kPa s/mL.
    pub resistance_kpa_s_ml: f64,
}

impl Linear {
    /// Returns the resistance of a valid line.
    pub fn of(line: &Line) -> Self {
        Self { resistance_kpa_s_ml: line.resistance_kpa_s_ml }
    }
}

impl Resistance for Linear {
    #[inline]
    fn drop_kpa(&self, flow_ml_s: f64) -> f64 {
        self.resistance_kpa_s_ml * flow_ml_s
    }
    #[inline]
    fn slope_kpa_s_ml(&self, _flow_ml_s: f64) -> f64 {
        self.resistance_kpa_s_ml
    }
    fn constant_kpa_s_ml(&self) -> Option<f64> {
        Some(self.resistance_kpa_s_ml)
    }
}

/// The friction of a hose grows with the flow and replaces a line's R.
impl Resistance for Friction {
    fn drop_kpa(&self, flow_ml_s: f64) -> f64 {
        Self::drop_kpa(self, flow_ml_s)
    }
    fn slope_kpa_s_ml(&self, flow_ml_s: f64) -> f64 {
        Self::slope_kpa_s_ml(self, flow_ml_s)
    }
}

/// Resistance of a line, chosen at run time.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Loss {
    /// Constant resistance R.
    Linear(Linear),
    /// Friction of a hose.
    Rough(Friction),
}

impl Loss {
    /// Returns R of a valid line.
    pub fn of(line: &Line) -> Self {
        Self::Linear(Linear::of(line))
    }

    /// Returns the friction of the line's hose, or R of the line if `friction` is none.
    pub fn with_friction(line: &Line, friction: Option<Friction>) -> Self {
        friction.map_or(Self::of(line), Self::Rough)
    }
}

impl Resistance for Loss {
    fn drop_kpa(&self, flow_ml_s: f64) -> f64 {
        match self {
            Self::Linear(linear) => linear.drop_kpa(flow_ml_s),
            Self::Rough(friction) => friction.drop_kpa(flow_ml_s),
        }
    }
    fn slope_kpa_s_ml(&self, flow_ml_s: f64) -> f64 {
        match self {
            Self::Linear(linear) => linear.slope_kpa_s_ml(flow_ml_s),
            Self::Rough(friction) => friction.slope_kpa_s_ml(flow_ml_s),
        }
    }
    fn constant_kpa_s_ml(&self) -> Option<f64> {
        match self {
            Self::Linear(linear) => linear.constant_kpa_s_ml(),
            Self::Rough(friction) => friction.constant_kpa_s_ml(),
        }
    }
}

/// Resistance of a line over its inertance: the deceleration of its flow.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Deceleration<R> {
    resistance: R,
    /// 1/L, mL/(s² kPa).
    per_inertance: f64,
    /// R/L of a constant resistance, 1/s.
    constant_per_s: Option<f64>,
}

impl<R: Resistance> Deceleration<R> {
    pub(crate) fn new(resistance: R, line: &Line) -> Self {
        let inertance = line.inertance_kpa_s2_ml;
        let constant_per_s = resistance.constant_kpa_s_ml().map(|constant| constant / inertance);
        Self { resistance, per_inertance: 1.0 / inertance, constant_per_s }
    }

    /// Returns true if the deceleration is in proportion to the flow.
    pub(crate) fn is_linear(&self) -> bool {
        self.constant_per_s.is_some()
    }

    /// Returns the resisting pressure over L at `flow_ml_s`, mL/s².
    #[inline]
    pub(crate) fn at_ml_s2(&self, flow_ml_s: f64) -> f64 {
        match self.constant_per_s {
            Some(constant) => constant * flow_ml_s,
            None => self.per_inertance * self.resistance.drop_kpa(flow_ml_s),
        }
    }

    /// Returns the derivative of the deceleration over the flow at `flow_ml_s`, 1/s.
    #[inline]
    pub(crate) fn damping_per_s(&self, flow_ml_s: f64) -> f64 {
        self.constant_per_s.unwrap_or_else(|| self.per_inertance * self.resistance.slope_kpa_s_ml(flow_ml_s))
    }
}
