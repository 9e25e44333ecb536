//! Which Python exception an error of the Rust crates becomes. The message stays.

use pump_ctl::plan::PlanError as CtlPlanError;
use pump_dose::pump_file::PumpFileError as DosePumpFileError;
use pump_model::ModelError;
use pump_model::integrator::IntegrationError;
use pyo3::PyErr;
use pyo3::exceptions::{PyOSError, PyValueError};
use pyo3::import_exception;

import_exception!(pumpmodel.errors, PlanError);
import_exception!(pumpmodel.errors, PumpError);
import_exception!(pumpmodel.errors, PumpFileError);

/// A bad argument.
pub(crate) fn value(error: impl std::fmt::Display) -> PyErr {
    PyValueError::new_err(error.to_string())
}

/// What the model refuses is a bad argument, but for an integration that fails on the way.
pub(crate) fn model(error: ModelError) -> PyErr {
    match error {
        ModelError::Integration(error) => integration(error),
        ModelError::NeverSettles { .. } | ModelError::NotPeriodic { .. } => {
            PumpError::new_err(error.to_string())
        }
        _ => value(error),
    }
}

pub(crate) fn integration(error: IntegrationError) -> PyErr {
    match error {
        IntegrationError::Tolerance { .. } => value(error),
        _ => PumpError::new_err(error.to_string()),
    }
}

/// A dose of good arguments that cannot be done is a `PlanError`.
pub(crate) fn plan(error: CtlPlanError) -> PyErr {
    match error {
        CtlPlanError::OutOfRange { .. } => value(error),
        CtlPlanError::Model(error) => model(error),
        _ => PlanError::new_err(error.to_string()),
    }
}

/// A file that the system cannot open is its `OSError`; one that can be read but not used a `PumpFileError`.
pub(crate) fn pump_file(error: DosePumpFileError) -> PyErr {
    match &error {
        DosePumpFileError::Read { path, source } => match source.raw_os_error() {
            // With three arguments OSError chooses its subclass, as FileNotFoundError.
            Some(number) => {
                let text = source.to_string();
                let text = text.strip_suffix(&format!(" (os error {number})")).unwrap_or(&text).to_owned();
                PyOSError::new_err((number, text, path.clone().into_os_string()))
            }
            None => PumpFileError::new_err(error.to_string()),
        },
        _ => PumpFileError::new_err(error.to_string()),
    }
}
