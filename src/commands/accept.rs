//! `dose accept`: an unfinished dose is accepted as it is.

use clap::Args;
use pump_bench::report::{AcceptedReport, accepted_text};
use pump_bench::{Accepted, Bench, DoseError, Session};

use crate::advice;
use crate::failure::Failure;
use crate::options::bench::BenchOptions;
use crate::options::report::FormatOption;
use crate::terminal::{noted, print_json, tell, warn};

/// The unfinished dose that is meant.
#[derive(Debug, Args)]
pub(super) struct NamedDose {
    /// Unfinished dose that is meant, by its number in `dose status --format json` or by the order of `dose serve` that
    /// made it. Another one is refused
    #[arg(long, value_name = "NUMBER")]
    dose: Option<String>,
}

impl NamedDose {
    /// Refuses if another dose is unfinished than the one that is meant. The caller holds the pump's lock.
    pub(super) fn check(&self, bench: &Bench) -> Result<(), Failure> {
        Ok(self.dose.iter().try_for_each(|dose| bench.check_is_unfinished(dose))?)
    }
}

#[derive(Debug, Args)]
pub(crate) struct AcceptArgs {
    #[command(flatten)]
    named: NamedDose,
    /// Accept the bounds on record of a dose whose board cannot be asked for its exact steps
    #[arg(long)]
    anyway: bool,
    #[command(flatten)]
    bench: BenchOptions,
    #[command(flatten)]
    format: FormatOption,
}

/// Accepts the interrupted dose, and refuses while a board that may know its exact steps cannot be asked.
pub(in crate::commands) fn accept_counted(session: &mut Session<'_>) -> Result<Accepted, Failure> {
    let accepted = session.accept_counted();
    noted(session, accepted).map_err(|error| {
        let is_unasked = matches!(error, DoseError::Connection(_));
        let failure = Failure::from(error);
        if !is_unasked {
            return failure;
        }
        failure.with(
            "; the board may know the exact steps of the unfinished dose, so nothing was accepted: try again once it \
             answers, or accept the bounds on record with `dose accept --anyway`",
        )
    })
}

impl AcceptArgs {
    pub(crate) fn run(&self) -> Result<(), Failure> {
        let bench = self.bench.bench()?;
        let mut session = bench.session()?;
        self.named.check(&bench)?;
        let accepted = if self.anyway {
            let accepted = session.accept();
            noted(&mut session, accepted)?
        } else {
            accept_counted(&mut session)?
        };
        let unasked = accepted.unasked.as_ref();
        let unasked = unasked.map(|error| {
            format!("the device could not be asked what it has counted: {}", advice::told(error))
        });
        let notes = session.notes().into_iter().map(|note| note.worded(advice::words));
        let warnings: Vec<String> = unasked.into_iter().chain(notes).collect();
        warn(&warnings);
        if self.format.json() {
            return print_json(&(AcceptedReport::new(&bench, &accepted, warnings).json() + "\n"));
        }
        tell(&accepted_text(&bench, &accepted, advice::words))
    }
}
