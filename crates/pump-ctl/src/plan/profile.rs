//! Speed over time: up, cruise, down.

use pump_model::Leg;
use pump_model::math::sqrt;

/// A trapezoidal speed profile from rest to rest, or a triangle where the turn is too short to reach the cruise speed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Trapezoid {
    turn_rad: f64,
    cruise_rad_s: f64,
    peak_rad_s: f64,
    acceleration_rad_s2: f64,
    ramp_s: f64,
    cruise_s: f64,
}

impl Trapezoid {
    /// Turns `turn_rad` (not negative) at `cruise_rad_s` with ramps of `acceleration_rad_s2` (both positive).
    pub fn new(turn_rad: f64, cruise_rad_s: f64, acceleration_rad_s2: f64) -> Self {
        // Both ramps together turn peak² / acceleration.
        let peak_rad_s = cruise_rad_s.min(sqrt(acceleration_rad_s2 * turn_rad));
        let ramp_s = peak_rad_s / acceleration_rad_s2;
        let ramps_rad = peak_rad_s * ramp_s;
        let cruise_s = if peak_rad_s > 0.0 { ((turn_rad - ramps_rad) / peak_rad_s).max(0.0) } else { 0.0 };
        Self { turn_rad, cruise_rad_s, peak_rad_s, acceleration_rad_s2, ramp_s, cruise_s }
    }

    /// The fastest speed that is reached, rad/s.
    pub fn peak_rad_s(&self) -> f64 {
        self.peak_rad_s
    }

    /// Whether that is the cruise speed asked for.
    pub fn reaches_cruise(&self) -> bool {
        self.peak_rad_s >= self.cruise_rad_s
    }

    /// Acceleration of the ramps, rad/s².
    pub fn acceleration_rad_s2(&self) -> f64 {
        self.acceleration_rad_s2
    }

    /// Time from start to rest, s.
    pub fn duration_s(&self) -> f64 {
        2.0 * self.ramp_s + self.cruise_s
    }

    /// When the rotor has turned `turned_rad`, s since the start. Outside [0, turn] the nearer end.
    pub fn time_of(&self, turned_rad: f64) -> f64 {
        let ramp_rad = 0.5 * self.peak_rad_s * self.ramp_s;
        let left_rad = (self.turn_rad - turned_rad).max(0.0);
        if turned_rad <= ramp_rad {
            sqrt(2.0 * turned_rad.max(0.0) / self.acceleration_rad_s2)
        } else if left_rad < ramp_rad {
            self.duration_s() - sqrt(2.0 * left_rad / self.acceleration_rad_s2)
        } else {
            self.ramp_s + (turned_rad - ramp_rad) / self.peak_rad_s
        }
    }

    /// The motion from `start_rad` in `direction` (1 or -1), from time 0.
    pub fn legs(&self, start_rad: f64, direction: i8) -> [Leg; 3] {
        let sign = f64::from(direction);
        let (ramp_s, cruise_s) = (self.ramp_s, self.cruise_s);
        let ramp_rad = 0.5 * self.peak_rad_s * ramp_s;
        let leg = |start_s, duration_s, turned_rad: f64, speed: f64, acceleration: f64| Leg {
            start_s,
            duration_s,
            angle_rad: start_rad + sign * turned_rad,
            speed_rad_s: sign * speed,
            acceleration_rad_s2: sign * acceleration,
        };
        [
            leg(0.0, ramp_s, 0.0, 0.0, self.acceleration_rad_s2),
            leg(ramp_s, cruise_s, ramp_rad, self.peak_rad_s, 0.0),
            leg(
                ramp_s + cruise_s,
                ramp_s,
                self.turn_rad - ramp_rad,
                self.peak_rad_s,
                -self.acceleration_rad_s2,
            ),
        ]
    }
}
