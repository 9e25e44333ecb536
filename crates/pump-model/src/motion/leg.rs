//! How the rotor moves: theta(t) as legs of constant acceleration.

use crate::math::sqrt;

/// A stretch of time with constant acceleration.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Leg {
    /// When it starts, s.
    pub start_s: f64,
    /// How long it lasts, s; infinite for a motor that runs or holds on.
    pub duration_s: f64,
    /// Angle at its start, rad, unwrapped.
    pub angle_rad: f64,
    /// Speed at its start, rad/s; negative in reverse.
    pub speed_rad_s: f64,
    /// Acceleration, rad/s².
    pub acceleration_rad_s2: f64,
}

impl Leg {
    /// Constant speed from `angle_rad` at time 0 on, for ever.
    pub fn constant_speed(angle_rad: f64, speed_rad_s: f64) -> Self {
        Self { start_s: 0.0, duration_s: f64::INFINITY, angle_rad, speed_rad_s, acceleration_rad_s2: 0.0 }
    }

    /// Rest at `angle_rad` from `start_s` on.
    pub fn rest(start_s: f64, angle_rad: f64) -> Self {
        Self { start_s, ..Self::constant_speed(angle_rad, 0.0) }
    }

    /// This leg with the rollers `off_rad` farther on.
    pub fn beside(self, off_rad: f64) -> Self {
        Self { angle_rad: self.angle_rad + off_rad, ..self }
    }

    /// When it ends, s.
    pub fn end_s(&self) -> f64 {
        self.start_s + self.duration_s
    }

    /// Angle at time `t_s`, rad.
    pub fn angle_at(&self, t_s: f64) -> f64 {
        self.angle_rad + self.turned(t_s - self.start_s)
    }

    /// Speed at time `t_s`, rad/s.
    pub fn speed_at(&self, t_s: f64) -> f64 {
        self.speed_rad_s + self.acceleration_rad_s2 * (t_s - self.start_s)
    }

    /// Angle turned `elapsed_s` after its start, rad.
    pub(crate) fn turned(&self, elapsed_s: f64) -> f64 {
        elapsed_s * (self.speed_rad_s + 0.5 * self.acceleration_rad_s2 * elapsed_s)
    }

    /// Angle at its end, rad; that of the start where it never ends or has no duration.
    pub fn end_angle_rad(&self) -> f64 {
        if self.duration_s.is_finite() { self.angle_at(self.end_s()) } else { self.angle_rad }
    }

    /// The leg cut where it turns back, so that each part has one direction: the part before and the part after.
    pub(crate) fn split_at_reversal(self) -> (Self, Option<Self>) {
        let turn_s = -self.speed_rad_s / self.acceleration_rad_s2;
        if !(turn_s > 0.0 && turn_s < self.duration_s) {
            return (self, None);
        }
        let before = Self { duration_s: turn_s, ..self };
        let after = Self {
            start_s: self.start_s + turn_s,
            duration_s: self.duration_s - turn_s,
            angle_rad: self.angle_rad + self.turned(turn_s),
            speed_rad_s: 0.0,
            acceleration_rad_s2: self.acceleration_rad_s2,
        };
        (before, Some(after))
    }

    /// 1 forward, -1 in reverse, 0 at rest. Meaningful for a leg that does not turn back.
    pub(crate) fn direction(&self) -> f64 {
        if self.speed_rad_s != 0.0 {
            self.speed_rad_s.signum()
        } else if self.acceleration_rad_s2 != 0.0 {
            self.acceleration_rad_s2.signum()
        } else {
            0.0
        }
    }

    /// Time from its start until it has turned `turn_rad` in its direction, s; none if it never does.
    pub(crate) fn time_to_turn(&self, turn_rad: f64) -> Option<f64> {
        let speed_squared = self.speed_rad_s * self.speed_rad_s + 2.0 * self.acceleration_rad_s2 * turn_rad;
        if turn_rad == 0.0 {
            return Some(0.0);
        }
        if speed_squared < 0.0 {
            return None;
        }
        // The form of the quadratic's root that does not cancel.
        let time = 2.0 * turn_rad / (self.speed_rad_s + self.direction() * sqrt(speed_squared));
        (time.is_finite() && time >= 0.0).then_some(time)
    }
}
