//! The share of the default pulse of a head that is known by its volume alone.

use core::f64::consts::TAU;

use libm::{floor, sqrt};
use pump_model::units::{degrees, wrap};
use pump_model::{DefaultPulse, Pump, RollerVolume};

use super::Budget;
use super::share::{Share, ShareSource};
use crate::calibration::{Applied, PLAUSIBLE, WeighedTurn};
use crate::displacement::PulsePrior;
use crate::dosing::Swept;
use crate::pump_file::PumpFile;

/// Start angles of each pulse, of an angle between bounds. Those of one pulse lie between those of the next.
const POINTS: u32 = 4;

/// Start angles of a weighed turn from an angle between bounds.
const WEIGHED_POINTS: u32 = 16;

/// Fractional part of the golden ratio, by whose multiples points lie evenly (Weyl's sequence).
const GOLDEN: f64 = 0.618_033_988_749_894_9;

impl Budget {
    /// Returns the budget with the share of the default pulse, if the pump of `file` is known by its volume alone and
    /// no short doses have found its pulse.
    ///
    /// The share is the root of the mean square difference of the turn's volume over the pulses that heads may have. A
    /// revolution keeps its volume. After a calibration the weighed runs keep theirs, which are parts of a pitch too.
    /// The differences are neither linear in the pulse nor normal, so the expanded uncertainty propagates their
    /// distribution together with that of the angle (JCGM 101:2008).
    #[must_use]
    pub(crate) fn with_default_pulse(
        mut self,
        file: &PumpFile,
        pump: &Pump,
        swept: &Swept,
        applied: Option<&Applied>,
    ) -> Self {
        let Some(prior) =
            file.pulse_prior().filter(|_| applied.is_none_or(|applied| applied.pulse.is_none()))
        else {
            return self;
        };
        let known = Known {
            prior,
            pitch_ml: pump.outlet_curve().pitch_ml(),
            zero_rad: applied.map_or(0.0, |applied| applied.correction.zero_rad),
            weighed: applied.map_or(&[], |applied| applied.turns.as_slice()),
        };
        let PulseDifferences { standard_ml, errors_ml } = PulseDifferences::of(&known, swept);
        self.shares.push(Share::new(ShareSource::Pulse, standard_ml));
        self.errors = self.errors.joined_by(errors_ml, standard_ml);
        self.with_percentages()
    }
}

/// Differences of a turn's volume over the pulses that heads may have.
struct PulseDifferences {
    /// Root of the mean square difference from the volume with the default pulse, in mL.
    standard_ml: f64,
    /// Volume of each pulse from each start angle less the planned volume, in mL.
    errors_ml: Vec<f64>,
}

impl PulseDifferences {
    fn of(known: &Known<'_>, swept: &Swept) -> Self {
        let pitch_rad = TAU / f64::from(known.prior.rollers);
        let (angle_rad, half_width_rad) = (swept.start.angle_rad(), swept.start.half_width_rad());
        let turn_rad = swept.end_rad - angle_rad;
        let half_width_rad = half_width_rad.min(0.5 * pitch_rad);
        let points = if half_width_rad == 0.0 { 1 } else { POINTS };
        let mut found = Self { standard_ml: 0.0, errors_ml: Vec::new() };
        let Some(shape) = DefaultShape::new() else { return found };
        let head = |pulse| Pulsed::of(known.prior.rollers, known.pitch_ml, pulse, &shape);
        let default = head(known.prior.pulse());
        let mut squares = 0.0;
        for (n, pulse) in (0_u32..).zip(known.prior.pulses()) {
            let head = head(pulse);
            let factor = known.weighed_ml(&default) / known.weighed_ml(&head);
            // No other head could have been calibrated: a reading beyond these is refused as a mistake.
            let factor = if factor > 0.0 { factor.clamp(1.0 / PLAUSIBLE, PLAUSIBLE) } else { PLAUSIBLE };
            for point in 0..points {
                let place = (f64::from(point) + (GOLDEN * f64::from(n)).fract()) / f64::from(points);
                let from_rad = angle_rad + half_width_rad * (2.0 * place - 1.0) + known.zero_rad;
                let head_ml = factor * head.turn_ml(from_rad, turn_rad);
                let difference_ml = head_ml - default.turn_ml(from_rad, turn_rad);
                squares += difference_ml * difference_ml;
                found.errors_ml.push(head_ml - swept.volume_ml);
            }
        }
        found.standard_ml = sqrt(squares / found.errors_ml.len().max(1) as f64);
        found
    }
}

