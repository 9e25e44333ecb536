//! The guard of a service: its inputs, and the pumps that are put to stand.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use jiff::Timestamp;
use tokio::sync::Notify;

use super::error::GuardError;
use super::input::{Input, InputView, Word};
use super::said::word_of_message;
use super::stand::{KIND, put_to_stand, tell_of_stand};
use crate::order::OrderId;
use crate::service::{Service, Stillness};
use crate::shell::command;

/// Time between two looks at the clock and at the pumps.
const LOOK: Duration = Duration::from_millis(100);

/// Longest reason of a stop, in letters, as the log keeps it.
const MOST_REASON: usize = 100;

/// Guard of the pumps of a service. A copy is the same guard.
#[derive(Debug, Clone)]
pub struct Guard(Arc<Inner>);

#[derive(Debug)]
struct Inner {
    service: Service,
    watch: Mutex<Watch>,
    wake: Notify,
}

/// Knowledge of the guard.
#[derive(Debug)]
struct Watch {
    inputs: Vec<Input>,
    /// Inputs that are not well, and were told.
    told: BTreeSet<String>,
    /// Pumps that are to stand and do not on record yet.
    pending: BTreeMap<String, Pending>,
    /// Pumps that stand by order while an input of theirs is not well.
    stood: BTreeSet<String>,
}

/// Stand of a pump that is not on record yet.
#[derive(Debug)]
struct Pending {
    reason: String,
    /// True once the pump is being put to stand.
    is_under_way: bool,
    /// Orders that were stopped for it.
    stopped: Vec<OrderId>,
}

impl Watch {
    /// Returns the first input that has a pump stand. `None` if all of its inputs are well.
    fn unwell(&self, pump: &str) -> Option<&Input> {
        self.inputs.iter().find(|input| input.guards(pump) && input.fault().is_some())
    }
}

impl Guard {
    /// The guard of a service by the inputs of its configuration. Each has its time to say for the first time that all
    /// is well.
    pub fn new(service: Service) -> Self {
        let (now, pumps) =
            (Instant::now(), service.pumps().map(|pump| pump.name().to_owned()).collect::<Vec<_>>());
        let tables = &service.config().service().inputs;
        let inputs = tables.iter().map(|table| Input::new(table.clone(), &pumps, now)).collect();
        let (told, pending, stood) = Default::default();
        let watch = Mutex::new(Watch { inputs, told, pending, stood });
        Self(Arc::new(Inner { service, watch, wake: Notify::new() }))
    }

    /// Returns the inputs as they are.
    pub fn inputs(&self) -> Vec<InputView> {
        let now = Instant::now();
        self.watch().inputs.iter().map(|input| input.view(now)).collect()
    }

    /// Tells whether an input is well. Once this returns for one that is not, its pumps are asked to stop, and the
    /// service begins no motion of theirs. A reason without meaning takes nothing away from the word.
    ///
    /// # Errors
    ///
    /// [`GuardError`] if there is no such input, or if its command or its topic speaks for it. Nothing has changed.
    pub fn tell(&self, name: &str, ok: bool, reason: Option<&str>) -> Result<InputView, GuardError> {
        let known = {
            let watch = self.watch();
            match watch.inputs.iter().find(|input| input.name() == name) {
                Some(input) if input.command().is_some() => Err(GuardError::OfCommand(name.to_owned())),
                Some(input) if input.topic().is_some() => Err(GuardError::OfTopic(name.to_owned())),
                Some(_) => Ok(()),
                None => {
                    let names: Vec<&str> = watch.inputs.iter().map(Input::name).collect();
                    let known = if names.is_empty() { "none".to_owned() } else { names.join(", ") };
                    let name = name.chars().take(80).collect();
                    Err(GuardError::UnknownInput { name, known })
                }
            }
        };
        known?;
        self.hear(name, if ok { Word::Well } else { Word::bad(reason.unwrap_or_default()) });
        let view = self.inputs().into_iter().find(|input| input.name == name);
        Ok(view.unwrap_or_else(|| unreachable!("the input {name} was found before")))
    }

