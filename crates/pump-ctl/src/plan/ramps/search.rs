//! The search for the ramps of a plan.

use pump_model::units::TURN_RAD;
use pump_model::{LineState, Pump};

use super::cruise::{Cruise, has_forgotten};
use super::grid::{Grid, Place};
use super::left_over::{LeftOver, Outcome, limit_ml};
use super::lines::{Lines, States, of_leg, of_motion};
use crate::plan::Plan;
use crate::plan::profile::{Profile, Shape};

/// Units of the way up that are tried where the dose ends before the line has forgotten its start.
const UPS: [f64; 3] = [1.0, 8.0, 16.0];

/// Units of each leg of the way down that are tried first, a quarter to one and a quarter of the period.
const DOWNS: [f64; 4] = [4.0, 8.0, 14.0, 22.0];

/// Parts of the plateau between both legs of the way down that are tried first.
const BETWEENS: [f64; 3] = [0.2, 0.4, 0.65];

/// Steps of the refinement: units, and parts of the plateau.
const FINER: [(f64, f64); 3] = [(2.0, 0.1), (1.0, 0.05), (0.5, 0.02)];

/// Rounds of each step of the refinement.
const ROUNDS: u32 = 2;

/// Finds the ramps of `plan`, which has usual ramps, from the angle and the lines that it starts with.
pub(in crate::plan) fn line_aware(pump: &Pump, plan: &Plan) -> Option<Shape> {
    Search::new(pump, plan).run()
}

/// Returns what comes of a plan with the ramps that it has.
pub(super) fn outcome_from_rest(pump: &Pump, plan: &Plan) -> Outcome {
    let far = Outcome { taken_back_ml: f64::INFINITY, time_s: f64::INFINITY, limit_ml: 0.0 };
    Search::new(pump, plan).outcome(&plan.profile, None, f64::INFINITY).unwrap_or(far)
}

/// A plan whose ramps are sought.
struct Search<'a> {
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

/// Keeps the better of the best so far and another.
fn keep_better(best: &mut Option<Best>, other: Best) {
    if best.is_none_or(|best| other.outcome.is_better_than(&best.outcome)) {
        *best = Some(other);
    }
}

impl<'a> Search<'a> {
    fn new(pump: &'a Pump, plan: &'a Plan) -> Self {
        let profile = &plan.profile;
        let grid = Grid::new(pump.outlet(), &profile.course, profile.limit_rad_s());
        let [_, outlet] = plan.lines.states(pump, 0.0);
        let direction = f64::from(profile.course.direction);
        Self {
            pump,
            profile,
            grid,
            lines: Lines::new(pump.outlet(), grid.unit_s),
            start: [outlet; 3],
            direction,
            end_ml: pump.outlet_curve().volume_ml(plan.end_angle_rad()),
            step_ml: plan.end_step_ml(pump) * direction,
            limit_ml: limit_ml(plan.planned_ml(), pump.revolution_ml() * plan.step_rad() / TURN_RAD),
        }
    }

    /// Tries the whole grid, and refines the best. Where even that takes back too much, the best of each way up
    /// and of each speed between both legs down is refined too.
    fn run(&self) -> Option<Shape> {
        let mut firsts: [Option<Best>; UPS.len() * BETWEENS.len()] = [None; UPS.len() * BETWEENS.len()];
        let mut slots = firsts.iter_mut();
        let mut tried = 0.0;
        let mut known = None;
        for up in UPS {
            // The motor's own ramp may be longer than a try.
            let up = up.max(self.grid.least);
            if up <= tried {
                continue;
            }
            tried = up;
            let cruise = self.cruise(up);
            for (between, slot) in BETWEENS.into_iter().zip(&mut slots) {
                for first in DOWNS {
                    for last in DOWNS {
                        self.try_place(Place { up, down: [first, last], between }, cruise.as_ref(), slot);
                    }
                }
            }
            known = Some((up, cruise));
            if self.starts_do_not_count() {
                break;
            }
        }
        let mut best: Option<Best> = None;
        for first in firsts.iter().flatten() {
            keep_better(&mut best, *first);
        }
        let best = self.refined(best?, known.as_ref());
        let mut found = Some(best);
        if !best.outcome.is_within() {
            for first in firsts.iter().flatten() {
                keep_better(&mut found, self.refined(*first, known.as_ref()));
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
        for (units, part) in FINER {
            for _ in 0..ROUNDS {
                for neighbour in here.place.neighbours(units, part) {
                    self.try_place(neighbour, cruise, &mut best);
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

    /// Tries the ramps at a place, and keeps them if they are better.
    fn try_place(&self, place: Place, cruise: Option<&Cruise>, best: &mut Option<Best>) {
        let Some(shape) = self.grid.shape(&place) else { return };
        let most_ml = best.map_or(f64::INFINITY, |best| best.outcome.taken_back_ml);
        if let Some(outcome) = self.outcome(&self.profile.with_shape(Some(shape)), cruise, most_ml) {
            keep_better(best, Best { place, shape, outcome });
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
        left_over.outcome(&self.lines, &states, end_s, self.step_ml, most_ml)
    }
}
