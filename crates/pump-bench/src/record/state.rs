//! The state of a pump between doses.

mod angle_loss;
mod disturbed;
mod motor_way;

use std::f64::consts::PI;

use pump_ctl::plan::Phase;
use pump_model::Pump;
use pump_model::units::{TURN_RAD, wrap};
use serde::{Deserialize, Serialize};

use super::intent::is_zero;
use super::{Account, AfterStop, Intent, LastDose, PhaseSource, Purpose, Unfinished, Wear};
use crate::safety::SafetyAccount;

pub use angle_loss::AngleLoss;
pub(crate) use motor_way::{MotorWay, motor_way};

/// Half width of an angle that is unknown, in rad. It covers the pitch of every pump, so the angle stays
/// unknown when the number of rollers is corrected in the pump file.
const UNKNOWN_RAD: f64 = PI;

/// Largest number of rollers by which an earlier version may have recorded an unknown angle.
const MOST_ROLLERS: u8 = 12;

/// Difference between a planned and a booked volume that is rounding, in mL.
const ROUNDING_ML: f64 = 1e-9;

/// State of a pump between doses.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct PumpState {
    /// Angle of the rotor from the model's zero, in rad, in [0, 2 pi).
    pub angle_rad: f64,
    /// Half width of the range around the angle that holds the true angle, in rad.
    pub half_width_rad: f64,
    /// Carry to the next dose, in mL. Positive toward the outlet.
    pub carry_ml: f64,
    /// Half width of the range around the carry that holds the true carry, in mL, without the doses of
    /// `account`.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub(crate) carry_half_width_ml: f64,
    /// Account of the doses since the angle's half width last changed. `None` if the angle is known exactly,
    /// or if no dose was made since.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) account: Option<Account>,
    /// Wear of the tube.
    pub wear: Wear,
    /// Dose that was begun and not finished.
    pub unfinished: Option<Unfinished>,
    /// Last dose, which a scale can weigh. `None` if the vessel holds something else too.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub last: Option<LastDose>,
    /// Source of the angle.
    #[serde(default)]
    pub source: PhaseSource,
    /// Step count of the device, positive toward the outlet. `None` if the device has no count or was not
    /// asked.
    #[serde(default)]
    pub count: Option<i64>,
    /// Cause for which the angle, once known, is unknown. `None` if it is known, and if it was never found.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lost_by: Option<AngleLoss>,
    /// Number of times that the rotor was released, or its device reset or lost, since the angle was last
    /// found.
    #[serde(default)]
    pub disturbances: u8,
    /// True if the motor was released on purpose, or was without current when it was last asked to move, and that is
    /// counted. Waking the device is then no further disturbance.
    #[serde(default)]
    pub released: bool,
    /// Print of the pump whose filled-in values a person has confirmed. `None` if nobody was asked.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) confirmed_pump: Option<u32>,
    /// Way in which the motor was turned when it moved last. `None` before its first motion, for a simulated motor, and
    /// in a record of an early version.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) turned_by: Option<MotorWay>,
    /// Print of the head that the angle is of. `None` in a record of an early version.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) head: Option<u32>,
    /// Angle of a motor step of the motions since the angle was last found, in rad, negative if the pump file turned
    /// the motor's direction round. `None` before the first, and in a record of an early version.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) step_rad: Option<f64>,
    /// Flow that still arrives after a stop, as doses by weight have found. `None` before the first.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) after_stop: Option<AfterStop>,
    /// Number of doses that the log has.
    #[serde(default, skip_serializing_if = "is_nought")]
    pub(crate) doses: u64,
    /// Number of tubes before this one.
    #[serde(default, skip_serializing_if = "is_nought")]
    pub(crate) tubes_before: u64,
    /// Volumes that safety limits count. `None` in a record of an early version.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) safety: Option<SafetyAccount>,
}

/// Returns true for zero, which a state leaves out.
fn is_nought(value: &u64) -> bool {
    *value == 0
}

impl PumpState {
    /// Returns the state of a rotor at `phase` with a new tube and without carry.
    pub fn fresh(phase: Phase, source: PhaseSource) -> Self {
        Self {
            angle_rad: wrap(phase.angle_rad(), TURN_RAD),
            half_width_rad: phase.half_width_rad(),
            carry_ml: 0.0,
            carry_half_width_ml: 0.0,
            account: None,
            wear: Wear::default(),
            unfinished: None,
            last: None,
            source,
            count: None,
            lost_by: None,
            disturbances: 0,
            released: false,
            confirmed_pump: None,
            turned_by: None,
            head: None,
            step_rad: None,
            after_stop: None,
            doses: 0,
            tubes_before: 0,
            safety: Some(SafetyAccount::default()),
        }
    }

