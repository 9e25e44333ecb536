//! Volumes of turns that are not known exactly, on heads whose flow may reverse.

use super::flow_curve::FlowCurve;
use super::runs::Runs;

impl FlowCurve {
    /// Returns the smallest and largest volume since angle 0 on the way from `from_rad` to `to_rad`, mL.
    ///
    /// Both angles must be finite, and `to_rad` must not be less. The result is exact up to rounding: the
    /// extremes lie at the ends, or where the flow reverses.
    ///
    /// ```
    /// let pump = pump_model::Pump::three_roller();
    /// let curve = pump.outlet_curve();
    /// // Where the flow is positive everywhere, the ends have the extremes.
    /// assert_eq!(curve.volume_range_ml(0.2, 5.0), (curve.volume_ml(0.2), curve.volume_ml(5.0)));
    /// ```
    #[cold]
    #[inline(never)]
    pub fn volume_range_ml(&self, from_rad: f64, to_rad: f64) -> (f64, f64) {
        // A pitch adds to the volume, so the least lies within the first pitch and the most within the last.
        let pitch_rad = self.pitch_rad();
        let (mut least_ml, mut most_ml) = (self.volume_ml(from_rad), self.volume_ml(to_rad));
        self.each_turn(from_rad, to_rad.min(from_rad + pitch_rad), &mut |_, ml| least_ml = least_ml.min(ml));
        self.each_turn(from_rad.max(to_rad - pitch_rad), to_rad, &mut |_, ml| most_ml = most_ml.max(ml));
        (least_ml.min(self.volume_ml(to_rad)), most_ml.max(self.volume_ml(from_rad)))
    }

    /// Returns the smallest and largest volume of turns between `least_rad` and `most_rad` from an uncertain
    /// start, mL. They start anywhere within `half_width_rad` of `start_rad`, as in [`Self::turn_range_ml`].
    ///
    /// All must be finite, and `most_rad` must not be less than `least_rad`. The extremes are those of the two
    /// turns, or those of turns that end where the flow reverses.
    ///
    /// ```
    /// let pump = pump_model::Pump::three_roller();
    /// let curve = pump.outlet_curve();
    /// let (least_ml, most_ml) = curve.turns_range_ml(0.3, 0.1, -1.0, 2.0);
    /// assert_eq!(least_ml, curve.turn_range_ml(0.3, 0.1, -1.0).0);
    /// assert_eq!(most_ml, curve.turn_range_ml(0.3, 0.1, 2.0).1);
    /// ```
    #[cold]
    #[inline(never)]
    pub fn turns_range_ml(
        &self,
        start_rad: f64,
        half_width_rad: f64,
        least_rad: f64,
        most_rad: f64,
    ) -> (f64, f64) {
        let half_width_rad = half_width_rad.min(0.5 * self.pitch_rad());
        let (_, middle_rad) = self.split(start_rad);
        let starts = (middle_rad - half_width_rad, middle_rad + half_width_rad);
        let of_turn = |turn_rad| self.turn_range_ml(middle_rad, half_width_rad, turn_rad);
        let (low, high) = (of_turn(least_rad), of_turn(most_rad));
        let (mut least_ml, mut most_ml) = (low.0.min(high.0), low.1.max(high.1));
        // A turn that is longer by a pitch delivers more, from every angle.
        let turns = (least_rad, most_rad.min(least_rad + self.pitch_rad()));
        self.each_turn(starts.0 + turns.0, starts.1 + turns.1, &mut |end_rad, end_ml| {
            least_ml = least_ml.min(end_ml - self.starts_range_ml(starts, turns, end_rad).1);
        });
        let turns = (least_rad.max(most_rad - self.pitch_rad()), most_rad);
        self.each_turn(starts.0 + turns.0, starts.1 + turns.1, &mut |end_rad, end_ml| {
            most_ml = most_ml.max(end_ml - self.starts_range_ml(starts, turns, end_rad).0);
        });
        (least_ml, most_ml)
    }

    /// Returns the smallest and largest volume at the starts from which turns end at `end_rad`, mL.
    #[cold]
    #[inline(never)]
    fn starts_range_ml(&self, starts: (f64, f64), turns: (f64, f64), end_rad: f64) -> (f64, f64) {
        let (first_rad, last_rad) = (starts.0.max(end_rad - turns.1), starts.1.min(end_rad - turns.0));
        self.volume_range_ml(first_rad.min(last_rad), last_rad)
    }

    /// Shows the angles between two at which the flow may reverse, with the volumes since angle 0, mL.
    #[cold]
    #[inline(never)]
    fn each_turn(&self, from_rad: f64, to_rad: f64, show: &mut dyn FnMut(f64, f64)) {
        /// Largest number of runs for each piece. The way has four pitches at most, and a piece has five runs.
        const RUNS: usize = 20;
        let mut runs = Runs::new(self, from_rad, true);
        for _ in 0..RUNS * self.pieces().len() + 1 {
            let run = runs.next();
            let end_rad = run.leave_rad(self);
            if end_rad.is_nan() || end_rad >= to_rad {
                return;
            }
            let [_, local_ml] = run.ends_ml();
            show(end_rad, run.pitches * self.pitch_ml() + local_ml);
        }
    }
}
