//! The connection to the broker, which is made again whenever it is lost.

use std::mem;
use std::time::Duration;

use rumqttc::v5::mqttbytes::v5::ConnectReturnCode;
use rumqttc::v5::{AsyncClient, ConnectionError, Event, EventLoop, Incoming};
use tokio::sync::watch::{self, Receiver, Sender};
use tokio::task::JoinHandle;
use tokio::time::{Instant, sleep, timeout};

use super::hearer::{Hearer, Retained};
use super::settings::Settings;
use super::teller::Teller;
use crate::guard::Guard;
use crate::service::Service;

/// Shortest and longest time from a lost connection to the next try.
const SHORTEST: Duration = Duration::from_millis(250);
const LONGEST: Duration = Duration::from_secs(30);

/// Time after which a connection has held, so that the next one is tried soon.
const HELD: Duration = Duration::from_secs(10);

/// Messages that wait for the connection.
const WAITING: usize = 64;

/// Longest time that the goodbye to the broker takes.
const LONGEST_END: Duration = Duration::from_secs(3);

/// Link to a broker. It tries for ever; while there is no broker, the pumps go on.
#[derive(Debug)]
pub struct Link {
    end: Sender<bool>,
    task: JoinHandle<()>,
}

impl Link {
    /// Begins to talk to the broker, and to hear the inputs of the guard there.
    pub fn begin(service: Service, guard: Guard, settings: Settings) -> Self {
        let (end, ended) = watch::channel(false);
        let task = tokio::spawn(async move { run(&service, &guard, &settings, ended).await });
        Self { end, task }
    }

    /// Tells the broker that the service ends, and waits 3 s at most.
    pub async fn end(mut self) {
        self.end.send_replace(true);
        if timeout(LONGEST_END, &mut self.task).await.is_err() {
            // The broker does not answer; it tells the last will once it misses the service.
            self.task.abort();
        }
    }
}

/// End of a connection.
enum Over {
    /// The service ends.
    Ended,
    /// The connection was lost, or none was made.
    Lost { reason: String, lasted: Duration },
}

async fn run(service: &Service, guard: &Guard, settings: &Settings, mut end: Receiver<bool>) {
    let mut retained = Retained::new();
    let mut is_away = false;
    let mut wait = SHORTEST;
    loop {
        let Over::Lost { reason, lasted } =
            connection(service, guard, settings, &mut retained, &mut is_away, &mut end).await
        else {
            return;
        };
        if !is_away {
            is_away = true;
            let text = format!(
                "the MQTT broker {} is away: {reason}; the pumps go on, and it is tried again for ever",
                settings.address()
            );
            service.note("mqtt", None, &text);
        }
        guard.miss_topics(&format!("the MQTT broker {} was away", settings.address()));
        if lasted >= HELD {
            wait = SHORTEST;
        }
        tokio::select! {
            _ = end.wait_for(|ends| *ends) => return,
            () = sleep(wait) => wait = (2 * wait).min(LONGEST),
        }
    }
}

/// Makes one connection, with nothing left of those before it.
async fn connection(
    service: &Service,
    guard: &Guard,
    settings: &Settings,
    retained: &mut Retained,
    is_away: &mut bool,
    end: &mut Receiver<bool>,
) -> Over {
    let (client, mut events) = AsyncClient::new(settings.options(), WAITING);
    let connected = tokio::select! {
        _ = end.wait_for(|ends| *ends) => return Over::Ended,
        connected = connect(&mut events) => connected,
    };
    if let Err(error) = connected {
        return Over::Lost { reason: words(&error), lasted: Duration::ZERO };
    }
    let begun = Instant::now();
    let watch = service.watch();
    if mem::take(is_away) {
        service.note("mqtt", None, &format!("the MQTT broker {} is back", settings.address()));
    }
    let lost = |reason| Over::Lost { reason, lasted: begun.elapsed() };
    let teller = Teller::new(service, guard, settings, client.clone());
    let mut hearer = Hearer::new(service, guard, &settings.topics, client, retained);
    let hearing = hear(&mut events, &mut hearer);
    tokio::pin!(hearing);
    let ended = async { drop(end.wait_for(|ends| *ends).await) };
    tokio::select! {
        error = &mut hearing => lost(words(&error)),
        told = teller.tell(watch, ended) => match told {
            Ok(()) => {
                // The broker ends the connection once it has read everything.
                let _ = timeout(LONGEST_END, hearing).await;
                Over::Ended
            }
            Err(error) => lost(error.to_string()),
        },
    }
}

async fn connect(events: &mut EventLoop) -> Result<(), ConnectionError> {
    while !matches!(events.poll().await?, Event::Incoming(Incoming::ConnAck(_))) {}
    Ok(())
}

/// Hears messages until the connection is lost.
async fn hear(events: &mut EventLoop, hearer: &mut Hearer<'_>) -> ConnectionError {
    loop {
        match events.poll().await {
            Ok(event) => hearer.take(event).await,
            Err(error) => {
                // Messages that came with the end were acknowledged, so they are carried out now or never.
                for event in mem::take(&mut events.state.events) {
                    hearer.take(event).await;
                }
                return error;
            }
        }
    }
}

/// Says why there is no connection.
fn words(error: &ConnectionError) -> String {
    match error {
        ConnectionError::ConnectionRefused(
            ConnectReturnCode::BadUserNamePassword | ConnectReturnCode::NotAuthorized,
        ) => "it refuses the user or the password; see user and password_file in [service.mqtt]".to_owned(),
        error => error.to_string(),
    }
}
