//! The legs of a profile, each of constant acceleration.

use pump_model::Leg;

use super::envelope::Place;
use super::profile::Profile;

/// The legs of a motion in order: to the speed limit, along it, down to rest. A constant limit makes three
/// legs, or four if the way down has two.
#[derive(Debug, Clone)]
pub struct Legs<'a> {
    profile: &'a Profile,
    next: Next,
}

/// The leg that comes next.
#[derive(Debug, Clone, Copy)]
enum Next {
    Ramp,
    Even,
    Along(Place),
    Down,
    Last,
    End,
}

impl Profile {
    /// Returns the legs of the motion, from time 0.
    pub fn legs(&self) -> Legs<'_> {
        Legs { profile: self, next: Next::Ramp }
    }
}

impl Iterator for Legs<'_> {
    type Item = Leg;

    fn next(&mut self) -> Option<Leg> {
        loop {
            match self.next {
                Next::Ramp => {
                    self.next = self.profile.first_place().map_or(Next::Even, Next::Along);
                    return Some(self.profile.ramp_leg());
                }
                Next::Even => {
                    self.next = Next::Down;
                    return Some(self.profile.even_leg());
                }
                Next::Along(place) => {
                    self.next = Next::Along(place.next());
                    match self.profile.leg_at_place(place) {
                        Some(leg) if leg.duration_s > 0.0 => return Some(leg),
                        Some(_) => {}
                        None => self.next = Next::Down,
                    }
                }
                Next::Down => {
                    self.next = Next::Last;
                    let leg = self.profile.first_down_leg();
                    if leg.duration_s > 0.0 {
                        return Some(leg);
                    }
                }
                Next::Last => {
                    self.next = Next::End;
                    return Some(self.profile.last_down_leg());
                }
                Next::End => return None,
            }
        }
    }
}
