//! The progress of a motion and of a wait, on standard error. Only a terminal shows it.

use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};
use pump_bench::Prepared;
use pump_bench::dosing::RunEnd;

use crate::terminal::waiting;

/// The bar of a motion: it counts millilitres.
pub(crate) struct MotionBar {
    bar: ProgressBar,
    /// Volume of the whole motion, in mL.
    whole_ml: f64,
}

impl MotionBar {
    /// The bar of a motion of `steps` and `whole_ml`. A program that reads the report wants none.
    pub(crate) fn new(steps: u64, whole_ml: f64, json: bool) -> Self {
        if json {
            return Self { bar: ProgressBar::hidden(), whole_ml };
        }
        let style = ProgressStyle::with_template("{bar:40} {msg}, {eta} left");
        let bar = ProgressBar::new(steps).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
        Self { bar, whole_ml }
    }

    /// The bar of a prepared dose, or a sign that turns for a run without an end.
    pub(crate) fn of(prepared: &Prepared, json: bool) -> Self {
        let whole_ml = prepared.plan.planned_ml();
        match prepared.request.end {
            RunEnd::Stop if !json => {
                Self { bar: waiting("running until stopped by Ctrl-C"), whole_ml: f64::INFINITY }
            }
            _ => Self::new(prepared.plan.steps().unsigned_abs(), whole_ml, json),
        }
    }

    /// Shows the steps made, and the volume that `delivered_ml` tells.
    pub(crate) fn made(&self, steps: u64, delivered_ml: impl FnOnce() -> f64) {
        self.bar.set_position(steps);
        if !self.bar.is_hidden() {
            self.bar.set_message(shown(delivered_ml(), self.whole_ml));
        }
    }

    /// Takes the bar away.
    pub(crate) fn end(&self) {
        self.bar.finish_and_clear();
    }
}

/// The volume that was delivered, of the whole where it has an end.
fn shown(delivered_ml: f64, whole_ml: f64) -> String {
    let decimals = |ml: f64| if ml.abs() < 10.0 { 3 } else { 1 };
    if whole_ml.is_infinite() {
        return format!("running until stopped by Ctrl-C: {delivered_ml:.*} mL", decimals(delivered_ml));
    }
    let decimals = decimals(whole_ml);
    format!("{delivered_ml:.decimals$} of {whole_ml:.decimals$} mL")
}

/// The time to the next dose of a batch, as `next dose in 7:12 (3 of 10)`.
pub(crate) fn until_next(left: Duration, number: u64, count: u64) -> String {
    // The last second is shown until it has passed.
    let seconds = left.as_secs_f64().ceil() as u64;
    let (hours, minutes, seconds) = (seconds / 3600, seconds / 60 % 60, seconds % 60);
    let left = if hours > 0 {
        format!("{hours}:{minutes:02}:{seconds:02}")
    } else {
        format!("{minutes}:{seconds:02}")
    };
    format!("next dose in {left} ({number} of {count})")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wait_counts_down_to_the_second() {
        for (seconds, told) in
            [(432.0, "7:12"), (431.2, "7:12"), (0.2, "0:01"), (3600.0, "1:00:00"), (90_061.0, "25:01:01")]
        {
            let left = Duration::from_secs_f64(seconds);
            assert_eq!(until_next(left, 3, 10), format!("next dose in {told} (3 of 10)"));
        }
    }

    #[test]
    fn a_bar_counts_millilitres() {
        assert_eq!(shown(0.5, 2.0), "0.500 of 2.000 mL");
        assert_eq!(shown(-12.34, -25.0), "-12.3 of -25.0 mL");
        assert_eq!(shown(12.34, f64::INFINITY), "running until stopped by Ctrl-C: 12.3 mL");
    }
}
