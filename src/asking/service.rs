//! A running service, as a command asks it.

use std::env;
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::ExitCode;
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

use pump_bench::config::Config;
use serde::Deserialize;
use serde_json::{Value, json};
use ureq::http::Response;
use ureq::{Agent, RequestBuilder};

use crate::commands::serve::secret;
use crate::failure::Failure;
use crate::interrupt::{Interrupt, name};
use crate::progress::MotionBar;
use crate::progress::supervised::Reached;
use crate::terminal::{print, say};

/// Variable with the token of the service at a url.
const TOKEN: &str = "DOSE_SERVICE_TOKEN";

/// Longest time until the service answers that it has begun.
const ANSWERS_WITHIN: Duration = Duration::from_secs(10);

/// Time between two looks for a signal.
const LOOK: Duration = Duration::from_millis(20);

/// A running service, as its file tells, or as a configuration names it.
#[derive(Debug, Deserialize)]
pub(super) struct Service {
    url: String,
    token: Option<String>,
    /// Place of the token of a service at a url, in words.
    #[serde(skip)]
    token_of: String,
}

/// The lines of a command that began, or the `error/1` of one that was refused.
pub(super) type Begun = Result<Response<ureq::Body>, Value>;

/// A line of the service's answer.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Line {
    Order(String),
    Out(String),
    Err(String),
    Progress(Value),
    Code(u8),
}

impl Service {
    /// The service whose file is beside the records in this folder. None if there is no such file.
    pub(super) fn beside(state_dir: &Path) -> Option<Self> {
        serde_json::from_str(&std::fs::read_to_string(state_dir.join("serve.json")).ok()?).ok()
    }

    /// The service at a url of the configuration, with the token of the environment or else of the file.
    pub(super) fn at(url: &str, config: &Config) -> Result<Self, Failure> {
        let (token, token_of) = match (env::var(TOKEN), &config.service().token_file) {
            (Ok(token), _) => (Some(token), format!("of the variable {TOKEN}")),
            (Err(_), Some(path)) => {
                (Some(secret::read("token", path)?), format!("of the file {}", path.display()))
            }
            (Err(_), None) => (None, String::new()),
        };
        Ok(Self { url: url.to_owned(), token, token_of })
    }

    fn agent() -> Agent {
        let config = Agent::config_builder().http_status_as_error(false).proxy(None);
        config
            .timeout_recv_response(Some(ANSWERS_WITHIN))
            .timeout_connect(Some(ANSWERS_WITHIN))
            .build()
            .into()
    }

    fn post(&self, path: &str, body: &Value) -> Result<Response<ureq::Body>, ureq::Error> {
        let request = self.bearing(Self::agent().post(format!("{}{path}", self.url)));
        request.header("content-type", "application/json").send(body.to_string())
    }

    /// Begins the command of a body. Returns none if no service answers, or if it does not have the pump.
    pub(super) fn begin(&self, path: &str, body: &Value) -> Option<Begun> {
        let mut answer = match self.post(path, body) {
            Ok(answer) => answer,
            // A file that an earlier service left behind names nobody who answers.
            Err(error) if is_nobody(&error) => return None,
            Err(error) => return Some(Err(self.unsettled(&error))),
        };
        match answer.status().as_u16() {
            200 => Some(Ok(answer)),
            404 => None,
            _ => Some(Err(error_of(&mut answer).unwrap_or_default())),
        }
    }

    /// Begins an order, as a command that is told by lines. Each refusal names the url: a person chose it.
    pub(super) fn order(&self, body: &Value) -> Begun {
        self.ask("/api/v1/command/order", body, "move the pump from here", |error| self.unsettled(error))
    }

    /// Asks for the status of pumps, as a command that is told by lines.
    pub(super) fn status(&self, body: &Value) -> Begun {
        let url = &self.url;
        let unsettled = |error: &ureq::Error| {
            refused(format!(
                "the service at {url} does not answer: {error}; try again, or read the record of this computer with \
                 --no-service"
            ))
        };
        self.ask("/api/v1/command/status", body, "read the record of this computer", unsettled)
    }

