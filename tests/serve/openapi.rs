//! The description of the service for programs, against what it answers.

use serde_json::{Value, json};

use crate::laboratory::Laboratory;

/// Returns the places at which a value is not what its schema says.
fn faults(at: &str, value: &Value, schema: &Value, api: &Value) -> Vec<String> {
    if let Some(name) = schema["$ref"].as_str() {
        let name = name.strip_prefix("#/components/schemas/").unwrap();
        return faults(at, value, &api["components"]["schemas"][name], api);
    }
    if let Some(choices) = schema["oneOf"].as_array() {
        let found: Vec<Vec<String>> = choices.iter().map(|choice| faults(at, value, choice, api)).collect();
        return if found.iter().any(Vec::is_empty) { Vec::new() } else { found.concat() };
    }
    let is_of = |kind: &str| match kind {
        "string" => value.is_string(),
        "number" => value.is_number(),
        "integer" => value.is_i64() || value.is_u64(),
        "boolean" => value.is_boolean(),
        "object" => value.is_object(),
        "array" => value.is_array(),
        "null" => value.is_null(),
        other => panic!("{at}: the schema has the type {other}"),
    };
    let kinds: Vec<&str> = match &schema["type"] {
        Value::String(kind) => vec![kind],
        Value::Array(kinds) => kinds.iter().map(|kind| kind.as_str().unwrap()).collect(),
        _ => Vec::new(),
    };
    let is_one = schema["enum"].as_array().is_none_or(|words| words.contains(value));
    let is_it = schema.get("const").is_none_or(|word| word == value);
    if !(kinds.is_empty() || kinds.into_iter().any(is_of)) || !is_one || !is_it {
        return vec![format!("{at} is {value}, and its schema is {schema}")];
    }
    let mut found = Vec::new();
    if let (Some(values), Some(known)) = (value.as_object(), schema["properties"].as_object()) {
        for (key, value) in values {
            match known.get(key) {
                Some(schema) => found.extend(faults(&format!("{at}.{key}"), value, schema, api)),
                None => found.push(format!("{at}.{key} is not described")),
            }
        }
        let required = schema["required"].as_array().into_iter().flatten();
        let missing = required.filter(|key| !values.contains_key(key.as_str().unwrap()));
        found.extend(missing.map(|key| format!("{at}.{key} is missing")));
    }
    for (index, value) in value.as_array().into_iter().flatten().enumerate() {
        found.extend(faults(&format!("{at}.{index}"), value, &schema["items"], api));
    }
    found
}

/// Returns the schema of an answer.
fn schema<'a>(api: &'a Value, method: &str, path: &str, status: u16) -> &'a Value {
    let response = &api["paths"][path][method]["responses"][status.to_string()];
    &response["content"]["application/json"]["schema"]
}

#[test]
fn answers_are_what_their_schemas_say() {
    let laboratory = Laboratory::new(&["acid"], "[[service.input]]\nname = \"leak\"\nsilent = \"10min\"\n");
    let service = laboratory.serve(&["--pace", "fast"]);
    let api = service.get("/openapi.json").1;
    let id = service.dose("acid", "2mL", &json!({"retract": "0.1mL", "rate": "2mL/s"}));
    service.ended(&id);
    let of_name = "/api/v1/pumps/{name}";
    let dose = format!("{of_name}/dose");
    let told = [
        ("get", "/api/v1/pumps", service.get("/api/v1/pumps")),
        ("get", of_name, service.get("/api/v1/pumps/acid")),
        ("get", of_name, service.get("/api/v1/pumps/nobody")),
        ("get", "/api/v1/orders", service.get("/api/v1/orders")),
        ("get", "/api/v1/orders/{id}", service.get(&format!("/api/v1/orders/{id}"))),
        ("get", "/api/v1/doses/{id}", service.get(&format!("/api/v1/doses/{id}"))),
        ("get", "/api/v1/inputs", service.get("/api/v1/inputs")),
        ("post", &dose, service.post("/api/v1/pumps/acid/dose", &json!({"volume": "5"}))),
        ("post", &dose, service.post("/api/v1/pumps/acid/dose", &json!({"volume": "1mL"}))),
    ];
    for (method, path, (status, answer)) in told {
        let schema = schema(&api, method, path, status);
        assert!(schema.is_object(), "{method} {path} {status} has no schema");
        let mut found = faults(path, &answer, schema, &api);
        // The task's own texts stand beside the keys of an order.
        found.retain(|fault| !fault.contains(".volume is not described"));
        assert!(found.is_empty(), "{method} {path} {status}: {found:#?}");
    }
}

#[test]
fn the_token_and_every_refusal_of_an_order_are_described() {
    let laboratory = Laboratory::new(&["acid"], "");
    let service = laboratory.serve(&["--pace", "fast"]);
    let api = service.get("/openapi.json").1;
    assert_eq!(api["components"]["securitySchemes"]["token"]["scheme"], "bearer");
    let of_clear = api["components"]["schemas"]["ClearBody"]["required"].as_array().unwrap();
    assert!(of_clear.contains(&json!("by")), "{of_clear:?}");
    let of_dose = schema(&api, "get", "/api/v1/doses/{id}", 200);
    let either = ["Dose", "DoseBounds"].map(|name| json!({"$ref": format!("#/components/schemas/{name}")}));
    assert_eq!(of_dose, &json!({"oneOf": either}));
    assert!(api["security"].as_array().unwrap().contains(&json!({"token": []})), "{}", api["security"]);
    for word in [
        "dose",
        "prime",
        "purge",
        "run",
        "resume",
        "accept",
        "clear",
        "stand",
        "emptied",
        "calibrate",
        "calibrate/use",
    ] {
        let path = format!("/api/v1/pumps/{{name}}/{word}");
        for status in [400, 401, 403, 404, 409, 413, 415, 421, 422, 423, 503] {
            let error = schema(&api, "post", &path, status);
            assert_eq!(error["$ref"], "#/components/schemas/Error", "{path} {status}");
        }
        assert_eq!(schema(&api, "post", &path, 202)["$ref"], "#/components/schemas/Order", "{path}");
    }
}
