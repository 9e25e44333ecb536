//! The next stretch of a dose by weight: how far, how fast, and when enough has arrived.

use super::angles::Angles;
use super::tolerance::Tolerance;
use crate::dosing::WeightFault;

/// Part of the dose that is left to slow stretches, at least.
const SLOW_PART: f64 = 0.04;

/// Drops that are left to slow stretches, at least.
const SLOW_DROPS: f64 = 3.0;

/// Steps of the balance's last digit that are left to slow stretches, at least.
const SLOW_DIGITS: f64 = 4.0;

/// Part by which the pump's volume changes from one stretch to the next, beside the drop and the digits: the scatter of
/// single pitches and the speed. The model of McIntyre et al. is 2.4 % off over all speeds.
const BETWEEN_STRETCHES: f64 = 0.024;

/// Target of a dose by weight, and how sure pump and balance are. Volumes are in mL.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Aim {
    /// Volume that the balance is to show.
    pub(super) target_ml: f64,
    /// Most volume by the model that the pump turns for.
    pub(super) most_ml: f64,
    /// Expanded uncertainty of the model's volume for the whole dose.
    pub(super) unsure_ml: f64,
    /// The part of it that does not come from the angle of the rollers.
    pub(super) pump_unsure_ml: f64,
    /// Volume of a drop that falls from the nozzle; 0 if it is immersed.
    pub(super) drop_ml: f64,
    /// Volume of a step of the balance's last digit.
    pub(super) digit_ml: f64,
    /// Volume of a motor step.
    pub(super) step_ml: f64,
}

/// Next stretch of a dose by weight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Next {
    /// Turn for this volume by the model, in mL, at the dose's own speed or slowly.
    Turn { volume_ml: f64, slowly: bool },
    /// The balance shows what was asked for.
    Done,
}

impl Aim {
    /// Returns the volume by which the balance may lack when the dose is done: a digit, half a drop, or a motor step.
    /// A drop falls whole, so that nothing comes nearer than half of one.
    pub(super) fn tolerance_ml(&self) -> f64 {
        self.tolerance().volume_ml
    }

    /// Returns that volume with its reason.
    pub(super) fn tolerance(&self) -> Tolerance {
        Tolerance::of(self.digit_ml, self.drop_ml, self.step_ml)
    }

    /// Returns the volume on the balance at which a stretch under way is stopped, with all that still arrives: half a
    /// drop below the target, since a drop that is about to fall adds half of itself on average.
    pub(super) fn enough_ml(&self) -> f64 {
        self.target_ml - 0.5 * self.drop_ml
    }

    /// Returns the relative uncertainty of the pump's volumes where the angle is known, k = 2.
    pub(super) fn pump_unsure(&self) -> f64 {
        self.pump_unsure_ml / self.target_ml
    }

    /// Returns the factor of the pump's volumes by what has arrived, and its relative uncertainty, k = 2. The model's
    /// own counts until the balance knows better.
    pub(super) fn factor(&self, weighed_ml: f64, turned_ml: f64) -> (f64, f64) {
        let of_model = (1.0, self.pump_unsure());
        if turned_ml <= 0.0 || weighed_ml <= 0.0 {
            return of_model;
        }
        let unsure = (self.drop_ml + 2.0 * self.digit_ml) / turned_ml + BETWEEN_STRETCHES;
        if unsure < of_model.1 { (weighed_ml / turned_ml, unsure) } else { of_model }
    }

    /// Returns the next stretch once `weighed_ml` are on the balance after `turned_ml` by the model, from each of the
    /// angles at which the rollers may have stood. The stretch ends below the target from every one of them.
    ///
    /// # Errors
    ///
    /// [`WeightFault::Ceiling`] if the pump has turned for all that it may.
    pub(super) fn next(
        &self,
        weighed_ml: f64,
        turned_ml: f64,
        (angles, turned_rad): (&Angles, f64),
    ) -> Result<Next, WeightFault> {
        if self.target_ml - weighed_ml <= self.tolerance_ml() {
            return Ok(Next::Done);
        }
        let left_ml = self.most_ml - turned_ml;
        if left_ml < self.least_ml() {
            let Self { target_ml: asked_ml, most_ml, .. } = *self;
            return Err(WeightFault::Ceiling { turned_ml, most_ml, asked_ml, weighed_ml });
        }
        let (volume_ml, slowly) = if angles.is_exact() {
            self.stretch(weighed_ml, turned_ml)
        } else {
            let turn = angles.least_turn(turned_rad, |turned_ml| self.stretch(weighed_ml, turned_ml));
            let (turn_rad, slowly) = turn.unwrap_or((0.0, true));
            (angles.booked_ml((turned_rad, turned_rad + turn_rad)), slowly)
        };
        Ok(Next::Turn { volume_ml: volume_ml.min(left_ml), slowly })
    }

