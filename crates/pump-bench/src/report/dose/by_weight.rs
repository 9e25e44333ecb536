//! The weighing of a dose that a balance ended.

use libm::log10;
use serde::Serialize;

use crate::bench::{DeliveredByWeight, PreparedByWeight, ToleranceBy};
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
    /// Least volume by the model that the pump turned for, mL, over the angles at which the rollers may have stood.
    pub turned_least_ml: f64,
    /// Most volume by the model that the pump turned for, mL, over these angles.
    pub turned_most_ml: f64,
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
    /// Volume on the balance, mL, of the part of the dose that an earlier command made; 0 if one command made it all.
    pub before_ml: f64,
    /// Mass that the dose may lack when it is done, g.
    pub tolerance_g: f64,
    /// Reason of that tolerance: a digit of the balance, half a drop, or a motor step.
    pub tolerance_by: ToleranceBy,
    /// Time from the first step to the last reading, s, the weighing between the stretches included; null if the motor
    /// is simulated.
    pub took_s: Option<f64>,
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
            turned_least_ml: delivered.turned_range_ml.0,
            turned_most_ml: delivered.turned_range_ml.1,
            most_ml: prepared.most_ml,
            stretches: delivered.stretches,
            stopped_by_balance: delivered.stopped_by_balance,
            reckoned_s: delivered.reckoned_s.map(|(time_s, _)| time_s),
            reckoned_learned: delivered.reckoned_s.map(|(_, is_learned)| is_learned),
            after_stop_s: after.map(|after| after.mean_s),
            after_stop_spread_s: after.map(|after| after.spread_s()),
            after_stop_stops: after.map(|after| after.stops),
            dropped_ml: delivered.dropped_ml,
            before_ml: delivered.before_ml,
            tolerance_g: delivered.tolerance_g,
            tolerance_by: delivered.tolerance_by,
            took_s: delivered.took_s,
        }
    }

    /// The part of an earlier command, for people.
    fn before(&self) -> String {
        match self.before_ml {
            0.0 => String::new(),
            before_ml => format!(" after {} mL of an earlier command", significant(before_ml, 4)),
        }
    }

    /// The volume by the model that the pump turned for, for people: a range where nobody knows the angle.
    fn turned(&self) -> String {
        let (least_ml, most_ml) = (self.turned_least_ml, self.turned_most_ml);
        if most_ml - least_ml <= 0.01 * most_ml.abs() {
            return format!("the pump turned for {} mL by the model", significant(self.turned_ml, 5));
        }
        let [least, most] = [least_ml, most_ml].map(|ml| significant(ml, 3));
        format!("the pump turned for {least} to {most} mL by the model, as the rollers may have stood")
    }

    /// The reason for which the dose comes no nearer to its mass, for people, if it lacks more than a digit.
    fn lacks(&self) -> String {
        let lacks_g = self.target_g - self.mass_g;
        if !self.at_rest || lacks_g < 1.5 * self.digit_g {
            return String::new();
        }
        let why = match self.tolerance_by {
            ToleranceBy::Digit => "the balance tells no less than a digit",
            ToleranceBy::Drop => "a drop falls whole, so that half of one may lack",
            ToleranceBy::Step => "the motor makes whole steps",
        };
        format!(
            ", {} g less than asked: {why} ({} g)",
            significant(lacks_g, 2),
            significant(self.tolerance_g, 2)
        )
    }

    /// The reason for which the dose has more than its mass, for people, if it is more than a digit.
    fn exceeds(&self) -> String {
        let more_g = self.mass_g - self.target_g;
        if !self.at_rest || more_g < 1.5 * self.digit_g {
            return String::new();
        }
        let of_drop =
            self.tolerance_by == ToleranceBy::Drop && more_g <= 2.0 * self.tolerance_g + self.digit_g;
        let why = if of_drop {
            format!("a drop falls whole ({} g)", significant(2.0 * self.tolerance_g, 2))
        } else {
            "more arrived after a stop than was reckoned with".to_owned()
        };
        format!(", {} g more than asked: {why}", significant(more_g, 2))
    }

    /// The time of the motion and that of the whole dose, for people.
    pub(in crate::report) fn times(&self, motion_s: f64) -> String {
        let in_all =
            self.took_s.map_or(String::new(), |took_s| format!(", {took_s:.1} s with the weighing,"));
        format!("the motor turned for {motion_s:.3} s{in_all}")
    }

    /// The line of the weighing for people.
    pub(in crate::report) fn line(&self) -> String {
        let decimals = (-log10(self.digit_g)).clamp(0.0, 6.0).round() as usize;
        let when = if self.at_rest { "" } else { " when the motor was stopped, and rising," };
        let weighed = format!(
            "by weight: {:.decimals$} g of {:.decimals$} g{when} in {} {}{}{}{}; {}, {} mL at most\n",
            self.mass_g,
            self.target_g,
            self.stretches,
            if self.stretches == 1 { "stretch" } else { "stretches" },
            self.before(),
            self.lacks(),
            self.exceeds(),
            self.turned(),
            significant(self.most_ml, 5),
        );
        let Some((time_s, is_learned)) = self.reckoned_s.zip(self.reckoned_learned) else { return weighed };
        let source = if is_learned { "learned before" } else { "the model's first value" };
        let is_of_any_angle = self.turned_least_ml < self.turned_most_ml;
        let unlearned = match is_of_any_angle {
            true => "; it is learned from an angle that is known to better than 2 deg alone",
            false => "",
        };
        let told = self.after_stop_s.zip(self.after_stop_stops);
        let now = told.map_or(unlearned.to_owned(), |(mean_s, stops)| {
            let plural = if stops == 1 { "" } else { "s" };
            format!("; {stops} stop{plural} on record now tell {} s", significant(mean_s, 2))
        });
        format!(
            "{weighed}flow that still arrives after a stop: that of {} s was reckoned with, {source}{now}\n",
            significant(time_s, 2)
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn weighed(mass_g: f64, tolerance_by: ToleranceBy) -> ByWeightReport {
        ByWeightReport {
            target_g: 0.5,
            mass_g,
            at_rest: true,
            digit_g: 0.01,
            turned_ml: 0.5,
            turned_least_ml: 0.5,
            turned_most_ml: 0.5,
            most_ml: 0.6,
            stretches: 3,
            stopped_by_balance: 2,
            reckoned_s: None,
            reckoned_learned: None,
            after_stop_s: None,
            after_stop_spread_s: None,
            after_stop_stops: None,
            dropped_ml: 0.0,
            before_ml: 0.0,
            tolerance_g: if tolerance_by == ToleranceBy::Drop { 0.014 } else { 0.01 },
            tolerance_by,
            took_s: None,
        }
    }

    #[test]
    fn a_mass_that_is_not_the_asked_one_has_its_reason() {
        let line = |mass_g, by| weighed(mass_g, by).line();
        assert!(
            !line(0.51, ToleranceBy::Drop).contains("than asked"),
            "a digit is as near as a balance tells"
        );
        let drop = line(0.52, ToleranceBy::Drop);
        assert!(drop.contains("0.02 g more than asked: a drop falls whole (0.028 g)"), "{drop}");
        let late = line(0.56, ToleranceBy::Drop);
        assert!(
            late.contains("0.06 g more than asked: more arrived after a stop than was reckoned with"),
            "{late}"
        );
        assert!(line(0.53, ToleranceBy::Digit).contains("more arrived after a stop"));
        assert!(line(0.48, ToleranceBy::Drop).contains("0.02 g less than asked: a drop falls whole"));
    }
}