    /// Returns the account of the volumes that safety limits count. An early version kept none, so that everything the
    /// tube has pumped counts as of `now_s`.
    pub(crate) fn safety_at(&self, now_s: u64) -> SafetyAccount {
        self.safety.unwrap_or_else(|| SafetyAccount::of_early_record(self.wear.volume_ml, now_s))
    }

    /// Returns the volumes that safety limits count after a motion that lasted `lasted_s`: the most that may have been
    /// pumped. A retraction leaves the vessel, and the next dose that repays it counts.
    fn safety_after(&self, made: &Unfinished, lasted_s: f64, pump: &Pump) -> SafetyAccount {
        let intent = &made.intent;
        let (least_ml, most_ml) = made.counted_ml(pump);
        let pumped_ml = least_ml.abs().max(most_ml.abs());
        let day_ml = if intent.purpose == Purpose::Retract { 0.0 } else { pumped_ml };
        // A line that is pumped back may draw air.
        let fills_line = matches!(intent.purpose, Purpose::Prime | Purpose::Purge | Purpose::Run);
        let vessel_ml = least_ml.max(most_ml).max(if fills_line { 0.0 } else { f64::NEG_INFINITY });
        self.safety_at(intent.unix_s).pumped(intent.unix_s, lasted_s as u64, day_ml, vessel_ml)
    }

    /// Returns the state with an unknown angle recorded as such. Earlier versions recorded it as half of the
    /// pitch that the pump file gave on that day.
    #[must_use]
    pub(crate) fn as_recorded(self, pitch_rad: f64) -> Self {
        let half_pitch = |rollers: u8| self.half_width_rad == PI / f64::from(rollers);
        let unknown = !self.phase().is_known(pitch_rad) || (2..=MOST_ROLLERS).any(half_pitch);
        let half_width_rad = if unknown { self.half_width_rad.max(UNKNOWN_RAD) } else { self.half_width_rad };
        Self { half_width_rad, ..self }
    }

    /// Returns the state once the angle is found at `phase`, or known to be unknown. The carry is dropped,
    /// unless it belongs to an unfinished dose, which stays on record.
    pub(crate) fn found(self, phase: Option<Phase>, source: PhaseSource, pump: &Pump) -> Self {
        let state = match self.unfinished {
            // The device's count began before the rotor was found.
            Some(part) => {
                Self { unfinished: Some(Unfinished { count_before: None, ..part }), ..self.closed(pump) }
            }
            None => self.without_carry(),
        };
        let phase = phase.unwrap_or(Phase::within(0.0, UNKNOWN_RAD));
        Self { source, lost_by: None, disturbances: 0, last: None, step_rad: None, ..state.at(phase) }
    }

    /// Returns the state with nothing to carry.
    #[must_use]
    pub(crate) fn without_carry(self) -> Self {
        Self { carry_ml: 0.0, carry_half_width_ml: 0.0, account: None, ..self }
    }

    /// Returns the state with its account closed: the carry keeps the account's uncertainty.
    pub(crate) fn closed(self, pump: &Pump) -> Self {
        let open_ml = self.account.map_or(0.0, |account| account.half_width_ml(pump));
        Self { carry_half_width_ml: self.carry_half_width_ml + open_ml, account: None, ..self }
    }

    /// Returns the half width of the range around the carry that holds the true carry, in mL.
    ///
    /// While a dose is unfinished, it is that of the carry before the dose.
    pub fn carry_within_ml(&self, pump: &Pump) -> f64 {
        match self.unfinished {
            Some(part) => part.intent.carry_in_half_width_ml,
            None => self.closed(pump).carry_half_width_ml,
        }
    }

    /// Returns the state with the rotor at `phase`.
    #[must_use]
    pub(crate) fn at(self, phase: Phase) -> Self {
        Self { angle_rad: wrap(phase.angle_rad(), TURN_RAD), half_width_rad: phase.half_width_rad(), ..self }
    }

    /// Returns the number of the tube, from 1.
    pub fn tube(&self) -> u32 {
        u32::try_from(self.tubes_before).unwrap_or(u32::MAX).saturating_add(1)
    }

    /// Returns the angle of the rotor, with its half width.
    pub fn phase(&self) -> Phase {
        Phase::within(self.angle_rad, self.half_width_rad)
    }

    /// Returns the state once the rotor stands after `made_least` to `made_most` net steps of `intent`.
    ///
    /// The tube wears by the most steps that may have been made in either direction. Nobody knows when the motion
    /// ended, so that it lasted as long as its plan.
    pub(crate) fn after(self, intent: &Intent, made_least: i64, made_most: i64, pump: &Pump) -> Self {
        self.after_until(u64::MAX, intent, made_least, made_most, pump)
    }

