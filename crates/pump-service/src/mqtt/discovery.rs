//! The documents that Home Assistant reads of the pumps: one device a pump.

use serde_json::{Value, json};

use super::asked::PRESS;
use super::settings::{OFFLINE, ONLINE};
use super::topics::{STOP, Topics};
use super::view::{PROBLEMS, STATES};
use crate::service::Pump;

/// Largest volume of the number, mL. The pump's own limits are those of the command.
const MOST_ML: f64 = 100_000.0;

/// Entity of a device: its component, its own word, and the keys of its document that others have not.
type Entity = (&'static str, &'static str, Value);

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
    let common = json!({
        "availability_topic": topics.status(), "payload_available": ONLINE, "payload_not_available": OFFLINE,
        "device": device, "origin": {"name": "pump-dose", "sw_version": version},
    });
    let document = |(component, object, own): Entity| {
        let mut document = common.clone();
        if let (Some(document), Value::Object(own)) = (document.as_object_mut(), own) {
            document.extend(own);
            document.insert("unique_id".to_owned(), json!(format!("{node}_{object}")));
        }
        (format!("{prefix}/{component}/{node}/{object}/config"), document)
    };
    sensors(topics, name).into_iter().chain(controls(topics, name)).map(document).collect()
}

/// Values that are read of a pump.
fn sensors(topics: &Topics, name: &str) -> [Entity; 5] {
    let state = topics.of(name, "state");
    let value = |key: &str| format!("{{{{ value_json.{key} }}}}");
    let problems = PROBLEMS.map(|word| format!("'{word}'")).join(", ");
    let is_problem = format!("{{{{ 'ON' if value_json.state in [{problems}] else 'OFF' }}}}");
    let told = json!({"name": "State", "state_topic": state, "value_template": value("state"),
        "device_class": "enum", "options": STATES, "json_attributes_topic": state});
    let delivered = json!({"name": "Delivered by the last dose", "state_topic": state,
        "value_template": value("delivered_ml"), "unit_of_measurement": "mL", "device_class": "volume",
        "suggested_display_precision": 2});
    let tube = json!({"name": "Pumped by the tube", "state_topic": state, "value_template": value("tube_ml"),
        "unit_of_measurement": "mL", "device_class": "volume", "state_class": "total_increasing",
        "suggested_display_precision": 0, "entity_category": "diagnostic"});
    let problem = json!({"name": "Problem", "state_topic": state, "device_class": "problem",
        "value_template": is_problem});
    // Home Assistant takes no state of more than 255 letters.
    let reason = json!({"name": "Reason", "state_topic": state, "entity_category": "diagnostic",
        "value_template": "{{ (value_json.reason or value_json.error or '')[:250] }}"});
    [
        ("sensor", "state", told),
        ("sensor", "reason", reason),
        ("sensor", "delivered", delivered),
        ("sensor", "tube", tube),
        ("binary_sensor", "problem", problem),
    ]
}

/// Things that a person may do with a pump. The broker takes what it gets by QoS 2 once, so a dose is pressed once.
fn controls(topics: &Topics, name: &str) -> [Entity; 3] {
    let volume = json!({"name": "Volume of a dose", "command_topic": topics.set(name, "volume"),
        "state_topic": topics.of(name, "volume"), "unit_of_measurement": "mL", "min": 0.01, "max": MOST_ML,
        "step": 0.01, "mode": "box", "qos": 1});
    let dose =
        json!({"name": "Dose", "command_topic": topics.set(name, "dose"), "payload_press": PRESS, "qos": 2});
    let stop =
        json!({"name": "Stop", "command_topic": topics.set(name, STOP), "payload_press": PRESS, "qos": 1});
    [("number", "volume", volume), ("button", "dose", dose), ("button", "stop", stop)]
}
