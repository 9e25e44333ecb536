//! Effect of a change of the flow at the rollers on a line shortly after it.

use crate::line::oscillator::{Balanced, Oscillator, SHORT};
use crate::line::propagator::{RECIPROCALS, TERMS};

/// Number of coefficients of a flow at constant speed, a quartic of time.
const COEFFICIENTS: usize = 5;

/// Number of orders, an even one: 0.5^18/18! is below rounding.
const ORDERS: usize = TERMS + 1;

/// Responses of x and y to each coefficient of the flow.
type Responses = [f64; 2 * COEFFICIENTS];

/// Response of a line at rest to a flow that begins, over a time that is short beside the line's swing.
///
/// A flow sum f_k t^k drives the state to sum_k f_k h^k sum_m A^m b h^(m+1) k!/(k+m+1)! after h: the Taylor series of
/// the integral of e^(A (h - t)) b f(t) dt (Higham, "Functions of Matrices", chapter 10).
#[derive(Debug, Clone)]
pub(crate) struct Onset {
    per_longest: f64,
    /// H^(m+1) A^m b k!/(k+m+1)! by m and k, where H is the longest time.
    orders: [Responses; ORDERS],
    /// Number of orders that are not below rounding.
    count: usize,
}

impl Onset {
    /// Returns the response over `longest_s` at most; none if that is not short.
    pub(crate) fn new(oscillator: &Oscillator, longest_s: f64) -> Option<Self> {
        let reach = oscillator.norm() * longest_s;
        if reach > SHORT {
            return None;
        }
        let mut onset =
            Self { per_longest: 1.0 / longest_s, orders: [[0.0; 2 * COEFFICIENTS]; ORDERS], count: 0 };
        let mut power = [longest_s * oscillator.rate * oscillator.impedance, 0.0];
        // The weights k!/(k+m+1)!.
        let mut weights = [0.0; COEFFICIENTS];
        weights.copy_from_slice(&RECIPROCALS[1..=COEFFICIENTS]);
        let mut size = 1.0;
        for (m, order) in onset.orders.iter_mut().enumerate() {
            for (k, (places, weight)) in order.as_chunks_mut().0.iter_mut().zip(&mut weights).enumerate() {
                *places = power.map(|x| *weight * x);
                *weight *= RECIPROCALS[k + m + 2];
            }
            onset.count = m + 1;
            power = oscillator.times(power).map(|x| longest_s * x);
            size *= reach * RECIPROCALS[m + 2];
            if size < 1e-18 {
                break;
            }
        }
        Some(onset)
    }

    /// Returns the state `after_s` after a flow of degree 4 at most began. `flow` has its coefficients
    /// in the time since its beginning, lowest order first.
    pub(crate) fn after(&self, after_s: f64, flow: &[f64; COEFFICIENTS]) -> Balanced {
        let part = after_s * self.per_longest;
        let square = part * part;
        // The sums of even and of odd orders do not wait for each other.
        let (mut sums, mut odd_sums) = ([0.0; 2 * COEFFICIENTS], [0.0; 2 * COEFFICIENTS]);
        let (orders, _) = self.orders.as_chunks();
        for [even, odd] in orders.iter().take(self.count.div_ceil(2)).rev() {
            for ((sum, odd_sum), (even, odd)) in sums.iter_mut().zip(&mut odd_sums).zip(even.iter().zip(odd))
            {
                *sum = square * *sum + even;
                *odd_sum = square * *odd_sum + odd;
            }
        }
        for (sum, odd_sum) in sums.iter_mut().zip(odd_sums) {
            *sum += part * odd_sum;
        }
        let mut power = part;
        let mut state = [0.0; 2];
        for ([x, y], c) in sums.as_chunks().0.iter().zip(flow) {
            let forced = power * c;
            state = [state[0] + forced * x, state[1] + forced * y];
            power *= after_s;
        }
        state
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::line::line::Line;
    use crate::motion::flow::Flow;
    use crate::port::Port;

    #[test]
    fn a_flow_that_begins_moves_a_line_as_the_exact_solution_says() {
        let flow = Flow { c: [3.0, -40.0, 2e3, 1e5, -3e6, 0.0, 0.0, 0.0, 0.0, 0.0], degree: 4 };
        for port in [Port::Inlet, Port::Outlet] {
            let oscillator = Oscillator::new(&Line::PUBLISHED, port);
            let longest_s = SHORT / oscillator.norm();
            let onset = Onset::new(&oscillator, longest_s).unwrap();
            for part in [0.0, 1e-3, 0.2, 0.9, 1.0] {
                let expected = oscillator.after(part * longest_s, [0.0; 2], &flow);
                let found = onset.after(part * longest_s, &flow.quartic_after(0.0));
                for (found, expected) in found.iter().zip(expected) {
                    assert!((found - expected).abs() <= 1e-13 * expected.abs(), "{found:e}, {expected:e}");
                }
            }
            assert!(Onset::new(&oscillator, 1.01 * longest_s).is_none());
        }
    }
}
