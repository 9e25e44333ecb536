//! The search for the ramps of a plan.

use pump_model::units::TURN_RAD;
use pump_model::{LineState, Pump};

use super::cruise::{Cruise, has_forgotten};
use super::grid::{Grid, Place};
use super::left_over::{LeftOver, Outcome, limit_ml};
use super::lines::{KNOWN, Lines, States, of_leg, of_motion};
use crate::plan::Plan;
use crate::plan::profile::{Profile, Shape};

/// Units of the way up that are tried where the dose ends before the line has forgotten its start.
const UPS: [f64; 3] = [1.0, 8.0, 16.0];

/// Units of each leg of the way down that are tried first, a quarter to one and a quarter of the period.
const DOWNS: [f64; 4] = [4.0, 8.0, 14.0, 22.0];

/// Units of each leg of a hurried way down that are tried first.
const HURRIED_DOWNS: [f64; 4] = [1.0, 3.0, 6.0, 11.0];

/// Parts of the plateau between both legs of the way down that are tried first.
const BETWEENS: [f64; 3] = [0.2, 0.4, 0.65];

/// Steps of the refinement: units, parts of the plateau, and rounds. The last step has one round, so that a Cortex-M4
/// plans with less than 20 million instructions.
const FINER: [(f64, f64, u32); 3] = [(2.0, 0.1, 2), (1.0, 0.05, 2), (0.5, 0.02, 1)];

/// Finds the ramps of `plan`, which has usual ramps, from the angle and the lines that it starts with.
pub(in crate::plan) fn line_aware(pump: &Pump, plan: &Plan) -> Option<Shape> {
    Search::new(pump, plan, Aim::Rest).run()
}

/// Finds the ramps of `plan` that take back least and end motion and settling within `most_s`, or else the ramps that
/// end soonest. The way up may be as short as the motor allows.
pub(in crate::plan) fn in_time(pump: &Pump, plan: &Plan, most_s: f64) -> Option<Shape> {
    Search::new(pump, plan, Aim::InTime { most_s }).run()
}

/// Returns the largest back flow of a plan with the ramps that it has, mL, over the lines that may be.
pub(in crate::plan) fn taken_back_ml(pump: &Pump, plan: &Plan) -> f64 {
    let search = Search::new(pump, plan, Aim::InTime { most_s: f64::INFINITY });
    search.outcome(&plan.profile, None, f64::INFINITY).map_or(f64::INFINITY, |outcome| outcome.taken_back_ml)
}

/// Returns true if a back flow, mL, is no fault of the ramps of `plan`.
pub(in crate::plan) fn is_no_fault(pump: &Pump, plan: &Plan, taken_back_ml: f64) -> bool {
    taken_back_ml <= limit_of(pump, plan)
}

/// Returns the largest back flow of a plan that is no fault, mL.
fn limit_of(pump: &Pump, plan: &Plan) -> f64 {
    limit_ml(plan.planned_ml(), pump.revolution_ml() * plan.step_rad() / TURN_RAD)
}

/// Returns what comes of a plan with the ramps that it has.
pub(super) fn outcome_from_rest(pump: &Pump, plan: &Plan) -> Outcome {
    let far = Outcome { taken_back_ml: f64::INFINITY, time_s: f64::INFINITY, limit_ml: 0.0 };
    Search::new(pump, plan, Aim::Rest).outcome(&plan.profile, None, f64::INFINITY).unwrap_or(far)
}

/// The aim of a search.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Aim {
    /// The line is to be at rest soonest, with a back flow that is no fault.
    Rest,
    /// The line is to be at rest within a time, s, with the least back flow.
    InTime { most_s: f64 },
}

impl Aim {
    /// Returns true if ramps with an outcome are to be preferred to others.
    fn prefers(self, one: &Outcome, other: &Outcome) -> bool {
        let Self::InTime { most_s } = self else { return one.is_better_than(other) };
        match (one.time_s <= most_s, other.time_s <= most_s) {
            (true, true) => one.taken_back_ml < other.taken_back_ml,
            (false, false) => one.time_s < other.time_s,
            (in_time, _) => in_time,
        }
    }

