//! Integration of both ports and the segments between them over a motion.

use crate::circuit::Loss;
use crate::circuit::line_run::TOLERANCES;
use crate::error::{IntegrationError, ModelError};
use crate::integrator::Statistics;
use crate::motion::leg::Leg;
use crate::motion::walk::{Passage, Walk};
use crate::pump::pump::Pump;

use super::chambers::{
    Chambers, INLET_KPA, INLET_ML_S, OUTLET_KPA, OUTLET_ML_S, Plant, PortLine, SEGMENTS, STATES, StateVector,
    pressure_of,
};
use super::contacts::{Contacts, Edges, MAX_SEGMENTS, Way};
use super::parameters::RollerCentric;
use super::solver::{Solver, Step};

/// Pressures, flows and volumes of the pump at one time.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct RollerSample {
    /// Pressure at the inlet, kPa absolute.
    pub inlet_kpa: f64,
    /// Pressure at the outlet, kPa absolute.
    pub outlet_kpa: f64,
    /// Flow from the inlet into the pump, mL/s: the flow of the line less that into its compliance,
    /// Q_L - C dP/dt. The step of the pressure where a segment joins a port has no part in it.
    pub inlet_ml_s: f64,
    /// Flow from the pump into the outlet, mL/s: Q_L + C dP/dt. The step of the pressure where a segment
    /// joins a port has no part in it.
    pub outlet_ml_s: f64,
    /// Volume that has passed the inlet line, mL.
    pub taken_ml: f64,
    /// Volume that has passed the outlet line, mL.
    pub delivered_ml: f64,
}

/// The integration of the roller-centric model over a motion from rest, pulled forward by its user. The
/// motion may also run in reverse.
///
/// Experimental: see [`RollerCentric`].
///
/// ```
/// use pump_model::{DEFAULT_TOLERANCE, Leg, Pump, RollerCentric, RollerRun};
/// let pump = Pump::three_roller();
/// let legs = [Leg::constant_speed(0.0, 10.0)];
/// let mut run = RollerRun::new(&pump, RollerCentric::PUBLISHED, legs, DEFAULT_TOLERANCE)?;
/// assert!(run.at(0.02)?.inlet_kpa < 88.637);
/// assert_eq!(run.segments_kpa().count(), 2);
/// # Ok::<(), pump_model::ModelError>(())
/// ```
#[derive(Debug, Clone)]
pub struct RollerRun<'a, M> {
    pump: &'a Pump,
    plant: Plant,
    edges: Edges,
    walk: Walk<Edges, M>,
    passage: Option<Passage>,
    contacts: Contacts,
    solver: Solver,
    last: Option<Step>,
    /// Volumes that have passed the inlet line and the outlet line before the last step, and after it, mL.
    before_ml: [f64; 2],
    passed_ml: [f64; 2],
}

impl<'a, M: Iterator<Item = Leg>> RollerRun<'a, M> {
    /// Starts when the first of the `legs` starts, with both lines at rest. `tolerance` is that of a step, as
    /// in [`DEFAULT_TOLERANCE`](crate::DEFAULT_TOLERANCE), 1e-13 to 0.1.
    ///
    /// # Errors
    ///
    /// Refuses parameters or a tolerance that are not allowed, more than 13 rollers in contact at once, and a
    /// pump whose zero was [shifted](Pump::shifted).
    pub fn new(
        pump: &'a Pump,
        model: RollerCentric,
        legs: impl IntoIterator<IntoIter = M>,
        tolerance: f64,
    ) -> Result<Self, ModelError> {
        let losses = [pump.inlet(), pump.outlet()].map(Loss::of);
        Self::resisted(pump, model, losses, legs, tolerance)
    }

    /// Starts as [`Self::new`] does, with a resistance of each line, inlet first, in place of R.
    ///
    /// # Errors
    ///
    /// Refuses parameters or a tolerance that are not allowed, more than 13 rollers in contact at once, and a
    /// pump whose zero was [shifted](Pump::shifted).
    pub fn resisted(
        pump: &'a Pump,
        model: RollerCentric,
        [inlet_loss, outlet_loss]: [Loss; 2],
        legs: impl IntoIterator<IntoIter = M>,
        tolerance: f64,
    ) -> Result<Self, ModelError> {
        model.validate(pump)?;
        if !TOLERANCES.contains(&tolerance) {
            return Err(IntegrationError::Tolerance { tolerance }.into());
        }
        let edges = Edges::new(pump, &model)?;
        edges.validate_zero(pump, &model)?;
        let tube_ml_rad = model.scale * pump.nominal_ml_rad();
        let plant = Plant {
            model,
            tube_ml_rad,
            pitch_ml: tube_ml_rad * pump.pitch_rad(),
            inlet: PortLine::new(pump.inlet(), inlet_loss, model.ambient_kpa),
            outlet: PortLine::new(pump.outlet(), outlet_loss, model.ambient_kpa),
        };
        let mut walk = Walk::new(edges, legs);
        let start_s = walk.time_s();
        // A walk never ends before the first passage: after the last leg it rests for ever.
        let passage = walk.next();
        let first = passage.unwrap_or(rest(start_s));
        let contacts = Contacts::of(pump, &model, &edges, edges.pitches_before(&first), first.piece);
        let state = at_rest(&plant, &contacts);
        let segments = (Way::of(pump).contacts() as usize).saturating_sub(1);
        let solver = Solver::new(segments, start_s, &state, [pump.inlet(), pump.outlet()], tolerance)?;
        let (last, before_ml, passed_ml) = (None, [0.0; 2], [0.0; 2]);
        Ok(Self { pump, plant, edges, walk, passage, contacts, solver, last, before_ml, passed_ml })
    }