/// Knowledge of a head whose pulse is not known.
struct Known<'a> {
    prior: PulsePrior,
    /// Volume of a pitch by the data sheet, or by the weighed runs if the default pulse is the head's, in mL.
    pitch_ml: f64,
    /// Angle of the model at which the angles of the record begin, in rad.
    zero_rad: f64,
    /// Turns that were weighed.
    weighed: &'a [WeighedTurn],
}

impl Known<'_> {
    /// Returns the volume of all weighed turns by `head`, in mL; 1 if nothing was weighed. A run of whole pitches
    /// delivers the same volume from any angle.
    fn weighed_ml(&self, head: &Pulsed<'_>) -> f64 {
        if self.weighed.is_empty() {
            return 1.0;
        }
        let of_turn = |turn: &WeighedTurn| {
            let start_rad = turn.start_rad.unwrap_or(0.0) + self.zero_rad;
            head.mean_turn_ml(start_rad, turn.half_width_rad, turn.turned_rad).abs()
        };
        self.weighed.iter().map(of_turn).sum()
    }
}

/// Shape of the default pulse: V/V_r over x/phi.
struct DefaultShape(RollerVolume);

impl DefaultShape {
    /// Returns the shape, as the roller volume of a pulse of 1 mL over 1 rad.
    fn new() -> Option<Self> {
        DefaultPulse::new(0.5, degrees(1.0)).roller_volume(1.0).ok().map(Self)
    }

    fn at(&self, part: f64) -> f64 {
        self.0.at(part)
    }
}

/// Head of which the volume of a pitch and the pulse are known.
struct Pulsed<'a> {
    pitch_rad: f64,
    phi_rad: f64,
    roller_ml: f64,
    /// Flow between the pulses, in mL/rad.
    nominal_ml_rad: f64,
    shape: &'a DefaultShape,
}

impl<'a> Pulsed<'a> {
    fn of(rollers: u32, pitch_ml: f64, pulse: DefaultPulse, shape: &'a DefaultShape) -> Self {
        let pitch_rad = TAU / f64::from(rollers);
        // The share is V_r/(V_pitch + V_r), and a = (V_pitch + V_r)/pitch.
        let bore_ml = pitch_ml / (1.0 - pulse.share);
        Self {
            pitch_rad,
            phi_rad: pulse.engagement_rad,
            roller_ml: pulse.share * bore_ml,
            nominal_ml_rad: bore_ml / pitch_rad,
            shape,
        }
    }

    /// Returns the volume of a turn, in mL.
    ///
    /// The bore delivers a times the turn, and each roller that leaves takes V_r on the way. A roller that began to
    /// leave p ago has V(phi - p) left to take (McIntyre et al.: q = a - sum g(phi - p)).
    fn turn_ml(&self, from_rad: f64, turn_rad: f64) -> f64 {
        self.nominal_ml_rad * turn_rad - (self.taken_ml(from_rad + turn_rad) - self.taken_ml(from_rad))
    }

    /// Returns the mean volume of a turn, in mL, over the angles within `half_width_rad` of `from_rad`.
    fn mean_turn_ml(&self, from_rad: f64, half_width_rad: f64, turn_rad: f64) -> f64 {
        if half_width_rad == 0.0 {
            return self.turn_ml(from_rad, turn_rad);
        }
        let at =
            |n: u32| from_rad + half_width_rad * (f64::from(2 * n + 1) / f64::from(WEIGHED_POINTS) - 1.0);
        let sum_ml: f64 = (0..WEIGHED_POINTS).map(|n| self.turn_ml(at(n), turn_rad)).sum();
        sum_ml / f64::from(WEIGHED_POINTS)
    }