    /// Returns the topics of MQTT at which inputs are told.
    pub(crate) fn topics(&self) -> BTreeSet<String> {
        self.watch().inputs.iter().filter_map(Input::topic).map(str::to_owned).collect()
    }

    /// Hears a message at a topic. Returns false if no input is told there.
    pub(crate) fn hear_message(&self, topic: &str, payload: &[u8], is_retained: bool) -> bool {
        let names = self.told_at(|told_at| told_at == topic);
        if let Some(word) = word_of_message(payload, is_retained) {
            names.iter().for_each(|name| self.hear(name, word.clone()));
        }
        !names.is_empty()
    }

    /// Takes the topics for unheard: an input that is told there is silent until its topic is heard again.
    pub(crate) fn miss_topics(&self, why: &str) {
        self.told_at(|_| true).iter().for_each(|name| self.hear(name, Word::Nothing(why.to_owned())));
    }

    /// Returns the names of the inputs that are told at such a topic.
    fn told_at(&self, is_it: impl Fn(&str) -> bool) -> Vec<String> {
        let watch = self.watch();
        let told = watch.inputs.iter().filter(|input| input.topic().is_some_and(&is_it));
        told.map(|input| input.name().to_owned()).collect()
    }

    /// Runs the commands of the inputs, watches the clock, and puts pumps to stand, until the service ends.
    pub async fn run(&self) {
        let commands: Vec<(String, String, Duration)> = {
            let watch = self.watch();
            let of = |input: &Input| {
                let (command, every) = input.command()?;
                Some((input.name().to_owned(), command.to_owned(), every))
            };
            watch.inputs.iter().filter_map(of).collect()
        };
        for (name, command, every) in commands {
            tokio::spawn(self.clone().listen(name, command, every));
        }
        while !self.0.service.is_ending() {
            self.check();
            for (pump, reason) in self.to_stand() {
                tokio::spawn(self.clone().stand(pump, reason));
            }
            tokio::select! {
                () = self.0.wake.notified() => {}
                () = tokio::time::sleep(LOOK) => {}
            }
        }
    }

    /// Runs the command of an input again and again, and hears what it says.
    async fn listen(self, name: String, command: String, every: Duration) {
        while !self.0.service.is_ending() {
            let (command, service) = (command.clone(), self.0.service.clone());
            let ran =
                tokio::task::spawn_blocking(move || command::run(&command, &[], "", || service.is_ending()));
            let word = match ran.await {
                Ok(Ok(ended)) => word_of(&ended),
                Ok(Err(error)) => Word::Nothing(format!("its command could not be run: {error}")),
                Err(error) => Word::Nothing(format!("its command could not be run: {error}")),
            };
            if !self.0.service.is_ending() {
                self.hear(&name, word);
            }
            tokio::time::sleep(every).await;
        }
    }

    /// Takes the word of an input, and does what follows from it.
    fn hear(&self, name: &str, word: Word) {
        let mut watch = self.watch();
        if let Some(input) = watch.inputs.iter_mut().find(|input| input.name() == name) {
            input.hear(word, Instant::now(), Timestamp::now());
        }
        drop(watch);
        self.check();
    }