    /// Makes one step that ends at `stop_s` at the latest. Returns none once that time is reached.
    pub(super) fn step(&mut self, stop_s: f64) -> Result<Option<Step>, IntegrationError> {
        if self.solver.time_s() >= stop_s {
            return Ok(None);
        }
        while self.passage.is_some_and(|passage| self.solver.time_s() >= passage.end_s) {
            self.passage = self.walk.next();
            if let Some(passage) = self.passage {
                self.enter(&passage);
            }
        }
        let Some(passage) = self.passage else {
            return Ok(None);
        };
        let chambers = Chambers {
            plant: &self.plant,
            contacts: &self.contacts,
            leg: passage.leg,
            offset_rad: passage.offset_rad,
        };
        let step = self.solver.step(&chambers, passage.end_s.min(stop_s))?;
        self.last = Some(step);
        self.before_ml = self.passed_ml;
        self.passed_ml = self.passed_ml_at(&step, 1.0);
        Ok(Some(step))
    }

    /// Returns the sample at `t_s`. `t_s` must not lie before the last step taken, and the times of later
    /// calls must not fall.
    ///
    /// # Errors
    ///
    /// Fails if the state is not finite or no step meets the tolerance.
    pub fn at(&mut self, t_s: f64) -> Result<RollerSample, IntegrationError> {
        while (self.last.is_none() || self.solver.time_s() < t_s) && self.step(f64::INFINITY)?.is_some() {}
        let Some(step) = &self.last else {
            return Ok(self.sample(&self.solver.state(), [0.0; 2], self.passed_ml));
        };
        let (start_s, length_s) = (step.start_s(), step.length_s());
        let state = if t_s < start_s + length_s { step.at(t_s) } else { self.solver.state() };
        let x = ((t_s - start_s) / length_s).min(1.0);
        let rates = [INLET_KPA, OUTLET_KPA].map(|port| step.polynomial(port).derivative().at(x) / length_s);
        let passed_ml = if x < 1.0 { self.passed_ml_at(step, x) } else { self.passed_ml };
        Ok(self.sample(&state, rates, passed_ml))
    }

    /// Returns the volumes that have passed the inlet line and the outlet line at a part `x` of the last step, mL.
    fn passed_ml_at(&self, step: &Step, x: f64) -> [f64; 2] {
        let [taken_ml, delivered_ml] = self.before_ml;
        let through = |flow: usize| step.length_s() * step.polynomial(flow).integral_to(x);
        [taken_ml + through(INLET_ML_S), delivered_ml + through(OUTLET_ML_S)]
    }

    fn sample(
        &self,
        state: &StateVector,
        [inlet_kpa_s, outlet_kpa_s]: [f64; 2],
        [taken_ml, delivered_ml]: [f64; 2],
    ) -> RollerSample {
        let Plant { model, inlet, outlet, .. } = &self.plant;
        RollerSample {
            inlet_kpa: state[INLET_KPA] + model.ambient_kpa,
            outlet_kpa: state[OUTLET_KPA] + model.ambient_kpa,
            inlet_ml_s: state[INLET_ML_S] - inlet.compliance_ml_kpa * inlet_kpa_s,
            outlet_ml_s: state[OUTLET_ML_S] + outlet.compliance_ml_kpa * outlet_kpa_s,
            taken_ml,
            delivered_ml,
        }
    }

    /// Integrates up to `end_s`, with a step that ends there. Later calls start from it.
    ///
    /// # Errors
    ///
    /// Fails if the state is not finite or no step meets the tolerance.
    pub fn run_to(&mut self, end_s: f64) -> Result<(), IntegrationError> {
        while self.step(end_s)?.is_some() {}
        Ok(())
    }

    /// Returns the pressures of the segments between two rollers at the time reached, kPa absolute, from the
    /// outlet to the inlet.
    pub fn segments_kpa(&self) -> impl Iterator<Item = f64> {
        let state = self.solver.state();
        (0..self.segments()).map(move |n| state[SEGMENTS + n] + self.plant.model.ambient_kpa)
    }

    /// Returns the number of segments between two rollers.
    fn segments(&self) -> usize {
        self.contacts.as_slice().len().saturating_sub(1).min(MAX_SEGMENTS)
    }

