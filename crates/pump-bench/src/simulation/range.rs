//! The smallest and largest pressures of a motion, those between its samples included.

use pump_model::circuit::Loss;
use pump_model::integrator::IntegrationError;
use pump_model::{ExactRun, Extremes, Leg, LineState, Port, PortRun, Pump};

use super::waveform::{Integration, Method};

/// Decays of the slowest mode after which a constant speed reaches nothing new: e^-16 is left of start-up, below
/// 1e-5 kPa.
const DECAYS: f64 = 16.0;

/// Longest time that is followed where next to nothing damps, in s.
const MOST_S: f64 = 600.0;

/// Longest time, in s, and most legs that are followed between two questions whether to go on.
const SLICE: (f64, usize) = (100.0, 4096);

/// A motion of which the smallest and largest pressures are sought. It starts with the first of its legs, and ends
/// before they do.
#[derive(Debug, Clone, Copy)]
pub struct Course<'a> {
    /// Pump that makes the motion.
    pub pump: &'a Pump,
    /// Method that computes the pressures.
    pub method: Method,
    /// States of the lines of inlet and outlet at the start.
    pub states: [LineState; 2],
    /// End of the motion, in s.
    pub end_s: f64,
}

impl Course<'_> {
    /// Returns the smallest and largest pressures of inlet and outlet, kPa absolute. The roller-centric model has none:
    /// it is known at its samples alone. `goes_on` is asked now and then, and its no ends the search early.
    ///
    /// # Errors
    /// Returns the [`IntegrationError`] of a step that fails.
    pub fn extremes<M: Iterator<Item = Leg> + Clone>(
        &self,
        legs: &M,
        goes_on: &dyn Fn() -> bool,
    ) -> Result<Option<[Extremes; 2]>, IntegrationError> {
        let (integration, is_radau) = match self.method {
            Method::Exact => {
                let range = |port, state| {
                    let mut run = ExactRun::new(self.pump, port, legs.clone(), state);
                    self.followed(port, legs.clone(), goes_on, |span| {
                        Ok(match span {
                            Span::Sought(end_s) => Some(run.extremes(end_s)),
                            Span::Periodic(end_s) => {
                                run.at(end_s);
                                None
                            }
                        })
                    })
                };
                return self.of_both(range).map(Some);
            }
            Method::Rodas5p(integration) if integration.roller_centric.is_some() => return Ok(None),
            Method::Rodas5p(integration) => (integration, false),
            Method::Radau { tolerance } => (Integration::new(tolerance), true),
        };
        let [inlet, outlet] = integration.losses(self.pump);
        let range = |port, state| {
            let loss = if port == Port::Inlet { inlet } else { outlet };
            let tolerance = integration.tolerance;
            let run = PortRun::<_, 2, Loss>::resisted(self.pump, loss, port, legs.clone(), state, tolerance)?;
            let mut run = if is_radau { run.with_radau()? } else { run };
            self.followed(port, legs.clone(), goes_on, |span| {
                Ok(match span {
                    Span::Sought(end_s) => Some(run.extremes(end_s)?),
                    Span::Periodic(end_s) => {
                        run.run_to(end_s)?;
                        None
                    }
                })
            })
        };
        self.of_both(range).map(Some)
    }

    /// Returns true if no pressure of the motion can be below `floor_kpa` between samples that are above it, by a bound
    /// that takes less than [`Self::extremes`] where there are many legs. A false tells nothing. `samples_kpa` are the
    /// pressures of inlet and outlet, kPa absolute, and no two of them, nor the start and the first, are more than
    /// `longest_s` apart.
    pub fn stays_above<M: Iterator<Item = Leg> + Clone>(
        &self,
        floor_kpa: f64,
        legs: &M,
        samples_kpa: [&[f64]; 2],
        longest_s: f64,
    ) -> bool {
        if !matches!(self.method, Method::Exact | Method::Radau { .. }) {
            return false;
        }
        let moving = legs.clone().take_while(|leg| leg.start_s < self.end_s);
        let most_rad_s = moving.fold(0.0_f64, |most, leg| {
            let end_s = leg.end_s().min(self.end_s);
            most.max(leg.speed_rad_s.abs()).max(leg.speed_at(end_s).abs())
        });
        let ports = [Port::Inlet, Port::Outlet].into_iter().zip(self.states).zip(samples_kpa);
        let half_s = 0.5 * longest_s;
        ports.into_iter().all(|((port, start), samples_kpa)| {
            let line = self.pump.line(port);
            let (low, high) = self.pump.curve(port).flow_range_ml_rad();
            let pushed_ml_s = most_rad_s * low.abs().max(high.abs());
            let (mut lowest_kpa, mut most_kpa) = (start.pressure_kpa(line), start.above_reservoir_kpa.abs());
            for kpa in samples_kpa {
                lowest_kpa = lowest_kpa.min(*kpa);
                most_kpa = most_kpa.max((kpa - line.reservoir_kpa).abs());
            }
            // L dQ/dt = P - R Q keeps the flow of the line below the largest |P|/R, or what it was at the start, and
            // C dP/dt is what the rollers push and the line does not take. Half of the longest time is the way to the
            // next sample.
            let (resistance, per_volume) = (line.resistance_kpa_s_ml, half_s / line.compliance_ml_kpa);
            let share = per_volume / resistance;
            let start_ml_s = start.flow_ml_s.abs();
            let bound_kpa = ((most_kpa + per_volume * pushed_ml_s) / (1.0 - share))
                .max(most_kpa + per_volume * (pushed_ml_s + start_ml_s));
            let line_ml_s = start_ml_s.max(bound_kpa / resistance);
            share < 0.5 && lowest_kpa - per_volume * (pushed_ml_s + line_ml_s) > floor_kpa
        })
    }

    /// Returns the ranges of both ports.
    fn of_both(
        &self,
        range: impl Fn(Port, LineState) -> Result<Extremes, IntegrationError>,
    ) -> Result<[Extremes; 2], IntegrationError> {
        let [at_inlet, at_outlet] = self.states;
        Ok([range(Port::Inlet, at_inlet)?, range(Port::Outlet, at_outlet)?])
    }

    /// Returns the range of a port over all spans of the motion.
    fn followed(
        &self,
        port: Port,
        legs: impl Iterator<Item = Leg> + Clone,
        goes_on: &dyn Fn() -> bool,
        mut follow: impl FnMut(Span) -> Result<Option<Extremes>, IntegrationError>,
    ) -> Result<Extremes, IntegrationError> {
        let start = self.states[usize::from(port == Port::Outlet)].pressure_kpa(self.pump.line(port));
        let mut range = Extremes::at(start);
        let mut go = |span| follow(span).map(|new| range = new.map_or(range, |new| range.and(new)));
        let (mut reached_s, mut count) = (f64::NEG_INFINITY, 0);
        let mut ahead = legs.peekable();
        while let Some(leg) = ahead.next().filter(|leg| leg.start_s < self.end_s) {
            reached_s = reached_s.max(leg.start_s);
            let end_s = leg.end_s().min(self.end_s);
            let fresh_s = leg.start_s + self.fresh_s(port, &leg);
            let last_s = end_s.min(fresh_s);
            while last_s - reached_s > SLICE.0 && goes_on() {
                reached_s += SLICE.0;
                go(Span::Sought(reached_s))?;
            }
            if fresh_s < end_s {
                go(Span::Sought(fresh_s))?;
                if ahead.peek().is_none() || end_s >= self.end_s {
                    return Ok(range);
                }
                go(Span::Periodic(end_s))?;
                reached_s = end_s;
            }
            count += 1;
            if count % SLICE.1 == 0 {
                go(Span::Sought(end_s))?;
                reached_s = end_s;
                if !goes_on() {
                    return Ok(range);
                }
            }
        }
        go(Span::Sought(self.end_s))?;
        Ok(range)
    }

    /// Returns the time after which a leg reaches nothing new, in s: at constant speed all repeats itself by then.
    fn fresh_s(&self, port: Port, leg: &Leg) -> f64 {
        if leg.acceleration_rad_s2 != 0.0 {
            return f64::INFINITY;
        }
        let period_s =
            if leg.speed_rad_s == 0.0 { 0.0 } else { self.pump.pitch_rad() / leg.speed_rad_s.abs() };
        (DECAYS / self.pump.line(port).slowest_decay_per_s() + period_s).min(MOST_S.max(period_s))
    }
}

/// Part of a motion, up to a time in s.
enum Span {
    /// Part whose extremes are sought.
    Sought(f64),
    /// Part that repeats what was before.
    Periodic(f64),
}