    /// Returns true if the service answers now.
    pub(super) fn answers(&self) -> bool {
        Self::agent().get(format!("{}/login", self.url)).call().is_ok()
    }

    /// Warns of a schedule whose file is refused. A service that does not say so is no reason to tell nothing else.
    pub(super) fn warn_of_schedule(&self) {
        let request = self.bearing(Self::agent().get(format!("{}/api/v1/schedule", self.url)));
        let told = request.call().ok().and_then(|mut answer| answer.body_mut().read_to_string().ok());
        let told: Option<Value> = told.and_then(|text| serde_json::from_str(&text).ok());
        if let Some(error) = told.as_ref().and_then(|told| told.get("error")?.as_str()) {
            say(&format!("warning: {error}\n"));
        }
    }

    /// Returns the request with the token.
    fn bearing<B>(&self, request: RequestBuilder<B>) -> RequestBuilder<B> {
        let bearer = self.token.iter().map(|token| format!("Bearer {token}"));
        bearer.fold(request, |request, bearer| request.header("authorization", bearer))
    }

    fn ask(
        &self,
        path: &str,
        body: &Value,
        here: &str,
        unsettled: impl FnOnce(&ureq::Error) -> Value,
    ) -> Begun {
        let url = &self.url;
        let mut answer = match self.post(path, body) {
            Ok(answer) => answer,
            Err(error) if is_nobody(&error) || matches!(error, ureq::Error::HostNotFound) => {
                return Err(refused(format!(
                    "no service answers at {url}, the `url` of [service] in the configuration: {error}; nothing has \
                     moved; start the service, correct the url, or {here} with --no-service"
                )));
            }
            Err(error) => return Err(unsettled(&error)),
        };
        let status = answer.status().as_u16();
        let mut error = match (status, error_of(&mut answer)) {
            (200, None) => return Ok(answer),
            (401, Some(_)) => return Err(refused(self.of_token())),
            (_, Some(error)) => error,
            (_, None) => {
                return Err(refused(format!(
                    "no `dose serve` of this version answers at {url}, the `url` of [service] in the configuration: \
                     its answer has the status {status}; nothing has moved; correct the url, or {here} with \
                     --no-service"
                )));
            }
        };
        let message = error.get("message").and_then(Value::as_str).unwrap_or_default();
        let message = format!("{message} (the service at {url} says so)");
        error["message"] = message.into();
        Err(error)
    }

    /// The words of a service that needs a token, or refused the one that it was given.
    fn of_token(&self) -> String {
        let Self { url, token, token_of } = self;
        let way = format!("name a file that has it with `token_file` in [service], or put it into {TOKEN}");
        match token {
            None => format!("the service at {url} needs its token; {way}"),
            Some(_) => format!(
                "the service at {url} has refused the token {token_of}: the service has another one, the first line of \
                 the `token_file` of its own configuration; nothing has moved; {way}"
            ),
        }
    }

    /// The error of a request whose fate nobody knows.
    fn unsettled(&self, error: &ureq::Error) -> Value {
        let message = format!(
            "the service at {} does not answer, and may have begun the command: {error}; see `dose status`, or move \
             the pump from here with --no-service",
            self.url
        );
        error_of_service(1, message, true)
    }

