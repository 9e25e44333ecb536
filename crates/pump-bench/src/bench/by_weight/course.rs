//! The course of a dose by weight: what the pump has turned for, and what the balance shows for it.

use std::collections::VecDeque;
use std::time::{Duration, Instant};

use super::aim::{Aim, Next};
use super::angles::Angles;
use super::delivered::DeliveredByWeight;
use super::lookout::Stop;
use super::prepared::PreparedByWeight;
use crate::balance::BalanceReading;
use crate::bench::bench::Bench;
use crate::bench::recorded_motion::Moved;
use crate::dosing::{DoseError, Prepared, WeightFault};
use crate::notice::Notice;
use crate::record::{AfterStop, DoseByWeight};

/// Time in which a drop falls 0.1 m: sqrt(2 h/g).
const FALL_S: f64 = 0.143;

/// Delay of a balance's filter where nobody knows it, in s. Makers state settling times of 1 to 3 s for a load that is
/// put on at once (Mettler-Toledo, data sheets of the MS-TS and ME lines), a few time constants.
const FILTER_S: f64 = 0.5;

/// Volume that is expected after a stop, in drops and digits, from which on its time is learned: a drop more or less is
/// then a quarter of it.
const CLEARLY: f64 = 4.0;

/// Dose by weight under way.
#[derive(Debug)]
pub(super) struct Course<'p> {
    pub(super) prepared: &'p PreparedByWeight,
    pub(super) aim: Aim,
    pub(super) angles: Angles,
    /// Reading at rest when this command began, in g.
    pub(super) tare_g: f64,
    /// Mass on the balance, in g, of the part of the dose that an earlier command made.
    pub(super) before_g: f64,
    /// Volume by the model, in mL, of the part of the dose that an earlier command made.
    pub(super) before_ml: f64,
    /// Last reading at rest, in g.
    pub(super) shown_g: f64,
    pub(super) digit_g: f64,
    /// Volume by the model that this command has turned for, in mL.
    pub(super) turned_ml: f64,
    pub(super) stretches: u32,
    pub(super) stopped_by_balance: u32,
    pub(super) made: u64,
    pub(super) end_angle_rad: f64,
    pub(super) measured_s: f64,
    /// Instant at which this command began to turn the pump.
    began: Instant,
    pub(super) after_stop: Option<AfterStop>,
    pub(super) reckoned_s: Option<(f64, bool)>,
}

impl Course<'_> {
    /// Returns the mass that the balance has shown more since this command began, in g.
    pub(super) fn weighed_g(&self) -> f64 {
        self.shown_g - self.tare_g
    }

    /// Returns the volume of [`Self::weighed_g`], in mL.
    pub(super) fn weighed_ml(&self) -> f64 {
        self.weighed_g() * self.prepared.z_ml_g
    }

    /// Returns the mass that the balance shows for the dose, the part of an earlier command included, in g.
    fn whole_g(&self) -> f64 {
        self.weighed_g() + self.before_g
    }

    /// Returns the volume by the model of the dose, the part of an earlier command included, in mL.
    pub(super) fn whole_turned_ml(&self) -> f64 {
        self.turned_ml + self.before_ml
    }

    /// Returns the least and the most volume by the model of the dose, in mL, over the angles at which the rollers may
    /// have stood. The part of an earlier command counts as it is booked.
    fn whole_range_ml(&self) -> (f64, f64) {
        let (least_ml, most_ml) = self.angles.range_ml((0.0, self.turned_rad()));
        (self.before_ml + least_ml, self.before_ml + most_ml)
    }

    /// Returns the turn since this command began, in rad.
    pub(super) fn turned_rad(&self) -> f64 {
        self.end_angle_rad - self.prepared.whole.plan.start().angle_rad()
    }

    /// Returns the next stretch.
    ///
    /// # Errors
    ///
    /// [`WeightFault::Ceiling`] if the pump has turned for all that it may.
    pub(super) fn next(&self) -> Result<Next, WeightFault> {
        self.aim.next(self.weighed_ml(), self.turned_ml, (&self.angles, self.turned_rad()))
    }

    /// Returns the error of a fault after `shown_g` were read last.
    pub(super) fn fault(&self, fault: WeightFault, shown_g: f64) -> DoseError {
        DoseError::ByWeight {
            fault,
            turned_ml: self.whole_turned_ml(),
            weighed_g: Some(shown_g - self.tare_g + self.before_g),
            from_stated_angle: self.angles.is_stated(),
        }
    }
}