    fn taken_ml(&self, angle_rad: f64) -> f64 {
        let mut away_rad = wrap(angle_rad, self.pitch_rad);
        let mut taken = floor(angle_rad / self.pitch_rad);
        while away_rad < self.phi_rad {
            taken -= self.shape.at(1.0 - away_rad / self.phi_rad);
            away_rad += self.pitch_rad;
        }
        taken * self.roller_ml
    }
}

#[cfg(test)]
mod tests {
    use pump_model::Line;

    use super::*;

    #[test]
    fn the_volume_of_a_turn_is_that_of_the_models_flow_curve() {
        let shape = DefaultShape::new().unwrap();
        for (rollers, share, engagement_deg) in
            [(4, 0.25, 55.0), (3, 0.2, 61.0), (8, 0.3, 60.0), (2, 0.1, 200.0)]
        {
            let pulse = DefaultPulse::new(share, engagement_deg);
            let pump = Pump::from_ml_per_rev(0.5, rollers, pulse, Line::PUBLISHED, Line::PUBLISHED).unwrap();
            let (curve, pitch_ml) = (pump.outlet_curve(), pump.outlet_curve().pitch_ml());
            for (from_rad, turn_rad) in [(0.05, 0.2), (0.33, 1.4), (1.1, 9.0), (-0.4, -0.3), (0.2, 70.0)] {
                let expected_ml = curve.volume_ml(from_rad + turn_rad) - curve.volume_ml(from_rad);
                let found_ml = Pulsed::of(rollers, pitch_ml, pulse, &shape).turn_ml(from_rad, turn_rad);
                assert!(
                    (found_ml - expected_ml).abs() < 1e-12,
                    "{rollers} {from_rad}: {found_ml} {expected_ml}"
                );
            }
        }
    }

    #[test]
    fn whole_pitches_have_no_share_and_half_a_pitch_has_one() {
        let pitch_ml = 0.125;
        let known = Known { prior: PulsePrior::of(4), pitch_ml, zero_rad: 0.0, weighed: &[] };
        let of = |turn_rad: f64| {
            let start = pump_ctl::plan::Phase::known(0.3);
            let end_rad = 0.3 + turn_rad;
            let swept = Swept {
                start,
                end_rad,
                volume_ml: 0.0,
                range_ml: (0.0, 0.0),
                end_step_ml: 0.0,
                carry_in_ml: 0.0,
            };
            PulseDifferences::of(&known, &swept).standard_ml
        };
        assert!(of(3.0 * TAU / 4.0) < 1e-14);
        let half_ml = of(TAU / 8.0);
        assert!(half_ml > 0.02 * pitch_ml && half_ml < 0.5 * pitch_ml, "{half_ml}");
    }

    #[test]
    fn a_turn_that_was_weighed_itself_is_not_unsure_by_its_pulse() {
        // Nearly a pitch, so that no head's volume of it is half or twice another's.
        let (start_rad, turned_rad) = (0.2, 1.3);
        let turn = WeighedTurn { start_rad: Some(start_rad), half_width_rad: 0.0, turned_rad };
        let of = |weighed: &[WeighedTurn], start_rad: f64| {
            let known = Known { prior: PulsePrior::of(4), pitch_ml: 0.125, zero_rad: 0.0, weighed };
            let start = pump_ctl::plan::Phase::known(start_rad);
            let end_rad = start_rad + turned_rad;
            let range_ml = (0.0, 0.0);
            let swept =
                Swept { start, end_rad, volume_ml: 0.0, range_ml, end_step_ml: 0.0, carry_in_ml: 0.0 };
            PulseDifferences::of(&known, &swept).standard_ml
        };
        assert!(of(&[], start_rad) > 1e-3);
        assert!(of(&[turn], start_rad) < 1e-14, "{}", of(&[turn], start_rad));
        // Half a pitch further on the reading of a part of a pitch makes the volume less sure, not surer.
        assert!(of(&[turn], start_rad + 0.8) > of(&[], start_rad + 0.8));
        let whole = WeighedTurn { start_rad: None, half_width_rad: 0.0, turned_rad: 80.0 * TAU / 4.0 };
        assert!((of(&[whole], start_rad) / of(&[], start_rad) - 1.0).abs() < 1e-9);
    }
}
