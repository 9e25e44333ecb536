//! The description of the paths: what is alike at many of them is said once, and put to each here.

use serde_json::{Map, Value, json};

use super::session::SESSION_COOKIE;

/// Schemas of answers by their names.
const SCHEMAS: &str = include_str!("schemas.json");

/// Schemas of answers by the words with which descriptions name them.
const NAMED: [(&str, &str); 6] = [
    ("`order/1`", "Order"),
    ("`dose/1`", "Dose"),
    ("`dose-bounds/1`", "DoseBounds"),
    ("`pump-view/1`", "PumpView"),
    ("`input/1`", "InputView"),
    ("`asked`", "Stopped"),
];

/// Refusals of every path.
const OF_ALL: [(&str, &str); 2] = [
    ("401", "`error/1`: a token or a login is needed"),
    ("503", "`error/1`: the service ends, or has as many connections as it takes"),
];

/// Refusals of every order.
const OF_ORDERS: [(&str, &str); 8] = [
    ("400", "`error/1`: the header `Idempotency-Key` is empty, too long or no plain text"),
    ("403", "`error/1`: a page of another site asks"),
    ("413", "`error/1`: the body has more than 256 kB"),
    ("415", "`error/1`: the header `Content-Type` is not `application/json`"),
    ("421", "`error/1`: the header `Host` is not a name of the service"),
    ("409", "`error/1`: the pump or its board is in use, or a dose is unfinished"),
    ("422", "`error/1`: refused before anything moved, or the key belongs to another order"),
    ("423", "`error/1`: the pump stands, at a safety limit, by order or by the guard"),
];

/// Refusal of every path with a name.
const OF_NAMED: (&str, &str) = ("404", "`error/1`: there is nothing of this name");

/// Completes a description: the token, the schemas of answers, and the refusals that are the same at many paths.
pub(super) fn completed(mut description: Value) -> Value {
    let schemas: Map<String, Value> =
        serde_json::from_str(SCHEMAS).unwrap_or_else(|error| unreachable!("the schemas are JSON: {error}"));
    for (name, schema) in schemas {
        description["components"]["schemas"][name] = schema;
    }
    description["components"]["securitySchemes"] = json!({
        "token": {"type": "http", "scheme": "bearer", "description": "The token of the service's `token_file`"},
        "login": {"type": "apiKey", "in": "cookie", "name": SESSION_COOKIE, "description": "A person at the page"},
    });
    // A service that this machine alone reaches has no token.
    description["security"] = json!([{"token": []}, {"login": []}, {}]);
    let paths = description["paths"].as_object_mut().into_iter().flatten();
    for (path, methods) in paths {
        for (_, operation) in methods.as_object_mut().into_iter().flatten() {
            complete_operation(path, operation);
        }
    }
    description
}

fn complete_operation(path: &str, operation: &mut Value) {
    let Some(responses) = operation["responses"].as_object_mut() else { return };
    let is_order = responses.contains_key("202");
    let of_order = OF_ORDERS.into_iter().filter(|_| is_order);
    let of_named = path.contains('{').then_some(OF_NAMED);
    for (status, text) in OF_ALL.into_iter().chain(of_order).chain(of_named) {
        responses.entry(status).or_insert_with(|| json!({"description": text}));
    }
    for (status, response) in responses {
        let said = response["description"].as_str().unwrap_or_default();
        let mut names: Vec<(usize, &str)> =
            NAMED.into_iter().filter_map(|(word, name)| Some((said.find(word)?, name))).collect();
        names.sort_unstable();
        let schema = match names[..] {
            _ if !status.starts_with('2') => reference("Error"),
            [(_, name), ..] if said.starts_with("A list of") => {
                json!({"type": "array", "items": reference(name)})
            }
            [(_, "Dose"), (_, "DoseBounds"), ..] => {
                json!({"oneOf": [reference("Dose"), reference("DoseBounds")]})
            }
            [(_, name), ..] => reference(name),
            [] => continue,
        };
        response["content"] = json!({"application/json": {"schema": schema}});
    }
}

fn reference(name: &str) -> Value {
    json!({"$ref": format!("#/components/schemas/{name}")})
}
