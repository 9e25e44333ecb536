//! The sources of errors: an error that wraps another hands it on.

use std::error::Error;
use std::io;

use pump_bench::DoseError;
use pump_bench::calibration::CalibrationError;
use pump_bench::config::ConfigError;
use pump_bench::displacement::DisplacementError;
use pump_bench::drives::{DriveError, DriveFault, SteppedError};
use pump_bench::pump_file::{FluidError, PumpFileError};
use pump_bench::record::{FolderError, JournalError};
use pump_bench::report::{Explain, Remedy, with_sources};
use pump_ctl::plan::PlanError;
use pump_ctl::step::BrakeError;
use pump_model::identification::IdentificationError;
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
    DriveError::device(io::Error::from(io::ErrorKind::TimedOut))
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
    assert!(has::<io::Error>(&DriveError::device(gone())));
    assert!(has::<DriveError>(&DriveFault::at(3, stalled())));
    let unrecorded = DoseError::NotJournalled { delivered_ml: 1.0, source: unwritten() };
    assert!(has::<JournalError>(&unrecorded));
    assert!(has::<Box<DoseError>>(&DoseError::Retraction {
        delivered_ml: 1.0,
        source: Box::new(unrecorded)
    }));
    let ended = DoseError::Drive {
        error: stalled(),
        least_ml: 0.0,
        most_ml: 1.0,
        unfinished: true,
        over_time: false,
    };
    assert!(has::<DriveError>(&ended));
}

#[test]
fn a_fault_of_a_flow_over_time_promises_no_rest() {
    let remedies = |over_time| {
        DoseError::Drive { error: stalled(), least_ml: 0.0, most_ml: 1.0, unfinished: true, over_time }
            .remedies()
    };
    assert_eq!(remedies(true).last(), Some(&Remedy::Accept));
    assert_eq!(remedies(false).last(), Some(&Remedy::SeeStatusThenFinish));
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

/// Every error that this test can make of those that have a source, and some that stand for another.
fn with_causes() -> Vec<Box<dyn Error>> {
    let origin = || "pump.toml".to_owned();
    let file = || CalibrationError::File { action: "read", path: "1.json".into(), source: gone() };
    let folder = || FolderError::File { action: "make", path: "state".into(), source: gone() };
    let drive =
        |error| DoseError::Drive { error, least_ml: 0.0, most_ml: 1.0, unfinished: true, over_time: false };
    let retraction = |source| DoseError::Retraction { delivered_ml: 1.0, source: Box::new(source) };
    let pump_file = || PumpFileError::Read { path: "pump.toml".into(), source: gone() };
    let displacement = || DisplacementError::Model(WRONG);
    vec![
        Box::new(ModelError::from(IntegrationError::StepUnderflow { time_s: 1.0 })),
        Box::new(PlanError::from(WRONG)),
        Box::new(displacement()),
        Box::new(IdentificationError::from(WRONG)),
        Box::new(FluidError::from(WRONG)),
        Box::new(SteppedError::from(BrakeError::Empty)),
        Box::new(pump_file()),
        Box::new(ConfigError::Read { path: "config.toml".into(), source: gone() }),
        Box::new(ConfigError::from(pump_file())),
        Box::new(PumpFileError::Model { origin: origin(), source: WRONG }),
        Box::new(PumpFileError::Limits { origin: origin(), source: WRONG.into() }),
        Box::new(PumpFileError::Displacement { origin: origin(), source: displacement() }),
        Box::new(unwritten()),
        Box::new(folder()),
        Box::new(file()),
        Box::new(CalibrationError::from(WRONG)),
        Box::new(stalled()),
        Box::new(DriveError::device(gone())),
        Box::new(DriveError::device(unwritten())),
        Box::new(DriveFault::at(3, stalled())),
        #[cfg(feature = "grbl")]
        Box::new(DriveError::from(pump_bench::drives::GrblError::Gone(gone().into()))),
        #[cfg(feature = "node")]
        Box::new(DriveError::from(pump_bench::drives::NodeError::Gone(gone()))),
        Box::new(DoseError::from(pump_file())),
        Box::new(DoseError::from(PlanError::from(WRONG))),
        Box::new(DoseError::from(folder())),
        Box::new(DoseError::from(unwritten())),
        Box::new(DoseError::from(file())),
        Box::new(DoseError::from(displacement())),
        Box::new(DoseError::Connection(stalled())),
        Box::new(DoseError::SuckBack { volume_ml: 1.0, source: WRONG.into() }),
        Box::new(DoseError::NotJournalled { delivered_ml: 1.0, source: unwritten() }),
        Box::new(DoseError::NotRecorded { delivered_ml: 1.0, end_angle_deg: 3.0, source: unwritten() }),
        Box::new(DoseError::AngleNotRecorded { angle_deg: None, source: unwritten() }),
        Box::new(drive(stalled())),
        Box::new(drive(DriveError::device(unwritten()))),
        Box::new(retraction(drive(stalled()))),
        Box::new(retraction(DoseError::NotJournalled { delivered_ml: 1.0, source: unwritten() })),
    ]
}

#[test]
fn a_printer_that_walks_the_chain_prints_nothing_twice() {
    for error in with_causes() {
        let mut texts = vec![error.to_string()];
        let mut at = error.source();
        while let Some(source) = at {
            texts.push(source.to_string());
            at = source.source();
        }
        let all = texts.join(": ");
        // Ours leaves out what only says that a cause follows.
        assert_eq!(with_sources(error.as_ref()), all.replace("the device refused or failed: ", ""));
        for text in &texts {
            assert!(!text.is_empty() && all.matches(text.as_str()).count() == 1, "`{text}` twice in: {all}");
        }
    }
}

#[test]
fn the_chain_tells_the_cause() {
    let cause = gone().to_string();
    let failed = DoseError::Retraction {
        delivered_ml: 1.0,
        source: Box::new(DoseError::NotJournalled { delivered_ml: 1.0, source: unwritten() }),
    };
    assert_eq!(
        with_sources(&failed),
        format!(
            "1.0000 mL were delivered and are on record, but the retraction failed: the dose was stopped after 1.0000 \
             mL because its progress could not be recorded: cannot write journal.jsonl: {cause}"
        )
    );
}