    /// Returns the volume that the tube and the compliance of the lines hold at the time reached, mL, up to a
    /// constant. It grows by the volume taken less the volume delivered.
    pub fn stored_ml(&self) -> f64 {
        let passage = self.passage.unwrap_or(rest(self.solver.time_s()));
        let Passage { leg, offset_rad, .. } = passage;
        let chambers = Chambers { plant: &self.plant, contacts: &self.contacts, leg, offset_rad };
        chambers.stored_ml(self.solver.time_s(), &self.solver.state())
    }

    /// Returns the time reached, s.
    pub fn time_s(&self) -> f64 {
        self.solver.time_s()
    }

    /// Returns the cost of the integration so far.
    pub fn statistics(&self) -> Statistics {
        self.solver.statistics()
    }

    /// Returns the middle of the first passage, s. It is away from all edges, so a pitch may begin there.
    pub(super) fn first_middle_s(&self) -> f64 {
        self.passage.map_or(0.0, |passage| 0.5 * (passage.start_s + passage.end_s))
    }

    /// Returns the state reached.
    pub(super) fn state(&self) -> StateVector {
        self.solver.state()
    }

    /// Returns the volume that has passed the outlet line, mL.
    pub(super) fn delivered_ml(&self) -> f64 {
        let [_, delivered_ml] = self.passed_ml;
        delivered_ml
    }

    /// Goes on into a passage. Segments join a port whose last roller left, and are cut off from one where a
    /// roller came.
    fn enter(&mut self, passage: &Passage) {
        let before = self.contacts;
        let pitches = self.edges.pitches_before(passage);
        let after = Contacts::of(self.pump, &self.plant.model, &self.edges, pitches, passage.piece);
        let mut state = self.solver.state();
        let mut segments = self.segments();
        // A closed roller always stays between rollers that leave and rollers that come, so the last segment
        // never joins both ports.
        for _ in before.first..after.first {
            self.join(&mut state, OUTLET_KPA, 0);
            slots(&mut state).rotate_left(1);
            segments = segments.saturating_sub(1);
        }
        for _ in after.last()..before.last() {
            segments = segments.saturating_sub(1);
            self.join(&mut state, INLET_KPA, segments);
        }
        for _ in before.last()..after.last() {
            let inlet_kpa = state[INLET_KPA];
            if let Some(slot) = slots(&mut state).get_mut(segments) {
                *slot = inlet_kpa;
            }
            segments += 1;
        }
        for _ in after.first..before.first {
            let outlet_kpa = state[OUTLET_KPA];
            slots(&mut state).rotate_right(1);
            if let Some(slot) = slots(&mut state).first_mut() {
                *slot = outlet_kpa;
            }
        }
        self.contacts = after;
        self.solver.restart(&state);
    }

    /// Joins a segment with a port: (C + D V0) P is the sum of both contents. V0 is the volume of the
    /// segment, since the port's own ends at the roller that leaves.
    fn join(&self, state: &mut StateVector, port: usize, segment: usize) {
        let Plant { model, pitch_ml, inlet, outlet, .. } = &self.plant;
        let compliance = if port == INLET_KPA { inlet } else { outlet }.compliance_ml_kpa;
        // The roller that leaves displaces nothing more; the next one is a pitch away.
        let segment_ml = pitch_ml - 0.5 * self.pump.roller_volume().at(self.pump.pitch_rad());
        let swell = model.distensibility_per_kpa * segment_ml;
        if let Some(segment_kpa) = slots(state).get(segment).copied() {
            state[port] = (compliance * state[port] + swell * segment_kpa) / (compliance + swell);
        }
    }
}

/// Returns a passage without motion from `start_s` on, for ever, at angle 0.
fn rest(start_s: f64) -> Passage {
    Passage { start_s, end_s: f64::INFINITY, leg: Leg::rest(start_s, 0.0), piece: 0, offset_rad: 0.0 }
}

/// Returns the pressures of the segments, absent ones included.
fn slots(state: &mut StateVector) -> &mut [f64] {
    state.get_mut(SEGMENTS..).unwrap_or_default()
}

/// Returns the state at rest. A segment has the pressure of the port that it is open to, and a closed one
/// that of the inlet.
fn at_rest(plant: &Plant, contacts: &Contacts) -> StateVector {
    let mut state = [0.0; STATES];
    let count = contacts.as_slice().len();
    let mut open_to_outlet = true;
    for (k, contact) in contacts.as_slice().iter().enumerate() {
        open_to_outlet &= contact.is_open();
        let reservoir = if open_to_outlet { &plant.outlet } else { &plant.inlet };
        state[pressure_of(k + 1, count)] = reservoir.reservoir_kpa;
    }
    state[INLET_KPA] = plant.inlet.reservoir_kpa;
    state[OUTLET_KPA] = plant.outlet.reservoir_kpa;
    state
}
