//! Edges of a pitch for each roller, and the rollers in contact between them.

use libm::{ceil, floor, round};

use crate::error::{ModelError, Parameter, refused};
use crate::head::pulses::SAME_EDGE_RAD;
use crate::head::roller_volume;
use crate::math::polynomial::Polynomial;
use crate::motion::walk::{Passage, Pitch};
use crate::pump::pump::Pump;
use crate::units::wrap;

use super::parameters::RollerCentric;

/// Largest number of segments: enough for 12 rollers of the pump of McIntyre et al.
pub(super) const MAX_SEGMENTS: usize = 12;

/// Largest number of rollers in contact with the tube at once.
pub(super) const MAX_CONTACTS: usize = MAX_SEGMENTS + 1;

/// Largest number of edges: those of the roller volume and the closure, each when engaging and when
/// disengaging.
const MAX_EDGES: usize = 2 * (roller_volume::MAX_PIECES + 2);

/// Way of a roller over the tube.
#[derive(Debug, Clone, Copy)]
pub(super) struct Way {
    /// Engagement angle phi, rad.
    pub(super) engagement_rad: f64,
    /// Angle of full engagement Lam, rad.
    pub(super) sealed_rad: f64,
    /// Angle between rollers, rad.
    pub(super) pitch_rad: f64,
}

impl Way {
    pub(super) fn of(pump: &Pump) -> Self {
        let roller = pump.roller_volume();
        Self {
            engagement_rad: roller.engagement_rad(),
            sealed_rad: pump.geometry().sealed_span_rad(roller.inset_rad()),
            pitch_rad: pump.pitch_rad(),
        }
    }

    /// Returns the largest number of rollers in contact at once.
    pub(super) fn contacts(&self) -> f64 {
        ceil((self.sealed_rad + 2.0 * self.engagement_rad) / self.pitch_rad)
    }

    /// Returns the angle at which a roller first touches the tube, rad: p = -Lam - phi.
    fn first_rad(&self) -> f64 {
        -self.sealed_rad - self.engagement_rad
    }
}

/// Angles of a pitch at which a roller begins or ends something: touching, closing, engaging, and the edges
/// of V between.
#[derive(Debug, Clone, Copy)]
pub(super) struct Edges {
    start_rad: [f64; MAX_EDGES],
    count: usize,
    pitch_rad: f64,
}

impl Edges {
    /// Finds the edges. Refuses more rollers in contact at once than there is room for.
    pub(super) fn new(pump: &Pump, model: &RollerCentric) -> Result<Self, ModelError> {
        let way = Way::of(pump);
        let contacts = way.contacts();
        if contacts > MAX_CONTACTS as f64 {
            let allowed = "13 at most; the roller-centric model has room for 12 segments";
            return Err(refused(Parameter::RollersInContact, contacts, allowed));
        }
        let mut edges = Self { start_rad: [0.0; MAX_EDGES], count: 1, pitch_rad: way.pitch_rad };
        let pieces = pump.roller_volume().pieces().iter().map(|piece| piece.start_rad);
        for x_rad in pieces.chain([model.closure_rad, way.engagement_rad]) {
            edges.insert(way.first_rad() + x_rad);
            edges.insert(way.engagement_rad - x_rad);
        }
        Ok(edges)
    }

    /// Refuses a pump whose flow curves do not belong to the angles of its dimensions.
    pub(super) fn validate_zero(&self, pump: &Pump, model: &RollerCentric) -> Result<(), ModelError> {
        /// Largest difference of flows that counts as equal, as a part of the nominal flow: far above
        /// rounding, far below a pulse.
        const SAME_FLOW: f64 = 1e-6;
        for piece in 0..self.count {
            let (start_rad, length_rad) = self.piece_rad(piece);
            let contacts = Contacts::of(pump, model, self, 0.0, piece);
            // Each roller takes half of its displacement from each side: a + V' at the outlet, a - V' at the
            // inlet.
            let slopes = contacts.as_slice().iter().map(|contact| contact.volume[1].at(0.5 * length_rad));
            let (falling, rising) = slopes.fold((0.0, 0.0), |(falling, rising), slope| {
                (falling + slope.min(0.0), rising + slope.max(0.0))
            });
            let (inlet, outlet, _) = pump.at_angle(start_rad + 0.5 * length_rad);
            let nominal = pump.nominal_ml_rad();
            let off = (nominal - rising - inlet).abs().max((nominal + falling - outlet).abs());
            if off > SAME_FLOW * nominal {
                let allowed = "0; the roller-centric model takes no shift of the zero, so give it the pump \
                               before the shift";
                return Err(refused(Parameter::FlowMismatch, off, allowed));
            }
        }
        Ok(())
    }

    /// Adds the place of a roller at `p_rad` within the pitch, unless it is known.
    fn insert(&mut self, p_rad: f64) {
        let local_rad = wrap(p_rad, self.pitch_rad);
        let known = self.starts().iter().any(|edge| (edge - local_rad).abs() < SAME_EDGE_RAD);
        if known || self.pitch_rad - local_rad < SAME_EDGE_RAD {
            return;
        }
        let place = self.starts().partition_point(|edge| *edge < local_rad);
        // There are as many places as edges.
        if let Some(after) = self.start_rad.get_mut(place..=self.count) {
            after.rotate_right(1);
            if let Some(first) = after.first_mut() {
                *first = local_rad;
                self.count += 1;
            }
        }
    }

