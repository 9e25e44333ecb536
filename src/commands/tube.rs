//! `dose tube`: the life of the tube, and its replacement.

use clap::Args;
use pump_bench::NewTube;
use pump_bench::report::{TubeReport, carry_dropped_text, rotor_text};

use crate::advice;
use crate::failure::Failure;
use crate::options::bench::BenchOptions;
use crate::options::files::{Files, PlotOption};
use crate::options::limits::TubeLimit;
use crate::options::report::FormatOption;
use crate::outputs::Outputs;
use crate::terminal::{noted, print_json, tell, warn};

#[derive(Debug, Args)]
pub(crate) struct TubeArgs {
    /// The tube is new: it has pumped nothing, and nothing is carried
    #[arg(long, conflicts_with_all = ["format", "plot"])]
    new: bool,
    #[command(flatten)]
    bench: BenchOptions,
    #[command(flatten)]
    tube_limit: TubeLimit,
    #[command(flatten)]
    format: FormatOption,
    #[command(flatten)]
    plot: PlotOption,
}

impl TubeArgs {
    pub(crate) fn run(&self) -> Result<(), Failure> {
        let mut file = self.bench.pump.file()?;
        self.tube_limit.change(&mut file);
        let bench = self.bench.bench_of(file)?;
        if !self.new {
            let tube = TubeReport::of(&bench)?;
            if let Some(path) = &self.plot.plot {
                let state_dir = Some(self.bench.record.folder(&self.bench.pump.config()?)?);
                let pump = self.bench.pump.path()?;
                let config = self.bench.pump.config_path();
                let outputs = [("--plot", Some(path.as_path()))];
                Files { outputs: &outputs, inputs: &[pump.as_deref()], config, state_dir }.check()?;
                let mut outputs = Outputs::default();
                outputs.drawing(path, tube.svg())?;
                outputs.put()?;
            }
            return if self.format.json() { print_json(&(tube.json() + "\n")) } else { tell(&tube.text()) };
        }
        let mut session = bench.session()?;
        let replaced = session.new_tube();
        let NewTube { state, worn_ml, owed_ml, unused, readings, .. } = noted(&mut session, replaced)?;
        warn(&session.notes());
        let unused = unused.map_or(String::new(), |version| {
            format!(
                "calibration {version} is not used any more; `dose calibrate use {version}` uses it again\n"
            )
        });
        let given_up = match readings {
            0 => String::new(),
            count => format!("{count} readings of a guided calibration of the old tube are given up\n"),
        };
        tell(&format!(
            "a new tube is on record; the one before pumped {worn_ml:.1} mL\n{}{}{unused}{given_up}warning: \
             a new tube gives another volume per revolution: calibrate it\nif the rotor was turned by hand, \
             say where it stands with `dose home --set <ANGLE>`\n",
            rotor_text(&bench, &state, advice::words),
            carry_dropped_text(owed_ml)
        ))
    }
}
