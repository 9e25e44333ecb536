//! Fuzzes the reader of journals: every text is read or refused, and its statements about rotor and dose
//! agree. The lines get right checksums and numbers here, since chance does not find them.
#![no_main]

use libfuzzer_sys::fuzz_target;
use pump_bench::record::PhaseSource;
use pump_bench::record::{PumpState, Story};
use pump_ctl::plan::Phase;
use pump_model::Pump;

fuzz_target!(|text: &str| {
    let lines = text.lines().map(|entry| {
        let crc32 = crc32fast::hash(entry.as_bytes());
        format!("{{\"crc32\":\"{crc32:08x}\",\"entry\":{entry}}}\n")
    });
    let first: String = lines.collect();
    let lines = text.lines().enumerate().map(|(number, entry)| {
        let crc32 = crc32fast::hash(format!("{number} {entry}").as_bytes());
        format!("{{\"crc32\":\"{crc32:08x}\",\"number\":{number},\"entry\":{entry}}}\n")
    });
    let second: String = lines.collect();
    let pump = Pump::three_roller();
    let fresh = PumpState::fresh(Phase::known(0.0), PhaseSource::Home);
    for bytes in [first.as_bytes(), second.as_bytes(), text.as_bytes()] {
        let Ok(story) = Story::from_bytes(bytes, &pump, fresh) else { continue };
        let Some(state) = story.state else { continue };
        if let Some(dose) = state.unfinished {
            assert!(dose.made_least <= dose.made_most);
            let (least_ml, most_ml) = dose.delivered_ml(&pump);
            assert!(least_ml <= most_ml || least_ml.is_nan(), "{least_ml} {most_ml}");
        }
    }
});
