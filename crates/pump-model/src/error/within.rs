//! Check that refuses a value outside its range.

use super::allowed::Allowed;
use super::model::ModelError;
use super::parameter::Parameter;

/// Refuses a value that is not allowed, with the parameter that it belongs to.
pub(crate) fn within(
    parameter: Parameter,
    value: f64,
    allowed: impl Into<Allowed>,
) -> Result<(), ModelError> {
    let allowed = allowed.into();
    if allowed.admits(value) { Ok(()) } else { Err(refused(parameter, value, allowed)) }
}

/// Returns the error for a value that is not allowed.
pub(crate) fn refused(parameter: Parameter, value: f64, allowed: impl Into<Allowed>) -> ModelError {
    ModelError::OutOfRange { parameter, value, allowed: allowed.into() }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use std::string::ToString;

    use super::*;

    #[test]
    fn a_refused_value_is_named_with_what_is_allowed() {
        let error = within(Parameter::LineResistance, -1.0, 0.0..=1e6).unwrap_err();
        assert_eq!(error.to_string(), "line resistance in kPa s/mL is -1; allowed: 0 to 1e6");
        assert_eq!(within(Parameter::LineResistance, 1e6, 0.0..=1e6), Ok(()));
    }
}
