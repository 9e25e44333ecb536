//! `dose discard`: an unfinished dose is accepted as it is.

use clap::Args;
use pump_bench::report::{carry_dropped_text, rotor_text};

use crate::failure::Failure;
use crate::options::bench::BenchOptions;
use crate::terminal::{noted, tell, warn};

#[derive(Debug, Args)]
pub(crate) struct DiscardArgs {
    #[command(flatten)]
    bench: BenchOptions,
}

impl DiscardArgs {
    pub(crate) fn run(&self) -> Result<(), Failure> {
        let bench = self.bench.bench()?;
        let mut session = bench.session()?;
        let carry_ml = session.owed_ml();
        let discarded = session.discard();
        let (state, unasked) = noted(&mut session, discarded)?;
        let unasked =
            unasked.map(|error| format!("the device could not be asked what it has counted: {error}"));
        warn(&unasked.into_iter().chain(session.notes()).collect::<Vec<_>>());
        let (rotor, dropped) = (rotor_text(&bench, &state), carry_dropped_text(carry_ml));
        tell(&format!("the unfinished dose is accepted as it is\n{rotor}{dropped}"))
    }
}
