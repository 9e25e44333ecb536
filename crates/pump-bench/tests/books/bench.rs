//! A bench on the simulated drive whose process may be killed at any entry of its journal.

use std::fs;
use std::ops::ControlFlow;

use pump_bench::notice::Notice;
use pump_bench::pump_file::PumpFile;
use pump_bench::record::Unfinished;
use pump_bench::report::Status;
use pump_bench::{Bench, DoseReport, DoseRequest, Prepared, built_in};
use pump_ctl::plan::Phase;
use serde_json::Value;

pub(crate) struct Lab {
    folder: tempfile::TempDir,
    pub(crate) bench: Bench,
}

/// Returns the pump of these tests, whose values count as written by a person.
pub(crate) fn file() -> PumpFile {
    let mut file = built_in("three-roller").unwrap();
    file.motor.confirmed = None;
    file
}

impl Lab {
    pub(crate) fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let bench = Bench::new(file(), None, folder.path()).unwrap();
        Self { folder, bench }
    }

    pub(crate) fn with_file(&self, file: PumpFile) -> Bench {
        Bench::new(file, None, self.folder.path()).unwrap()
    }

    pub(crate) fn home(&self, phase: Option<Phase>) {
        self.bench.set_angle(phase).unwrap();
    }

    pub(crate) fn status(&self) -> Value {
        serde_json::from_str(&Status::of(&self.bench).unwrap().json()).unwrap()
    }

    /// Doses to the end. Returns what was prepared and the JSON of the report.
    pub(crate) fn dose(&self, request: DoseRequest) -> (Prepared, Value) {
        let mut session = self.bench.session().unwrap();
        let prepared = session.prepare(request).unwrap();
        let delivered = session.run(&prepared, |_| ControlFlow::Continue(())).unwrap();
        let report = DoseReport::new(&self.bench, &prepared, Some(&delivered));
        (prepared, serde_json::from_str(&report.json()).unwrap())
    }

    /// Doses and is stopped by its user after `part` of the steps.
    pub(crate) fn stopped(&self, request: DoseRequest, part: f64) -> Prepared {
        let mut session = self.bench.session().unwrap();
        let prepared = session.prepare(request).unwrap();
        stop_at(&mut session, &prepared, part);
        prepared
    }

    /// Doses and is killed after `entries` entries of the progress of the motion that begins last.
    pub(crate) fn killed(&self, request: DoseRequest, entries: usize) -> Prepared {
        let (prepared, _) = self.dose(request);
        self.kill(entries);
        prepared
    }

    /// Resumes with `request` and is killed after `entries` entries of progress.
    pub(crate) fn resumed_and_killed(&self, request: DoseRequest, entries: usize) {
        let mut session = self.bench.session().unwrap();
        let prepared = session.prepare_rest(request).unwrap();
        session.run(&prepared, |_| ControlFlow::Continue(())).unwrap();
        drop(session);
        self.kill(entries);
    }

    /// Plans the rest of the unfinished dose.
    pub(crate) fn rest(&self, request: DoseRequest) -> Prepared {
        self.bench.session().unwrap().prepare_rest(request).unwrap()
    }

    pub(crate) fn unfinished(&self) -> Unfinished {
        self.bench.stands().unwrap().unfinished.unwrap()
    }

    /// Cuts the journal `entries` entries of progress after its last intent.
    fn kill(&self, entries: usize) {
        let path = self.bench.folder().path().join("journal.jsonl");
        let text = fs::read_to_string(&path).unwrap();
        let lines: Vec<&str> = text.split_inclusive('\n').collect();
        let intent = lines.iter().rposition(|line| line.contains("\"intent\"")).unwrap();
        assert!(lines[intent + 1..=intent + entries].iter().all(|line| line.contains("\"progress\"")));
        fs::write(&path, lines[..=intent + entries].concat()).unwrap();
    }
}

/// Runs a prepared dose and stops it after `part` of its steps.
pub(crate) fn stop_at(session: &mut pump_bench::Session<'_>, prepared: &Prepared, part: f64) {
    let last = (part * prepared.plan.steps().unsigned_abs() as f64) as u64;
    let watch = |made| if made >= last { ControlFlow::Break(()) } else { ControlFlow::Continue(()) };
    assert!(!session.run(prepared, watch).unwrap().completed);
}

/// Returns the numbers of a text, in order.
pub(crate) fn numbers(text: &str) -> Vec<f64> {
    let parts = text.split(|c: char| !(c.is_ascii_digit() || c == '.' || c == '-'));
    parts.filter_map(|part| part.trim_end_matches('.').parse().ok()).collect()
}

/// Returns the warning that contains `words`.
pub(crate) fn warning<'a>(prepared: &'a Prepared, words: &str) -> &'a str {
    let found = prepared.warnings.iter().find(|warning| warning.text().contains(words));
    found.map(Notice::text).unwrap_or_else(|| panic!("no `{words}` in {:?}", prepared.warnings))
}
