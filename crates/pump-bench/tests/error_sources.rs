//! The sources of errors: an error that wraps another hands it on.

use std::error::Error;
use std::io;

use pump_bench::DoseError;
use pump_bench::calibration::CalibrationError;
use pump_bench::displacement::DisplacementError;
use pump_bench::drives::{DriveError, DriveFault, SteppedError};
use pump_bench::pump_file::PumpFileError;
use pump_bench::record::{FolderError, JournalError};
use pump_ctl::plan::PlanError;
use pump_ctl::step::BrakeError;
use pump_model::{Allowed, IntegrationError, ModelError, Parameter};

const WRONG: ModelError =
    ModelError::OutOfRange { parameter: Parameter::BoreRadius, value: -1.0, allowed: Allowed::Positive };

fn gone() -> io::Error {
    io::Error::from(io::ErrorKind::NotFound)
}

fn unwritten() -> JournalError {
    JournalError::File { action: "write", path: "journal.jsonl".into(), source: gone() }
}

fn stalled() -> DriveError {
    DriveError::from(IntegrationError::StepUnderflow { time_s: 1.0 })
}

/// True if an error has a source of the type `S`.
fn has<S: Error + 'static>(error: &dyn Error) -> bool {
    error.source().is_some_and(|source| source.is::<S>())
}

#[test]
fn an_error_that_wraps_another_has_it_as_its_source() {
    let origin = || "pump.toml".to_owned();
    assert!(has::<io::Error>(&PumpFileError::Read { path: "pump.toml".into(), source: gone() }));
    assert!(has::<ModelError>(&PumpFileError::Model { origin: origin(), source: WRONG }));
    assert!(has::<PlanError>(&PumpFileError::Limits { origin: origin(), source: WRONG.into() }));
    let source = DisplacementError::Model(WRONG);
    assert!(has::<DisplacementError>(&PumpFileError::Displacement { origin: origin(), source }));
    assert!(has::<io::Error>(&unwritten()));
    assert!(has::<io::Error>(&FolderError::File { action: "make", path: "state".into(), source: gone() }));
    assert!(has::<io::Error>(&CalibrationError::File {
        action: "read",
        path: "1.json".into(),
        source: gone()
    }));
    assert!(has::<IntegrationError>(&stalled()));
    assert!(has::<io::Error>(&DriveError::device(gone())));
    assert!(has::<DriveError>(&DriveFault::at(3, stalled())));
    let unrecorded = DoseError::NotJournalled { delivered_ml: 1.0, source: unwritten() };
    assert!(has::<JournalError>(&unrecorded));
    assert!(has::<Box<DoseError>>(&DoseError::Retraction {
        delivered_ml: 1.0,
        source: Box::new(unrecorded)
    }));
    let ended = DoseError::Drive { error: stalled(), least_ml: 0.0, most_ml: 1.0, unfinished: true };
    assert!(has::<DriveError>(&ended));
}

#[test]
fn an_error_that_stands_for_another_has_its_text_and_its_source() {
    let alike = |outer: &dyn Error, inner: &dyn Error| {
        assert_eq!(outer.to_string(), inner.to_string());
        assert_eq!(outer.source().is_some(), inner.source().is_some(), "{outer}");
    };
    alike(
        &ModelError::from(IntegrationError::StepUnderflow { time_s: 1.0 }),
        &IntegrationError::StepUnderflow { time_s: 1.0 },
    );
    alike(&PlanError::from(WRONG), &WRONG);
    alike(&DoseError::from(PlanError::from(WRONG)), &WRONG);
    alike(&DoseError::from(unwritten()), &unwritten());
    alike(&DoseError::Connection(stalled()), &stalled());
    alike(&SteppedError::from(BrakeError::Empty), &BrakeError::Empty);
}
