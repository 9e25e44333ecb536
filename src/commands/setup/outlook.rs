//! The end of a first run: how sure doses are now, and what one more step would bring.

use std::fmt::Write;

use pump_bench::setup::Outlook;

use super::asker::Asked;
use super::course::{Course, heading, rounded};

/// Most steps that are said.
const MOST_STEPS: usize = 3;

/// Says how sure doses are, and what makes them surer.
pub(super) fn tell_outlook(course: &Course) -> Asked<()> {
    let bench = course.bench()?;
    let name = &course.answers.name;
    let volume_ml = course.answers.volume_ml.unwrap_or(10.0);
    heading("How sure doses are now");
    let [outlook, small] = [Outlook::of(&bench, volume_ml)?, Outlook::of(&bench, 0.1 * volume_ml)?];
    let mut text = line(&outlook) + &line(&small);
    let volume = rounded(volume_ml);
    if !outlook.steps.is_empty() {
        let _ = writeln!(text, "One more step could reduce the uncertainty of a dose of {volume} mL to");
    }
    for step in outlook.steps.iter().take(MOST_STEPS) {
        let best = 100.0 * step.at_best_ml / outlook.volume_ml;
        let source = step.source.replace('_', " ");
        let _ = writeln!(text, "  ± {best:.1} %  ({source}) {}", step.notice.worded(course.runnable.words()));
    }
    let _ = writeln!(
        text,
        "`{name}` is set up: `dose {volume}mL --pump {name}` doses, `dose setup {name}` weighs again"
    );
    if course.folder.is_default_pump(name) {
        let _ = writeln!(
            text,
            "It is the default pump: a command without --pump means {name}; --pump three-roller names the built-in one"
        );
    }
    let safety = &bench.file().safety;
    if safety.max_ml_per_day.is_none() && safety.vessel_ml.is_none() {
        let path = course.folder.pump_file(name);
        let _ = writeln!(
            text,
            "Nothing yet limits what it pumps unattended; set max_ml_per_day and vessel_ml in [safety] of {}",
            path.display()
        );
    }
    Ok(course.tell(&text)?)
}

/// The interval of a dose, with the digits that its width allows.
fn line(outlook: &Outlook) -> String {
    let decimals = (1.0 - outlook.expanded_ml.log10().floor()).clamp(0.0, 6.0) as usize;
    let percent = 100.0 * outlook.expanded_ml / outlook.volume_ml;
    format!(
        "  a dose of {} mL lies between {:.decimals$} and {:.decimals$} mL in 95 % of cases (± {percent:.1} % in \
         all)\n",
        rounded(outlook.volume_ml),
        outlook.least_ml,
        outlook.most_ml,
    )
}
