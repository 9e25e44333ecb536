//! The torque that a dose asks of the motor.

use pump_model::math::ceil;
use pump_model::{Port, Pump, Stretches};

use super::PlanError;
use super::margins::Margin;
use super::motion::Motion;

/// Most points of a [`TorqueCurve`].
pub const TORQUE_POINTS: usize = 8;

/// 1 kPa mL/rad is so many N m.
const N_M: f64 = 1e-3;

/// What the motor can give at the pump head over its speed: straight lines between points.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct TorqueCurve {
    /// (rad/s, N m), rising in speed; the last is repeated in the places left.
    points: [(f64, f64); TORQUE_POINTS],
}

impl TorqueCurve {
    /// From (speed in rad/s, torque in N m) at the pump head: 2 to [`TORQUE_POINTS`] points, the first at speed 0, speeds
    /// rising, torques not negative. `None` if they are not that. Beyond the last speed the motor gives nothing.
    pub fn new(points: &[(f64, f64)]) -> Option<Self> {
        let last = points.last()?;
        let mut curve = Self { points: [*last; TORQUE_POINTS] };
        let rising = points.windows(2).all(|two| matches!(two, [a, b] if a.0 < b.0));
        let starts = points.first().is_some_and(|first| first.0 == 0.0);
        let allowed = |(speed, torque): &(f64, f64)| speed.is_finite() && (0.0..=1e6).contains(torque);
        let counts = (2..=TORQUE_POINTS).contains(&points.len());
        for (slot, point) in curve.points.iter_mut().zip(points) {
            *slot = *point;
        }
        (counts && rising && starts && points.iter().all(allowed)).then_some(curve)
    }

    /// A curve from what [`Self::precomputed_points`] said of it, for constants. Nothing is checked.
    pub const fn precomputed(points: [(f64, f64); TORQUE_POINTS]) -> Self {
        Self { points }
    }

    /// (rad/s, N m), rising in speed; the last is repeated in the places left.
    pub fn precomputed_points(&self) -> [(f64, f64); TORQUE_POINTS] {
        self.points
    }

    /// Torque at a speed, not negative, N m; 0 beyond the last.
    pub fn at(&self, speed_rad_s: f64) -> f64 {
        let [.., (last_rad_s, _)] = self.points;
        // A speed at the end of the curve may round to a hair more.
        let rounded = speed_rad_s > last_rad_s && speed_rad_s <= last_rad_s * (1.0 + 1e-9);
        let speed_rad_s = if rounded { last_rad_s } else { speed_rad_s };
        let parts = self.points.iter().zip(self.points.iter().skip(1));
        for ((from, torque), (to, next)) in parts {
            if speed_rad_s <= *to && to > from {
                return torque + (next - torque) * ((speed_rad_s - from) / (to - from));
            }
        }
        0.0
    }

    /// Smallest torque at any speed up to this, N m.
    pub(super) fn least_to(&self, speed_rad_s: f64) -> f64 {
        let below = self.points.iter().filter(|(speed, _)| *speed <= speed_rad_s);
        below.fold(self.at(speed_rad_s), |least, (_, torque)| least.min(*torque))
    }
}

/// What turning takes besides the pressures, and what the motor has. All at the pump head, gear included.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Torque {
    /// Torque that squeezing the tube takes at any speed, N m, 0 to 1e6.
    pub occlusion_n_m: f64,
    /// Moment of inertia of all that turns, kg m², 0 to 1e6.
    pub inertia_kg_m2: f64,
    /// Ambient pressure, kPa absolute: the pressures do work against it.
    pub ambient_kpa: f64,
    /// What the motor can give.
    pub motor: TorqueCurve,
}

impl Torque {
    pub(super) fn validate(&self) -> Result<(), PlanError> {
        let within = |parameter, value: f64, range: core::ops::RangeInclusive<f64>, allowed| {
            if range.contains(&value) {
                Ok(())
            } else {
                Err(PlanError::OutOfRange { parameter, value, allowed })
            }
        };
        within("occlusion torque in N m", self.occlusion_n_m, 0.0..=1e6, "0 to 1e6")?;
        within("inertia in kg m2", self.inertia_kg_m2, 0.0..=1e6, "0 to 1e6")?;
        within("ambient pressure in kPa absolute", self.ambient_kpa, 0.0..=1e6, "0 to 1e6")
    }