/// One stretch: the plan that the motor makes, and the longer one that the journal announces.
#[derive(Debug)]
pub(super) struct Stretch {
    pub(super) part: Prepared,
    pub(super) announced: Prepared,
}

/// End of one stretch.
pub(super) struct StretchEnd {
    pub(super) moved: Moved,
    pub(super) stop: Option<Stop>,
    /// Reading when the motor came to rest, in g.
    pub(super) at_rest_g: Option<f64>,
    /// Turns since the start of the dose, in rad, and when.
    pub(super) notes: VecDeque<(Instant, f64)>,
    /// Instant at which the motor came to rest.
    pub(super) stood: Instant,
    /// Last reading, in g.
    pub(super) last_g: Option<f64>,
    pub(super) stopped_by_user: bool,
}

impl<'p> Course<'p> {
    pub(super) fn begin(
        prepared: &'p PreparedByWeight,
        tare: BalanceReading,
        after_stop: Option<AfterStop>,
    ) -> Self {
        let plan = &prepared.whole.plan;
        let (before_g, before_ml) =
            prepared.begun.map_or((0.0, 0.0), |begun| (begun.weighed_g(), begun.turned_ml));
        let aim = Aim {
            target_ml: prepared.left_ml(),
            most_ml: prepared.most_ml - before_ml,
            unsure_ml: prepared.unsure_ml,
            pump_unsure_ml: prepared.pump_unsure_ml,
            drop_ml: prepared.whole.drop_ml,
            digit_ml: tare.step_g * prepared.z_ml_g,
            step_ml: Bench::largest_step_ml(&prepared.whole),
        };
        Self {
            prepared,
            aim,
            angles: Angles::of(&prepared.whole.model, plan.start()),
            tare_g: tare.mass_g,
            before_g,
            before_ml,
            shown_g: tare.mass_g,
            digit_g: tare.step_g,
            turned_ml: 0.0,
            stretches: 0,
            stopped_by_balance: 0,
            made: 0,
            end_angle_rad: plan.start().angle_rad(),
            measured_s: 0.0,
            began: Instant::now(),
            after_stop,
            reckoned_s: None,
        }
    }

    /// Returns the time of flow that still arrives after a stop, in s, and whether it was learned: mean and spread of
    /// what doses have found, or the model's. The line empties with its time constant R C; then come fall and filter.
    pub(super) fn reckoned(&self) -> (f64, bool) {
        match self.after_stop {
            Some(found) => (found.mean_s + found.spread_s(), true),
            None => {
                let line = self.prepared.whole.model.outlet();
                (line.resistance_kpa_s_ml * line.compliance_ml_kpa + FALL_S + FILTER_S, false)
            }
        }
    }

    /// Returns the factor of the pump's volumes by what has arrived. Where the angle is not known, the model's own
    /// counts: what has arrived tells of the angle first.
    pub(super) fn factor(&self) -> f64 {
        if self.angles.is_stated() { self.aim.factor(self.weighed_ml(), self.turned_ml).0 } else { 1.0 }
    }

    /// Adds a stretch that was made.
    pub(super) fn add(&mut self, stretch: &Stretch, end: &StretchEnd, turned_ml: f64) {
        self.stretches += 1;
        self.stopped_by_balance += u32::from(matches!(end.stop, Some(Stop::Enough)));
        self.made += end.moved.made;
        self.measured_s += end.moved.measured_s;
        self.turned_ml = turned_ml;
        let (part, start_rad) = (&stretch.part.plan, stretch.part.plan.start().angle_rad());
        self.end_angle_rad += part.angle_after(end.moved.made) - start_rad;
    }

