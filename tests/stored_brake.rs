//! A brake that is stored is checked when it is read: a brake that does not stop is none.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use pump_ctl::plan::Motor;
use pump_ctl::step::{BRAKE_ENTRIES, Brake, TickRate};
use serde_json::{Value, json};

const MOTOR: Motor = Motor::new(12_800.0, 17.8, 500.0);

fn stored() -> Value {
    serde_json::to_value(MOTOR.brake(TickRate::from_hz(1_000_000).unwrap()).unwrap()).unwrap()
}

/// Returns the refusal of the stored brake with this change.
fn refused(change: impl FnOnce(&mut Value)) -> String {
    let mut stored = stored();
    change(&mut stored);
    serde_json::from_value::<Brake>(stored).unwrap_err().to_string()
}

#[test]
fn a_stored_brake_is_read_as_it_was() {
    let brake: Brake = serde_json::from_value(stored()).unwrap();
    assert_eq!(brake, MOTOR.brake(TickRate::from_hz(1_000_000).unwrap()).unwrap());
    assert_eq!(stored()["tick_rate"], json!(1_000_000));
}

#[test]
fn a_stored_brake_that_would_stop_dead_is_refused() {
    let zero = json!({ "count": 0, "interval": 0, "add": 0, "frac": 0 });
    let empty = refused(|stored| stored["climb"] = json!(vec![zero.clone(); BRAKE_ENTRIES]));
    assert!(empty.contains("a brake of no segments would stop a motor dead"), "{empty}");
    let gap = refused(|stored| stored["climb"][3] = zero);
    assert!(gap.contains("segment 4 of the brake"), "{gap}");
    let slower = refused(|stored| stored["climb"][2]["interval"] = json!(1_000_000));
    assert!(slower.contains("never slow down"), "{slower}");
    let timer = refused(|stored| stored["tick_rate"] = json!(0));
    assert!(timer.contains("nonzero"), "{timer}");
}
