//! Steps before a dose that nobody watches: an interrupted dose on record, and a disturbed angle.

use std::mem;

use pump_bench::notice::Notice;
use pump_bench::report::AcceptedReport;
use pump_bench::safety::UnfinishedPolicy;
use pump_bench::{Bench, DoseError, DoseRequest, Session};

use super::{Said, deliver, report};
use crate::advice;
use crate::commands::accept::accept_counted;
use crate::failure::Failure;
use crate::interrupt::Interrupt;
use crate::options::dosing::DosingOptions;
use crate::options::unattended::has_no_terminal;
use crate::terminal::{noted, print, warn};
use crate::warned::Warned;

/// Notices about what came before a dose. The dose's report tells them. If the dose is refused, no report follows, and
/// they are told as warnings once this is dropped.
#[derive(Debug, Default)]
pub(in crate::commands) struct Untold(Vec<Notice>);

impl Untold {
    /// Takes the notices, to tell them now.
    pub(in crate::commands) fn take(&mut self) -> Vec<Notice> {
        mem::take(&mut self.0)
    }

    /// Returns the notices for a report.
    pub(in crate::commands) fn notices(&self) -> Vec<Notice> {
        self.0.clone()
    }

    /// Takes the notices as told with a dose that has begun, and not with one that `failed` before it moved.
    pub(in crate::commands) fn told(&mut self, failed: Option<&Failure>) {
        if !failed.is_some_and(Failure::moved_nothing) {
            self.0.clear();
        }
    }
}

impl Drop for Untold {
    fn drop(&mut self) {
        warn(&self.0);
    }
}

/// Does what the policies of a dose say before it is prepared. Returns what the dose's report is to tell of it.
pub(in crate::commands) fn before_dose(
    bench: &Bench,
    session: &mut Session<'_>,
    options: &DosingOptions,
    interrupt: &Interrupt,
) -> Result<Untold, Failure> {
    let mut told = Untold::default();
    let done = settle(bench, session, options, interrupt, &mut told.0);
    done.map_err(|failure| failure.of_session(session))?;
    Ok(told)
}

fn settle(
    bench: &Bench,
    session: &mut Session<'_>,
    options: &DosingOptions,
    interrupt: &Interrupt,
    told: &mut Vec<Notice>,
) -> Result<(), Failure> {
    let policy = options.unattended.unfinished();
    if is_unfinished(session) {
        match policy {
            // Preparing the dose refuses it.
            UnfinishedPolicy::Ask => return Ok(()),
            UnfinishedPolicy::Accept => told.push(accept(bench, session, "--unfinished accept")?),
            // The rest would go on until a limit, and nobody is there to stop it.
            UnfinishedPolicy::Resume if is_endless(session) => {
                told.push(accept(bench, session, "a run until stopped has no rest to resume")?);
            }
            UnfinishedPolicy::Resume => {}
        }
    }
    let is_to_finish = is_unfinished(session);
    find_angle(session, options, interrupt)?;
    if is_to_finish {
        resume(bench, session, options, interrupt)?;
    }
    Ok(())
}

/// True if an interrupted dose is on record.
fn is_unfinished(session: &Session<'_>) -> bool {
    session.state().is_some_and(|state| state.unfinished.is_some())
}

/// True if the interrupted dose was a run until somebody stops it.
fn is_endless(session: &Session<'_>) -> bool {
    session.state().and_then(|state| state.unfinished).is_some_and(|unfinished| unfinished.is_endless())
}

/// Does as the pump file says if nobody is there and the angle was disturbed.
pub(in crate::commands) fn find_angle(
    session: &mut Session<'_>,
    options: &DosingOptions,
    interrupt: &Interrupt,
) -> Result<(), Failure> {
    if !options.unattended.is_unattended() || options.start_angle.angle_rad().is_some() {
        return Ok(());
    }
    obey_home(session, interrupt)
}

/// Does as the pump file says if the angle of an unfinished dose was disturbed and nobody is there.
pub(in crate::commands) fn find_angle_of_rest(
    session: &mut Session<'_>,
    interrupt: &Interrupt,
) -> Result<(), Failure> {
    if !has_no_terminal() || !is_unfinished(session) {
        return Ok(());
    }
    obey_home(session, interrupt).map_err(|failure| failure.of_session(session))
}

/// Does as the pump file says if the angle was disturbed.
fn obey_home(session: &mut Session<'_>, interrupt: &Interrupt) -> Result<(), Failure> {
    let found = session.follow_home_policy(|_| interrupt.flow());
    noted(session, found).map_err(Failure::from)
}

/// Accepts the interrupted dose, for this reason. Returns what is to be told of it.
fn accept(bench: &Bench, session: &mut Session<'_>, reason: &str) -> Result<Notice, Failure> {
    let accepted = accept_counted(session)?;
    let unasked = accepted.unasked.as_ref().map_or(String::new(), |error| {
        format!("; the device could not be asked what it has counted: {}", advice::told(error))
    });
    let AcceptedReport { requested_ml, delivered_least_ml, delivered_most_ml, dropped_carry_ml, .. } =
        AcceptedReport::new(bench, &accepted, Vec::new());
    let whole = if accepted.dose.is_endless() {
        "an interrupted run until stopped".to_owned()
    } else {
        let requested = format!("{requested_ml:.4}");
        format!("an interrupted dose of {} mL", requested.trim_end_matches('0').trim_end_matches('.'))
    };
    let delivered = if delivered_most_ml - delivered_least_ml < 1e-4 {
        format!("{delivered_least_ml:.4} mL")
    } else {
        format!("{delivered_least_ml:.4} to {delivered_most_ml:.4} mL")
    };
    let dropped = if dropped_carry_ml.abs() < 5e-5 {
        String::new()
    } else {
        format!(", and {dropped_carry_ml:.4} mL of carry are dropped")
    };
    Ok(Notice::from(format!(
        "{whole} was accepted as it is ({reason}): {delivered} were \
         delivered{dropped}{unasked}"
    )))
}

/// Makes the rest of the interrupted dose, and reports it as a dose of its own.
fn resume(
    bench: &Bench,
    session: &mut Session<'_>,
    options: &DosingOptions,
    interrupt: &Interrupt,
) -> Result<(), Failure> {
    let json = options.format.json();
    let mut prepared = match session.prepare_rest(DoseRequest::dose(0.0)) {
        Err(done @ DoseError::WasFinished) => {
            warn(&session.notes());
            warn(&[done.to_string()]);
            return Ok(());
        }
        prepared => noted(session, prepared)?,
    };
    prepared
        .warnings
        .push(Notice::from("this is the rest of an interrupted dose on record (--unfinished resume)"));
    let delivered = deliver(bench, session, &prepared, interrupt, json, &mut Warned::default())?;
    let said = Said { json, verbose: options.verbose.verbose, asked: None };
    report(bench, &prepared, Some(delivered), &said)?;
    if json { Ok(()) } else { print("\n") }
}
