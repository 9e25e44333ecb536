//! Python exceptions for the errors of the Rust crates. The messages stay.

use std::error::Error;
use std::io;
use std::path::Path;

use pump_bench::DoseError;
use pump_bench::balance::BalanceError as DoseBalanceError;
use pump_bench::calibration::CalibrationError;
use pump_bench::config::ConfigError;
use pump_bench::displacement::DisplacementError;
use pump_bench::pump_file::PumpFileError as DosePumpFileError;
use pump_bench::record::FolderError;
use pump_ctl::plan::PlanError as CtlPlanError;
use pump_model::ModelError;
use pump_model::integrator::IntegrationError;
use pyo3::exceptions::{PyMemoryError, PyOSError, PyValueError};
use pyo3::import_exception;
use pyo3::prelude::*;

use super::advice;
use super::readable::readable;

import_exception!(pumpmodel.errors, BalanceError);
import_exception!(pumpmodel.errors, DriveError);
import_exception!(pumpmodel.errors, PlanError);
import_exception!(pumpmodel.errors, PumpError);
import_exception!(pumpmodel.errors, PumpFileError);
import_exception!(pumpmodel.errors, SafetyError);
import_exception!(pumpmodel.errors, StoppedError);
import_exception!(pumpmodel.errors, UnfinishedError);

/// Returns the `ValueError` of a bad argument.
pub(crate) fn value(error: impl std::fmt::Display) -> PyErr {
    PyValueError::new_err(readable(&error.to_string()))
}

/// Puts the place that raised an exception before its message.
pub(crate) fn within(place: impl std::fmt::Display, error: PyErr) -> PyErr {
    Python::attach(|py| PyErr::from_type(error.get_type(py), format!("{place}: {}", error.value(py))))
}

/// Maps an error of the model: a bad argument is a `ValueError`, an integration that fails on the way a `PumpError`.
pub(crate) fn model(error: ModelError) -> PyErr {
    match error {
        ModelError::Integration(error) => integration(error),
        ModelError::NeverSettles { .. } | ModelError::NotPeriodic { .. } => {
            PumpError::new_err(error.to_string())
        }
        _ => value(error),
    }
}

/// Maps an error of the integrator: a tolerance out of range is a `ValueError`, a failure on the way a `PumpError`.
pub(crate) fn integration(error: IntegrationError) -> PyErr {
    match error {
        IntegrationError::Tolerance { .. } => value(error),
        _ => PumpError::new_err(error.to_string()),
    }
}

/// Maps an error of a plan: good arguments that no plan meets are a `PlanError`.
pub(crate) fn plan(error: CtlPlanError) -> PyErr {
    match error {
        CtlPlanError::OutOfRange { .. } => value(error),
        CtlPlanError::Model(error) => model(error),
        _ => PlanError::new_err(error.to_string()),
    }
}

/// Maps an error of a pump file: an unreadable file is an `OSError`, an unusable one a `PumpFileError`.
pub(crate) fn pump_file(error: DosePumpFileError) -> PyErr {
    match &error {
        DosePumpFileError::Read { path, source }
            if source.raw_os_error().is_some() || lacks_memory(source) =>
        {
            file(path, source)
        }
        _ => PumpFileError::new_err(advice::told(&error)),
    }
}

/// Maps an error of the configuration: an unreadable file is an `OSError`, an unusable one a `PumpFileError`.
pub(crate) fn config(error: ConfigError) -> PyErr {
    match error {
        ConfigError::Pump(error) => pump_file(error),
        ConfigError::Read { path, source } if source.raw_os_error().is_some() => file(&path, &source),
        error => PumpFileError::new_err(advice::told(&error)),
    }
}

/// Returns the `OSError` of a file, in the subclass that fits its number.
pub(crate) fn file(path: &Path, error: &io::Error) -> PyErr {
    let text = error.to_string();
    if lacks_memory(error) {
        return PyMemoryError::new_err(format!("{}: {text}", path.display()));
    }
    match error.raw_os_error() {
        // With three arguments OSError chooses its subclass, as FileNotFoundError.
        Some(number) => {
            let text = text.strip_suffix(&format!(" (os error {number})")).unwrap_or(&text).to_owned();
            PyOSError::new_err((number, text, path.as_os_str().to_owned()))
        }
        None => PyOSError::new_err(format!("{}: {text}", path.display())),
    }
}

/// Maps an error of a calibration: impossible readings are a `ValueError`, a dose outside its range a `PlanError`.
pub(crate) fn calibration(error: CalibrationError) -> PyErr {
    match &error {
        CalibrationError::File { path, source, .. } => file(path, source),
        CalibrationError::Damaged { .. } => PumpError::new_err(advice::told(&error)),
        CalibrationError::NoSpeed { .. }
        | CalibrationError::OutsideSpeeds { .. }
        | CalibrationError::OtherPump { .. } => PlanError::new_err(advice::told(&error)),
        CalibrationError::Model(error) => model(*error),
        _ => value(advice::told(&error)),
    }
}