    /// Returns the units of each leg of the way down that are tried first.
    fn downs(self) -> [f64; 4] {
        if self == Self::Rest { DOWNS } else { HURRIED_DOWNS }
    }
}

/// A plan whose ramps are sought.
struct Search<'a> {
    aim: Aim,
    pump: &'a Pump,
    profile: &'a Profile,
    grid: Grid,
    lines: Lines,
    start: States,
    direction: f64,
    end_ml: f64,
    /// Volume of the last motor step, mL.
    step_ml: f64,
    /// Largest back flow that is no fault, mL.
    limit_ml: f64,
}

/// The best ramps so far.
#[derive(Debug, Clone, Copy)]
struct Best {
    place: Place,
    shape: Shape,
    outcome: Outcome,
}

impl Best {
    /// Returns the time to rest of ramps whose back flow is no fault, s, and infinity for others.
    fn soonest_s(&self) -> f64 {
        if self.outcome.is_within() { self.outcome.time_s } else { f64::INFINITY }
    }
}

impl<'a> Search<'a> {
    fn new(pump: &'a Pump, plan: &'a Plan, aim: Aim) -> Self {
        let profile = &plan.profile;
        let grid = Grid::new(pump.outlet(), &profile.course, profile.limit_rad_s());
        let [_, outlet] = plan.lines.states(pump, 0.0);
        let direction = f64::from(profile.course.direction);
        Self {
            aim,
            pump,
            profile,
            grid,
            lines: Lines::new(pump.outlet(), grid.unit_s),
            start: [outlet; 3],
            direction,
            end_ml: pump.outlet_curve().volume_ml(plan.end_angle_rad()),
            step_ml: plan.end_step_ml(pump) * direction,
            limit_ml: limit_of(pump, plan),
        }
    }

    /// Keeps the better of the best so far and another.
    fn keep_better(&self, best: &mut Option<Best>, other: Best) {
        if best.is_none_or(|best| self.aim.prefers(&other.outcome, &best.outcome)) {
            *best = Some(other);
        }
    }

    /// Tries the whole grid, and refines the best. Where even that takes back too much, the best of each way up
    /// and of each speed between both legs down is refined too.
    fn run(&self) -> Option<Shape> {
        let mut firsts: [Option<Best>; UPS.len() * BETWEENS.len()] = [None; UPS.len() * BETWEENS.len()];
        let mut slots = firsts.iter_mut();
        let mut tried = 0.0;
        let mut known = None;
        let mut soonest_s = f64::INFINITY;
        for up in UPS {
            // The motor's own ramp may be longer than a try.
            let up = up.max(self.grid.least);
            if up <= tried {
                continue;
            }
            tried = up;
            let cruise = self.cruise(up);
            for (between, slot) in BETWEENS.into_iter().zip(&mut slots) {
                for first in self.aim.downs() {
                    for last in self.aim.downs() {
                        let place = Place { up, down: [first, last], between };
                        self.try_place(place, cruise.as_ref(), soonest_s, slot);
                    }
                }
                soonest_s = soonest_s.min(slot.map_or(f64::INFINITY, |best| best.soonest_s()));
            }
            known = Some((up, cruise));
            if self.starts_do_not_count() {
                break;
            }
        }
        let mut best: Option<Best> = None;
        for first in firsts.iter().flatten() {
            self.keep_better(&mut best, *first);
        }
        let best = self.refined(best?, known.as_ref());
        let mut found = Some(best);
        if !best.outcome.is_within() {
            for first in firsts.iter().flatten() {
                self.keep_better(&mut found, self.refined(*first, known.as_ref()));
            }
        }
        found.map(|best| best.shape)
    }

    /// Goes from a place to better ones beside it until none is better. `known` is the cruise after a way up.
    fn refined(&self, first: Best, known: Option<&(f64, Option<Cruise>)>) -> Best {
        let own;
        let cruise = match known {
            Some((up, cruise)) if *up == first.place.up => cruise.as_ref(),
            _ => {
                own = self.cruise(first.place.up);
                own.as_ref()
            }
        };
        let mut best = Some(first);
        let mut here = first;
        for (units, part, rounds) in FINER {
            for _ in 0..rounds {
                for neighbour in here.place.neighbours(units, part) {
                    self.try_place(neighbour, cruise, f64::INFINITY, &mut best);
                }
                let Some(found) = best.filter(|best| best.place != here.place) else { break };
                here = found;
            }
        }
        here
    }

