//! What Home Assistant reads of the pumps: one device a pump.

use serde_json::{Value, json};

use super::asked::PRESS;
use super::settings::{OFFLINE, ONLINE};
use super::topics::{STOP, Topics};
use super::view::{PROBLEMS, STATES};
use crate::service::Pump;

/// Largest volume of the number, mL. The pump's own limits are those of the command.
const MOST_ML: f64 = 100_000.0;

/// Returns the topics and documents of a pump.
pub(super) fn documents(prefix: &str, topics: &Topics, pump: &Pump) -> Vec<(String, Value)> {
    let name = pump.name();
    let root: String =
        topics.root().chars().map(|c| if c.is_ascii_alphanumeric() || c == '-' { c } else { '_' }).collect();
    let node = format!("{root}_{name}");
    let version = env!("CARGO_PKG_VERSION");
    let device = json!({
        "identifiers": [&node], "name": name, "model": pump.bench().file().pump.name,
        "manufacturer": "pump-dose", "sw_version": version,
    });
    let state = topics.of(name, "state");
    let problems = PROBLEMS.map(|word| format!("'{word}'")).join(", ");
    let number = |value: &str| format!("{{{{ value_json.{value} }}}}");
    // The broker takes what it gets by QoS 2 once: a dose is pressed once.
    let once = 2;
    let entities = [
        (
            "sensor",
            "state",
            json!({"name": "State", "state_topic": state, "value_template": number("state"),
                "device_class": "enum", "options": STATES, "json_attributes_topic": state}),
        ),
        (
            "sensor",
            "delivered",
            json!({"name": "Delivered by the last dose", "state_topic": state,
                "value_template": number("delivered_ml"), "unit_of_measurement": "mL",
                "device_class": "volume", "suggested_display_precision": 2}),
        ),
        (
            "sensor",
            "tube",
            json!({"name": "Pumped by the tube", "state_topic": state, "value_template": number("tube_ml"),
                "unit_of_measurement": "mL", "device_class": "volume", "state_class": "total_increasing",
                "suggested_display_precision": 0, "entity_category": "diagnostic"}),
        ),
        (
            "binary_sensor",
            "problem",
            json!({"name": "Problem", "state_topic": state, "device_class": "problem",
                "value_template": format!("{{{{ 'ON' if value_json.state in [{problems}] else 'OFF' }}}}")}),
        ),
        (
            "number",
            "volume",
            json!({"name": "Volume of a dose", "command_topic": topics.set(name, "volume"),
                "state_topic": topics.of(name, "volume"), "unit_of_measurement": "mL", "min": 0.01,
                "max": MOST_ML, "step": 0.01, "mode": "box", "qos": 1}),
        ),
        (
            "button",
            "dose",
            json!({"name": "Dose", "command_topic": topics.set(name, "dose"), "payload_press": PRESS,
                "qos": once}),
        ),
        (
            "button",
            "stop",
            json!({"name": "Stop", "command_topic": topics.set(name, STOP), "payload_press": PRESS, "qos": 1}),
        ),
    ];
    let common = json!({
        "availability_topic": topics.status(), "payload_available": ONLINE, "payload_not_available": OFFLINE,
        "device": device, "origin": {"name": "pump-dose", "sw_version": version},
    });
    let document = |(component, object, own): (&str, &str, Value)| {
        let mut document = common.clone();
        if let (Some(document), Value::Object(own)) = (document.as_object_mut(), own) {
            document.extend(own);
            document.insert("unique_id".to_owned(), json!(format!("{node}_{object}")));
        }
        (format!("{prefix}/{component}/{node}/{object}/config"), document)
    };
    entities.into_iter().map(document).collect()
}
