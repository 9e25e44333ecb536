//! `dose home --sensor`: the rotor turns until its index sensor answers.

use std::io::{self, BufRead, IsTerminal, Write};

use pump_bench::Bench;
use pump_bench::notice::Notice;
use pump_bench::report::{carry_dropped_text, rotor_text};

use crate::advice;
use crate::failure::Failure;
use crate::interrupt::Interrupt;
use crate::terminal::{announced, noted, tell, warn};

/// Finds the angle by the index sensor.
pub(super) fn sensor(yes: bool, bench: &Bench) -> Result<(), Failure> {
    let mut session = bench.session()?;
    let carry_ml = session.owed_ml();
    let index_rad = session.index_rad();
    noted(&mut session, index_rad)?;
    warn(&session.notes());
    // Whoever is asked reads it in the question, and everybody else before the motor turns.
    let within_dose = session.search_warning();
    if !yes {
        let most_ml = bench.model().revolution_ml();
        let of_dose = within_dose
            .as_ref()
            .map_or(String::new(), |warning| format!("; {}", warning.worded(advice::words)));
        agree(&format!(
            "the pump turns forward until the sensor answers, and pumps up to {most_ml:.1} mL{of_dose}"
        ))?;
    }
    let untold: Vec<Notice> = within_dose.into_iter().filter(|_| yes).collect();
    let interrupt = Interrupt::watch()?;
    let sought = announced(&mut session, false, &untold, |session| session.seek_index(|_| interrupt.flow()));
    warn(&session.notes());
    let sought = sought?;
    match sought.map_err(|error| Failure::from(error).of_session(&session))? {
        Some(state) => {
            let dropped = carry_dropped_text(carry_ml - state.carry_ml);
            let told = tell(&format!("{}{dropped}", rotor_text(bench, &state, advice::words)));
            told.map_err(|failure| failure.of_session(&session))
        }
        None => Err(Failure::stopped(
            interrupt.signal().unwrap_or(0),
            session.has_moved(),
            "stopped by the user before the sensor answered; the rotor is where the record says",
        )),
    }
}

/// Asks a person at a terminal; nobody else can agree.
fn agree(what: &str) -> Result<(), Failure> {
    let refused = |why: &str| Err(Failure::refused(format!("{what}; {why}")));
    if !io::stdin().is_terminal() {
        return refused("nobody is there to agree: say --yes");
    }
    let mut answer = String::new();
    let asked = write!(io::stderr(), "{what}. Go on? [y/N] ")
        .and_then(|()| io::stdin().lock().read_line(&mut answer));
    match asked {
        Ok(_) if ["y", "yes"].contains(&answer.trim().to_lowercase().as_str()) => Ok(()),
        Ok(_) => refused("nobody agreed, and nothing was moved"),
        Err(error) => refused(&format!("the answer could not be read: {error}")),
    }
}