    /// Returns true if the line has forgotten the start by the time at which the way down begins.
    fn starts_do_not_count(&self) -> bool {
        self.profile.reaches_limit() && has_forgotten(self.pump, self.profile.left_s())
    }

    /// Follows the lines through the part of the cruise in which ways down begin. `None` if the motion has no
    /// cruise.
    fn cruise(&self, up: f64) -> Option<Cruise> {
        let profile = |down: f64, between: f64| {
            let shape = self.grid.shape(&Place { up, down: [down; 2], between });
            shape.map(|shape| self.profile.with_shape(Some(shape))).filter(Profile::reaches_limit)
        };
        let latest = profile(1.0, 0.05)?;
        let earliest_s = profile(24.0, 0.95).map_or(latest.reached_limit_s(), |early| early.left_s());
        Some(Cruise::new(self.pump, &self.lines, &latest, earliest_s, &self.start))
    }

    /// Tries the ramps at a place, and keeps them if they are better. A motion that is longer than the way to rest of
    /// others, with a back flow that is no fault, is no better. `soonest_s` is that way of ramps that were kept
    /// elsewhere.
    fn try_place(&self, place: Place, cruise: Option<&Cruise>, soonest_s: f64, best: &mut Option<Best>) {
        let Some(shape) = self.grid.shape(&place) else { return };
        let profile = self.profile.with_shape(Some(shape));
        let soonest_s = soonest_s.min(best.map_or(f64::INFINITY, |best| best.soonest_s()));
        if self.aim == Aim::Rest && profile.duration_s() >= soonest_s {
            return;
        }
        let most_ml = best.map_or(f64::INFINITY, |best| best.outcome.taken_back_ml);
        if let Some(outcome) = self.outcome(&profile, cruise, most_ml) {
            self.keep_better(best, Best { place, shape, outcome });
        }
    }

    /// Follows the lines to the end of a motion. `None` if it takes back more than the limit and more than
    /// `most_ml`.
    fn outcome(&self, profile: &Profile, cruise: Option<&Cruise>, most_ml: f64) -> Option<Outcome> {
        let curve = self.pump.outlet_curve();
        let mut left_over = LeftOver::new(self.direction, self.end_ml, self.limit_ml);
        let mut states: [LineState; 3] = self.start;
        let (left_s, end_s) = (profile.left_s(), profile.duration_s());
        match cruise.filter(|_| profile.reaches_limit()) {
            Some(cruise) => states = cruise.at(left_s),
            None => {
                let up_s = profile.reached_limit_s();
                let volume_ml = of_motion(curve, profile);
                self.lines.run(&volume_ml, (0.0, up_s), &mut states, None);
                self.lines.run(&volume_ml, (up_s, left_s), &mut states, None);
            }
        }
        let between_s = left_s + profile.first_down_s();
        let [first, last] = profile.down_legs();
        self.lines.run(of_leg(curve, first), (left_s, between_s), &mut states, None);
        self.lines.run(of_leg(curve, last), (between_s, end_s), &mut states, Some(&mut left_over));
        match self.aim {
            Aim::Rest => left_over.outcome(&self.lines, &states, end_s, self.step_ml, most_ml),
            Aim::InTime { .. } => Some(self.hurried_outcome(&left_over, &states, end_s)),
        }
    }

    /// Returns the outcome of a motion of `motion_s` that ends with the lines in `states`, with the settling of the
    /// line that is known.
    fn hurried_outcome(&self, left_over: &LeftOver, states: &States, motion_s: f64) -> Outcome {
        let taken_back_ml = self
            .lines
            .ring_down(states)
            .map(|down| down.taken_back_ml(self.direction))
            .fold(left_over.taken_back_ml, f64::max);
        let stepped = self.lines.with_volume(states, self.step_ml);
        let settled_s = self.lines.ring_down(&stepped).nth(KNOWN).map_or(0.0, |down| down.settled_after_s());
        Outcome { taken_back_ml, time_s: motion_s + settled_s, limit_ml: self.limit_ml }
    }
}
