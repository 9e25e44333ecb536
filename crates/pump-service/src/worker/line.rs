//! One line that a process of the command has told.

use serde_json::Value;

/// Line of a process.
#[derive(Debug, Clone, PartialEq)]
pub enum Line {
    /// Progress of a motion, `progress/1`.
    Progress(Value),
    /// A report, as `dose/1`.
    Report(Value),
    /// Words of a report for people.
    Words(String),
    /// Words beside a report, as a warning.
    Message(String),
    /// The reason of a failure, `error/1`.
    Error(Value),
    /// The reason of a failure, `error/1`, of a command that has told it to a person in words.
    Failed(Value),
    /// The motion is over, and the command tells a person of its failure before it ends.
    Ending,
}

impl Line {
    /// Reads a line of standard output: a report or progress in JSON, or else words.
    pub(super) fn of_output(line: &str) -> Self {
        match object(line) {
            Some(value) if has_schema(&value, "progress/1") && value["state"] == "ending" => Self::Ending,
            Some(mut value) if has_schema(&value, "progress/1") => match value.get_mut("error") {
                Some(error) => Self::Failed(error.take()),
                None => Self::Progress(value),
            },
            Some(value) => Self::Report(value),
            None => Self::Words(line.to_owned()),
        }
    }

    /// Reads a line of standard error: words, or a failure in JSON.
    pub(super) fn of_errors(line: &str) -> Self {
        match object(line) {
            Some(value) if has_schema(&value, "error/1") => Self::Error(said_plainly(value)),
            _ => Self::Message(line.to_owned()),
        }
    }
}

/// Says a refusal of the command line's words without its way to name options: whoever asks over HTTP typed no line.
fn said_plainly(mut error: Value) -> Value {
    let text = |key: &str| error.get(key).and_then(Value::as_str);
    if let Some(plain) =
        text("message").and_then(|message| plain_words(message, text("value")?, text("allowed")))
    {
        error["message"] = plain.into();
    }
    error
}

/// Returns the plain words of a refusal by the parser of the command line; `None` for one that is plain already.
fn plain_words(message: &str, value: &str, allowed: Option<&str>) -> Option<String> {
    if let Some(option) = value.strip_prefix("--")
        && message.starts_with(&format!("unexpected argument '{value}' found"))
    {
        return Some(format!("there is no option `{option}` here; take it out, or correct its spelling"));
    }
    let (place, why) = message.strip_prefix(&format!("invalid value '{value}' for '"))?.split_once('\'')?;
    let option = place.strip_prefix("--").and_then(|option| option.split(' ').next());
    Some(match (option, why.strip_prefix(": ")) {
        (Some(option), Some(why)) => format!("{option}: {why}"),
        (None, Some(why)) => why.to_owned(),
        (option, None) => {
            let allowed = allowed.unwrap_or("other values");
            format!("{} is `{value}`; allowed: {allowed}", option.unwrap_or("it"))
        }
    })
}

fn object(line: &str) -> Option<Value> {
    serde_json::from_str(line).ok().filter(Value::is_object)
}

fn has_schema(value: &Value, schema: &str) -> bool {
    value.get("schema").and_then(Value::as_str) == Some(schema)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message_of(message: &str, value: &str, allowed: Option<&str>) -> String {
        let error =
            serde_json::json!({"schema": "error/1", "message": message, "value": value, "allowed": allowed});
        match Line::of_errors(&error.to_string()) {
            Line::Error(error) => error["message"].as_str().unwrap_or_default().to_owned(),
            other => format!("{other:?}"),
        }
    }

    #[test]
    fn a_refusal_of_the_parser_is_said_without_the_command_lines_words() {
        let no_unit = "`1.02` has no unit; write for example 25g or 25mL";
        let told = [
            (format!("invalid value '1.02' for '[READING]': {no_unit}"), "1.02", None, no_unit),
            (
                "invalid value '3gal' for '--rate <FLOW>': `3gal`: unknown flow unit `gal`".to_owned(),
                "3gal",
                None,
                "rate: `3gal`: unknown flow unit `gal`",
            ),
            (
                "invalid value 'x' for '--finish <any|low-flow>'; [possible values: any, low-flow]"
                    .to_owned(),
                "x",
                Some("any, low-flow"),
                "finish is `x`; allowed: any, low-flow",
            ),
            (
                "unexpected argument '--foo' found; tip: to pass '--foo' as a value, use '-- --foo'"
                    .to_owned(),
                "--foo",
                None,
                "there is no option `foo` here; take it out, or correct its spelling",
            ),
            (
                "invalid value 'a' for 'b': c' for '--rate <FLOW>': why".to_owned(),
                "a' for 'b': c",
                None,
                "rate: why",
            ),
        ];
        for (message, value, allowed, plain) in told {
            assert_eq!(message_of(&message, value, allowed), plain);
        }
    }

    #[test]
    fn a_plain_refusal_stays_as_it_is() {
        let plain = "the pump stands since 2026-03-01: a leak";
        assert_eq!(message_of(plain, "", None), plain);
        let of_another = "invalid value 'a' for '--rate <FLOW>': why";
        assert_eq!(message_of(of_another, "b", None), of_another);
    }
}
