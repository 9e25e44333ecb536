//! A rack: its pumps with their benches, and the steps that they run.

use super::clock::SharedStop;
use super::error::RackError;
use super::member::Member;
use super::rack_file::RackFile;
use super::sharing;
use super::step::RackStep;
use crate::bench::Bench;
use crate::drives::StopRequest;
use crate::pump_file::Pace;
use crate::record::{ShortText, Unfinished};

/// Rack of pumps that one process moves.
#[derive(Debug, Clone)]
pub struct Rack {
    name: String,
    members: Vec<Member>,
    steps: Vec<RackStep>,
    pub(super) pace: Pace,
    pub(super) stop: StopRequest,
    /// True if nobody watches, so that each pump obeys the `home` of its safety limits.
    pub(super) unattended: bool,
}

impl Rack {
    /// Makes the rack of a file, with a bench for each of its pumps in the order of [`RackFile::pump_files`].
    ///
    /// # Errors
    ///
    /// [`RackError::Shared`] if two pumps are one, or are axes of one board that does not move them
    /// as the steps say.
    pub fn new(file: RackFile, benches: Vec<Bench>) -> Result<Self, RackError> {
        let members = file.pump_names().map(str::to_owned).zip(benches);
        // The clock of the rack is that of all its pumps.
        let in_step = |bench: Bench| if bench.is_simulated() { bench.paced(Some(Pace::Fast)) } else { bench };
        let members = members.map(|(name, bench)| Member { name, bench: in_step(bench) });
        let members = sharing::beside_each_other(members.collect());
        let (name, steps) = (file.name(), file.steps().to_vec());
        sharing::check(&members, &steps)?;
        Ok(Self { name, members, steps, pace: Pace::Real, stop: StopRequest::default(), unattended: false })
    }

    /// Returns the rack with the pace of its simulated motors, in place of real time. Motors that take no time keep
    /// step with each other.
    #[must_use]
    pub fn paced(self, pace: Pace) -> Self {
        Self { pace, ..self }
    }

    /// Returns the rack with a request of the user to stop. It stops every pump.
    #[must_use]
    pub fn stopping_on(self, stop: StopRequest) -> Self {
        Self { stop, ..self }
    }

    /// Returns the rack with or without a person who watches. Without one, each pump obeys `[safety] home`.
    #[must_use]
    pub fn unattended(self, unattended: bool) -> Self {
        Self { unattended, ..self }
    }

    /// Returns the name of the rack.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Returns the pumps.
    pub fn members(&self) -> &[Member] {
        &self.members
    }

    /// Returns the steps.
    pub fn steps(&self) -> &[RackStep] {
        &self.steps
    }

    /// Returns true if no motor moves.
    pub fn is_simulated(&self) -> bool {
        self.members.iter().all(|member| member.bench.is_simulated())
    }

    /// Returns the numbers of the pumps of a step.
    pub(super) fn pumps_of(&self, step: usize) -> Vec<usize> {
        self.steps.get(step).map(|step| step.flows.iter().map(|flow| flow.pump).collect()).unwrap_or_default()
    }

    /// Refuses to make the rest of an interrupted share by itself: its motor has not moved, and a pump that was to
    /// begin with it has no unfinished share. The ratio of the step would be lost without a word.
    ///
    /// # Errors
    ///
    /// [`RackError::Alone`] with the first such share. [`RackError::Dose`] if a record cannot be read.
    pub fn check_rests(&self) -> Result<(), RackError> {
        let mut shares = Vec::new();
        for (pump, member) in self.members.iter().enumerate() {
            let story = member.bench.story().map_err(|error| self.dose_error(pump, None, error))?;
            let dose = story.state.and_then(|state| state.unfinished);
            let is_of_rack = |dose: &Unfinished| {
                dose.intent.told.and_then(|told| told.rack) == Some(ShortText::new(&self.name))
            };
            shares.push(dose.filter(is_of_rack));
        }
        for (pump, share) in shares.iter().enumerate() {
            let Some(dose) = share.filter(|dose| dose.made_least == 0 && dose.made_most == 0) else {
                continue;
            };
            let asked = dose.intent.told.and_then(|told| told.asked);
            let is_step = |step: &&RackStep| {
                step.flows.iter().any(|flow| flow.pump == pump && Some(flow.asked) == asked)
            };
            let Some(step) = self.steps.iter().find(is_step) else { continue };
            let missing = step.flows.iter().filter(|flow| shares[flow.pump].is_none());
            let others: Vec<String> = missing.map(|flow| self.members[flow.pump].name.clone()).collect();
            if !others.is_empty() {
                return Err(RackError::Alone { pump: self.members[pump].name.clone(), others });
            }
        }
        Ok(())
    }

    /// Returns the benches of a run. Their waits hear the stop of all.
    pub(super) fn benches(&self, stop: &SharedStop) -> Vec<Bench> {
        let members = self.members.iter().enumerate();
        members.map(|(pump, member)| member.bench.clone().stopping_on(stop.request(pump))).collect()
    }
}
