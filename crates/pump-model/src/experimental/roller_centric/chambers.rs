//! Equations of the chambers and the lines.

use core::cell::RefCell;

use crate::circuit::Loss;
use crate::circuit::lumped::flow_scale_ml_s;
use crate::circuit::resistance::Deceleration;
use crate::integrator::{Ode, Options};
use crate::line::line::Line;
use crate::motion::leg::Leg;

use super::contacts::{Contacts, MAX_SEGMENTS};
use super::parameters::RollerCentric;

/// Index of the inlet's pressure in the state.
///
/// Pressures are above ambient, kPa; flows are in the lines, mL/s. Segments follow from the outlet to the inlet, and
/// absent segments keep their value. The volumes through the lines are no states, since nothing depends on them: they
/// are integrals of the flows.
pub(super) const INLET_KPA: usize = 0;
pub(super) const INLET_ML_S: usize = 1;
pub(super) const OUTLET_KPA: usize = 2;
pub(super) const OUTLET_ML_S: usize = 3;
pub(super) const SEGMENTS: usize = 4;

/// Number of states.
pub(super) const STATES: usize = SEGMENTS + MAX_SEGMENTS;

pub(super) type StateVector = [f64; STATES];

/// Returns the index of a chamber's pressure in the state. Chambers count from the outlet, and `contacts`
/// rollers are in contact.
pub(super) fn pressure_of(chamber: usize, contacts: usize) -> usize {
    if chamber == 0 {
        OUTLET_KPA
    } else if chamber == contacts {
        INLET_KPA
    } else {
        SEGMENTS + chamber - 1
    }
}

/// Line with its resistance.
#[derive(Debug, Clone, Copy)]
pub(super) struct PortLine {
    pub(super) compliance_ml_kpa: f64,
    /// Reciprocal of the inertance, 1/L, mL/(s² kPa).
    per_inertance: f64,
    /// Reservoir pressure P_res above ambient, kPa.
    pub(super) reservoir_kpa: f64,
    deceleration: Deceleration<Loss>,
}

impl PortLine {
    pub(super) fn new(line: &Line, loss: Loss, ambient_kpa: f64) -> Self {
        Self {
            compliance_ml_kpa: line.compliance_ml_kpa,
            per_inertance: 1.0 / line.inertance_kpa_s2_ml,
            reservoir_kpa: line.reservoir_kpa - ambient_kpa,
            deceleration: Deceleration::new(loss, line),
        }
    }
}

/// Parameters and lines, which stay constant while the pump turns.
#[derive(Debug, Clone, Copy)]
pub(super) struct Plant {
    pub(super) model: RollerCentric,
    /// Flow per radian of the tube between rollers, s a, mL/rad.
    pub(super) tube_ml_rad: f64,
    /// Volume of the tube over a pitch, s a pitch, mL.
    pub(super) pitch_ml: f64,
    pub(super) inlet: PortLine,
    pub(super) outlet: PortLine,
}

/// Differential equation within one passage.
pub(super) struct Chambers<'a> {
    pub(super) plant: &'a Plant,
    pub(super) contacts: &'a Contacts,
    pub(super) leg: Leg,
    /// Angle of the leg's start since the piece's start, rad.
    pub(super) offset_rad: f64,
}

/// Quantities that depend on the angle alone, at one time. There are fewer chambers than N states.
struct Moment<const N: usize> {
    speed: f64,
    acceleration: f64,
    /// Number of rollers in contact; there is one chamber more.
    contacts: usize,
    /// Conductance G_k past each roller, mL/(s kPa), and its slope over the angle.
    conductance: [[f64; 2]; N],
    /// Volume V0 of each chamber, mL, and its first two slopes over the angle.
    volume: [[f64; 3]; N],
    /// Reciprocal of the capacity C + D V0 of each chamber, kPa/mL.
    per_capacity: [f64; N],
}