    /// Returns the number of whole pitches before the piece of a passage. The walk counts them, and the angle
    /// of the piece's start tells them.
    pub(super) fn pitches_before(&self, passage: &Passage) -> f64 {
        let (start_rad, _) = self.piece_rad(passage.piece);
        round((passage.leg.angle_rad - passage.offset_rad - start_rad) / self.pitch_rad)
    }

    fn starts(&self) -> &[f64] {
        self.start_rad.get(..self.count).unwrap_or(&self.start_rad)
    }
}

impl Pitch for Edges {
    fn pitch_rad(&self) -> f64 {
        self.pitch_rad
    }
    fn last(&self) -> usize {
        self.count - 1
    }
    fn index_of(&self, local_rad: f64) -> usize {
        self.starts().iter().rposition(|start| *start <= local_rad).unwrap_or(0)
    }
    fn piece_rad(&self, number: usize) -> (f64, f64) {
        let mut from = self.starts().iter().skip(number);
        let start_rad = from.next().copied().unwrap_or(0.0);
        (start_rad, from.next().unwrap_or(&self.pitch_rad) - start_rad)
    }
}

/// Roller in contact, over the angle since the piece's start, rad.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Contact {
    /// Volume V_k, mL, and its first two derivatives.
    pub(super) volume: [Polynomial; 3],
    /// Opening 1 - u at the piece's start and its slope, 1/rad; zeros where the roller is closed.
    pub(super) opening: [f64; 2],
}

impl Contact {
    /// Builds the contact of a roller that is at `start_rad` on its way where the piece starts. The roller
    /// stays inside one piece of V over `length_rad`.
    fn new(pump: &Pump, model: &RollerCentric, way: &Way, start_rad: f64, length_rad: f64) -> Self {
        let middle_rad = start_rad + 0.5 * length_rad;
        // The engagement x grows at the inlet and falls at the outlet.
        let (x_rad, direction) = if middle_rad < -way.sealed_rad {
            (start_rad - way.first_rad(), 1.0)
        } else if middle_rad > 0.0 {
            (way.engagement_rad - start_rad, -1.0)
        } else {
            let sealed = Polynomial::constant(pump.roller_volume().total_ml());
            return Self {
                volume: [sealed, Polynomial::default(), Polynomial::default()],
                opening: [0.0; 2],
            };
        };
        let inside_rad = x_rad + direction * 0.5 * length_rad;
        let piece = pump.roller_volume().piece_at(inside_rad);
        let volume = piece.volume.shifted(x_rad - piece.start_rad).stretched(direction);
        let slope = volume.derivative();
        let is_open = inside_rad < model.closure_rad;
        let per_closure = 1.0 / model.closure_rad;
        Self {
            volume: [volume, slope, slope.derivative()],
            opening: if is_open { [1.0 - x_rad * per_closure, -direction * per_closure] } else { [0.0; 2] },
        }
    }

    /// True if the roller lets fluid pass.
    pub(super) fn is_open(&self) -> bool {
        self.opening != [0.0; 2]
    }
}

/// Rollers in contact while the rotor is in one piece of the pitch, from the outlet to the inlet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Contacts {
    places: [Contact; MAX_CONTACTS],
    count: usize,
    /// Number of the roller nearest to the outlet.
    pub(super) first: i64,
    /// Lengths of tube that belong to outlet and inlet where the piece starts, rad: phi - p_l and
    /// p_m + Lam + phi.
    pub(super) ends_rad: [f64; 2],
}

impl Contacts {
    pub(super) fn of(pump: &Pump, model: &RollerCentric, edges: &Edges, pitches: f64, piece: usize) -> Self {
        let way = Way::of(pump);
        let (local_rad, length_rad) = edges.piece_rad(piece);
        let middle_rad = local_rad + 0.5 * length_rad;
        // The angle p is local - n pitch: nothing touches or leaves in the middle of a piece.
        let first = ceil((middle_rad - way.engagement_rad) / way.pitch_rad);
        let last = floor((middle_rad - way.first_rad()) / way.pitch_rad);
        let mut contacts = Self {
            places: [Contact::default(); MAX_CONTACTS],
            count: 0,
            first: (pitches + first) as i64,
            ends_rad: [
                way.engagement_rad - (local_rad - first * way.pitch_rad),
                local_rad - last * way.pitch_rad - way.first_rad(),
            ],
        };
        let mut n = first;
        for place in &mut contacts.places {
            if n > last {
                break;
            }
            *place = Contact::new(pump, model, &way, local_rad - n * way.pitch_rad, length_rad);
            contacts.count += 1;
            n += 1.0;
        }
        contacts
    }

    pub(super) fn as_slice(&self) -> &[Contact] {
        self.places.get(..self.count).unwrap_or(&self.places)
    }

    /// Returns the number of the roller nearest to the inlet.
    pub(super) fn last(&self) -> i64 {
        self.first + self.count as i64 - 1
    }
}
