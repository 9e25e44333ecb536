//! The progress of a motion and of a wait, on standard error. Only a terminal shows it.

use std::time::Duration;

use indicatif::{HumanDuration, ProgressBar, ProgressStyle};
use pump_bench::Prepared;
use pump_bench::dosing::RunEnd;

use super::supervised::{Lines, Reached};
use crate::terminal::waiting;

/// The bar of a motion: it counts millilitres.
pub(crate) struct MotionBar {
    bar: ProgressBar,
    /// Volume of the whole motion, in mL.
    whole_ml: f64,
    /// Time of the whole motion by its plan, in s; `None` if a balance ends it, at a time that nobody knows.
    whole_s: Option<f64>,
    steps: u64,
    /// Lines to a supervising program.
    lines: Option<Lines>,
}

impl MotionBar {
    /// The bar of a pump's motion of `steps` and `whole_ml`, which takes `whole_s` by its plan. A program that reads
    /// the report wants none.
    pub(crate) fn new(pump: &str, steps: u64, whole_ml: f64, whole_s: Option<f64>, json: bool) -> Self {
        let lines = Lines::of(pump, steps, whole_ml);
        if json {
            return Self { bar: ProgressBar::hidden(), whole_ml, whole_s, steps, lines };
        }
        let style = ProgressStyle::with_template("{bar:40} {msg}");
        let bar = ProgressBar::new(steps).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
        bar.set_message(shown(0.0, whole_ml) + &whole_s.map_or(String::new(), |s| time_left(0, steps, s)));
        Self { bar, whole_ml, whole_s, steps, lines }
    }

    /// The bar of a prepared dose, or a sign that turns for a run without an end.
    pub(crate) fn of(pump: &str, prepared: &Prepared, json: bool) -> Self {
        let whole_ml = prepared.plan.planned_ml();
        match prepared.request.end {
            RunEnd::Stop => {
                let bar =
                    if json { ProgressBar::hidden() } else { waiting("running until stopped by Ctrl-C") };
                let lines = Lines::of(pump, 0, f64::INFINITY);
                Self { bar, whole_ml: f64::INFINITY, whole_s: None, steps: 0, lines }
            }
            _ => {
                let whole_s = Some(prepared.plan.profile().duration_s());
                Self::new(pump, prepared.plan.steps().unsigned_abs(), whole_ml, whole_s, json)
            }
        }
    }

    /// Shows the steps made, and the place that they have `reached`.
    pub(crate) fn made(&self, steps: u64, reached: impl Fn() -> Reached) {
        self.lines.iter().for_each(|lines| lines.made(steps, &reached));
        self.bar.set_position(steps);
        if !self.bar.is_hidden() {
            let volume = shown(reached().delivered_ml, self.whole_ml);
            let left = self.whole_s.map_or(String::new(), |whole_s| time_left(steps, self.steps, whole_s));
            self.bar.set_message(format!("{volume}{left}"));
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

/// The time that is left of a motion that takes `whole_s` for all of its steps.
fn time_left(made: u64, steps: u64, whole_s: f64) -> String {
    let part = made as f64 / steps.max(1) as f64;
    let left_s = (whole_s * (1.0 - part)).max(0.0);
    format!(", {} left", HumanDuration(Duration::from_secs_f64(left_s.ceil())))
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
    fn the_time_left_is_that_of_the_plan_from_the_start() {
        assert_eq!(time_left(0, 3200, 23.815), ", 24 seconds left");
        assert_eq!(time_left(1600, 3200, 23.815), ", 12 seconds left");
        assert_eq!(time_left(3200, 3200, 23.815), ", 0 seconds left");
    }

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
