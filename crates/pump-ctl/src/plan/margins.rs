//! How near a dose comes to its limits.

use pump_model::{Extremes, Port, Pump};

use super::motion::Motion;
use super::{LimitedBy, Limits, Lowest, Plan};

/// How near a dose comes to a limit.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Margin {
    /// The worst that is predicted, kPa absolute or N m; of a pressure with what a single motor step adds.
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
    /// Smallest pressure at the port that pushes.
    pub outlet_suction: Option<Margin>,
    /// Torque of the motor while the rotor turns.
    pub torque: Option<Margin>,
}

impl Margins {
    /// The limit of which most is used, and how much; none if no limit is given.
    pub fn nearest(&self) -> Option<(LimitedBy, Margin)> {
        let all = [
            (LimitedBy::OutletPressure, self.outlet),
            (LimitedBy::InletPressure, self.inlet),
            (LimitedBy::OutletSuction, self.outlet_suction),
            (LimitedBy::Torque, self.torque),
        ];
        let given = all.into_iter().filter_map(|(limit, margin)| Some((limit, margin?)));
        given.max_by(|a, b| a.1.used.total_cmp(&b.1.used))
    }

    /// The limit that is broken most, if any is.
    pub(super) fn broken(&self) -> Option<(LimitedBy, Margin)> {
        self.nearest().filter(|(_, margin)| margin.used > 1.0)
    }

    /// Of each limit the worse.
    fn and(self, other: Self) -> Self {
        let worse = |a: Option<Margin>, b: Option<Margin>| {
            a.into_iter().chain(b).max_by(|a, b| a.used.total_cmp(&b.used))
        };
        Self {
            outlet: worse(self.outlet, other.outlet),
            inlet: worse(self.inlet, other.inlet),
            outlet_suction: worse(self.outlet_suction, other.outlet_suction),
            torque: worse(self.torque, other.torque),
        }
    }
}

impl Limits {
    /// Whether anything but speed and acceleration is limited.
    pub(super) fn are_predicted(&self) -> bool {
        self.max_outlet_kpa.is_some() || self.lowest_where_it_sucks().is_some() || self.torque.is_some()
    }

    /// The ports that suck and push, in this order: in reverse they swap roles.
    pub(super) fn ports(direction: i8) -> [Port; 2] {
        if direction > 0 { [Port::Inlet, Port::Outlet] } else { [Port::Outlet, Port::Inlet] }
    }

    /// How near `plan` comes to these limits, from wherever the rollers may stand. Pressures are exact, a torque is known to about
    /// 0.2 % of the fluid's part of it.
    pub fn margins(&self, pump: &Pump, plan: &Plan) -> Margins {
        let beside = plan.start.beside(pump.pitch_rad());
        beside.fold(Margins::default(), |worst, off_rad| worst.and(self.margins_beside(pump, plan, off_rad)))
    }

    /// Whether `plan` breaks a limit from somewhere, and which one.
    pub(super) fn broken(&self, pump: &Pump, plan: &Plan) -> Option<(LimitedBy, Margin)> {
        let mut beside = plan.start.beside(pump.pitch_rad());
        beside.find_map(|off_rad| self.margins_beside(pump, plan, off_rad).broken())
    }

    /// Of rollers `off_rad` beside the middle of the angles that may be.
    fn margins_beside(&self, pump: &Pump, plan: &Plan, off_rad: f64) -> Margins {
        let mut margins = Margins::default();
        if !self.are_predicted() {
            return margins;
        }
        let motion = Motion::new(plan, pump, off_rad);
        let [sucking, pushing] = Self::ports(plan.direction());
        let [rest_sucking, rest_pushing] = [sucking, pushing].map(|port| pump.line(port).reservoir_kpa);
        let [step_sucking, step_pushing] = [sucking, pushing].map(|port| plan.step_kpa(pump, port));
        if self.max_outlet_kpa.is_some() || self.lowest.is_some() {
            let Extremes { min_kpa, max_kpa } = motion.extremes(pump, pushing);
            let highest = |limit| Margin::of_pressure(max_kpa + step_pushing, limit, rest_pushing, 1.0);
            let lowest =
                |lowest: Lowest| Margin::of_pressure(min_kpa - step_pushing, lowest.kpa, rest_pushing, -1.0);
            margins.outlet = self.max_outlet_kpa.map(highest);
            margins.outlet_suction = self.lowest.map(lowest);
        }
        if let Some(lowest) = self.lowest_where_it_sucks() {
            let reached_kpa = motion.extremes(pump, sucking).min_kpa - step_sucking;
            margins.inlet = Some(Margin::of_pressure(reached_kpa, lowest.kpa, rest_sucking, -1.0));
        }
        margins.torque = self.torque.map(|torque| torque.worst(pump, &motion));
        margins
    }
}
