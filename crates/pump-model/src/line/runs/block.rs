//! The pressure over a block of time as one polynomial, which the state at the block's start and the flow decide.

use libm::sqrt;

use crate::line::oscillator::{Balanced, Oscillator};
use crate::line::propagator::{Propagator, RECIPROCALS};
use crate::motion::flow::{DEGREE, Flow};

/// Number of samples that are computed together, each in a lane of its own.
pub(super) const LANES: usize = 8;

/// Number of coefficients of a polynomial, a multiple of four: 2 (5/4)^20/20! is below rounding.
const TERMS: usize = 20;

/// Number of terms of the Taylor series from which the coefficients are taken: 2.5^27/27! is below rounding.
const TAYLOR: usize = 27;

/// |A| h of a long block. A longer one needs more coefficients, a shorter one comes to its end sooner.
const LONG: f64 = 5.0;

/// |A| h of a short block: 1.1^20/20! is below rounding.
const SHORT: f64 = 1.1;

/// Longest block of a line that hardly moves, s.
const LONGEST_S: f64 = 1e3;

/// Number of what decides a block at constant speed: a state, and the coefficients of a flow of degree 4.
const CONSTANT_SPEED: usize = 7;

/// Number of what decides a block at any speed: a state, and the coefficients of any flow.
const CAUSES: usize = DEGREE + 3;

/// The state at a block's start, and the coefficients of the flow in powers of the block's length.
type Causes = [f64; CAUSES];

/// Coefficients over the places in a block, lowest order first.
type Terms = [f64; TERMS];

/// A block of time with the line's course.
#[derive(Debug, Clone)]
pub(super) struct Block {
    pub(super) length_s: f64,
    /// Place of the block's start: -1 in a long block, 0 in a short one. The end is at 1.
    pub(super) start: f64,
    places_per_s: f64,
    /// The pressure.
    pub(super) kpa: Terms,
    /// The state y of a short block.
    y: Terms,
    end: Balanced,
    causes: Causes,
    degree: usize,
}

/// Long blocks of one length: the pressure and the state at the end that each cause brings about, and y.
///
/// Taylor's coefficients about the middle lose their highest orders as Chebyshev's polynomials (Lanczos, "Applied
/// Analysis", chapter 7), so that a third fewer serve than from the start.
#[derive(Debug, Clone)]
pub(super) struct Blocks {
    norm: f64,
    length_s: f64,
    powers_s: [f64; DEGREE + 1],
    courses: [[f64; TERMS + 2]; CAUSES],
    of_y: [Terms; CAUSES],
    /// Number of causes whose effects are known.
    known: usize,
}

impl Blocks {
    pub(super) fn new(oscillator: &Oscillator) -> Self {
        let (rate, decay) = (oscillator.rate, oscillator.decay);
        let norm = 0.5 * (decay + sqrt(decay * decay + 4.0 * rate * rate));
        let length_s = (LONG / norm).min(LONGEST_S);
        let mut powers_s = [1.0; DEGREE + 1];
        let mut power_s = 1.0;
        for place in &mut powers_s {
            *place = power_s;
            power_s *= length_s;
        }
        let mut blocks = Self {
            norm,
            length_s,
            powers_s,
            courses: [[0.0; TERMS + 2]; CAUSES],
            of_y: [[0.0; TERMS]; CAUSES],
            known: 0,
        };
        blocks.learn(oscillator, CONSTANT_SPEED);
        blocks
    }