    /// Returns the state as [`Self::after`] does, once the rotor stands at the wall time `ended_s`.
    pub(crate) fn after_until(
        self,
        ended_s: u64,
        intent: &Intent,
        made_least: i64,
        made_most: i64,
        pump: &Pump,
    ) -> Self {
        let all = intent.steps.abs();
        let worn = if -made_least > made_most { made_least } else { made_most };
        let part = Unfinished::of(intent, made_least, made_most);
        let motion_s = intent.motion_s * worn.abs() as f64 / all as f64;
        // A clock that was set meanwhile tells no longer motion than the plan.
        let lasted_s = motion_s.min(ended_s.saturating_sub(intent.unix_s) as f64);
        let worn_ml = match made_least == made_most {
            true => intent.delivered_ml(pump, worn).abs(),
            // The most that it may have pumped wears the tube, as it counts for the safety limits.
            false => part.most_ml(pump),
        };
        let wear = Wear {
            volume_ml: self.wear.volume_ml + worn_ml,
            revolutions: self.wear.revolutions + worn.abs() as f64 * intent.step_rad / TURN_RAD,
            motion_s: self.wear.motion_s + motion_s,
        };
        let finished = made_least == all && made_most == all;
        let unfinished = match intent.purpose {
            // A turn to find the angle of an unfinished dose leaves that dose on record.
            Purpose::Jog => self.unfinished.map(|dose| dose.searched(&part, pump)),
            purpose => (!finished && purpose.is_delivery()).then_some(part),
        };
        Self {
            carry_ml: match intent.purpose {
                // The carry on record counts, whatever it was when the turn was planned.
                Purpose::Jog => self.carry_ml,
                _ if finished => intent.carry_out_ml,
                // The volume sucked back is known within bounds: its middle counts.
                Purpose::Retract => self.carry_ml - part.motion_booked_ml(pump),
                _ => self.carry_ml,
            },
            wear,
            unfinished,
            last: LastDose::after(self.last, intent, made_least, made_most),
            source: PhaseSource::Recorded,
            lost_by: self.lost_by_now(part.phase(), AngleLoss::UncountedSteps, pump),
            step_rad: Some(intent.way_rad()),
            turned_by: intent.motor_way.filter(|_| (made_least, made_most) != (0, 0)).or(self.turned_by),
            safety: Some(self.safety_after(&part, lasted_s, pump)),
            ..self.booked(&part, pump)
        }
        .at(part.phase())
    }