    /// Takes the reading at rest after a stretch, and learns from it: the angle, and how much still arrived after the
    /// stop.
    pub(super) fn weigh(&mut self, end: &StretchEnd, reading: BalanceReading) {
        let begun_ml = self.weighed_ml();
        self.shown_g = reading.mass_g;
        self.digit_g = reading.step_g;
        self.aim.digit_ml = reading.step_g * self.prepared.z_ml_g;
        let (to_rad, weighed_ml) = (self.turned_rad(), self.weighed_ml());
        let follows = |weighed_ml, ml| self.aim.may_follow(weighed_ml, ml);
        let from_rad = self.angles.weighed(to_rad, weighed_ml, follows);
        // From an angle that is not known the model does not tell how long ago the pump had turned for a volume.
        if let Some(at_rest_g) = end.at_rest_g.filter(|_| self.angles.is_stated()) {
            self.learn_after_stop((at_rest_g, weighed_ml - begun_ml), (from_rad, to_rad), end);
        }
    }

    /// Learns how much still arrived after the stop of a stretch. `at_rest_g` was read at the stop, and the stretch
    /// brought `arrived_ml`.
    fn learn_after_stop(
        &mut self,
        (at_rest_g, arrived_ml): (f64, f64),
        (from_rad, to_rad): (f64, f64),
        end: &StretchEnd,
    ) {
        let since_ml = |noted_rad: f64| self.angles.booked_ml((noted_rad, to_rad));
        let turned_ml = since_ml(from_rad);
        // The flow pulsates, so the model tells how long ago the pump had turned for what was still missing.
        let missing_ml = (self.shown_g - at_rest_g) * self.prepared.z_ml_g * turned_ml / arrived_ml;
        let before = end.notes.iter().rev().find(|(_, noted_rad)| since_ml(*noted_rad) >= missing_ml);
        // Drops and digits hide what follows a slow stretch. The expected volume decides: the one found has their
        // scatter.
        let lag_ago = end.stood.checked_sub(Duration::from_secs_f64(self.reckoned().0));
        let then = end.notes.iter().rev().find(|(at, _)| lag_ago.is_some_and(|ago| *at <= ago));
        let expected_ml = since_ml(then.map_or(from_rad, |(_, noted_rad)| *noted_rad));
        let is_clear = expected_ml > CLEARLY * (self.aim.drop_ml + self.aim.digit_ml);
        if let Some((at, _)) = before.filter(|_| is_clear) {
            let after_s = end.stood.saturating_duration_since(*at).as_secs_f64();
            self.after_stop = Some(AfterStop::with(self.after_stop, after_s));
        }
    }

    /// Returns the weighing as the record keeps it.
    pub(super) fn on_record(&self) -> DoseByWeight {
        DoseByWeight {
            target_g: self.prepared.target_g(),
            mass_g: self.whole_g(),
            digit_g: self.digit_g,
            weighed_ml: self.whole_g() * self.prepared.z_ml_g,
            turned_ml: self.whole_turned_ml(),
            dropped_ml: self.prepared.dropped_ml,
        }
    }

    pub(super) fn delivered(self, completed: bool, warnings: Vec<Notice>) -> DeliveredByWeight {
        DeliveredByWeight {
            began: None,
            mass_g: self.whole_g(),
            digit_g: self.digit_g,
            volume_ml: self.whole_g() * self.prepared.z_ml_g,
            before_ml: self.before_g * self.prepared.z_ml_g,
            tolerance_g: self.aim.tolerance_ml() / self.prepared.z_ml_g,
            tolerance_by: self.aim.tolerance().by,
            turned_range_ml: self.whole_range_ml(),
            took_s: self.reckoned_s.map(|_| self.began.elapsed().as_secs_f64()),
            turned_ml: self.whole_turned_ml(),
            stretches: self.stretches,
            stopped_by_balance: self.stopped_by_balance,
            made: self.made,
            end_angle_rad: self.end_angle_rad,
            measured_s: self.measured_s,
            completed,
            after_stop: self.after_stop,
            reckoned_s: self.reckoned_s,
            dropped_ml: self.prepared.dropped_ml,
            warnings,
        }
    }
}

impl Bench {
    /// Returns the largest volume of a motor step, in mL.
    fn largest_step_ml(prepared: &Prepared) -> f64 {
        let (_, most_ml_rad) = prepared.model.outlet_curve().flow_range_ml_rad();
        most_ml_rad * prepared.plan.step_rad()
    }
}