    /// Computes the effects of the first `count` causes, as far as they are not known.
    fn learn(&mut self, oscillator: &Oscillator, count: usize) {
        let half = Propagator::new(oscillator, 0.5 * self.length_s, count - 3);
        let places = self.courses.iter_mut().zip(&mut self.of_y).enumerate();
        for (cause, (course, of_y)) in places.take(count).skip(self.known) {
            let series = match cause.checked_sub(2) {
                None => {
                    let start = [[1.0, 0.0], [0.0, 1.0]].get(cause).copied().unwrap_or_default();
                    taylor(oscillator, half.step_s, half.moved(start), [0.0; DEGREE + 1])
                }
                Some(order) => {
                    let (flow, response) = (from_middle(order), half.response.get(order));
                    let response = response.copied().unwrap_or_default();
                    taylor(oscillator, half.step_s, response.map(|z| flow[0] * z), flow)
                }
            };
            let (places, end_places) = course.split_at_mut(TERMS);
            end_places.copy_from_slice(&end(&series));
            for ((x, y), [found_x, found_y]) in places.iter_mut().zip(of_y).zip(economised(series)) {
                (*x, *y) = (found_x, found_y);
            }
        }
        self.known = count;
    }

    /// Begins a block in `state` with `room_s` to the next edge. `flow` counts time from `since_s` before.
    ///
    /// A long block may end beyond the edge, where a flow that is not even may soon be so large that its digits are
    /// missing before.
    #[inline]
    pub(super) fn begin(
        &mut self,
        block: &mut Block,
        oscillator: &Oscillator,
        state: Balanced,
        (flow, since_s): (&Flow, f64),
        room_s: f64,
    ) {
        let fitting = match flow.degree {
            0 => 0.0,
            1..=4 => 0.5,
            _ => 1.0,
        };
        if room_s < fitting * self.length_s {
            let length_s = room_s.min(SHORT / self.norm);
            block.begin_short(oscillator, state, &flow.shifted(since_s), length_s);
            return;
        }
        let [x, y] = state;
        block.causes = [x, y, flow.c[0], 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        if flow.degree > 0 {
            if flow.degree + 3 > self.known {
                self.learn(oscillator, CAUSES);
            }
            let c = flow.shifted(since_s).c;
            for (cause, (c, power)) in block.causes.iter_mut().skip(2).zip(c.iter().zip(self.powers_s)) {
                *cause = c * power;
            }
        }
        block.degree = flow.degree;
        (block.length_s, block.start, block.places_per_s) = (self.length_s, -1.0, 2.0 / self.length_s);
        let course = sums(&self.courses, &block.causes, flow.degree);
        let (kpa, end) = course.split_at(TERMS);
        block.kpa.copy_from_slice(kpa);
        block.end.copy_from_slice(end);
    }

    /// Returns the state at a place of a block.
    pub(super) fn at(&self, block: &Block, place: f64) -> Balanced {
        let y = if block.is_long() { sums(&self.of_y, &block.causes, block.degree) } else { block.y };
        let square = place * place;
        let mut sums = [0.0; 4];
        let pairs = block.kpa.as_chunks().0.iter().zip(y.as_chunks().0);
        for ([x, odd_x], [y, odd_y]) in pairs.rev() {
            for (sum, term) in sums.iter_mut().zip([x, odd_x, y, odd_y]) {
                *sum = *sum * square + term;
            }
        }
        let [x, odd_x, y, odd_y] = sums;
        [x + place * odd_x, y + place * odd_y]
    }
}

impl Block {
    /// Returns a block without a length.
    pub(super) fn new() -> Self {
        let (terms, causes) = ([0.0; TERMS], [0.0; CAUSES]);
        Self {
            length_s: 0.0,
            start: 0.0,
            places_per_s: 0.0,
            kpa: terms,
            y: terms,
            end: [0.0; 2],
            causes,
            degree: 0,
        }
    }

    fn begin_short(&mut self, oscillator: &Oscillator, state: Balanced, flow: &Flow, length_s: f64) {
        let mut forcing = flow.c;
        let mut power_s = 1.0;
        for c in &mut forcing {
            *c *= power_s;
            power_s *= length_s;
        }
        let series: [Balanced; TERMS] = taylor(oscillator, length_s, state, forcing);
        (self.length_s, self.start, self.places_per_s) = (length_s, 0.0, 1.0 / length_s);
        for ((x, y), [found_x, found_y]) in self.kpa.iter_mut().zip(&mut self.y).zip(series) {
            (*x, *y) = (found_x, found_y);
        }
        self.end = end(&series);
    }