impl Chambers<'_> {
    fn at<const N: usize>(&self, t: f64) -> Moment<N> {
        let elapsed = t - self.leg.start_s;
        let turned = self.offset_rad + self.leg.turned(elapsed);
        let contacts = self.contacts.as_slice();
        let Plant { model, tube_ml_rad, pitch_ml, inlet, outlet } = self.plant;
        let [outlet_rad, inlet_rad] = self.contacts.ends_rad;
        let mut moment = Moment {
            speed: self.leg.speed_at(t),
            acceleration: self.leg.acceleration_rad_s2,
            contacts: contacts.len(),
            conductance: [[0.0; 2]; N],
            volume: [[*pitch_ml, 0.0, 0.0]; N],
            per_capacity: [0.0; N],
        };
        moment.volume[0] = [tube_ml_rad * (outlet_rad - turned), -tube_ml_rad, 0.0];
        moment.volume[contacts.len()] = [tube_ml_rad * (inlet_rad + turned), *tube_ml_rad, 0.0];
        for (k, contact) in contacts.iter().enumerate() {
            for (n, polynomial) in contact.volume.iter().enumerate() {
                let half = 0.5 * polynomial.at(turned);
                moment.volume[k][n] -= half;
                moment.volume[k + 1][n] -= half;
            }
            let [at_start, slope] = contact.opening;
            let opening = at_start + slope * turned;
            let square = opening * opening / model.valve_resistance_kpa_s_ml;
            moment.conductance[k] = [square * opening, 3.0 * square * slope];
        }
        let last = contacts.len();
        let chambers = moment.per_capacity.iter_mut().zip(&moment.volume).take(last + 1);
        for (chamber, (per_capacity, volume)) in chambers.enumerate() {
            let of_outlet = if chamber == 0 { outlet.compliance_ml_kpa } else { 0.0 };
            let of_inlet = if chamber == last { inlet.compliance_ml_kpa } else { 0.0 };
            *per_capacity = 1.0 / (model.distensibility_per_kpa * volume[0] + of_outlet + of_inlet);
        }
        moment
    }

    /// Returns the flow that the rollers let into a chamber less the flow that they let out, mL/s. With
    /// `over` 1 it is the slope over the angle, mL/(s rad).
    fn leaks<const N: usize>(&self, moment: &Moment<N>, y: &[f64], chamber: usize, over: usize) -> f64 {
        let kpa = |chamber| y[pressure_of(chamber, moment.contacts)];
        let past = |k: usize| moment.conductance[k][over] * (kpa(k + 1) - kpa(k));
        let behind = if chamber < moment.contacts { past(chamber) } else { 0.0 };
        let ahead = if chamber > 0 { past(chamber - 1) } else { 0.0 };
        behind - ahead
    }

    /// Returns the swelling of a chamber, 1 + D (P - P_atm).
    fn swelling<const N: usize>(&self, moment: &Moment<N>, y: &[f64], chamber: usize) -> f64 {
        1.0 + self.plant.model.distensibility_per_kpa * y[pressure_of(chamber, moment.contacts)]
    }

    /// Returns the flow into a chamber that its pressure must take up, mL/s.
    fn net<const N: usize>(&self, moment: &Moment<N>, y: &[f64], chamber: usize) -> f64 {
        let mut net = self.leaks(moment, y, chamber, 0)
            - moment.volume[chamber][1] * moment.speed * self.swelling(moment, y, chamber);
        if chamber == 0 {
            net -= y[OUTLET_ML_S];
        }
        if chamber == moment.contacts {
            net += y[INLET_ML_S];
        }
        net
    }

    /// Returns the volume that tube and lines hold at time `t`, mL, up to a constant.
    pub(super) fn stored_ml(&self, t: f64, y: &StateVector) -> f64 {
        let moment = self.at::<STATES>(t);
        let Plant { inlet, outlet, .. } = self.plant;
        let tube: f64 =
            (0..=moment.contacts).map(|c| moment.volume[c][0] * self.swelling(&moment, y, c)).sum();
        tube + inlet.compliance_ml_kpa * y[INLET_KPA] + outlet.compliance_ml_kpa * y[OUTLET_KPA]
    }
}