    /// Returns the least volume of a stretch.
    fn least_ml(&self) -> f64 {
        (0.5 * self.digit_ml).max(0.25 * self.drop_ml).max(self.step_ml)
    }

    /// Returns the volume of the next stretch by the model, and whether it is slow, where the model's volume so far is
    /// `turned_ml`.
    fn stretch(&self, weighed_ml: f64, turned_ml: f64) -> (f64, bool) {
        let rest_ml = self.target_ml - weighed_ml;
        let (factor, unsure) = self.factor(weighed_ml, turned_ml);
        let sure = (1.0 - unsure).max(0.0) / factor;
        let slow_ml =
            (SLOW_PART * self.target_ml).max(SLOW_DROPS * self.drop_ml).max(SLOW_DIGITS * self.digit_ml);
        // A fast stretch is worth its weighing if it makes more than is left to the slow ones.
        let fast_ml = rest_ml * sure - slow_ml / factor;
        if fast_ml > slow_ml {
            (fast_ml, false)
        } else {
            (((rest_ml - 0.5 * self.drop_ml) * sure).max(self.least_ml()), true)
        }
    }

    /// Returns true if `weighed_ml` more on the balance may follow from `turned_ml` more by the model.
    pub(super) fn may_follow(&self, weighed_ml: f64, turned_ml: f64) -> bool {
        // A drop may hang at the beginning and another at the end.
        let unsure_ml = 2.0 * self.pump_unsure() * turned_ml.abs() + 2.0 * (self.drop_ml + self.digit_ml);
        (weighed_ml - turned_ml).abs() <= unsure_ml
    }

    /// Checks what has arrived against what the pump has turned for, twice the uncertainty being allowed.
    ///
    /// # Errors
    ///
    /// [`WeightFault::NotRising`] or [`WeightFault::TooMuch`] if no pump of this model delivers that.
    pub(super) fn check(&self, weighed_ml: f64, turned_ml: f64, z_ml_g: f64) -> Result<(), WeightFault> {
        let unsure_ml = 2.0 * self.unsure_ml + self.drop_ml + 10.0 * self.digit_ml;
        if weighed_ml > turned_ml + unsure_ml {
            return Err(WeightFault::TooMuch { weighed_ml, turned_ml, unsure_ml });
        }
        let least_ml = (turned_ml - unsure_ml).max(self.least_rise_ml(turned_ml));
        if weighed_ml < least_ml {
            return Err(WeightFault::NotRising { rose_g: weighed_ml / z_ml_g, turned_ml });
        }
        Ok(())
    }

    /// Returns the volume that the balance shows at least after the pump turned for `turned_ml`, whatever the pump: a
    /// quarter, beyond what hangs at the nozzle and the digits.
    pub(super) fn least_rise_ml(&self, turned_ml: f64) -> f64 {
        0.25 * (turned_ml - 2.0 * self.drop_ml - 10.0 * self.digit_ml)
    }
}

#[cfg(test)]
mod tests {
    use pump_ctl::plan::Phase;
    use pump_model::Pump;

    use super::*;

    const AIM: Aim = Aim {
        target_ml: 25.0,
        most_ml: 26.4,
        unsure_ml: 1.4,
        pump_unsure_ml: 1.4,
        drop_ml: 0.06,
        digit_ml: 0.01,
        step_ml: 0.0017,
    };