    fn is_long(&self) -> bool {
        self.start < 0.0
    }

    /// Returns the state at the end.
    pub(super) fn end(&self) -> Balanced {
        self.end
    }

    /// Returns the place of a time since the block's start.
    #[inline]
    pub(super) fn place(&self, since_s: f64) -> f64 {
        since_s * self.places_per_s + self.start
    }

    /// Returns the time of a place since the block's start, s.
    pub(super) fn since_s(&self, place: f64) -> f64 {
        (place - self.start) / self.places_per_s
    }
}

/// Returns the pressures at `places`, kPa.
///
/// Every fourth coefficient belongs to a sum of its own, so that no sum is long.
#[inline(always)]
pub(super) fn pressures(terms: &Terms, places: &[f64; LANES]) -> [f64; LANES] {
    places.map(|place| {
        let square = place * place;
        let fourth = square * square;
        let mut fours = terms.as_chunks().0.iter().rev();
        let mut sums = fours.next().copied().unwrap_or_default();
        for terms in fours {
            for (sum, term) in sums.iter_mut().zip(terms) {
                *sum = *sum * fourth + term;
            }
        }
        let [a, b, c, d] = sums;
        (a + place * b) + square * (c + place * d)
    })
}

/// Returns the sums of the effects of all causes, with a flow of `degree` at most.
#[inline(always)]
fn sums<const N: usize>(effects: &[[f64; N]; CAUSES], causes: &Causes, degree: usize) -> [f64; N] {
    let [x, y, c0, c1, c2, c3, c4, ramp @ ..] = effects;
    let [by_x, by_y, by_c0, by_c1, by_c2, by_c3, by_c4, by_ramp @ ..] = causes;
    let mut sums = [0.0; N];
    for n in 0..N {
        sums[n] = by_x * x[n] + by_y * y[n] + by_c0 * c0[n];
    }
    if degree > 0 {
        for n in 0..N {
            sums[n] = sums[n] + by_c1 * c1[n] + by_c2 * c2[n] + by_c3 * c3[n] + by_c4 * c4[n];
        }
    }
    if degree + 3 > CONSTANT_SPEED {
        for (effects, cause) in ramp.iter().zip(by_ramp) {
            for (sum, effect) in sums.iter_mut().zip(effects) {
                *sum += cause * effect;
            }
        }
    }
    sums
}

/// Returns the coefficients of the flow ((1 + u)/2)^order, which is (t/length)^order at the place u, lowest order
/// first.
fn from_middle(order: usize) -> [f64; DEGREE + 1] {
    let mut c = (0..order).fold(1.0, |c, _| 0.5 * c);
    let mut flow = [0.0; DEGREE + 1];
    for ((j, place), reciprocal) in
        flow.iter_mut().enumerate().zip(RECIPROCALS.iter().skip(1)).take(order + 1)
    {
        *place = c;
        c *= (order - j) as f64 * reciprocal;
    }
    flow
}

/// Returns the Taylor coefficients of the states over parts of `length_s`, from `state` on. So does `flow` count.
fn taylor<const N: usize>(
    oscillator: &Oscillator,
    length_s: f64,
    state: Balanced,
    flow: [f64; DEGREE + 1],
) -> [Balanced; N] {
    let input = oscillator.rate * oscillator.impedance;
    let mut term = state;
    let mut forcing = flow.into_iter();
    let mut series = [[0.0; 2]; N];
    for (place, reciprocal) in series.iter_mut().zip(RECIPROCALS.iter().skip(1)) {
        *place = term;
        let [x, y] = oscillator.times(term);
        let factor = length_s * reciprocal;
        term = [factor * (x + input * forcing.next().unwrap_or(0.0)), factor * y];
    }
    series
}

/// Returns the state at the end of a Taylor series.
fn end(series: &[Balanced]) -> Balanced {
    series.iter().rev().fold([0.0; 2], |sum, z| [sum[0] + z[0], sum[1] + z[1]])
}

/// Returns the coefficients of fewer terms that come closest from -1 to 1.
fn economised(mut series: [Balanced; TAYLOR]) -> impl Iterator<Item = Balanced> {
    for (n, chebyshev) in CHEBYSHEV.iter().enumerate().skip(TERMS).rev() {
        let (lower, rest) = series.split_at_mut(n);
        let Some([dropped_x, dropped_y]) = rest.first() else {
            continue;
        };
        for ([x, y], weight) in lower.iter_mut().rev().skip(1).step_by(2).zip(chebyshev) {
            *x -= weight * dropped_x;
            *y -= weight * dropped_y;
        }
    }
    series.into_iter().take(TERMS)
}

/// Coefficients of Chebyshev's polynomials u^n + ..., by n: those of u^(n-2), u^(n-4) ...
const CHEBYSHEV: [[f64; TAYLOR / 2]; TAYLOR] = {
    let mut table = [[0.0; TAYLOR / 2]; TAYLOR];
    let mut n = 2;
    while n < TAYLOR {
        let (mut j, mut before) = (1, 1.0);
        while 2 * j <= n {
            before *= -(((n - 2 * j + 2) * (n - 2 * j + 1)) as f64) / (4 * j * (n - j)) as f64;
            table[n][j - 1] = before;
            j += 1;
        }
        n += 1;
    }
    table
};

#[cfg(test)]
mod tests {
    use super::*;
    use crate::line::line::Line;
    use crate::port::Port;

