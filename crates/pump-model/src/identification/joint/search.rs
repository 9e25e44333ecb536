//! The search for the line of several recordings, by Levenberg and Marquardt's steps over blocks of rows.

use libm::{log, sqrt};

use super::super::least_squares::{GAIN, MOST_STEPS, Residuals, STEP, Triangle};
use super::super::sought::N;
use super::super::watch::Watch;
use super::super::waveform::{ANGLES, FREQUENCIES, WaveformResiduals};
use super::blocks::{Block, OWN, SHARED, damping_row, joined};
use super::recording::JointRecording;
use crate::error::ModelError;
use crate::line::line::Line;
use crate::pump::pump::Pump;

/// Parameters that are sought of a recording, in the order of the search for one.
pub(super) fn flags_of(record: &JointRecording<'_>, shared: [bool; SHARED]) -> [bool; N] {
    [shared[0], shared[1], shared[2], record.seeks_angle, record.seeks_start, shared[3]]
}

/// Recordings whose line is sought.
pub(super) struct Search<'a, 'b> {
    pub(super) pump: &'b Pump,
    pub(super) records: &'b mut [JointRecording<'a>],
    /// Shared parameters that are sought.
    pub(super) flags: [bool; SHARED],
    pub(super) watch: &'b Watch<'b>,
}

/// End of a search.
#[derive(Debug, Clone, Copy)]
pub(super) struct End {
    pub(super) shared: [f64; SHARED],
    /// Sum of squares, each over the square of its standard deviation.
    pub(super) sum: f64,
    pub(super) steps: u32,
}

impl End {
    pub(super) fn converged(&self) -> bool {
        self.steps < MOST_STEPS
    }
}

impl Search<'_, '_> {
    /// Returns the best minimum that the search reaches from the natural frequencies beside that of `line`, or `None`
    /// if none has a finite sum. The records' best angles and starts go with it.
    pub(super) fn best(&mut self, line: &Line) -> Result<Option<End>, ModelError> {
        let (both, either) = (self.flags[1] && self.flags[2], self.flags[1] || self.flags[2]);
        let frequencies = if either { FREQUENCIES.as_slice() } else { &FREQUENCIES[..1] };
        let mut best: Option<End> = None;
        for frequency in frequencies {
            // A frequency f times as large takes an L C f² times as small.
            let shift = if both { 1.0 } else { 2.0 } * log(*frequency);
            let lowered = |n: usize, value: f64| log(value) - if self.flags[n] { shift } else { 0.0 };
            let shared = [
                log(line.resistance_kpa_s_ml),
                lowered(1, line.compliance_ml_kpa),
                lowered(2, line.inertance_kpa_s2_ml),
                line.reservoir_kpa,
            ];
            let shared = self.begun(shared)?;
            let found = self.from(shared)?;
            if self.watch.is_stopped() {
                break;
            }
            if found.sum.is_finite() && best.is_none_or(|best| found.sum < best.sum) {
                best = Some(found);
                self.records.iter_mut().for_each(|record| record.room.best = record.room.own);
            }
        }
        if let Some(best) = best {
            self.records.iter_mut().for_each(|record| record.room.next = record.room.best);
            self.rows(&best.shared)?;
            self.accept();
        }
        Ok(best)
    }

    /// Puts each recording's angle where the residuals of this line are least, and returns the shared parameters with
    /// the pressure that meets the means.
    fn begun(&mut self, mut shared: [f64; SHARED]) -> Result<[f64; SHARED], ModelError> {
        let (mut weights, mut means) = (0.0, 0.0);
        for n in 0..self.records.len() {
            let record = self.records[n];
            let count = record.recording.samples.len() as f64;
            let angles = if record.seeks_angle { ANGLES } else { 1 };
            let (mut least, mut at, mut mean_kpa) = (f64::INFINITY, 0.0, 0.0);
            for angle in 0..angles {
                let angle_rad = f64::from(angle) / f64::from(angles) * self.pump.pitch_rad();
                let (mean, square) = self.waveform(&record).spread(&joined(&shared, &[angle_rad, 0.0]))?;
                let sum = if self.flags[3] { square } else { square + count * mean * mean };
                if sum < least {
                    (least, at, mean_kpa) = (sum, angle_rad, mean);
                }
            }
            self.records[n].room.next = [at, 0.0];
            let weight = count / (record.standard_kpa * record.standard_kpa);
            weights += weight;
            means += weight * mean_kpa;
        }
        if self.flags[3] {
            shared[3] += means / weights;
        }
        Ok(shared)
    }

