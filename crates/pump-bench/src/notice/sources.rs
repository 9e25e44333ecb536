//! The text of an error with its sources.

use std::error::Error;

/// Text of an error that a device's own error is the source of, and that adds nothing to it.
pub(crate) const DEVICE_FAILED: &str = "the device refused or failed";

/// Text of an error that a refusal of this program is the source of, and that adds nothing to it.
pub(crate) const PROGRAM_REFUSED: &str = "this program refused";

/// Returns the text of an error and of all its sources, from the outermost to the cause. An error that only says that
/// a device failed, or that this program refused, is left out: its source says how.
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
    let (mut texts, mut next) = (Vec::new(), Some(error));
    while let Some(error) = next {
        next = error.source();
        let text = error.to_string();
        if next.is_none() || ![DEVICE_FAILED, PROGRAM_REFUSED].contains(&text.as_str()) {
            texts.push(text);
        }
    }
    texts.join(": ")
}
