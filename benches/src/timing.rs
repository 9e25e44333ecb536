//! Times of the rows by turns. Each round times every row, so a slow spell of the machine slows all of them.

use std::error::Error;
use std::time::Instant;

pub(crate) type Outcome = Result<(), Box<dyn Error>>;

/// A task to time.
pub(crate) struct Row<'a> {
    pub name: String,
    /// Tolerance that the solver was given, if the row solves the benchmark case.
    pub tolerance: Option<f64>,
    /// Error that the solver reached, kPa, if the row solves the benchmark case.
    pub error_kpa: Option<f64>,
    /// Number of results of one run, and their noun.
    pub makes: (f64, &'static str),
    pub run: Box<dyn FnMut() -> Outcome + 'a>,
}

/// The length of a measurement.
#[derive(Clone, Copy)]
pub(crate) struct Effort {
    pub rounds: usize,
    /// Time that a row fills in a round with repetitions, s.
    pub fill_s: f64,
}

/// Times of every row in every round, s.
pub(crate) struct Times(Vec<Vec<f64>>);

impl Times {
    pub(crate) fn measure(rows: &mut [Row<'_>], effort: Effort) -> Result<Self, Box<dyn Error>> {
        let mut repetitions = Vec::new();
        for row in rows.iter_mut() {
            (row.run)()?;
            let once_s = seconds(row, 1)?;
            repetitions.push((effort.fill_s / once_s).clamp(1.0, 1e6) as usize);
        }
        let mut times = vec![Vec::new(); rows.len()];
        for _ in 0..effort.rounds {
            for ((row, &count), times) in rows.iter_mut().zip(&repetitions).zip(&mut times) {
                times.push(seconds(row, count)? / count as f64);
            }
        }
        Ok(Self(times))
    }

    /// Returns the median time of a row, s.
    pub(crate) fn median_s(&self, row: usize) -> f64 {
        median(self.0[row].clone())
    }

    /// Returns the median over the rounds of a row's time over another row's time in that round.
    pub(crate) fn ratio(&self, row: usize, to: usize) -> f64 {
        median(self.0[row].iter().zip(&self.0[to]).map(|(row, to)| row / to).collect())
    }
}

fn seconds(row: &mut Row<'_>, count: usize) -> Result<f64, Box<dyn Error>> {
    let start = Instant::now();
    for _ in 0..count {
        (row.run)()?;
    }
    Ok(start.elapsed().as_secs_f64())
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}