/// Maps an error of a displacement against speed: a speed or flow outside its range is a `ValueError`.
pub(crate) fn displacement(error: DisplacementError) -> PyErr {
    match error {
        DisplacementError::Model(error) => model(error),
        _ => value(error),
    }
}

/// Maps an error of a balance.
pub(crate) fn balance(error: &DoseBalanceError) -> PyErr {
    BalanceError::new_err(advice::told(error))
}

/// Maps an error of a bench. A failing motor, and a pump or device in use, are a `DriveError`.
pub(crate) fn dose(py: Python<'_>, error: DoseError) -> PyErr {
    let numbers = numbers(&error);
    let raised = class(error);
    for (name, number) in numbers {
        // An exception takes any attribute.
        let _ = raised.value(py).setattr(name, number);
    }
    raised
}

/// Returns the attributes of an exception.
fn numbers(error: &DoseError) -> Vec<(&'static str, f64)> {
    let bounds = |least_ml, most_ml| vec![("delivered_least_ml", least_ml), ("delivered_most_ml", most_ml)];
    match error {
        DoseError::NoRest { requested_ml, least_ml, most_ml }
        | DoseError::Unfinished { requested_ml, least_ml, most_ml } => {
            let mut known = bounds(*least_ml, *most_ml);
            known.push(("requested_ml", *requested_ml));
            known
        }
        DoseError::UnfinishedRun { least_ml, most_ml }
        | DoseError::NoRestOfProfile { least_ml, most_ml }
        | DoseError::Drive { least_ml, most_ml, .. } => bounds(*least_ml, *most_ml),
        DoseError::ByWeight { turned_ml, weighed_g, .. } => {
            let mut known = vec![("turned_ml", *turned_ml)];
            known.extend(weighed_g.map(|mass_g| ("weighed_g", mass_g)));
            known
        }
        DoseError::Stands { stand, .. } => {
            vec![
                ("used_ml", stand.used_ml),
                ("planned_ml", stand.planned_ml),
                ("allowed_ml", stand.allowed_ml),
            ]
        }
        DoseError::RanOut { delivered_ml, .. } => bounds(*delivered_ml, *delivered_ml),
        _ => Vec::new(),
    }
}

/// Returns true if a call of the system found no memory on the way to an error.
fn lacks_memory(error: &(dyn Error + 'static)) -> bool {
    let mut source = Some(error);
    while let Some(error) = source {
        let io = error.downcast_ref::<io::Error>();
        if io.is_some_and(|error| error.kind() == io::ErrorKind::OutOfMemory) {
            return true;
        }
        source = error.source();
    }
    false
}

/// Returns the exception without its attributes.
fn class(error: DoseError) -> PyErr {
    let message = advice::told(&error);
    if lacks_memory(&error) {
        return PyMemoryError::new_err(message);
    }
    match error {
        DoseError::PumpFile(error) => pump_file(error),
        DoseError::Plan(error) => plan(error),
        DoseError::RestWithoutAngle(_) => PlanError::new_err(message),
        DoseError::Calibration(error) => calibration(error),
        DoseError::Displacement(DisplacementError::Model(error)) => model(error),
        DoseError::NoRest { .. }
        | DoseError::Unfinished { .. }
        | DoseError::UnfinishedRun { .. }
        | DoseError::BeyondRequest { .. }
        | DoseError::AngleIsKnown
        | DoseError::NoRestOfProfile { .. }
        | DoseError::NoRestByWeight(_) => UnfinishedError::new_err(message),
        DoseError::Balance(_) | DoseError::ByWeight { .. } => BalanceError::new_err(message),
        DoseError::Stands { .. } => SafetyError::new_err(message),
        DoseError::NotCleared { .. } | DoseError::NotPutToStand { .. } | DoseError::Profile(_) => {
            value(message)
        }
        DoseError::Drive { .. }
        | DoseError::Folder(FolderError::Busy { .. })
        | DoseError::Connection(_)
        | DoseError::NoIndex { .. }
        | DoseError::Retraction { .. } => DriveError::new_err(message),
        DoseError::SuckBack { source: CtlPlanError::OutOfRange { .. }, .. } => PyValueError::new_err(message),
        DoseError::DeviceSpeed { .. }
        | DoseError::Displacement(_)
        | DoseError::NotByWeight { .. }
        | DoseError::Flow(_)
        | DoseError::SteepFlow { .. }
        | DoseError::NoRun { .. }
        | DoseError::Disturbed { .. }
        | DoseError::TubeWorn { .. }
        | DoseError::SuckBack { .. }
        | DoseError::RunsTheOtherWay { .. }
        | DoseError::TooSlow { .. }
        | DoseError::Stale { .. } => PlanError::new_err(message),
        DoseError::NoAngle { .. } => PumpFileError::new_err(message),
        _ => PumpError::new_err(message),
    }
}
