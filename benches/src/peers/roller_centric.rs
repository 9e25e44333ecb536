//! The roller-centric model by `diffsol`: its equations once more, as the module `roller_centric` states them.
//!
//! The solver stops where a roller begins or ends something. There a segment joins the outlet, or is cut off at the
//! inlet.

use std::cell::RefCell;
use std::f64::consts::PI;

use diffsol::error::DiffsolError;
use diffsol::{
    NalgebraContext, NalgebraLU, NalgebraMat, NalgebraVec, OdeBuilder, OdeEquationsImplicit, OdeSolverMethod,
    OdeSolverProblem, OdeSolverStopReason,
};
use pump_model::{Pump, RollerCentric};

use super::Recorder;
use super::implicit::Method;
use crate::case::{Case, END_S, Samples};

type Matrix = NalgebraMat<f64>;
type Factored = NalgebraLU<f64>;

/// Most of three rollers that are in contact at once.
const MOST: usize = 3;

/// Pressures of inlet and outlet above ambient, kPa, each followed by the flow in its line, mL/s. Then the pressures of
/// the segments from the outlet on.
const STATES: usize = 4 + MOST - 1;
const INLET: usize = 0;
const OUTLET: usize = 2;
const SEGMENTS: usize = 4;

type State = [f64; STATES];

/// A roller in contact, over the angle of the rotor.
#[derive(Clone, Copy, Default)]
struct Roller {
    /// Engagement x at angle 0, rad, and its slope; 0 where the roller is engaged in full.
    engagement: [f64; 2],
    is_open: bool,
}

/// The rotor's way from one edge to the next.
#[derive(Clone, Copy)]
struct Passage {
    start_s: f64,
    end_s: f64,
    /// Rollers in contact from the outlet to the inlet, and the numbers of the first and of the one after the last.
    rollers: [Roller; MOST],
    numbers: [i64; 2],
    /// Lengths of tube of outlet and inlet at angle 0, rad.
    ends_rad: [f64; 2],
}

impl Passage {
    fn contacts(&self) -> usize {
        (self.numbers[1] - self.numbers[0]) as usize
    }
}

/// Returns the place of a chamber's pressure. Chambers count from the outlet.
fn place(chamber: usize, contacts: usize) -> usize {
    match chamber {
        0 => OUTLET,
        _ if chamber == contacts => INLET,
        _ => SEGMENTS + chamber - 1,
    }
}

/// The pump with the model's parameters.
struct Head<'a> {
    pump: &'a Pump,
    model: RollerCentric,
    speed_rad_s: f64,
    tube_ml_rad: f64,
    /// Angle Lam over which a roller is engaged in full, rad, and the engagement angle phi.
    sealed_rad: f64,
    phi_rad: f64,
}

impl<'a> Head<'a> {
    fn new(case: &'a Case) -> Self {
        let (pump, model) = (&case.pump, RollerCentric::PUBLISHED);
        let volume = pump.roller_volume();
        Self {
            pump,
            model,
            speed_rad_s: case.leg.speed_rad_s,
            tube_ml_rad: model.scale * pump.nominal_ml_rad(),
            sealed_rad: PI + 2.0 * (pump.geometry().contact_angle_rad - volume.inset_rad()),
            phi_rad: volume.engagement_rad(),
        }
    }

    fn passages(&self) -> Vec<Passage> {
        let pitch_rad = self.pump.pitch_rad();
        let begins = [0.0, self.model.closure_rad, self.phi_rad];
        let held = self.pump.roller_volume().held_rad().flat_map(|(from, to)| [from, to]);
        let mut local_rad: Vec<f64> = begins
            .into_iter()
            .chain(held)
            .flat_map(|x| [x - self.sealed_rad - self.phi_rad, self.phi_rad - x])
            .map(|p| p.rem_euclid(pitch_rad))
            .collect();
        local_rad.sort_by(f64::total_cmp);
        local_rad.dedup_by(|next, kept| *next - *kept < 1e-9);
        let pitches = (0..).map(|n| f64::from(n) * pitch_rad);
        let edges = pitches.flat_map(|start| local_rad.iter().map(move |local| start + local));
        let mut start_s = 0.0;
        let mut passages = Vec::new();
        for end_s in edges.map(|edge| edge / self.speed_rad_s).skip_while(|end_s| *end_s < 1e-9) {
            passages.push(self.passage(start_s, end_s.min(END_S)));
            start_s = end_s;
            // Rounding may leave a last passage too short for a step.
            if end_s > END_S - 1e-9 {
                break;
            }
        }
        passages
    }