    /// Returns the state with the steps of `part` in the account. Motions that do not change the carry close
    /// the account instead.
    fn booked(self, part: &Unfinished, pump: &Pump) -> Self {
        let Unfinished { intent, made_least, made_most, .. } = part;
        let before = self.account;
        if !intent.purpose.changes_carry() {
            return self.closed(pump);
        }
        let goes_on = intent.turned == before.map(|account| account.turned)
            && before.is_none_or(|account| account.correction.shapes_like(&intent.correction));
        let closed = match before {
            Some(account) if goes_on => {
                let changed_ml = account.changed_ml(&intent.correction, pump);
                Self { carry_half_width_ml: self.carry_half_width_ml + changed_ml, ..self }
            }
            _ => self.closed(pump),
        };
        // A disturbance since the plan was made changes what its steps are booked with.
        let finished = *made_least == intent.steps.abs() && made_most == made_least;
        let slip_ml = (intent.planned_ml - part.motion_booked_ml(pump)).abs();
        let slip_ml = if finished && slip_ml > ROUNDING_ML { slip_ml } else { 0.0 };
        let turned = intent.turned_after(*made_least, *made_most);
        Self {
            carry_half_width_ml: closed.carry_half_width_ml + slip_ml,
            account: (!turned.is_exact()).then_some(intent.account(turned)),
            ..closed
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::displacement::Correction;
    use crate::record::DoseTerms;

    const PITCH_RAD: f64 = TURN_RAD / 3.0;
    const FALL_RAD: f64 = TURN_RAD / 100.0;

    const TURN: Intent = Intent {
        unix_s: 0,
        purpose: Purpose::Jog,
        requested_ml: 1.0,
        carry_in_ml: 0.0,
        carry_in_half_width_ml: 0.0,
        planned_ml: 1.0,
        carry_out_ml: 0.25,
        start_angle_rad: 1.0,
        half_width_rad: 0.0,
        turned: None,
        steps: -1000,
        step_rad: 0.001,
        revolution_ml: None,
        inverted: false,
        motor_way: None,
        motion_s: 1.0,
        speed_rad_s: 1.0,
        retract_ml: None,
        whole: None,
        terms: DoseTerms {
            cruise_rad_s: None,
            flow_ml_s: None,
            fastest: false,
            smooth: false,
            low_flow: false,
            by_weight: false,
            weighing: None,
            until_stopped: false,
            profile: false,
            ramps: None,
            max_outlet_kpa: None,
            min_inlet_kpa: None,
        },
        correction: Correction::NONE,
        told: None,
    };

    #[test]
    fn a_rotor_that_was_let_go_once_is_known_less_well_and_twice_not_at_all() {
        let pump = Pump::three_roller();
        let stood = PumpState::fresh(Phase::within(1.0, 0.01), PhaseSource::Home);
        let once = stood.disturbed(FALL_RAD, &pump);
        assert_eq!((once.angle_rad, once.half_width_rad), (1.0, 0.01 + FALL_RAD));
        assert!(!once.disturbed(FALL_RAD, &pump).phase().is_known(PITCH_RAD));
        let found = once.found(Some(Phase::known(2.0)), PhaseSource::Mark, &pump);
        assert!(found.disturbed(FALL_RAD, &pump).phase().is_known(PITCH_RAD), "found anew");
    }

    #[test]
    fn a_lost_angle_stays_lost_however_often_the_device_tells_its_count() {
        let pump = Pump::three_roller();
        let mut state = PumpState::fresh(Phase::known(1.0), PhaseSource::Home);
        for _ in 0..4 {
            let start = state.phase();
            let intent = Intent {
                purpose: Purpose::Dose,
                start_angle_rad: start.angle_rad(),
                half_width_rad: start.half_width_rad(),
                ..TURN
            };
            // The cable is pulled in motion, and the device tells its count when it is met again.
            let lost = state.after(&intent, 300, 700, &pump).disturbed(FALL_RAD, &pump);
            let part = Unfinished { count_before: Some(0), ..lost.unfinished.unwrap() };
            state = lost.recounted(&part, 500, FALL_RAD, &pump);
        }
        assert!(!state.phase().is_known(PITCH_RAD), "{state:?}");
        let found = state.found(Some(Phase::known(2.0)), PhaseSource::Mark, &pump);
        assert!(found.phase().is_known(PITCH_RAD), "found");
    }

    #[test]
    fn bounds_of_a_pitch_and_more_hide_the_angle_until_the_device_tells_its_count() {
        let pump = Pump::three_roller();
        let state = PumpState::fresh(Phase::within(1.0, 0.01), PhaseSource::Home);
        let intent = Intent { purpose: Purpose::Dose, steps: 8000, half_width_rad: 0.01, ..TURN };
        let recounted = |lost: PumpState| {
            let lost = lost.as_recorded(PITCH_RAD);
            assert!(!lost.phase().is_known(PITCH_RAD), "{lost:?}");
            let part = Unfinished { count_before: Some(0), ..lost.unfinished.unwrap() };
            lost.recounted(&part, 4000, FALL_RAD, &pump)
        };
        let lost = state.after(&intent, 500, 7500, &pump);
        let found = recounted(lost);
        assert!(
            (found.angle_rad - 5.0).abs() < 1e-12 && (found.half_width_rad - 0.01).abs() < 1e-12,
            "{found:?}"
        );
        assert_eq!((found.unfinished.unwrap().made_least, found.unfinished.unwrap().made_most), (4000, 4000));
        let fell = recounted(lost.disturbed(FALL_RAD, &pump));
        assert!((fell.half_width_rad - 0.01 - FALL_RAD).abs() < 1e-12, "{fell:?}");
        for unknown in [
            lost.lost(AngleLoss::TakenOver, &pump),
            lost.disturbed(FALL_RAD, &pump).disturbed(FALL_RAD, &pump),
        ] {
            assert!(!recounted(unknown).phase().is_known(PITCH_RAD));
        }
    }

    #[test]
    fn a_motion_that_may_have_turned_the_motor_tells_the_way() {
        let [one, other] = ["12800 steps, axis X", "6400 steps, axis X"].map(|way| Some(MotorWay::new(way)));
        let pump = Pump::three_roller();
        let before = PumpState { turned_by: one, ..PumpState::fresh(Phase::known(1.0), PhaseSource::Home) };
        let intent = Intent { motor_way: other, ..TURN };
        assert_eq!(before.after(&intent, 0, 0, &pump).turned_by, one);
        // A kill leaves bounds: the motor may have made none of the steps.
        assert_eq!(before.after(&intent, 0, 256, &pump).turned_by, other);
        assert_eq!(before.after(&TURN, 0, 256, &pump).turned_by, one, "an entry of an early version");
    }

    #[test]
    fn a_rotor_that_was_turned_to_a_mark_leaves_nothing_to_resume() {
        let before = PumpState { carry_ml: 0.25, ..PumpState::fresh(Phase::known(1.0), PhaseSource::Home) };
        let after = before.after(&TURN, 400, 600, &Pump::three_roller());
        assert_eq!(after.unfinished, None);
        assert_eq!((after.angle_rad, after.carry_ml), (0.5, 0.25));
        assert!((after.half_width_rad - 0.1).abs() < 1e-12);
    }
}
