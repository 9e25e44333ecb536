//! The picture of a tube: the factor of its calibrations over time, in a terminal and as SVG.

use super::TubeReport;
#[cfg(feature = "plot")]
use crate::export::{PlotError, tube_svg};
use crate::numbers::duration;
use crate::record::Stamp;

/// Lines of the picture in a terminal, and its columns.
const LINES: usize = 9;
const COLUMNS: usize = 56;

/// Fewest calibrations that a picture shows more of than their lines do.
const LEAST: usize = 2;

/// Length of a day, in s.
const DAY_S: f64 = 86_400.0;

/// Point of the picture: days since the first calibration, factor, and its expanded uncertainty.
type Point = (f64, f64, f64);

impl TubeReport {
    /// Draws the factor of the calibrations over time as SVG, with the bounds of their expanded uncertainty.
    ///
    /// # Errors
    ///
    /// [`PlotError`] of a picture that cannot be drawn.
    #[cfg(feature = "plot")]
    pub fn svg(&self) -> Result<String, PlotError> {
        let title = format!("tube {} of {}: measured over model volume (k = 2)", self.tube, self.pump);
        tube_svg(&title, &self.points())
    }

    /// Returns the picture for a terminal. It is empty with fewer than two calibrations, and with all at
    /// one time.
    pub(super) fn picture(&self) -> String {
        let points = self.points();
        if points.len() < LEAST {
            return String::new();
        }
        let low = points.iter().map(|(_, factor, unsure)| factor - unsure).fold(f64::INFINITY, f64::min);
        let high = points.iter().map(|(_, factor, unsure)| factor + unsure).fold(f64::NEG_INFINITY, f64::max);
        let days = points.iter().map(|(day, ..)| *day).fold(0.0, f64::max);
        if days <= 0.0 {
            // Calibrations of one time have no course.
            return String::new();
        }
        let line = |factor: f64| {
            let part = if high > low { (high - factor) / (high - low) } else { 0.5 };
            (part * (LINES - 1) as f64).round() as usize
        };
        let column = |day: f64| (day / days * (COLUMNS - 1) as f64).round() as usize;
        let mut cells = vec![vec![' '; COLUMNS]; LINES];
        for (day, factor, unsure) in &points {
            let place = column(*day);
            for row in cells.iter_mut().take(line(factor - unsure) + 1).skip(line(factor + unsure)) {
                if let Some(cell) = row.get_mut(place) {
                    *cell = '|';
                }
            }
        }
        // A calibration stands before the bars of its neighbours.
        for (day, factor, _) in &points {
            if let Some(cell) = cells.get_mut(line(*factor)).and_then(|row| row.get_mut(column(*day))) {
                *cell = 'o';
            }
        }
        let mut text = String::new();
        for (n, row) in cells.iter().enumerate() {
            let label = match n {
                0 => format!("{high:.4}"),
                n if n + 1 == LINES => format!("{low:.4}"),
                _ => String::new(),
            };
            let row: String = row.iter().collect();
            text += format!("  {label:>7} |{row}").trim_end();
            text += "\n";
        }
        text + &format!(
            "          +{}\n          0 to {}, model volume times the factor (k = 2)\n",
            "-".repeat(COLUMNS),
            if days < 2.0 { duration(DAY_S * days) } else { format!("{days:.0} days") }
        )
    }

    /// Returns the calibrations as points over days.
    fn points(&self) -> Vec<Point> {
        let days = |date: &str| date.parse::<Stamp>().ok().map(|time| time.unix_s as f64 / DAY_S);
        let first = self.calibrations.first().and_then(|first| days(&first.date)).unwrap_or(0.0);
        let point = |one: &super::TubeCalibration| {
            Some((days(&one.date)? - first, one.factor, one.expanded_uncertainty))
        };
        self.calibrations.iter().filter_map(point).collect()
    }
}
