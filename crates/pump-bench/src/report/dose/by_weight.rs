//! The weighing of a dose that a balance ended.

use libm::log10;
use serde::Serialize;

use crate::bench::{DeliveredByWeight, PreparedByWeight};
use crate::numbers::significant;

/// The weighing of a dose that a balance ended.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct ByWeightReport {
    /// Mass that the balance was to show, g.
    pub target_g: f64,
    /// Mass that the balance shows, g. Of a dose that was stopped it is the last reading, and more still arrives.
    pub mass_g: f64,
    /// True if that mass was read at rest, when the dose was complete.
    pub at_rest: bool,
    /// Step of the balance's last digit, g.
    pub digit_g: f64,
    /// Volume that the pump turned for by the model, mL.
    pub turned_ml: f64,
    /// Most volume by the model that the pump might turn for, mL.
    pub most_ml: f64,
    /// Stretches of the motion. Each was weighed at rest.
    pub stretches: u32,
    /// Stretches that the balance stopped before the end of their plan.
    pub stopped_by_balance: u32,
    /// Time of flow by which the dose reckoned with what still arrives after a stop, s; null if the motor is simulated.
    pub reckoned_s: Option<f64>,
    /// True if that time was learned from earlier doses, false if it is the model's; null if the motor is simulated.
    pub reckoned_learned: Option<bool>,
    /// Mean time of flow that still arrived after a stop, s, over the stops on record; null if none told it.
    pub after_stop_s: Option<f64>,
    /// Standard deviation of these times, s.
    pub after_stop_spread_s: Option<f64>,
    /// Number of stops on record.
    pub after_stop_stops: Option<u32>,
    /// Carry of earlier doses that was dropped, mL.
    pub dropped_ml: f64,
}

impl ByWeightReport {
    /// Reports the weighing of a dose that was delivered.
    pub(in crate::report) fn of(prepared: &PreparedByWeight, delivered: &DeliveredByWeight) -> Self {
        let after = delivered.after_stop;
        Self {
            target_g: prepared.target_g(),
            mass_g: delivered.mass_g,
            at_rest: delivered.completed,
            digit_g: delivered.digit_g,
            turned_ml: delivered.turned_ml,
            most_ml: prepared.most_ml,
            stretches: delivered.stretches,
            stopped_by_balance: delivered.stopped_by_balance,
            reckoned_s: delivered.reckoned_s.map(|(time_s, _)| time_s),
            reckoned_learned: delivered.reckoned_s.map(|(_, is_learned)| is_learned),
            after_stop_s: after.map(|after| after.mean_s),
            after_stop_spread_s: after.map(|after| after.spread_s()),
            after_stop_stops: after.map(|after| after.stops),
            dropped_ml: delivered.dropped_ml,
        }
    }

    /// The line of the weighing for people.
    pub(in crate::report) fn line(&self) -> String {
        let decimals = (-log10(self.digit_g)).clamp(0.0, 6.0).round() as usize;
        let when = if self.at_rest { "" } else { " when the motor was stopped, and rising," };
        let weighed = format!(
            "by weight: {:.decimals$} g of {:.decimals$} g{when} in {} {}; the pump turned for {} mL by the model, {} \
             mL at most\n",
            self.mass_g,
            self.target_g,
            self.stretches,
            if self.stretches == 1 { "stretch" } else { "stretches" },
            significant(self.turned_ml, 5),
            significant(self.most_ml, 5),
        );
        let Some((time_s, is_learned)) = self.reckoned_s.zip(self.reckoned_learned) else { return weighed };
        let source = if is_learned { "learned before" } else { "the model's first value" };
        let now = self.after_stop_s.zip(self.after_stop_stops).map_or(String::new(), |(mean_s, stops)| {
            let plural = if stops == 1 { "" } else { "s" };
            format!("; {stops} stop{plural} on record now tell {} s", significant(mean_s, 2))
        });
        format!(
            "{weighed}flow that still arrives after a stop: that of {} s was reckoned with, {source}{now}\n",
            significant(time_s, 2)
        )
    }
}
