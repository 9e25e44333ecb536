//! The messages of the service to the broker: whether it is there, states, progress and notes.

use std::collections::BTreeMap;
use std::time::Duration;

use rumqttc::v5::mqttbytes::QoS;
use rumqttc::v5::mqttbytes::v5::Filter;
use rumqttc::v5::{AsyncClient, ClientError};
use serde_json::Value;
use tokio::sync::broadcast::Receiver;
use tokio::sync::broadcast::error::{RecvError, TryRecvError};
use tokio::time::Instant;

use super::discovery::documents;
use super::kept::kept;
use super::settings::{OFFLINE, ONLINE, Settings};
use super::view::{State, word_of_progress};
use crate::guard::Guard;
use crate::service::{Event, Service};

/// Time from one message of progress of a pump to its next.
const APART: Duration = Duration::from_millis(500);

/// Teller of one connection.
pub(super) struct Teller<'a> {
    service: &'a Service,
    guard: &'a Guard,
    settings: &'a Settings,
    client: AsyncClient,
    /// State of each pump as it was told last, and the word of its motion.
    told: BTreeMap<String, (String, Option<&'static str>)>,
    /// Time of each pump's last progress.
    progressed: BTreeMap<String, Instant>,
}

impl<'a> Teller<'a> {
    /// A teller that has told nothing yet.
    pub(super) fn new(
        service: &'a Service,
        guard: &'a Guard,
        settings: &'a Settings,
        client: AsyncClient,
    ) -> Self {
        let (told, progressed) = (BTreeMap::new(), BTreeMap::new());
        Self { service, guard, settings, client, told, progressed }
    }

    /// Tells everything, and then what happens, until `end`. Says goodbye then.
    pub(super) async fn tell(
        mut self,
        mut watch: Receiver<Event>,
        end: impl Future<Output = ()>,
    ) -> Result<(), ClientError> {
        self.begin().await?;
        tokio::pin!(end);
        loop {
            tokio::select! {
                () = &mut end => break,
                event = watch.recv() => match event {
                    Ok(event) => self.take(&event).await?,
                    Err(RecvError::Lagged(_)) => self.states().await?,
                    Err(RecvError::Closed) => break,
                },
            }
        }
        // The pumps that the end of the service has stopped are told too.
        loop {
            match watch.try_recv() {
                Ok(event) => self.take(&event).await?,
                Err(TryRecvError::Lagged(_)) => self.states().await?,
                Err(TryRecvError::Empty | TryRecvError::Closed) => break,
            }
        }
        self.states().await?;
        self.keep(self.settings.topics.status(), OFFLINE).await?;
        self.client.disconnect().await
    }

    /// Hears commands and inputs, and tells Home Assistant and everybody that the service is there.
    async fn begin(&mut self) -> Result<(), ClientError> {
        let filters = self.settings.topics.filters().map(|path| Filter {
            // A command that is sent with the retain flag has it from the first time on.
            preserve_retain: true,
            ..Filter::new(path, QoS::AtLeastOnce)
        });
        // An input's message has the retain flag only where the broker has kept it from before.
        let inputs = self.guard.topics().into_iter().map(|topic| Filter::new(topic, QoS::AtLeastOnce));
        self.client.subscribe_many(filters.into_iter().chain(inputs)).await?;
        let (service, settings) = (self.service, self.settings);
        if let Some(prefix) = &settings.discovery {
            for (topic, document) in
                service.pumps().flat_map(|pump| documents(prefix, &settings.topics, pump))
            {
                self.keep(topic, document.to_string()).await?;
            }
        }
        for pump in service.pumps() {
            match kept(service.history(), pump.name()) {
                Ok(Some(volume)) => self.keep(settings.topics.of(pump.name(), "volume"), volume).await?,
                Ok(None) => {}
                Err(error) => service.note("mqtt", Some(pump.name()), &error.to_string()),
            }
        }
        self.states().await?;
        // Orders that the end of the service before has cut off are noted while nobody hears yet.
        match service.history().last_events(1) {
            Ok(newest) => {
                for event in newest {
                    self.keep(settings.topics.notes(), Event::new("note", &event).data.to_string()).await?;
                }
            }
            Err(error) => service.note("mqtt", None, &error.to_string()),
        }
        self.keep(settings.topics.status(), ONLINE).await
    }

    /// Tells the state of every pump.
    async fn states(&mut self) -> Result<(), ClientError> {
        let service = self.service;
        for pump in service.pumps() {
            self.state(pump.name(), None).await?;
        }
        Ok(())
    }

    /// Tells the state of a pump, if it has changed. `motion` is the word of a line of progress.
    async fn state(&mut self, name: &str, motion: Option<&'static str>) -> Result<(), ClientError> {
        let Ok(pump) = self.service.pump(name) else { return Ok(()) };
        let view = self.service.view(pump);
        let text = State::of(&view, motion).text();
        let before = self.told.insert(name.to_owned(), (text.clone(), motion));
        if before.is_some_and(|(before, _)| before == text) {
            return Ok(());
        }
        self.keep(self.settings.topics.of(name, "state"), text).await
    }

    async fn take(&mut self, event: &Event) -> Result<(), ClientError> {
        if event.name == "note" {
            let topic = self.settings.topics.notes();
            return self.keep(topic, event.data.to_string()).await;
        }
        let Ok(value) = serde_json::from_str::<Value>(&event.data) else { return Ok(()) };
        let text = |key: &str| value.get(key).and_then(Value::as_str).unwrap_or_default();
        match event.name {
            "pump" => self.state(text("name"), None).await,
            "progress" => self.progress(text("name"), &value).await,
            "order" => self.state(text("pump"), None).await,
            _ => Ok(()),
        }
    }

    /// Tells how far a motion is, twice a second at most.
    async fn progress(&mut self, name: &str, value: &Value) -> Result<(), ClientError> {
        let word = word_of_progress(value);
        if self.told.get(name).is_none_or(|(_, told)| *told != Some(word)) {
            self.state(name, Some(word)).await?;
        }
        let is_due = self.progressed.get(name).is_none_or(|last| last.elapsed() >= APART);
        // The plan of a motion is long, and the next line comes soon.
        if value.get("plan").is_some() || !is_due || name.is_empty() {
            return Ok(());
        }
        self.progressed.insert(name.to_owned(), Instant::now());
        let topic = self.settings.topics.of(name, "progress");
        self.client.publish(topic, QoS::AtMostOnce, false, value.to_string()).await
    }

    /// Sends a message that the broker keeps.
    async fn keep(&self, topic: String, text: impl Into<String>) -> Result<(), ClientError> {
        self.client.publish(topic, QoS::AtLeastOnce, true, text.into()).await
    }
}
