//! The angles at which the rollers may have stood before a dose by weight. Each weighing rules some of them out.

use libm::floor;
use pump_ctl::plan::{Phase, Turned};
use pump_model::Pump;

/// Number of angles over the width of the start angle.
const ANGLES: i32 = 256;

/// Parts of a pitch in which a volume's turn is sought. The flow within one is taken as even.
const PARTS: f64 = 1024.0;

/// Angles at which the rollers may have stood at the start of a dose.
#[derive(Debug, Clone)]
pub(super) struct Angles {
    pump: Pump,
    start: Phase,
    /// Angles that no weighing has ruled out, in rad.
    starts_rad: Vec<f64>,
    /// Turn since the start, in rad, and the volume on the balance, in mL, at each weighing.
    weighings: Vec<(f64, f64)>,
}

impl Angles {
    /// Takes every angle within the width of `start`: one if it is exact.
    pub(super) fn of(pump: &Pump, start: Phase) -> Self {
        let (angle_rad, half_width_rad) = (start.angle_rad(), start.half_width_rad());
        let half_width_rad = half_width_rad.min(0.5 * pump.pitch_rad());
        let angle = |n: i32| angle_rad + half_width_rad * (f64::from(2 * n + 1) / f64::from(ANGLES) - 1.0);
        let starts_rad =
            if half_width_rad == 0.0 { vec![angle_rad] } else { (0..ANGLES).map(angle).collect() };
        Self { pump: *pump, start, starts_rad, weighings: vec![(0.0, 0.0)] }
    }

    /// Returns true if there is one angle alone.
    pub(super) fn is_exact(&self) -> bool {
        self.start.half_width_rad() == 0.0
    }

    /// Returns true if the angle at the start was known so well that doses are planned from it as if it were exact.
    pub(super) fn is_stated(&self) -> bool {
        self.start.is_stated()
    }

    /// Returns the volume in mL, from one angle, of the turn between two turns since the start.
    fn volume_ml(&self, start_rad: f64, (from_rad, to_rad): (f64, f64)) -> f64 {
        let curve = self.pump.outlet_curve();
        curve.volume_ml(start_rad + to_rad) - curve.volume_ml(start_rad + from_rad)
    }

