//! A command that asks the running service to carry it out: several people and programs then see what moves, and can
//! stop it. The service runs the same command with the same words, so reports and exit codes are the same.

use std::env;
use std::fs;
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::ExitCode;
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

use clap::ArgMatches;
use pump_bench::config::Config;
use serde::Deserialize;
use serde_json::{Value, json};
use ureq::Agent;
use ureq::http::Response;

use crate::interrupt::{Interrupt, name};
use crate::progress::MotionBar;
use crate::progress::supervised::Reached;
use crate::terminal::{print, say};

/// Commands that the service carries out; the empty one is a dose.
const ASKED: [&str; 6] = ["", "prime", "purge", "run", "resume", "accept"];

/// Options with which a command is carried out by itself: they say so, move nothing, or name a motor or a balance of
/// their own.
const BY_ITSELF: [&str; 5] = ["no_service", "dry_run", "driver", "port", "until_scale"];

/// Longest time until the service answers that it has begun.
const ANSWERS_WITHIN: Duration = Duration::from_secs(10);

/// Time between two looks for a signal.
const LOOK: Duration = Duration::from_millis(20);

/// A running service, as its file tells.
#[derive(Debug, Deserialize)]
struct Service {
    url: String,
    token: String,
}

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

/// Has the service carry the command out. Returns its exit code, or none if the command is to be carried out by itself:
/// no service runs, it does not have this pump, or the command is not for it.
pub(crate) fn ask(matches: &ArgMatches, words: &[String]) -> Option<ExitCode> {
    if env::var_os("DOSE_SERVICE").is_some_and(|word| word == "off") {
        return None;
    }
    let (mut leaf, mut path) = (matches, Vec::new());
    while let Some((name, inner)) = leaf.subcommand() {
        path.push(name);
        leaf = inner;
    }
    let is_typed = |id: &str| {
        let known = leaf.ids().any(|known| known == id);
        known && leaf.value_source(id) == Some(clap::parser::ValueSource::CommandLine)
    };
    if !ASKED.contains(&path.join(" ").as_str()) || BY_ITSELF.into_iter().any(is_typed) {
        return None;
    }
    let text = |id: &str| leaf.try_get_raw(id).ok().flatten().and_then(|mut values| values.next());
    // A command that cannot find its configuration says so by itself.
    let config = Config::of_user(text("config").map(Path::new)).ok()?;
    let state_dir = text("state_dir").map(Into::into).or_else(|| config.state_dir().ok())?;
    let is_rack = path == ["run"] && text("rack").is_some();
    let pump = text("pump").and_then(|pump| pump.to_str()).unwrap_or(config.default_pump());
    let service: Service =
        serde_json::from_str(&fs::read_to_string(state_dir.join("serve.json")).ok()?).ok()?;
    let answer = service.begin(if is_rack { "" } else { pump }, words)?;
    Some(service.follow(answer))
}

impl Service {
    fn agent() -> Agent {
        let config = Agent::config_builder().http_status_as_error(false).proxy(None);
        config
            .timeout_recv_response(Some(ANSWERS_WITHIN))
            .timeout_connect(Some(ANSWERS_WITHIN))
            .build()
            .into()
    }

    fn post(&self, path: &str, body: &Value) -> Result<Response<ureq::Body>, ureq::Error> {
        let request = Self::agent().post(format!("{}{path}", self.url));
        let request = request.header("authorization", format!("Bearer {}", self.token));
        request.header("content-type", "application/json").send(body.to_string())
    }

    /// Begins the command. Returns none if no service answers, or if it does not have the pump.
    fn begin(&self, pump: &str, words: &[String]) -> Option<Result<Response<ureq::Body>, Value>> {
        let folder = env::current_dir().ok()?;
        let attended = std::io::IsTerminal::is_terminal(&std::io::stdin());
        let body = json!({"pump": pump, "words": words, "folder": folder, "attended": attended});
        let mut answer = match self.post("/api/v1/command", &body) {
            Ok(answer) => answer,
            // A file that an earlier service left behind names nobody who answers.
            Err(error) if is_nobody(&error) => return None,
            Err(error) => {
                let message = format!(
                    "the service at {} does not answer, and may have begun the command: {error}; see `dose status`, \
                     or move the pump from here with --no-service",
                    self.url
                );
                return Some(Err(json!({"message": message, "code": 1})));
            }
        };
        match answer.status().as_u16() {
            200 => Some(Ok(answer)),
            404 => None,
            _ => {
                let error = answer.body_mut().read_to_string().ok();
                Some(Err(error.and_then(|text| serde_json::from_str(&text).ok()).unwrap_or_default()))
            }
        }
    }

    /// Passes on what the command says until its end. A signal stops it as it would stop one carried out here.
    fn follow(&self, answer: Result<Response<ureq::Body>, Value>) -> ExitCode {
        let answer = match answer {
            Ok(answer) => answer,
            Err(error) => {
                let text = error.get("message").and_then(Value::as_str).unwrap_or("the service refused it");
                say(&format!("error: {text}\n"));
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
    let of_ml = number("of_ml").unwrap_or(f64::INFINITY);
    let bar = bar.get_or_insert_with(|| MotionBar::new("", of_steps as u64, of_ml, *whole_s, false));
    bar.made(steps as u64, || Reached { delivered_ml, angle_rad: 0.0 });
    let _ = std::io::stderr().flush();
}