    /// What the motor has to give in the direction of motion, N m, by power balance: negative where it brakes.
    ///
    /// tau = (P_out - P_atm) q_out - (P_in - P_atm) q_in + J alpha + tau_occlusion, q the flow per radian; in reverse the fluid's
    /// part has the other sign, since the same flow per radian runs back.
    fn needed_n_m(&self, [inlet, outlet]: [(f64, f64); 2], acceleration_rad_s2: f64, direction: f64) -> f64 {
        let work = |(pressure_kpa, flow_ml_rad)| (pressure_kpa - self.ambient_kpa) * flow_ml_rad;
        let fluid_n_m = N_M * (work(outlet) - work(inlet));
        direction * (fluid_n_m + self.inertia_kg_m2 * acceleration_rad_s2) + self.occlusion_n_m
    }

    /// More than is needed at any time of a motion from rest up to `speed_rad_s`, N m, where pressures stay within `within_kpa`
    /// of the reservoirs and flows per radian below `flow_ml_rad`.
    pub(super) fn bound_n_m(
        &self,
        pump: &Pump,
        within_kpa: [f64; 2],
        flow_ml_rad: f64,
        acceleration_rad_s2: f64,
    ) -> f64 {
        let [inlet, outlet] = [(pump.inlet(), within_kpa[0]), (pump.outlet(), within_kpa[1])]
            .map(|(line, within_kpa)| (line.reservoir_kpa - self.ambient_kpa).abs() + within_kpa);
        let fluid_n_m = N_M * flow_ml_rad * (inlet + outlet);
        fluid_n_m + self.inertia_kg_m2 * acceleration_rad_s2 + self.occlusion_n_m
    }

    /// Where a motion comes nearest to what the motor can give, whether it drives or brakes.
    ///
    /// Between edges of the flow and corners of the motion everything is smooth; there the torque is looked at, ends included, at
    /// least every hundredth of a radian and every tenth of a radian of the faster line's swing, 4096 times at most. Between two
    /// looks a sine of that line rises by 0.00125 of its amplitude, a pulse by 0.0006 mL/rad: what is missed is about 0.2 % of
    /// the fluid's part.
    pub(super) fn worst(&self, pump: &Pump, motion: &Motion) -> Margin {
        const TURN_RAD: f64 = 0.01;
        const SWING_RAD: f64 = 0.1;
        let swing_s = SWING_RAD / pump.inlet().natural_rad_s().max(pump.outlet().natural_rad_s());
        let stretches = |port| Stretches::new(pump.curve(port), motion.legs());
        let (mut inlets, mut outlets) = (stretches(Port::Inlet), stretches(Port::Outlet));
        let (mut inlet_run, mut outlet_run) = (motion.run(pump, Port::Inlet), motion.run(pump, Port::Outlet));
        let end_s = motion.duration_s();
        let mut worst = Margin { reached: 0.0, limit: self.motor.at(0.0), used: 0.0 };

        let (mut inlet, mut outlet) = (inlets.next(), outlets.next());
        let mut from_s = 0.0;
        while let (Some(at_inlet), Some(at_outlet)) = (inlet, outlet) {
            let to_s = at_inlet.end_s.min(at_outlet.end_s).min(end_s);
            let leg = at_outlet.leg;
            let fastest_rad_s = leg.speed_at(from_s).abs().max(leg.speed_at(to_s).abs());
            let look_s = swing_s.min(TURN_RAD / fastest_rad_s);
            let looks = ceil((to_s - from_s) / look_s).clamp(1.0, 4096.0);
            let mut look = 0.0;
            while look <= looks {
                let t_s = from_s + (to_s - from_s) * (look / looks);
                let ports = [
                    (inlet_run.pressure_kpa(t_s), at_inlet.flow_ml_rad(t_s)),
                    (outlet_run.pressure_kpa(t_s), at_outlet.flow_ml_rad(t_s)),
                ];
                let direction = motion.direction();
                let needed_n_m = self.needed_n_m(ports, leg.acceleration_rad_s2, direction).abs();
                let margin = Margin::of_torque(needed_n_m, self.motor.at(leg.speed_at(t_s).abs()));
                if margin.used > worst.used {
                    worst = margin;
                }
                look += 1.0;
            }
            if to_s >= end_s {
                break;
            }
            if at_inlet.end_s <= to_s {
                inlet = inlets.next();
            }
            if at_outlet.end_s <= to_s {
                outlet = outlets.next();
            }
            from_s = to_s;
        }
        worst
    }
}
