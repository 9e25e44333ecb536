//! Fuzzes the reader of quantities: every text is a finite number or is refused with a message.
#![no_main]

use libfuzzer_sys::fuzz_target;
use pump_bench::units;

fuzz_target!(|text: &str| {
    let plain = [
        units::volume_ml(text),
        units::flow_ml_s(text),
        units::speed_rad_s(text),
        units::time_s(text),
        units::angle_rad(text),
        units::stated_angle(text).map(|stated| stated.angle_rad),
        units::tolerance_rad(text),
    ];
    for read in plain {
        match read {
            Ok(number) => assert!(number.is_finite(), "{text:?} is {number}"),
            Err(error) => assert!(!error.to_string().is_empty()),
        }
    }
    if let Ok(amount) = units::amount(text) {
        let volume_ml = amount.volume_ml(997.0);
        assert!(volume_ml.is_finite() && volume_ml != 0.0, "{text:?} is {amount:?}");
    }
    if let Ok(pressure) = units::pressure(text) {
        assert!(pressure.absolute_kpa(101.325).is_finite(), "{text:?} is {pressure:?}");
    }
});