/// The equations, in any size that has room for the segments in contact. Several stages of a step, and the start of the
/// next, are at one time, whose moment is found once.
pub(super) struct Equations<'a, const N: usize> {
    chambers: &'a Chambers<'a>,
    last: RefCell<Option<(f64, Moment<N>)>>,
}

impl<'a, const N: usize> Equations<'a, N> {
    pub(super) fn new(chambers: &'a Chambers<'a>) -> Self {
        Self { chambers, last: RefCell::new(None) }
    }

    /// Returns what `of` makes of the moment at a time.
    fn at<T>(&self, t: f64, of: impl FnOnce(&Chambers<'a>, &Moment<N>) -> T) -> T {
        let mut last = self.last.borrow_mut();
        let (_, moment) = match last.take() {
            Some(known) if known.0 == t => last.insert(known),
            _ => last.insert((t, self.chambers.at(t))),
        };
        of(self.chambers, moment)
    }
}

impl<const N: usize> Ode<N> for Equations<'_, N> {
    fn derivative(&self, t: f64, y: &[f64; N]) -> [f64; N] {
        self.at(t, |chambers, moment| chambers.derivative(moment, y))
    }

    fn jacobian(&self, t: f64, y: &[f64; N]) -> [[f64; N]; N] {
        self.at(t, |chambers, moment| chambers.jacobian(moment, y))
    }

    fn time_derivative(&self, t: f64, y: &[f64; N]) -> [f64; N] {
        self.at(t, |chambers, moment| chambers.time_derivative(moment, y))
    }
}

impl Chambers<'_> {
    fn derivative<const N: usize>(&self, moment: &Moment<N>, y: &[f64; N]) -> [f64; N] {
        let Plant { inlet, outlet, .. } = self.plant;
        let mut dy = [0.0; N];
        for chamber in 0..=moment.contacts {
            dy[pressure_of(chamber, moment.contacts)] =
                self.net(moment, y, chamber) * moment.per_capacity[chamber];
        }
        dy[INLET_ML_S] = inlet.per_inertance * (inlet.reservoir_kpa - y[INLET_KPA])
            - inlet.deceleration.at_ml_s2(y[INLET_ML_S]);
        dy[OUTLET_ML_S] = outlet.per_inertance * (y[OUTLET_KPA] - outlet.reservoir_kpa)
            - outlet.deceleration.at_ml_s2(y[OUTLET_ML_S]);
        dy
    }

    fn jacobian<const N: usize>(&self, moment: &Moment<N>, y: &[f64; N]) -> [[f64; N]; N] {
        let Plant { model, inlet, outlet, .. } = self.plant;
        let mut j = [[0.0; N]; N];
        for chamber in 0..=moment.contacts {
            let row = pressure_of(chamber, moment.contacts);
            let per_capacity = moment.per_capacity[chamber];
            let mut own = moment.volume[chamber][1] * moment.speed * model.distensibility_per_kpa;
            if chamber < moment.contacts {
                let [behind, _] = moment.conductance[chamber];
                j[row][pressure_of(chamber + 1, moment.contacts)] = behind * per_capacity;
                own += behind;
            } else {
                j[row][INLET_ML_S] = per_capacity;
            }
            if chamber > 0 {
                let [ahead, _] = moment.conductance[chamber - 1];
                j[row][pressure_of(chamber - 1, moment.contacts)] = ahead * per_capacity;
                own += ahead;
            } else {
                j[row][OUTLET_ML_S] = -per_capacity;
            }
            j[row][row] = -own * per_capacity;
        }
        j[INLET_ML_S][INLET_KPA] = -inlet.per_inertance;
        j[INLET_ML_S][INLET_ML_S] = -inlet.deceleration.damping_per_s(y[INLET_ML_S]);
        j[OUTLET_ML_S][OUTLET_KPA] = outlet.per_inertance;
        j[OUTLET_ML_S][OUTLET_ML_S] = -outlet.deceleration.damping_per_s(y[OUTLET_ML_S]);
        j
    }

    fn time_derivative<const N: usize>(&self, moment: &Moment<N>, y: &[f64; N]) -> [f64; N] {
        let Moment { speed, acceleration, .. } = *moment;
        let mut ft = [0.0; N];
        for chamber in 0..=moment.contacts {
            let [_, slope, curvature] = moment.volume[chamber];
            let per_capacity = moment.per_capacity[chamber];
            let capacity_rate = self.plant.model.distensibility_per_kpa * slope * speed;
            let net_rate = self.leaks(moment, y, chamber, 1) * speed
                - (curvature * speed * speed + slope * acceleration) * self.swelling(moment, y, chamber);
            let net = self.net(moment, y, chamber);
            ft[pressure_of(chamber, moment.contacts)] =
                (net_rate - net * capacity_rate * per_capacity) * per_capacity;
        }
        ft
    }
}

