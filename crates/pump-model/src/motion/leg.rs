//! Motions of the rotor: theta(t) as legs of constant acceleration.

use libm::sqrt;

/// A stretch of time with constant acceleration.
///
/// ```
/// use pump_model::Leg;
/// let ramp = Leg { duration_s: 2.0, acceleration_rad_s2: 3.0, ..Leg::constant_speed(0.5, 1.0) };
/// assert_eq!((ramp.speed_at(2.0), ramp.angle_at(2.0)), (7.0, 8.5));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Leg {
    /// Start of the leg, s.
    pub start_s: f64,
    /// Duration of the leg, s; infinite for a motor that runs or holds on.
    pub duration_s: f64,
    /// Angle at the start, rad, unwrapped.
    pub angle_rad: f64,
    /// Speed at the start, rad/s; negative in reverse.
    pub speed_rad_s: f64,
    /// Acceleration over the leg, rad/s².
    pub acceleration_rad_s2: f64,
}

impl Leg {
    /// Returns constant speed from `angle_rad` at time 0 on, for ever.
    pub fn constant_speed(angle_rad: f64, speed_rad_s: f64) -> Self {
        Self { start_s: 0.0, duration_s: f64::INFINITY, angle_rad, speed_rad_s, acceleration_rad_s2: 0.0 }
    }

    /// Returns rest at `angle_rad` from `start_s` on.
    pub fn rest(start_s: f64, angle_rad: f64) -> Self {
        Self { start_s, ..Self::constant_speed(angle_rad, 0.0) }
    }

    /// Returns this leg with the rollers `off_rad` farther on.
    #[must_use]
    pub fn beside(self, off_rad: f64) -> Self {
        Self { angle_rad: self.angle_rad + off_rad, ..self }
    }

    /// Returns the end of the leg, s.
    pub fn end_s(&self) -> f64 {
        self.start_s + self.duration_s
    }

    /// Returns the angle at time `t_s`, rad.
    pub fn angle_at(&self, t_s: f64) -> f64 {
        self.angle_rad + self.turned(t_s - self.start_s)
    }

    /// Returns the speed at time `t_s`, rad/s.
    pub fn speed_at(&self, t_s: f64) -> f64 {
        self.speed_rad_s + self.acceleration_rad_s2 * (t_s - self.start_s)
    }

    /// Returns the angle turned `elapsed_s` after the start, rad.
    pub(crate) fn turned(&self, elapsed_s: f64) -> f64 {
        elapsed_s * (self.speed_rad_s + 0.5 * self.acceleration_rad_s2 * elapsed_s)
    }

    /// Returns the angle at the end, rad. For a leg that never ends or has no duration it is the angle at the
    /// start.
    pub fn end_angle_rad(&self) -> f64 {
        if self.duration_s.is_finite() { self.angle_at(self.end_s()) } else { self.angle_rad }
    }

    /// Cuts the leg where it turns back, so each part has one direction. Returns the part before and the part
    /// after.
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

    /// Returns the direction: 1 forward, -1 in reverse, 0 at rest. It has a meaning only for a leg that does
    /// not turn back.
    pub(crate) fn direction(&self) -> f64 {
        if self.speed_rad_s != 0.0 {
            self.speed_rad_s.signum()
        } else if self.acceleration_rad_s2 != 0.0 {
            self.acceleration_rad_s2.signum()
        } else {
            0.0
        }
    }

    /// Returns the time from the start until the leg has turned `turn_rad` in its direction, s; none if it
    /// never does.
    pub(crate) fn time_to_turn(&self, turn_rad: f64) -> Option<f64> {
        if turn_rad == 0.0 {
            return Some(0.0);
        }
        let time = if self.acceleration_rad_s2 == 0.0 {
            turn_rad / self.speed_rad_s
        } else {
            let speed_squared =
                self.speed_rad_s * self.speed_rad_s + 2.0 * self.acceleration_rad_s2 * turn_rad;
            if speed_squared < 0.0 {
                return None;
            }
            // This form of the quadratic's root does not cancel.
            2.0 * turn_rad / (self.speed_rad_s + self.direction() * sqrt(speed_squared))
        };
        (time.is_finite() && time >= 0.0).then_some(time)
    }
}
