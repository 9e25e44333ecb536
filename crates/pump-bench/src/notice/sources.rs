//! The text of an error with its sources.

use std::error::Error;

/// Text of an error that names a device's own error as its source and adds nothing to it.
pub(crate) const DEVICE_FAILED: &str = "the device refused or failed";

/// Returns the text of an error and of all its sources, from the outermost to the cause. Between others, an error that
/// only says that the device failed is left out: its source says how.
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
        source = cause.source();
        let told = cause.to_string();
        if told != DEVICE_FAILED || source.is_none() {
            text += &format!(": {told}");
        }
    }
    text
}