    /// Passes on what the command says until its end. A signal stops it as it would stop one carried out here.
    /// A refusal is JSON if a program reads it.
    pub(super) fn follow(&self, answer: Begun, json: bool) -> ExitCode {
        let answer = match answer {
            Ok(answer) => answer,
            Err(error) => {
                let text = error.get("message").and_then(Value::as_str).unwrap_or("the service refused it");
                say(&if json { format!("{error}\n") } else { format!("error: {text}\n") });
                let code = error.get("code").and_then(Value::as_u64).and_then(|code| u8::try_from(code).ok());
                return ExitCode::from(code.unwrap_or(2));
            }
        };
        let interrupt = Interrupt::watch().ok();
        let lines = lines(answer);
        let (mut order, mut bar, mut whole_s, mut stopped) = (None, None, None, false);
        loop {
            let line = lines.recv_timeout(LOOK);
            let signal = interrupt.as_ref().and_then(Interrupt::signal);
            if let (Some(signal), Some(order), false) = (signal, &order, stopped) {
                stopped = self
                    .post(&format!("/api/v1/orders/{order}/stop"), &json!({"reason": name(signal)}))
                    .is_ok();
            }
            match line {
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => {
                    say(
                        "error: the service ended before the command did; `dose status` says what is on record\n",
                    );
                    return ExitCode::from(1);
                }
                Ok(Line::Order(id)) => order = Some(id),
                Ok(Line::Progress(progress)) => show(&mut bar, &mut whole_s, &progress),
                Ok(said) => {
                    if let Some(bar) = bar.take() {
                        MotionBar::end(&bar);
                    }
                    match said {
                        Line::Out(text) => drop(print(&format!("{text}\n"))),
                        Line::Err(text) => say(&format!("{text}\n")),
                        Line::Code(code) => return ExitCode::from(code),
                        Line::Order(_) | Line::Progress(_) => {}
                    }
                }
            }
        }
    }
}

/// The `error/1` of an answer that is one; none of the lines of a command.
fn error_of(answer: &mut Response<ureq::Body>) -> Option<Value> {
    if answer.status().as_u16() == 200 {
        return None;
    }
    let error: Value = serde_json::from_str(&answer.body_mut().read_to_string().ok()?).ok()?;
    (error.get("schema")? == "error/1").then_some(error)
}

/// The `error/1` of a request that nobody carries out: nothing has moved.
fn refused(message: String) -> Value {
    error_of_service(2, message, false)
}

fn error_of_service(code: u8, message: String, moved: bool) -> Value {
    json!({"schema": "error/1", "code": code, "kind": "service", "message": message, "value": null, "allowed": null,
        "moved": moved})
}

/// True if nobody listens at the service's address, so that nothing was asked.
fn is_nobody(error: &ureq::Error) -> bool {
    match error {
        ureq::Error::ConnectionFailed => true,
        ureq::Error::Io(error) => error.kind() == std::io::ErrorKind::ConnectionRefused,
        _ => false,
    }
}

/// The lines of an answer, as they come.
fn lines(answer: Response<ureq::Body>) -> Receiver<Line> {
    let (give, take) = channel();
    thread::spawn(move || {
        for line in BufReader::new(answer.into_body().into_reader()).lines() {
            let Some(line) = line.ok().and_then(|line| serde_json::from_str(&line).ok()) else { return };
            if give.send(line).is_err() {
                return;
            }
        }
    });
    take
}

/// Shows a line of progress as the bar of a motion. `whole_s` is the time of the present one, which its plan has told.
fn show(bar: &mut Option<MotionBar>, whole_s: &mut Option<f64>, progress: &Value) {
    if let Some(plan) = progress.get("plan") {
        *whole_s = plan.get("motion_s").and_then(Value::as_f64);
        return;
    }
    let number = |key: &str| progress.get(key).and_then(Value::as_f64);
    let (Some(steps), Some(of_steps), Some(delivered_ml)) =
        (number("steps"), number("of_steps"), number("delivered_ml"))
    else {
        return;
    };
    let of_ml = number("of_ml");
    // A run until it is stopped has no end that a plan could tell.
    let whole_s = whole_s.filter(|_| of_ml.is_some());
    let of_ml = of_ml.unwrap_or(f64::INFINITY);
    let bar = bar.get_or_insert_with(|| MotionBar::new("", of_steps as u64, of_ml, whole_s, false));
    bar.made(steps as u64, || Reached { delivered_ml, angle_rad: 0.0 });
    let _ = std::io::stderr().flush();
}