    /// Returns the least and the most volume, in mL, of the turn between two turns since the start.
    pub(super) fn range_ml(&self, turns_rad: (f64, f64)) -> (f64, f64) {
        let volumes = self.starts_rad.iter().map(|start_rad| self.volume_ml(*start_rad, turns_rad));
        volumes.fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), ml| (least.min(ml), most.max(ml)))
    }

    /// Returns the volume, in mL, that a dose books for the turn between two turns since the start.
    pub(super) fn booked_ml(&self, (from_rad, to_rad): (f64, f64)) -> f64 {
        let middle_ml = |turn_rad| Turned::at(self.start).by(turn_rad, turn_rad).middle_ml(&self.pump);
        middle_ml(to_rad) - middle_ml(from_rad)
    }

    /// Takes a weighing: `weighed_ml` are on the balance after a turn since the start.
    ///
    /// From an earlier weighing to this one, `may_follow` holds for the volume on the balance and the model's, in mL,
    /// of the true angle. Others are ruled out. Returns the turn at the weighing before, in rad.
    pub(super) fn weighed(
        &mut self,
        turned_rad: f64,
        weighed_ml: f64,
        may_follow: impl Fn(f64, f64) -> bool,
    ) -> f64 {
        let follows = |start_rad: f64| {
            self.weighings.iter().all(|(from_rad, from_ml)| {
                may_follow(weighed_ml - from_ml, self.volume_ml(start_rad, (*from_rad, turned_rad)))
            })
        };
        let kept: Vec<_> = self.starts_rad.iter().copied().filter(|start_rad| follows(*start_rad)).collect();
        // If no angle explains the weighings, the fault is not the angle's.
        if !kept.is_empty() {
            self.starts_rad = kept;
        }
        let before_rad = self.weighings.last().map_or(0.0, |(turned_rad, _)| *turned_rad);
        self.weighings.push((turned_rad, weighed_ml));
        before_rad
    }

    /// Returns the least turn beyond `turned_rad` that `stretch` allows from any angle, in rad, and its mark. From the
    /// volume of the turn so far, in mL, `stretch` gives the volume that may follow, in mL, and the mark.
    pub(super) fn least_turn<T>(
        &self,
        turned_rad: f64,
        stretch: impl Fn(f64) -> (f64, T),
    ) -> Option<(f64, T)> {
        let turns = self.starts_rad.iter().map(|start_rad| {
            let (volume_ml, mark) = stretch(self.volume_ml(*start_rad, (0.0, turned_rad)));
            (self.turn_rad(start_rad + turned_rad, volume_ml), mark)
        });
        turns.min_by(|a, b| a.0.total_cmp(&b.0))
    }

    /// Returns the turn from `angle_rad` that delivers a volume first, in rad.
    fn turn_rad(&self, angle_rad: f64, volume_ml: f64) -> f64 {
        let curve = self.pump.outlet_curve();
        let (pitch_rad, pitch_ml) = (curve.pitch_rad(), curve.pitch_ml());
        // Where the flow reverses, a volume may be reached within the pitch before.
        let pitches = (floor(volume_ml / pitch_ml) - 1.0).max(0.0);
        let (part_rad, begin_ml) = (pitch_rad / PARTS, curve.volume_ml(angle_rad));
        let at_ml = |turn_rad: f64| curve.volume_ml(angle_rad + turn_rad) - begin_ml;
        let (mut turn_rad, mut before_ml) = (pitches * pitch_rad, pitches * pitch_ml);
        while before_ml < volume_ml {
            let after_ml = at_ml(turn_rad + part_rad);
            if after_ml >= volume_ml {
                return turn_rad + part_rad * (volume_ml - before_ml) / (after_ml - before_ml);
            }
            (turn_rad, before_ml) = (turn_rad + part_rad, after_ml);
        }
        turn_rad
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unknown() -> (Pump, Angles) {
        let pump = Pump::three_roller();
        (pump, Angles::of(&pump, Phase::unknown(pump.pitch_rad())))
    }

    #[test]
    fn the_least_turn_delivers_no_more_than_the_volume_from_any_angle() {
        let (pump, angles) = unknown();
        for volume_ml in [0.01, 0.3, 2.0, 6.0, 31.0] {
            let (turn_rad, ()) = angles.least_turn(0.7, |_| (volume_ml, ())).unwrap();
            let (least_ml, most_ml) = Phase::unknown(pump.pitch_rad()).range_ml(&pump, turn_rad);
            assert!((most_ml - volume_ml).abs() < 0.002 * volume_ml, "{volume_ml}: {most_ml}");
            assert!(least_ml < volume_ml);
        }
    }

    #[test]
    fn weighings_find_the_angle() {
        let (pump, mut angles) = unknown();
        let (curve, truth_rad) = (*pump.outlet_curve(), 0.4);
        for turn in 1..20 {
            let turned_rad = 0.1 * f64::from(turn);
            let weighed_ml = curve.volume_ml(truth_rad + turned_rad) - curve.volume_ml(truth_rad);
            angles.weighed(turned_rad, weighed_ml, |weighed_ml, ml| (ml - weighed_ml).abs() < 0.02);
        }
        let pitch_rad = pump.pitch_rad();
        let off_rad = |start_rad: &f64| {
            let apart_rad = (start_rad - truth_rad).rem_euclid(pitch_rad);
            apart_rad.min(pitch_rad - apart_rad)
        };
        assert!(!angles.starts_rad.is_empty() && angles.starts_rad.iter().all(|at| off_rad(at) < 0.1));
        // Readings that no angle explains rule out none.
        let count = angles.starts_rad.len();
        angles.weighed(2.0, 1.0, |_, _| false);
        assert_eq!(angles.starts_rad.len(), count);
    }

    #[test]
    fn an_exact_angle_is_one() {
        let pump = Pump::three_roller();
        let angles = Angles::of(&pump, Phase::known(0.3));
        let (least_ml, most_ml) = angles.range_ml((0.2, 1.5));
        assert!(angles.is_exact() && angles.is_stated() && least_ml == most_ml);
        assert!((angles.booked_ml((0.2, 1.5)) - least_ml).abs() < 1e-12);
    }
}
