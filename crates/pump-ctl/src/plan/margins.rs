//! How near a dose comes to its limits.

use pump_model::{Port, Pump};

use super::motion::Motion;
use super::{LimitedBy, Limits, Plan, PlanError};

/// How near a dose comes to a limit.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Margin {
    /// The worst that is predicted, kPa absolute or N m.
    pub reached: f64,
    /// The limit, in the same unit; of a torque what the motor has at that speed.
    pub limit: f64,
    /// How much of the limit is used: 0 as at rest, 1 at the limit, more beyond it.
    pub used: f64,
}

impl Margin {
    /// Of a pressure that is `rest` when nothing turns; `sign` is 1 for a limit from above and -1 for one from below.
    fn of_pressure(reached: f64, limit: f64, rest: f64, sign: f64) -> Self {
        let room = sign * (limit - rest);
        let used = if room > 0.0 {
            sign * (reached - rest) / room
        } else if sign * (reached - limit) > 0.0 {
            f64::INFINITY
        } else {
            1.0
        };
        Self { reached, limit, used }
    }

    /// Of a torque, not negative.
    pub(super) fn of_torque(needed_n_m: f64, limit_n_m: f64) -> Self {
        let used = if needed_n_m > 0.0 { needed_n_m / limit_n_m } else { 0.0 };
        Self { reached: needed_n_m, limit: limit_n_m, used }
    }
}

/// How near a dose comes to each limit that is given, start-up, stop and settling included: made by [`Limits::margins`].
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Margins {
    /// Pressure at the port that pushes.
    pub outlet: Option<Margin>,
    /// Pressure at the port that sucks.
    pub inlet: Option<Margin>,
    /// Torque of the motor while the rotor turns.
    pub torque: Option<Margin>,
}

impl Margins {
    /// The limit of which most is used, and how much; none if no limit is given.
    pub fn nearest(&self) -> Option<(LimitedBy, Margin)> {
        let all = [
            (LimitedBy::OutletPressure, self.outlet),
            (LimitedBy::InletPressure, self.inlet),
            (LimitedBy::Torque, self.torque),
        ];
        let given = all.into_iter().filter_map(|(limit, margin)| Some((limit, margin?)));
        given.max_by(|a, b| a.1.used.total_cmp(&b.1.used))
    }

    /// The limit that is broken most, if any is.
    pub(super) fn broken(&self) -> Option<(LimitedBy, Margin)> {
        self.nearest().filter(|(_, margin)| margin.used > 1.0)
    }
}

impl Limits {
    /// Whether anything but speed and acceleration is limited.
    pub(super) fn are_predicted(&self) -> bool {
        self.max_outlet_kpa.is_some() || self.min_inlet_kpa.is_some() || self.torque.is_some()
    }

    /// The ports that suck and push, in this order: in reverse they swap roles.
    pub(super) fn ports(direction: i8) -> [Port; 2] {
        if direction > 0 { [Port::Inlet, Port::Outlet] } else { [Port::Outlet, Port::Inlet] }
    }

    /// How near `plan` comes to these limits. Pressures are exact, a torque is known to about 0.2 % of the fluid's part of it.
    pub fn margins(&self, pump: &Pump, plan: &Plan) -> Result<Margins, PlanError> {
        if !self.are_predicted() {
            return Ok(Margins::default());
        }
        let motion = Motion::new(plan, pump);
        let [sucking, pushing] = Self::ports(plan.direction());
        let mut margins = Margins::default();
        if let Some(limit_kpa) = self.max_outlet_kpa {
            let reached_kpa = motion.extremes(pump, pushing).max_kpa;
            let rest_kpa = pump.line(pushing).reservoir_kpa;
            margins.outlet = Some(Margin::of_pressure(reached_kpa, limit_kpa, rest_kpa, 1.0));
        }
        if let Some(limit_kpa) = self.min_inlet_kpa {
            let reached_kpa = motion.extremes(pump, sucking).min_kpa;
            let rest_kpa = pump.line(sucking).reservoir_kpa;
            margins.inlet = Some(Margin::of_pressure(reached_kpa, limit_kpa, rest_kpa, -1.0));
        }
        margins.torque = self.torque.map(|torque| torque.worst(pump, &motion));
        Ok(margins)
    }
}
