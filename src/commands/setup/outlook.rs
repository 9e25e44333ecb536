//! The end of a first run: how sure doses are now, and what one more step would bring.

use std::fmt::Write;

use pump_bench::setup::Outlook;

use super::asker::Asked;
use super::course::{Course, heading};
use super::written::rounded;
use crate::advice;
use crate::failure::Failure;
use crate::terminal::tell;

/// Says how sure doses are, and what makes them surer.
pub(super) fn tell_outlook(course: &Course) -> Asked<()> {
    let bench = course.bench()?;
    let name = &course.answers.name;
    let volume_ml = course.answers.volume_ml.unwrap_or(10.0);
    heading("How sure doses are now");
    let mut text = String::new();
    for volume_ml in [volume_ml, 0.1 * volume_ml] {
        let outlook = Outlook::of(&bench, volume_ml).map_err(Failure::from)?;
        let [dose, least, most] = [outlook.volume_ml, outlook.least_ml, outlook.most_ml].map(rounded);
        let percent = 100.0 * outlook.expanded_ml / outlook.volume_ml;
        let _ = writeln!(text, "  a dose of {dose} mL lies between {least} and {most} mL in 95 % of cases (± {percent:.1} %)");
        for step in &outlook.steps {
            let best = 100.0 * step.at_best_ml / outlook.volume_ml;
            let source = step.source.replace('_', " ");
            let _ = writeln!(text, "    {source}: {}; at best ± {best:.1} %", step.notice.worded(advice::words));
        }
    }
    let is_usual = if name.is_empty() { String::new() } else { format!(" --pump {name}") };
    let _ = writeln!(text, "`dose {}mL{is_usual}` doses; `dose setup {name}` weighs one more dose", rounded(volume_ml));
    Ok(tell(&text)?)
}