    /// Searches downhill from these shared parameters and the next own ones of the records, as
    /// [`super::super::least_squares::search`] does.
    fn from(&mut self, mut shared: [f64; SHARED]) -> Result<End, ModelError> {
        let mut sum = self.sum(&shared)?;
        self.rows(&shared)?;
        self.accept();
        let mut damping = 1e-3;
        for steps in 0..MOST_STEPS {
            if self.gained() <= GAIN * sum {
                return Ok(End { shared, sum, steps });
            }
            let Some((step, is_small)) = self.step(damping) else { break };
            let next = core::array::from_fn(|n| shared[n] + step[n]);
            // Steps to models that cannot be, or to their border, are refused like steps uphill.
            let next_sum = self.sum(&next).ok().filter(|next_sum| *next_sum <= sum);
            match next_sum.filter(|_| self.rows(&next).is_ok()) {
                Some(next_sum) => {
                    self.accept();
                    let done = sum - next_sum <= GAIN * sum;
                    (shared, sum) = (next, next_sum);
                    if done {
                        return Ok(End { shared, sum, steps });
                    }
                    damping = (0.1 * damping).max(1e-12);
                }
                None => damping *= 10.0,
            }
            if is_small {
                return Ok(End { shared, sum, steps });
            }
        }
        Ok(End { shared, sum, steps: MOST_STEPS })
    }

    /// Returns the next step of the shared parameters, and whether no parameter changes by more than a little. Each
    /// record's next parameters go with it.
    fn step(&mut self, damping: f64) -> Option<([f64; SHARED], bool)> {
        let mut all = Triangle::holding(self.flags);
        let mut squares = [0.0; SHARED];
        for record in &mut *self.records {
            for (square, length) in squares.iter_mut().zip(record.room.block.shared_lengths()) {
                *square += length * length;
            }
            record.room.next_block = record.room.block.damped(damping);
            record.room.next_block.eliminate_into(&mut all);
        }
        for (n, square) in squares.into_iter().enumerate() {
            all.push(damping_row(n, damping, sqrt(square)), 0.0);
        }
        let step = all.solution()?;
        let mut is_small = step.iter().all(|step| step.abs() < STEP);
        for record in &mut *self.records {
            let own = record.room.next_block.own(&step);
            is_small &= own.iter().all(|step| step.abs() < STEP);
            record.room.next = core::array::from_fn(|n| record.room.own[n] + own[n]);
        }
        Some((step, is_small))
    }

    /// Returns the sum of squares by which the best parameters are better than these.
    fn gained(&self) -> f64 {
        let own: f64 = self.records.iter().map(|record| record.room.block.own_gained()).sum();
        own + self.shared().gained()
    }

    /// Returns the rows of the shared parameters.
    pub(super) fn shared(&self) -> Triangle<SHARED> {
        let mut all = Triangle::holding(self.flags);
        self.records.iter().for_each(|record| record.room.block.eliminate_into(&mut all));
        all
    }

    /// Returns the weighted sum of squares at these shared parameters and the records' next ones.
    fn sum(&self, shared: &[f64; SHARED]) -> Result<f64, ModelError> {
        let sum = |record: &JointRecording<'_>| {
            let sum = self.waveform(record).sum(&joined(shared, &record.room.next))?;
            Ok(sum / (record.standard_kpa * record.standard_kpa))
        };
        self.records.iter().map(sum).sum()
    }

    /// Computes the rows at these shared parameters and the records' next ones.
    fn rows(&mut self, shared: &[f64; SHARED]) -> Result<(), ModelError> {
        for n in 0..self.records.len() {
            let record = self.records[n];
            let rows = self.waveform(&record).rows(&joined(shared, &record.room.next))?;
            let block = Block::of(&rows, flags_of(&record, self.flags), 1.0 / record.standard_kpa);
            self.records[n].room.next_block = block;
        }
        Ok(())
    }

    /// Goes to the next parameters of the records.
    fn accept(&mut self) {
        for record in &mut *self.records {
            (record.room.own, record.room.block) = (record.room.next, record.room.next_block);
        }
    }

    /// Returns the residuals of a record.
    pub(super) fn waveform<'c>(&'c self, record: &'c JointRecording<'c>) -> WaveformResiduals<'c> {
        WaveformResiduals {
            recording: &record.recording,
            pump: self.pump,
            flags: flags_of(record, self.flags),
            watch: self.watch,
        }
    }
}

/// Number of parameters of its own that are sought of a record.
pub(super) fn own_count(record: &JointRecording<'_>) -> usize {
    [record.seeks_angle, record.seeks_start].into_iter().filter(|is_sought| *is_sought).count()
}

const _: () = assert!(OWN == 2, "`own_count` has an entry for each");
