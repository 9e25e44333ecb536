//! The text of an error with its sources.

use std::error::Error;

/// Returns the text of an error and of all its sources, from the outermost to the cause.
///
/// ```
/// use pump_bench::PumpFile;
/// use pump_bench::report::with_sources;
///
/// let error = PumpFile::read("/no/such/pump.toml".as_ref()).unwrap_err();
/// assert_eq!(error.to_string(), "cannot read pump file /no/such/pump.toml");
/// assert!(with_sources(&error).starts_with("cannot read pump file /no/such/pump.toml: No such file"));
/// ```
pub fn with_sources(error: &dyn Error) -> String {
    let mut text = error.to_string();
    let mut source = error.source();
    while let Some(cause) = source {
        text += &format!(": {cause}");
        source = cause.source();
    }
    text
}