    fn passage(&self, start_s: f64, end_s: f64) -> Passage {
        let (pitch_rad, first_rad) = (self.pump.pitch_rad(), -self.sealed_rad - self.phi_rad);
        let middle_rad = 0.5 * (start_s + end_s) * self.speed_rad_s;
        let first = ((middle_rad - self.phi_rad) / pitch_rad).ceil() as i64;
        let end = ((middle_rad - first_rad) / pitch_rad).floor() as i64 + 1;
        let mut rollers = [Roller::default(); MOST];
        for (roller, number) in rollers.iter_mut().zip(first..end) {
            let passed_rad = number as f64 * pitch_rad;
            let engagement = match middle_rad - passed_rad {
                p if p < -self.sealed_rad => [-passed_rad - first_rad, 1.0],
                p if p > 0.0 => [self.phi_rad + passed_rad, -1.0],
                _ => [self.phi_rad, 0.0],
            };
            let is_open = engagement[0] + engagement[1] * middle_rad < self.model.closure_rad;
            *roller = Roller { engagement, is_open };
        }
        let (first_passed, last_passed) = (first as f64 * pitch_rad, (end - 1) as f64 * pitch_rad);
        let ends_rad = [self.phi_rad + first_passed, -last_passed - first_rad];
        Passage { start_s, end_s, rollers, numbers: [first, end], ends_rad }
    }

    /// Computes dz/dt; with `inputs` 0 that of a change of the state alone, the Jacobian times z.
    fn slope(&self, passage: &Passage, t: f64, z: &[f64], inputs: f64, dz: &mut [f64]) {
        let (contacts, angle_rad) = (passage.contacts(), self.speed_rad_s * t);
        let RollerCentric { distensibility_per_kpa, valve_resistance_kpa_s_ml, closure_rad, .. } = self.model;
        let (mut volumes, mut leaks) = ([[0.0; 2]; MOST], [0.0; MOST]);
        for (k, roller) in passage.rollers.iter().take(contacts).enumerate() {
            let [at_0, direction] = roller.engagement;
            let x = at_0 + direction * angle_rad;
            let volume = self.pump.roller_volume();
            volumes[k] = [volume.at(x), direction * volume.slope_ml_rad(x)];
            if roller.is_open {
                let opening = 1.0 - x / closure_rad;
                let across_kpa = z[place(k + 1, contacts)] - z[place(k, contacts)];
                leaks[k] = opening * opening * opening / valve_resistance_kpa_s_ml * across_kpa;
            }
        }
        let [inlet, outlet] = [self.pump.inlet(), self.pump.outlet()];
        dz.fill(0.0);
        for chamber in 0..=contacts {
            let (mut volume, mut capacity) = ([self.tube_ml_rad * self.pump.pitch_rad(), 0.0], 0.0);
            let mut net = 0.0;
            if chamber == 0 {
                volume = [self.tube_ml_rad * (passage.ends_rad[0] - angle_rad), -self.tube_ml_rad];
                capacity = outlet.compliance_ml_kpa;
                net -= z[OUTLET + 1];
            } else {
                volume =
                    [volume[0] - 0.5 * volumes[chamber - 1][0], volume[1] - 0.5 * volumes[chamber - 1][1]];
                net -= leaks[chamber - 1];
            }
            if chamber == contacts {
                let own = 0.5 * volumes[chamber - 1][0];
                volume[0] = self.tube_ml_rad * (passage.ends_rad[1] + angle_rad) - own;
                volume[1] += self.tube_ml_rad;
                capacity = inlet.compliance_ml_kpa;
                net += z[INLET + 1];
            } else {
                volume = [volume[0] - 0.5 * volumes[chamber][0], volume[1] - 0.5 * volumes[chamber][1]];
                net += leaks[chamber];
            }
            let own = place(chamber, contacts);
            net -= volume[1] * self.speed_rad_s * (inputs + distensibility_per_kpa * z[own]);
            dz[own] = net / (capacity + distensibility_per_kpa * volume[0]);
        }
        let above_kpa = |kpa: f64| inputs * (kpa - self.model.ambient_kpa);
        let drop_kpa = above_kpa(inlet.reservoir_kpa) - z[INLET] - inlet.resistance_kpa_s_ml * z[INLET + 1];
        dz[INLET + 1] = drop_kpa / inlet.inertance_kpa_s2_ml;
        let drop_kpa =
            z[OUTLET] - above_kpa(outlet.reservoir_kpa) - outlet.resistance_kpa_s_ml * z[OUTLET + 1];
        dz[OUTLET + 1] = drop_kpa / outlet.inertance_kpa_s2_ml;
    }