    #[test]
    fn a_pump_that_delivers_the_most_that_it_may_ends_no_stretch_above_the_target() {
        let exact = Angles::of(&Pump::three_roller(), Phase::known(0.3));
        for factor in [0.95, 1.0, 1.056] {
            let (mut weighed_ml, mut turned_ml, mut stretches) = (0.0, 0.0, 0);
            while let Next::Turn { volume_ml, slowly } =
                AIM.next(weighed_ml, turned_ml, (&exact, 0.0)).unwrap()
            {
                turned_ml += volume_ml;
                weighed_ml += factor * volume_ml;
                stretches += 1;
                assert!(weighed_ml < 25.0 + 0.5 * AIM.drop_ml, "{factor}: {weighed_ml} after {volume_ml}");
                assert!(slowly || weighed_ml < 25.0 - 0.5, "{factor}: the last part is slow");
                assert!(stretches < 8, "{factor}");
            }
            assert!((weighed_ml - 25.0).abs() <= AIM.tolerance_ml(), "{factor}: {weighed_ml}");
        }
    }

    #[test]
    fn from_an_unknown_angle_no_stretch_ends_above_the_target() {
        let pump = Pump::three_roller();
        let aim = Aim { target_ml: 4.0, most_ml: 5.7, unsure_ml: 1.7, pump_unsure_ml: 0.22, ..AIM };
        for (factor, number) in
            [0.95, 1.0, 1.05].into_iter().flat_map(|factor| (0..24).map(move |n| (factor, n)))
        {
            let truth_rad = pump.pitch_rad() * f64::from(number) / 24.0;
            let mut angles = Angles::of(&pump, Phase::unknown(pump.pitch_rad()));
            let weighed_ml = |turn_rad: f64| {
                factor * pump.outlet_curve().volume_ml(truth_rad + turn_rad)
                    - factor * pump.outlet_curve().volume_ml(truth_rad)
            };
            let (mut turned_rad, mut stretches) = (0.0_f64, 0);
            loop {
                let (on_balance_ml, booked_ml) =
                    (weighed_ml(turned_rad), angles.booked_ml((0.0, turned_rad)));
                let next = aim.next(on_balance_ml, booked_ml, (&angles, turned_rad)).unwrap();
                let Next::Turn { volume_ml, .. } = next else { break };
                // The planner turns until the books have grown by the volume.
                let mut to_rad = turned_rad;
                while angles.booked_ml((turned_rad, to_rad)) < volume_ml {
                    to_rad += 5e-4;
                }
                angles.weighed(to_rad, weighed_ml(to_rad), |weighed_ml, ml| aim.may_follow(weighed_ml, ml));
                (turned_rad, stretches) = (to_rad, stretches + 1);
                assert!(weighed_ml(turned_rad) < 4.0 + 0.5 * aim.drop_ml, "{factor} {truth_rad}");
                assert!(stretches < 20, "{factor} {truth_rad}");
            }
            assert!((weighed_ml(turned_rad) - 4.0).abs() <= aim.tolerance_ml(), "{factor} {truth_rad}");
        }
    }

    #[test]
    fn the_ceiling_ends_a_dose_that_does_not_arrive() {
        // Half of it is lost on the way.
        let exact = Angles::of(&Pump::three_roller(), Phase::known(0.3));
        let (mut weighed_ml, mut turned_ml) = (0.0, 0.0);
        let fault = loop {
            match AIM.next(weighed_ml, turned_ml, (&exact, 0.0)) {
                Ok(Next::Turn { volume_ml, .. }) => {
                    turned_ml += volume_ml;
                    weighed_ml += 0.5 * volume_ml;
                }
                Ok(Next::Done) => panic!("{weighed_ml}"),
                Err(fault) => break fault,
            }
        };
        assert!(matches!(fault, WeightFault::Ceiling { .. }) && turned_ml <= AIM.most_ml + 1e-9, "{fault}");
    }

    #[test]
    fn readings_that_no_pump_of_the_model_gives_are_faults() {
        assert!(AIM.check(10.3, 10.0, 1.0).is_ok());
        assert!(matches!(AIM.check(3.0, 10.0, 1.0), Err(WeightFault::NotRising { .. })));
        assert!(matches!(AIM.check(13.5, 10.0, 1.0), Err(WeightFault::TooMuch { .. })));
        assert!(AIM.check(0.0, 0.1, 1.0).is_ok(), "a drop may hang");
    }
}
