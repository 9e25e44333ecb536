//! Fuzzes the reader of pump files: a text is refused with a message or describes a pump, and that pump
//! stays itself when it is written and read again.
#![no_main]

use libfuzzer_sys::fuzz_target;
use pump_bench::pump_file::PumpFile;

fuzz_target!(|text: &str| {
    let Ok(file) = PumpFile::parse(text, "fuzz") else { return };
    let again = PumpFile::parse(&file.to_toml(), "again").expect("what was accepted is accepted again");
    assert_eq!(file, again);
    let pump = file.model().expect("it was checked");
    assert!(pump.revolution_ml() > 0.0 && pump.revolution_ml().is_finite());
    assert!(file.limits().validate().is_ok());
});
