//! The angles at which a turn reaches a volume, on heads whose flow may reverse.

use libm::{ceil, floor};

use super::flow_curve::FlowCurve;
use super::runs::{Run, Runs};

/// Largest number of pitches from angle 0 that a turn reaches. Beyond it the angle is too coarse a number.
const FARTHEST: f64 = 1e12;

/// An angle at which the volume of a turn reaches a volume, or nearly does.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Reach {
    /// Angle of the rollers, rad.
    pub angle_rad: f64,
    /// True at a local maximum that falls short of the volume.
    pub is_short: bool,
}

/// The reaches of a volume from an angle on, in order of the turn. [`FlowCurve::reaches`] makes them.
#[derive(Debug)]
pub struct Reaches<'a> {
    curve: &'a FlowCurve,
    runs: Runs<'a>,
    /// Direction of the turn: 1 forward, -1 in reverse.
    sign: f64,
    /// Volume since angle 0 to reach, mL.
    wanted_ml: f64,
    short_ml: f64,
    /// Smallest and largest volume since the start of a pitch, mL.
    pitch_range_ml: (f64, f64),
    /// True if the run before brought volume.
    flowed: bool,
}

impl FlowCurve {
    /// Returns the angles at which a turn from `start_rad` reaches `volume_ml`, in order of the turn. The turn
    /// goes in reverse if the volume is negative. Both must be finite.
    ///
    /// Where the flow reverses, the volume of a turn is not monotone: it reaches a volume, falls below and
    /// reaches it again. At each of these angles the volume rises in the direction of the turn. A local
    /// maximum that falls short of the volume by less than `short_ml` counts too. No turn is longer than 1e12
    /// pitches.
    ///
    /// ```
    /// let pump = pump_model::Pump::three_roller();
    /// let curve = pump.outlet_curve();
    /// let reach = curve.reaches(0.3, -5.0, 0.0).next().unwrap();
    /// assert!((curve.volume_ml(reach.angle_rad) - curve.volume_ml(0.3) + 5.0).abs() < 1e-12);
    /// assert_eq!(curve.reaches(0.3, -5.0, 0.0).count(), 1);
    /// ```
    #[cold]
    #[inline(never)]
    pub fn reaches(&self, start_rad: f64, volume_ml: f64, short_ml: f64) -> Reaches<'_> {
        Reaches {
            curve: self,
            runs: Runs::new(self, start_rad, volume_ml >= 0.0),
            sign: if volume_ml < 0.0 { -1.0 } else { 1.0 },
            wanted_ml: self.volume_ml(start_rad) + volume_ml,
            short_ml,
            pitch_range_ml: self.pitch_range_ml(),
            flowed: false,
        }
    }

    /// Returns the smallest and the largest volume since the start of a pitch, within the pitch, mL.
    #[cold]
    #[inline(never)]
    pub(super) fn pitch_range_ml(&self) -> (f64, f64) {
        self.pieces().iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), piece| {
            let ((_, smallest), (_, largest)) = piece.volume.range_in(0.0, piece.length_rad);
            (low.min(smallest), high.max(largest))
        })
    }
}

impl Reaches<'_> {
    /// Returns the part of the volume that is missing at a volume since the start of a pitch, mL.
    fn missing_ml(&self, pitches: f64, local_ml: f64) -> f64 {
        self.sign * (self.wanted_ml - pitches * self.curve.pitch_ml() - local_ml)
    }

    /// Returns the part of the volume that is missing in a pitch, the least and the most, mL.
    fn missing_range_ml(&self, pitches: f64) -> (f64, f64) {
        let (low_ml, high_ml) = self.pitch_range_ml;
        let (one, other) = (self.missing_ml(pitches, low_ml), self.missing_ml(pitches, high_ml));
        (one.min(other), one.max(other))
    }

    /// Goes over the pitches in which too much is missing everywhere. The last of them stays, since rounding
    /// may decide there.
    fn skip(&mut self) {
        let pitches = self.runs.pitches();
        let excess_ml = self.missing_range_ml(pitches).0 - self.short_ml;
        let skipped = ceil(excess_ml / self.curve.pitch_ml()) - 1.0;
        if skipped >= 2.0 {
            self.runs.skip_to(floor(pitches + self.sign * skipped));
            self.flowed = false;
        }
    }

    /// Returns the reach at the start of a run or within it, if there is one.
    fn reach_in(&mut self, run: &Run) -> Option<Reach> {
        let [enter_ml, leave_ml] = run.ends_ml().map(|local_ml| self.missing_ml(run.pitches, local_ml));
        let flowed = core::mem::replace(&mut self.flowed, run.flows);
        if run.flows && enter_ml > 0.0 && leave_ml <= 0.0 {
            let local_ml = self.wanted_ml - run.pitches * self.curve.pitch_ml();
            return Some(Reach { angle_rad: run.angle_of(self.curve, local_ml), is_short: false });
        }
        let is_top = flowed && !run.flows && enter_ml > 0.0 && enter_ml < self.short_ml;
        is_top.then(|| Reach { angle_rad: run.enter_rad(self.curve), is_short: true })
    }
}

impl Iterator for Reaches<'_> {
    type Item = Reach;

    #[cold]
    #[inline(never)]
    fn next(&mut self) -> Option<Reach> {
        let mut looked = f64::NAN;
        loop {
            let pitches = self.runs.pitches();
            let is_finite = (self.wanted_ml + self.short_ml).is_finite();
            if !is_finite || pitches.is_nan() || pitches.abs() > FARTHEST {
                return None;
            }
            if pitches != looked {
                // From here on the volume is there, and it never falls below again.
                if self.missing_range_ml(pitches).1 < 0.0 {
                    return None;
                }
                self.skip();
                looked = self.runs.pitches();
            }
            let run = self.runs.next();
            if let Some(reach) = self.reach_in(&run) {
                return Some(reach);
            }
        }
    }
}