    #[test]
    fn blocks_are_the_exact_solution() {
        let lines = [
            Line::PUBLISHED,
            Line { resistance_kpa_s_ml: 0.0, ..Line::PUBLISHED },
            Line { resistance_kpa_s_ml: 30.0, ..Line::PUBLISHED },
        ];
        let flow = |degree: usize| {
            let mut c = [3.0, -40.0, 2e3, 1e5, -3e6, 1e7, -1e9, 1e10, 1e11, -1e13];
            c.iter_mut().skip(degree + 1).for_each(|c| *c = 0.0);
            Flow { c, degree }
        };
        for oscillator in lines.iter().map(|line| Oscillator::new(line, Port::Outlet)) {
            let (mut blocks, mut block) = (Blocks::new(&oscillator), Block::new());
            for (degree, part) in [(0, 0.1), (4, 0.1), (4, 0.6), (DEGREE, 0.9), (DEGREE, 1.0)] {
                let (start, flow, since_s) = ([20.0, -7.0], flow(degree), 0.01);
                let room_s = part * blocks.length_s;
                blocks.begin(&mut block, &oscillator, start, (&flow, since_s), room_s);
                assert_eq!(block.is_long(), degree == 0 || part > 0.5 && degree == 4 || part == 1.0);
                for part in [0.0, 0.05, 0.35, 0.5, 0.7, 0.985, 1.0] {
                    let h = part * block.length_s;
                    let expected = oscillator.after(h, start, &flow.shifted(since_s));
                    let place = block.place(h);
                    let found = blocks.at(&block, place);
                    let size = block.end[0].abs() + block.end[1].abs() + 20.0;
                    for (found, expected) in found.iter().zip(expected) {
                        let off = (found - expected).abs();
                        assert!(off < 1e-14 * size, "{degree}, {part}: {found}, {expected}");
                    }
                    let [kpa, ..] = pressures(&block.kpa, &[place; LANES]);
                    assert!((kpa - found[0]).abs() < 1e-14 * size);
                    if part == 1.0 {
                        assert!(
                            (block.end[0] - found[0]).abs() + (block.end[1] - found[1]).abs() < 1e-14 * size
                        );
                    }
                }
            }
        }
    }
}
