//! Commands of this user on this machine, which the service carries out in their place.

use std::path::PathBuf;

use axum::body::{Body, Bytes};
use axum::extract::State;
use axum::http::StatusCode;
use axum::http::header::{CONTENT_TYPE, HeaderMap};
use axum::response::{IntoResponse, Response};
use serde::Deserialize;
use serde_json::{Value, json};
use tokio::sync::mpsc::{Sender, channel, unbounded_channel};
use tokio_stream::wrappers::ReceiverStream;

use super::bodies::body;
use super::failure::Failure;
use super::shared::Shared;
use crate::order::{Order, OrderId, Task, option, plain_name, plain_text, switch};
use crate::service::{Refusal, Service};
use crate::worker::{Line, Seat, Worker};

/// Lines that wait for a slow reader.
const WAITING: usize = 64;

/// A command with its words.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct CommandBody {
    /// Name of the pump in the configuration.
    pump: String,
    /// Words after the program's name.
    words: Vec<String>,
    /// Folder of the files that the words name.
    folder: PathBuf,
    /// True if a person sits at the terminal.
    attended: bool,
}

/// An order whose report is that of a typed command.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct OrderBody {
    /// Order; an empty pump is the service's default.
    order: Order,
    /// True if a program reads the report.
    json: bool,
    /// True if the report has every detail.
    verbose: bool,
    /// True if a person sits at the terminal.
    attended: bool,
}

/// A question for the status of a pump, of a rack or of all pumps.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct StatusBody {
    /// Name of the pump in the configuration; empty for its default.
    pump: String,
    /// Name of the rack in the configuration.
    rack: Option<String>,
    all: bool,
    /// Life of the tube in place of the pump file's.
    tube_limit: Option<String>,
    /// True if a program reads the status.
    json: bool,
}

/// Carries out a command of this machine's user. The answer is a line of JSON with the order's name, `{"order": ID}`,
/// then one for each line of its output, `{"out": TEXT}`, `{"err": TEXT}` or `{"progress": {..}}`, and at last
/// `{"code": CODE}`. A reader that goes away stops the command.
pub(super) async fn command(
    State(shared): State<Shared>,
    headers: HeaderMap,
    bytes: Bytes,
) -> Result<Response, Failure> {
    if !shared.access.is_local(&headers) {
        let message = "only commands of this user on this machine may do so; their token is in serve.json";
        return Err(Failure::new(StatusCode::FORBIDDEN, "token", message));
    }
    let CommandBody { pump, words, folder, attended } = body(&bytes)?;
    let seat = Seat { folder: Some(folder), is_attended: attended, ..Seat::default() };
    follow(shared.service, &pump, words, seat)
}

/// Carries out a command of somebody else who may give orders: its options are those of an order. The answer is that of
/// [`command`].
pub(super) async fn order(State(shared): State<Shared>, bytes: Bytes) -> Result<Response, Failure> {
    let OrderBody { mut order, json, verbose, attended } = body(&bytes)?;
    if matches!(order.task, Task::Command { .. }) {
        let message = "a command line is not an order; only this user on this machine may give them";
        return Err(Failure::new(StatusCode::FORBIDDEN, "token", message));
    }
    if !matches!(order.task, Task::Rack { .. }) {
        order.pump = named(order.pump, &shared.service);
        // A pump file is no pump of the service, and the command may use it by itself.
        shared.service.pump(&order.pump)?;
    }
    let mut words = order.words().map_err(Refusal::from)?;
    if !json {
        words.retain(|word| *word != option("format", "json"));
    }
    words.extend(verbose.then(|| switch("verbose")));
    follow(
        shared.service,
        &order.pump,
        words,
        Seat { folder: None, is_attended: attended, ..Seat::default() },
    )
}

/// Tells the status of pumps as the command `dose status` does. The answer is that of [`command`], without an order.
pub(super) async fn status(State(shared): State<Shared>, bytes: Bytes) -> Result<Response, Failure> {
    let StatusBody { pump, rack, all, tube_limit, json } = body(&bytes)?;
    let pump = named(pump, &shared.service);
    let mut words = vec!["status".to_owned()];
    words.push(match rack {
        _ if all => switch("all"),
        Some(rack) => option("rack", plain_name("rack", &rack).map_err(Refusal::from)?),
        None => option("pump", shared.service.pump(&pump)?.name()),
    });
    if let Some(limit) = tube_limit {
        words.push(option("tube-limit", plain_text("tube-limit", &limit).map_err(Refusal::from)?));
    }
    words.extend(json.then(|| option("format", "json")));
    let mut lines = String::new();
    let (_never, stops) = unbounded_channel();
    let worker = Worker::start(shared.service.program(), &words, &Seat::default()).map_err(Refusal::Start)?;
    let mut tell = |line: &Line, text: &str| {
        told(line, text.to_owned()).iter().for_each(|told| lines += &format!("{told}\n"));
    };
    let ended = worker.run(stops, &mut tell).await;
    let code = ended.map_err(Refusal::Start)?.code;
    lines += &format!("{}\n", json!({"code": code}));
    Ok(([(CONTENT_TYPE, "application/x-ndjson")], lines).into_response())
}

/// Returns the name of a pump, or that of the service's default pump for an empty one.
fn named(pump: String, service: &Service) -> String {
    if pump.is_empty() { service.config().default_pump().to_owned() } else { pump }
}

/// Begins a command, and answers with its lines.
fn follow(service: Service, pump: &str, words: Vec<String>, seat: Seat) -> Result<Response, Failure> {
    let (hearer, mut lines) = unbounded_channel();
    let id = service.place_command(pump, words, seat, hearer)?;
    let (give, take) = channel::<Result<String, std::io::Error>>(WAITING);
    tokio::spawn(async move {
        if give.send(Ok(format!("{}\n", json!({"order": id})))).await.is_err() {
            return end(&service, &id, &give).await;
        }
        loop {
            let line = tokio::select! {
                () = give.closed() => break,
                line = lines.recv() => line,
            };
            let Some((line, text)) = line else { break };
            let Some(told) = told(&line, text) else { continue };
            if give.send(Ok(format!("{told}\n"))).await.is_err() {
                break;
            }
        }
        end(&service, &id, &give).await;
    });
    Ok(([(CONTENT_TYPE, "application/x-ndjson")], Body::from_stream(ReceiverStream::new(take)))
        .into_response())
}

/// Tells the exit code, or stops a command whose reader has gone.
async fn end(service: &Service, id: &OrderId, give: &Sender<Result<String, std::io::Error>>) {
    if give.is_closed() {
        service.stop_order(id, "the end of the command that ordered it");
        return;
    }
    let code = service.order(id).ok().flatten().and_then(|record| record.code).unwrap_or(1);
    // A reader that went away at the very end has missed the code alone.
    let _ = give.send(Ok(format!("{}\n", json!({"code": code})))).await;
}

/// A line of the command as the answer tells it. `None` for one whose words are told already.
fn told(line: &Line, text: String) -> Option<Value> {
    Some(match line {
        Line::Progress(value) => json!({"progress": value}),
        Line::Report(_) | Line::Words(_) => json!({"out": text}),
        Line::Message(_) | Line::Error(_) => json!({"err": text}),
        Line::Failed(_) | Line::Ending => return None,
    })
}
