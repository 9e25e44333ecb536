//! The margin of a motion to the motor's torque.

use libm::ceil;
use pump_model::{Port, Pump, Stretches};

use super::margin::Margin;
use super::torque::Torque;
use crate::plan::prediction::ShortenedMotion;

impl Torque {
    /// Finds the margin where a motion comes nearest to the motor's torque, whether the motor drives or
    /// brakes.
    ///
    /// Between edges of the flow and corners of the motion the torque is smooth. Each such stretch gets looks
    /// at the torque, ends included, 4096 at most. They are a hundredth of a radian apart at most, and a
    /// tenth of a radian of the faster line's swing. Between two looks a sine of that line rises by 0.00125
    /// of its amplitude, a pulse by 0.0006 mL/rad. The looks miss about 0.2 % of the fluid's part.
    pub(super) fn worst(&self, pump: &Pump, motion: &ShortenedMotion) -> Margin {
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
