//! The margins of a plan.

use pump_model::{Extremes, Port, Pump};

use super::bound::Bound;
use super::limits::Limits;
use super::margin::Margin;
use super::margins::Margins;
use super::pressure_limits::Lowest;
use crate::plan::Plan;
use crate::plan::prediction::ShortenedMotion;
use crate::step::Direction;

impl Limits {
    /// Returns the suction port and the discharge port, in this order. In reverse, inlet and outlet swap
    /// these roles.
    pub(in crate::plan) fn ports(direction: Direction) -> [Port; 2] {
        match direction {
            Direction::Forward => [Port::Inlet, Port::Outlet],
            Direction::Reverse => [Port::Outlet, Port::Inlet],
        }
    }

    /// Computes the margins of `plan` to these limits, the worst from any angle at which the rollers may
    /// stand.
    ///
    /// Pressures are exact. A torque is known to about 0.2 % of the fluid's part of it.
    pub fn margins(&self, pump: &Pump, plan: &Plan) -> Margins {
        let beside = plan.start.beside(pump.pitch_rad());
        beside.fold(Margins::default(), |worst, off_rad| worst.and(self.margins_beside(pump, plan, off_rad)))
    }

    /// Returns a limit that `plan` breaks from some angle at which the rollers may stand, or `None` if it
    /// holds every limit.
    pub(in crate::plan) fn broken(&self, pump: &Pump, plan: &Plan) -> Option<(Bound, Margin)> {
        let mut beside = plan.start.beside(pump.pitch_rad());
        beside.find_map(|off_rad| self.margins_beside(pump, plan, off_rad).broken())
    }

    /// Computes the margins where the rollers stand `off_rad` beside the middle of their range.
    fn margins_beside(&self, pump: &Pump, plan: &Plan, off_rad: f64) -> Margins {
        let mut margins = Margins::default();
        if !self.are_predicted() {
            return margins;
        }
        let motion = ShortenedMotion::new(plan, pump, off_rad);
        let [sucking, pushing] = Self::ports(plan.direction());
        let [rest_sucking, rest_pushing] = [sucking, pushing].map(|port| pump.line(port).reservoir_kpa);
        let [step_sucking, step_pushing] = [sucking, pushing].map(|port| plan.step_kpa(pump, port));
        if self.pressures.max_outlet_kpa.is_some() || self.lowest.is_some() {
            let Extremes { min_kpa, max_kpa } = motion.extremes(pump, pushing);
            let highest = |limit| Margin::of_pressure(max_kpa + step_pushing, limit, rest_pushing, 1.0);
            let lowest =
                |lowest: Lowest| Margin::of_pressure(min_kpa - step_pushing, lowest.kpa, rest_pushing, -1.0);
            margins.outlet = self.pressures.max_outlet_kpa.map(highest);
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
