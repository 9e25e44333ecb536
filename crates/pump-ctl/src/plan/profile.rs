//! Speed over time: to the cruise speed, along, and down to rest.

use pump_model::Leg;
use pump_model::math::sqrt;

/// A trapezoidal speed profile that ends at rest, or a triangle where the turn is too short to reach the cruise speed.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Trapezoid {
    turn_rad: f64,
    start_rad_s: f64,
    cruise_rad_s: f64,
    /// The speed between the ramps.
    plateau_rad_s: f64,
    acceleration_rad_s2: f64,
    ramp_s: f64,
    cruise_s: f64,
    down_s: f64,
}

impl Trapezoid {
    /// Turns `turn_rad` (not negative) from rest at `cruise_rad_s` with ramps of `acceleration_rad_s2` (both positive).
    pub fn new(turn_rad: f64, cruise_rad_s: f64, acceleration_rad_s2: f64) -> Self {
        Self::from_speed(0.0, turn_rad, cruise_rad_s, acceleration_rad_s2)
    }

    /// The same for a rotor that turns at `start_rad_s` (not negative) already. `turn_rad` must be enough to stop it:
    /// start² / (2 acceleration).
    pub(super) fn from_speed(
        start_rad_s: f64,
        turn_rad: f64,
        cruise_rad_s: f64,
        acceleration_rad_s2: f64,
    ) -> Self {
        // Up to the peak and down from it turns (2 peak² - start²) / (2 acceleration).
        let peak_rad_s = sqrt(acceleration_rad_s2 * turn_rad + 0.5 * start_rad_s * start_rad_s);
        let plateau_rad_s = cruise_rad_s.min(peak_rad_s);
        let ramp_s = (plateau_rad_s - start_rad_s).abs() / acceleration_rad_s2;
        let down_s = plateau_rad_s / acceleration_rad_s2;
        let ramps_rad = 0.5 * (start_rad_s + plateau_rad_s) * ramp_s + 0.5 * plateau_rad_s * down_s;
        let cruise_s =
            if plateau_rad_s > 0.0 { ((turn_rad - ramps_rad) / plateau_rad_s).max(0.0) } else { 0.0 };
        Self {
            turn_rad,
            start_rad_s,
            cruise_rad_s,
            plateau_rad_s,
            acceleration_rad_s2,
            ramp_s,
            cruise_s,
            down_s,
        }
    }

    /// The fastest speed that is reached, rad/s.
    pub fn peak_rad_s(&self) -> f64 {
        self.plateau_rad_s.max(self.start_rad_s)
    }

    /// Whether the cruise speed asked for is reached.
    pub fn reaches_cruise(&self) -> bool {
        self.plateau_rad_s >= self.cruise_rad_s
    }

    /// Acceleration of the ramps, rad/s².
    pub fn acceleration_rad_s2(&self) -> f64 {
        self.acceleration_rad_s2
    }

    /// Time from start to rest, s.
    pub fn duration_s(&self) -> f64 {
        self.ramp_s + self.down_s + self.cruise_s
    }

    /// Acceleration of the first ramp, rad/s²; negative where the rotor is faster than the cruise speed at first.
    fn ramp_rad_s2(&self) -> f64 {
        if self.start_rad_s > self.plateau_rad_s {
            -self.acceleration_rad_s2
        } else {
            self.acceleration_rad_s2
        }
    }

    /// Angles turned at the ends of the first ramp and of the cruise, rad.
    pub(super) fn corners_rad(&self) -> [f64; 2] {
        let ramp_rad = 0.5 * (self.start_rad_s + self.plateau_rad_s) * self.ramp_s;
        let down_rad = 0.5 * self.plateau_rad_s * self.down_s;
        [ramp_rad, self.turn_rad - down_rad]
    }

    /// When the rotor has turned `turned_rad`, s since the start. Outside [0, turn] the nearer end.
    pub fn time_of(&self, turned_rad: f64) -> f64 {
        let [ramp_rad, cruised_rad] = self.corners_rad();
        if turned_rad <= ramp_rad {
            let turned_rad = turned_rad.max(0.0);
            let mean_rad_s = 0.5 * (self.start_rad_s + self.speed_at(turned_rad));
            if mean_rad_s > 0.0 { turned_rad / mean_rad_s } else { 0.0 }
        } else if turned_rad > cruised_rad {
            self.duration_s() - sqrt(2.0 * (self.turn_rad - turned_rad).max(0.0) / self.acceleration_rad_s2)
        } else {
            self.ramp_s + (turned_rad - ramp_rad) / self.plateau_rad_s
        }
    }

    /// Speed when the rotor has turned `turned_rad`, rad/s.
    pub(super) fn speed_at(&self, turned_rad: f64) -> f64 {
        let [ramp_rad, cruised_rad] = self.corners_rad();
        let square = if turned_rad <= ramp_rad {
            self.start_rad_s * self.start_rad_s + 2.0 * self.ramp_rad_s2() * turned_rad
        } else if turned_rad > cruised_rad {
            2.0 * self.acceleration_rad_s2 * (self.turn_rad - turned_rad)
        } else {
            return self.plateau_rad_s;
        };
        sqrt(square.max(0.0))
    }

    /// The motion from `start_rad` in `direction` (1 or -1), from time 0.
    pub fn legs(&self, start_rad: f64, direction: i8) -> [Leg; 3] {
        let sign = f64::from(direction);
        let [ramp_rad, cruised_rad] = self.corners_rad();
        let leg = |start_s, duration_s, turned_rad: f64, speed: f64, acceleration: f64| Leg {
            start_s,
            duration_s,
            angle_rad: start_rad + sign * turned_rad,
            speed_rad_s: sign * speed,
            acceleration_rad_s2: sign * acceleration,
        };
        let (up, down) = (self.ramp_rad_s2(), -self.acceleration_rad_s2);
        [
            leg(0.0, self.ramp_s, 0.0, self.start_rad_s, up),
            leg(self.ramp_s, self.cruise_s, ramp_rad, self.plateau_rad_s, 0.0),
            leg(self.ramp_s + self.cruise_s, self.down_s, cruised_rad, self.plateau_rad_s, down),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_follow_the_legs_from_rest_and_from_speed() {
        for (start, turn, cruise) in
            [(0.0, 30.0, 7.0), (0.0, 0.01, 7.0), (3.0, 30.0, 7.0), (9.0, 30.0, 2.0), (9.0, 0.1, 20.0)]
        {
            let profile = Trapezoid::from_speed(start, turn, cruise, 500.0);
            let legs = profile.legs(0.0, 1);
            assert!((legs[2].angle_at(profile.duration_s()) - turn).abs() < 1e-12);
            assert!(legs[2].speed_at(profile.duration_s()).abs() < 1e-9);
            for leg in legs {
                for part in [0.1, 0.5, 0.9] {
                    let t = leg.start_s + part * leg.duration_s;
                    assert!(
                        (profile.time_of(leg.angle_at(t)) - t).abs() < 1e-9,
                        "{start} {turn} {cruise} {t}"
                    );
                    assert!((profile.speed_at(leg.angle_at(t)) - leg.speed_at(t)).abs() < 1e-9);
                }
            }
        }
    }
}
