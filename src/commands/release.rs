//! `dose release`: the motor lets go of the rotor.

use clap::Args;
use pump_bench::report::rotor_text;

use crate::advice;
use crate::failure::Failure;
use crate::options::bench::BenchOptions;
use crate::terminal::{noted, tell, warn};

#[derive(Debug, Args)]
pub(crate) struct ReleaseArgs {
    #[command(flatten)]
    bench: BenchOptions,
}

impl ReleaseArgs {
    pub(crate) fn run(&self) -> Result<(), Failure> {
        let bench = self.bench.bench()?;
        let mut session = bench.session()?;
        let connected = session.connect();
        noted(&mut session, connected)?;
        warn(&session.notes());
        let state = session.release()?;
        tell(&format!("the motor is without current\n{}", rotor_text(&bench, &state, advice::words)))
    }
}
