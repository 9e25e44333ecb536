//! `dose accept`: an unfinished dose is accepted as it is.

use clap::Args;
use pump_bench::report::{AcceptedReport, accepted_text};

use crate::advice;
use crate::failure::Failure;
use crate::options::bench::BenchOptions;
use crate::options::report::FormatOption;
use crate::terminal::{noted, print_json, tell, warn};

#[derive(Debug, Args)]
pub(crate) struct AcceptArgs {
    #[command(flatten)]
    bench: BenchOptions,
    #[command(flatten)]
    format: FormatOption,
}

impl AcceptArgs {
    pub(crate) fn run(&self) -> Result<(), Failure> {
        let bench = self.bench.bench()?;
        let mut session = bench.session()?;
        let accepted = session.accept();
        let accepted = noted(&mut session, accepted)?;
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
