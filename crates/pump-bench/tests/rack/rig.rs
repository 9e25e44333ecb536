//! A desk with simulated pumps, and a drive that fails where a test says.

use std::path::Path;

use pump_bench::drives::{Drive, DriveError, DriveFault, Gate, Leave};
use pump_bench::pump_file::Pace;
use pump_bench::rack::{Rack, RackError, RackFile};
use pump_bench::record::PumpState;
use pump_bench::{Bench, PumpFile, built_in};
use pump_ctl::plan::Plan;

/// Names of the pumps in a rack, each with its built-in pump.
pub(crate) const PUMPS: [(&str, &str); 3] =
    [("acid", "three-roller"), ("base", "two-roller"), ("salt", "three-roller-published")];

/// Head of a rack file with three pumps.
pub(crate) const HEAD: &str = "schema = \"rack/1\"\n[pumps]\nacid = \"three-roller\"\nbase = \"two-roller\"\nsalt = \
                               \"three-roller-published\"\n";

pub(crate) struct Desk {
    folder: tempfile::TempDir,
}

impl Desk {
    pub(crate) fn new() -> Self {
        Self { folder: tempfile::tempdir().unwrap() }
    }

    pub(crate) fn path(&self) -> &Path {
        self.folder.path()
    }

    /// The bench of a pump of the rack.
    pub(crate) fn bench(&self, name: &str) -> Bench {
        let (_, pump) = PUMPS.iter().find(|(known, _)| *known == name).unwrap();
        Bench::new(built_in(pump).unwrap(), None, self.path()).unwrap()
    }

    /// The recorded state of a pump of the rack. `None` if it has no record.
    pub(crate) fn state(&self, name: &str) -> Option<PumpState> {
        self.bench(name).story().unwrap().state
    }

    /// The rack of these steps with the three pumps.
    pub(crate) fn rack(&self, steps: &str) -> Result<Rack, RackError> {
        self.rack_of(steps, |_, file| file)
    }

    /// The rack of these steps, whose pump files `changed` changes.
    pub(crate) fn rack_of(
        &self,
        steps: &str,
        changed: impl Fn(&str, PumpFile) -> PumpFile,
    ) -> Result<Rack, RackError> {
        let file = RackFile::parse(&format!("{HEAD}{steps}"), Path::new("mix.toml"))?;
        let bench = |(name, pump): (&str, &str)| {
            Bench::new(changed(name, built_in(pump).unwrap()), None, self.path()).unwrap()
        };
        let benches = PUMPS.map(bench).into();
        Ok(Rack::new(file, benches)?.paced(Pace::Fast))
    }

    /// True if no pump has moved.
    pub(crate) fn is_untouched(&self) -> bool {
        let pumped_ml = |name| self.state(name).map_or(0.0, |state: PumpState| state.wear.volume_ml);
        PUMPS.iter().all(|(name, _)| pumped_ml(name) == 0.0)
    }
}

/// Simulated drive that panics after so many steps.
#[derive(Debug)]
pub(crate) struct Panicking(pub(crate) u64);

impl Drive for Panicking {
    fn id(&self) -> &str {
        "panicking"
    }

    fn is_simulated(&self) -> bool {
        true
    }

    fn run(&mut self, plan: &Plan, gate: &mut Gate<'_>) -> Result<u64, DriveFault> {
        let failed = Failing { after: self.0, unsure: 0 }.run(plan, gate);
        panic!("an error of the program: {failed:?}");
    }
}

/// Simulated drive that fails after so many steps, of which it knows all but the last ones.
#[derive(Debug, Default)]
pub(crate) struct Failing {
    pub(crate) after: u64,
    pub(crate) unsure: i64,
}

impl Drive for Failing {
    fn id(&self) -> &str {
        "failing"
    }

    fn is_simulated(&self) -> bool {
        true
    }

    fn run(&mut self, plan: &Plan, gate: &mut Gate<'_>) -> Result<u64, DriveFault> {
        let mut made = 0;
        for step in plan.each_step() {
            if made == self.after {
                let error = DriveError::device(std::io::Error::from(std::io::ErrorKind::BrokenPipe));
                return Err(DriveFault::between(made as i64 - self.unsure, made as i64, error));
            }
            loop {
                match gate(made, step.number) {
                    Leave::Go => break,
                    Leave::Wait => {}
                    Leave::Stop => return Ok(made),
                }
            }
            made = step.number;
        }
        Ok(made)
    }
}