    /// Looks at the clock and at the pumps. A pump whose input is not well is stopped and kept still, and is put to
    /// stand unless it does so already.
    fn check(&self) {
        let service = &self.0.service;
        let mut watch = self.watch();
        let now = Instant::now();
        watch.inputs.iter_mut().for_each(|input| input.look(now));
        let changed = tell_changes(&mut watch, now);
        let (mut still, mut stops) = (BTreeMap::new(), Vec::new());
        for pump in service.pumps() {
            let (name, unwell) = (pump.name().to_owned(), watch.unwell(pump.name()));
            let (reason, fault) = (unwell.and_then(Input::reason), unwell.and_then(Input::fault));
            let fault = unwell
                .zip(fault)
                .map(|(input, fault)| format!("input {} is not well: {fault}", input.name()));
            match &reason {
                None => drop(watch.stood.remove(&name)),
                Some(_) if watch.pending.contains_key(&name) => {}
                Some(_) if pump.stands_by_order() && !service.is_moving(pump) => {
                    watch.stood.insert(name.clone());
                }
                Some(reason) => {
                    let is_again = watch.stood.contains(&name);
                    let (reason, stopped) = (reason.clone(), Vec::new());
                    watch.pending.insert(
                        name.clone(),
                        Pending { reason: reason.clone(), is_under_way: false, stopped },
                    );
                    stops.push((name.clone(), reason, is_again));
                }
            }
            let pending = watch.pending.get(&name);
            if let Some(why) = reason.as_ref().or(pending.map(|pending| &pending.reason)) {
                let reason = format!("{why}; it stands until the input is well and a person clears it");
                still.insert(name, Stillness { reason, fault, is_pending: pending.is_some() });
            }
        }
        service.keep_still(still);
        drop(watch);
        for (pump, reason, is_again) in &stops {
            let cut: String = reason.chars().take(MOST_REASON).collect();
            let stopped = service.stop(Some(pump), &cut);
            if let Some(pending) = self.watch().pending.get_mut(pump) {
                pending.stopped = stopped;
            }
            if *is_again {
                let text =
                    format!("{pump} was cleared while its input was not well, so it stands again: {reason}");
                service.note(KIND, Some(pump), &text);
            }
        }
        for (view, text) in &changed {
            service.tell("input", view);
            text.iter().for_each(|text| service.note(KIND, None, text));
        }
        if !stops.is_empty() {
            self.0.wake.notify_one();
        }
    }

    /// Returns the pumps that are to be put to stand and are not yet, with the reason. They are under way then.
    fn to_stand(&self) -> Vec<(String, String)> {
        let mut watch = self.watch();
        let waiting = watch.pending.iter_mut().filter(|(_, pending)| !pending.is_under_way);
        waiting
            .map(|(pump, pending)| {
                pending.is_under_way = true;
                (pump.clone(), pending.reason.clone())
            })
            .collect()
    }

    /// Puts a pump to stand, and tells everyone.
    async fn stand(self, name: String, reason: String) {
        let service = &self.0.service;
        let Ok(pump) = service.pump(&name) else { return };
        if !put_to_stand(service, pump, &reason).await {
            return;
        }
        let pending = self.watch().pending.remove(&name);
        let stopped = pending.map_or_else(Vec::new, |pending| pending.stopped);
        service.note(KIND, Some(&name), &format!("{name} stands until a person clears it: {reason}"));
        self.0.wake.notify_one();
        tell_of_stand(service, pump, &reason, &stopped).await;
    }

    fn watch(&self) -> MutexGuard<'_, Watch> {
        self.0.watch.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Returns the inputs that watchers are to be told of, and the words about those that are not well any more, or are
/// well again.
fn tell_changes(watch: &mut Watch, now: Instant) -> Vec<(InputView, Option<String>)> {
    let Watch { inputs, told, .. } = watch;
    let mut changed = Vec::new();
    for input in inputs {
        if !input.is_news(now) {
            continue;
        }
        let (name, view) = (input.name(), input.view(now));
        let text = match &view.reason {
            Some(reason) if told.insert(name.to_owned()) => {
                Some(format!("input {reason}; it stops {}", view.pumps.join(", ")))
            }
            None if told.remove(name) => Some(format!(
                "input {name}: all is well again; each pump that stands waits for a person's clear"
            )),
            _ => None,
        };
        changed.push((view, text));
    }
    changed
}

/// Returns what a command says by its end. One that was ended, by a signal or because it took too long, says nothing:
/// the signal that ends the service may end it too.
fn word_of(ended: &command::Ended) -> Word {
    let code = ended.status.map(|status| (status.success(), status.code()));
    match code {
        None => Word::Nothing(format!("its command took longer than {:?}", command::LONGEST)),
        Some((true, _)) => Word::Well,
        Some((_, Some(code @ 1..=128))) if ended.line.is_empty() => {
            Word::bad(&format!("its command ended with exit code {code}"))
        }
        Some((_, Some(1..=128))) => Word::bad(&ended.line),
        Some((_, Some(code))) if cfg!(windows) => {
            Word::bad(&format!("its command ended with exit code {code}"))
        }
        Some(_) => Word::Nothing("a signal ended its command".to_owned()),
    }
}