/// Returns the errors allowed in a step: `tolerance` times 1 kPa + |P - P_atm|. A flow may err by the amount that
/// carries the same energy, as in the flow-centric circuit.
pub(super) fn options<const N: usize>(inlet: &Line, outlet: &Line, tolerance: f64) -> Options<N> {
    let mut options = Options::equal(tolerance);
    for (line, flow) in [(inlet, INLET_ML_S), (outlet, OUTLET_ML_S)] {
        options.absolute[flow] = tolerance * flow_scale_ml_s(line);
    }
    options
}

#[cfg(test)]
mod tests {
    use nalgebra::SVector;

    use super::*;
    use crate::experimental::roller_centric::contacts::Edges;
    use crate::motion::walk::Walk;
    use crate::pump::pump::Pump;

    /// Checks every equation in turn with its derivatives, over a pitch in a ramp.
    #[test]
    fn jacobian_and_time_derivative_are_those_of_the_equations() {
        for rollers in [2, 3, 8] {
            let pump = Pump::preset(rollers, crate::Variant::Measured).unwrap();
            let model = RollerCentric::PUBLISHED;
            let edges = Edges::new(&pump, &model).unwrap();
            let lines = [pump.inlet(), pump.outlet()];
            let [inlet, outlet] = lines.map(|line| PortLine::new(line, Loss::of(line), model.ambient_kpa));
            let tube_ml_rad = model.scale * pump.nominal_ml_rad();
            let plant = Plant { model, tube_ml_rad, pitch_ml: tube_ml_rad * pump.pitch_rad(), inlet, outlet };
            let leg = Leg { speed_rad_s: 3.0, acceleration_rad_s2: 7.0, ..Leg::rest(0.0, 0.1) };
            let y: StateVector = core::array::from_fn(|n| 10.0 * libm::sin(1.0 + 3.0 * n as f64));
            for passage in Walk::new(edges, [leg]).take(12) {
                let contacts =
                    Contacts::of(&pump, &model, &edges, edges.pitches_before(&passage), passage.piece);
                let offset_rad = passage.offset_rad;
                let chambers = Chambers { plant: &plant, contacts: &contacts, leg, offset_rad };
                let chambers = Equations::<STATES>::new(&chambers);
                let t = 0.5 * (passage.start_s + passage.end_s);
                let close = |found: SVector<f64, STATES>, expected: StateVector, what: &str| {
                    let expected = SVector::from(expected);
                    let scale = expected.amax().max(1.0);
                    assert!((found - expected).amax() < 1e-6 * scale, "{rollers} {what}: {found} {expected}");
                };
                let h = 1e-6;
                let slope = |t: f64, y: &StateVector| SVector::from(chambers.derivative(t, y));
                let difference = (slope(t + h, &y) - slope(t - h, &y)) / (2.0 * h);
                close(difference, chambers.time_derivative(t, &y), "time");
                for n in 0..STATES {
                    let (mut more, mut less) = (y, y);
                    more[n] += 1e-3;
                    less[n] -= 1e-3;
                    let column = chambers.jacobian(t, &y).map(|row| row[n]);
                    close((slope(t, &more) - slope(t, &less)) / 2e-3, column, "state");
                }
            }
        }
    }
}