    /// Returns the state at rest. A segment that is open to the outlet has its pressure, another one the inlet's.
    fn at_rest(&self, passage: &Passage) -> State {
        let [inlet_kpa, outlet_kpa] =
            [self.pump.inlet(), self.pump.outlet()].map(|line| line.reservoir_kpa - self.model.ambient_kpa);
        let mut state = [0.0; STATES];
        let mut is_open = true;
        for (k, roller) in passage.rollers.iter().take(passage.contacts()).enumerate() {
            is_open &= roller.is_open;
            state[place(k + 1, passage.contacts())] = if is_open { outlet_kpa } else { inlet_kpa };
        }
        (state[INLET], state[OUTLET]) = (inlet_kpa, outlet_kpa);
        state
    }

    /// Returns the state at an edge, `after` the passage `before`.
    fn over_edge(&self, before: &Passage, after: &Passage, mut state: State) -> State {
        for _ in before.numbers[0]..after.numbers[0] {
            let volume = self.pump.roller_volume();
            let segment_ml = self.tube_ml_rad * self.pump.pitch_rad() - 0.5 * volume.total_ml();
            let swell = self.model.distensibility_per_kpa * segment_ml;
            let compliance = self.pump.outlet().compliance_ml_kpa;
            let content = compliance * state[OUTLET] + swell * state[SEGMENTS];
            state[OUTLET] = content / (compliance + swell);
            state[SEGMENTS..].rotate_left(1);
        }
        if after.numbers[1] > before.numbers[1] {
            state[SEGMENTS + after.contacts() - 2] = state[INLET];
        }
        state
    }
}

pub(crate) fn run(
    case: &Case,
    method: Method,
    tolerance: f64,
    samples: &mut Samples,
) -> Result<(), DiffsolError> {
    let head = Head::new(case);
    let passages = head.passages();
    let current = RefCell::new(passages[0]);
    let derivative =
        |z: &[f64], _: &[f64], t: f64, dz: &mut [f64]| head.slope(&current.borrow(), t, z, 1.0, dz);
    let jacobian = |_: &[f64], _: &[f64], t: f64, v: &[f64], jv: &mut [f64]| {
        head.slope(&current.borrow(), t, v, 0.0, jv);
    };
    let start = head.at_rest(&passages[0]);
    let mut problem = OdeBuilder::<Matrix>::new()
        .rtol(tolerance)
        .atol([tolerance])
        .rhs_implicit(derivative, jacobian)
        .init(|_, _, z| z.copy_from_slice(&start), STATES)
        .build()?;
    // The limits count over the whole run, in which each roller that opens costs some.
    problem.ode_options.max_nonlinear_solver_failures = usize::MAX;
    problem.ode_options.max_error_test_failures = usize::MAX;
    let way = (&head, &passages[..], &current);
    match method {
        Method::Bdf => follow(problem.bdf::<Factored>()?, &problem, way, case, samples),
        Method::Esdirk34 => follow(problem.esdirk34::<Factored>()?, &problem, way, case, samples),
    }
}

/// Integrates from edge to edge and fills the samples.
fn follow<'a, E, S>(
    mut solver: S,
    problem: &'a OdeSolverProblem<E>,
    (head, passages, current): (&Head<'_>, &[Passage], &RefCell<Passage>),
    case: &Case,
    samples: &mut Samples,
) -> Result<(), DiffsolError>
where
    E: OdeEquationsImplicit<T = f64, V = NalgebraVec<f64>, M = Matrix, C = NalgebraContext> + 'a,
    S: OdeSolverMethod<'a, E>,
{
    let above_kpa = case.ports.each_ref().map(|port| port.line.reservoir_kpa - head.model.ambient_kpa);
    let mut recorder = Recorder::new(case, samples);
    let mut there = solver.state().y.clone();
    for passage in passages {
        let before = current.replace(*passage);
        if passage.start_s > 0.0 {
            let mut state = solver.state_mut();
            let mut z = [0.0; STATES];
            z.iter_mut().enumerate().for_each(|(n, z)| *z = state.y[n]);
            let (z, mut dz) = (head.over_edge(&before, passage, z), [0.0; STATES]);
            head.slope(passage, passage.start_s, &z, 1.0, &mut dz);
            for n in 0..STATES {
                (state.y[n], state.dy[n]) = (z[n], dz[n]);
            }
            state.set_step_size(1.0, &problem.atol, problem.rtol, &problem.eqn, 2);
        }
        solver.set_stop_time(passage.end_s)?;
        loop {
            let reason = solver.step()?;
            let mut failure = None;
            recorder.record(solver.state().t, |sample_s| {
                failure = solver.interpolate_inplace(sample_s, &mut there).err().or(failure.take());
                [there[INLET] - above_kpa[0], there[OUTLET] - above_kpa[1]]
            });
            if let Some(failure) = failure {
                return Err(failure);
            }
            if reason == OdeSolverStopReason::TstopReached {
                break;
            }
        }
    }
    Ok(())
}
