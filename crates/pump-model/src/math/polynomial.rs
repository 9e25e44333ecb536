//! Polynomials for roller volumes, flows per radian and dense output.

/// Highest degree of a [`Polynomial`] whose number of coefficients is not stated. The paper's roller volume has it.
pub const DEGREE: usize = 5;

/// Polynomial with `C` coefficients: the sum of `c[n]` x^n.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Polynomial<const C: usize = { DEGREE + 1 }> {
    /// Coefficients, lowest order first.
    pub c: [f64; C],
}

impl Default for Polynomial {
    fn default() -> Self {
        Self::constant(0.0)
    }
}

/// Real roots of a polynomial with `C` coefficients inside an interval, in rising order.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Roots<const C: usize = { DEGREE + 1 }> {
    values: [f64; C],
    count: usize,
}

impl<const C: usize> Default for Roots<C> {
    fn default() -> Self {
        Self { values: [0.0; C], count: 0 }
    }
}

impl<const C: usize> Roots<C> {
    /// Returns the roots, in rising order.
    pub fn as_slice(&self) -> &[f64] {
        self.values.get(..self.count).unwrap_or(&self.values)
    }

    fn push(&mut self, root: f64) {
        // There are fewer roots than coefficients; a double root found twice is kept once.
        if self.as_slice().last() != Some(&root)
            && let Some(slot) = self.values.get_mut(self.count)
        {
            *slot = root;
            self.count += 1;
        }
    }
}

impl<const C: usize> Polynomial<C> {
    /// Returns the value at `x`.
    #[inline]
    pub fn at(&self, x: f64) -> f64 {
        self.c.iter().rev().fold(0.0, |sum, c| sum * x + c)
    }

    /// Returns the first derivative at `x`.
    #[inline]
    pub(crate) fn slope_at(&self, x: f64) -> f64 {
        self.c.iter().enumerate().skip(1).rev().fold(0.0, |sum, (n, c)| sum * x + n as f64 * c)
    }

    /// Returns the first derivative.
    #[must_use]
    pub const fn derivative(&self) -> Self {
        let mut c = [0.0; C];
        let mut n = 1;
        while n < C {
            c[n - 1] = n as f64 * self.c[n];
            n += 1;
        }
        Self { c }
    }

    /// Returns the integral from 0 to `x`.
    #[cfg(feature = "experimental")]
    pub(crate) fn integral_to(&self, x: f64) -> f64 {
        let terms = self.c.iter().enumerate().rev();
        terms.fold(0.0, |sum, (order, c)| (sum + c / (order + 1) as f64) * x)
    }

    /// Returns `factor p(x)`.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        Self { c: self.c.map(|c| c * factor) }
    }

    /// Returns the sum of this polynomial and another.
    #[must_use]
    pub fn plus(&self, other: &Self) -> Self {
        let mut sum = *self;
        for (to, from) in sum.c.iter_mut().zip(other.c) {
            *to += from;
        }
        sum
    }

    /// Returns `p(start + length x)` as a polynomial in `x`.
    fn over(&self, start: f64, length: f64) -> Self {
        let mut c = self.c;
        shift_coefficients(&mut c, start);
        stretch_coefficients(&mut c, length);
        Self { c }
    }

    /// Returns the real roots in `[low, high]`, simple ones to the last bits. A root where the polynomial
    /// only touches zero is found if its computed value there is exactly zero.
    pub fn roots_in(&self, low: f64, high: f64) -> Roots<C> {
        if self.over(low, high - low).keeps_its_sign() {
            return Roots::default();
        }
        let mut derivatives = [*self; C];
        let mut last = *self;
        for derivative in derivatives.iter_mut().skip(1) {
            last = last.derivative();
            *derivative = last;
        }
        // Between two neighbouring roots of its derivative a polynomial is monotone, so it has at most one
        // root there. The search starts from the constant last derivative and climbs.
        let mut roots = Roots::default();
        for polynomial in derivatives.iter().rev() {
            let mut next = Roots::default();
            let mut left = low;
            for &right in roots.as_slice().iter().chain(core::iter::once(&high)) {
                if let Some(root) = polynomial.monotone_root(left, right) {
                    next.push(root);
                }
                left = right;
            }
            roots = next;
        }
        roots
    }

    /// True if all control points over [0, 1] lie on one side of zero; then the polynomial does too.
    ///
    /// A polynomial lies within the hull of its Bernstein coefficients (Farouki, "The Bernstein polynomial
    /// basis: a centennial retrospective", Computer Aided Geometric Design 29, 2012). The answer is no where
    /// rounding might decide.
    fn keeps_its_sign(&self) -> bool {
        let mut points = self.c;
        let mut size = 0.0;
        for (point, binomial) in points.iter_mut().zip(const { binomials::<C>() }) {
            size += point.abs();
            *point /= binomial;
        }
        for done in 1..C {
            let mut before = 0.0;
            for (n, point) in points.iter_mut().enumerate() {
                let here = *point;
                if n >= done {
                    *point += before;
                }
                before = here;
            }
        }
        let noise = 1e-14 * size;
        points.iter().all(|point| *point > noise) || points.iter().all(|point| *point < -noise)
    }

    /// Returns the root in `[low, high]` of a polynomial that is monotone there; none for the zero
    /// polynomial.
    fn monotone_root(&self, low: f64, high: f64) -> Option<f64> {
        let (at_low, at_high) = (self.at(low), self.at(high));
        if at_low == 0.0 && at_high == 0.0 {
            return None;
        }
        if at_low == 0.0 {
            return Some(low);
        }
        if at_high == 0.0 {
            return Some(high);
        }
        if (at_low > 0.0) == (at_high > 0.0) {
            return None;
        }
        Some(self.solve_monotone(0.0, low, high))
    }

    /// Returns the `x` in `[low, high]` at which the monotone polynomial is `value`; the nearer end if
    /// `value` is outside.
    ///
    /// Newton's method is kept inside a bracket that bisection shrinks.
    pub fn solve_monotone(&self, value: f64, low: f64, high: f64) -> f64 {
        let (at_low, at_high) = (self.at(low), self.at(high));
        let rising = at_high >= at_low;
        if (value <= at_low) == rising {
            return low;
        }
        if (value >= at_high) == rising {
            return high;
        }
        let slope = self.derivative();
        let (mut low, mut high) = (low, high);
        let mut x = 0.5 * (low + high);
        for _ in 0..100 {
            let excess = self.at(x) - value;
            if excess == 0.0 {
                break;
            }
            if (excess > 0.0) == rising {
                high = x;
            } else {
                low = x;
            }
            let newton = x - excess / slope.at(x);
            let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
            if next == x || next <= low || next >= high {
                break;
            }
            x = next;
        }
        x
    }

    /// Returns the smallest and largest value in `[low, high]` and their places: `((x, min), (x, max))`.
    pub fn range_in(&self, low: f64, high: f64) -> ((f64, f64), (f64, f64)) {
        let mut smallest = (low, self.at(low));
        let mut largest = smallest;
        let critical = self.derivative().roots_in(low, high);
        for &x in critical.as_slice().iter().chain(core::iter::once(&high)) {
            let value = self.at(x);
            if value < smallest.1 {
                smallest = (x, value);
            }
            if value > largest.1 {
                largest = (x, value);
            }
        }
        (smallest, largest)
    }
}

impl Polynomial {
    /// Returns the polynomial that is `value` everywhere.
    pub fn constant(value: f64) -> Self {
        Self { c: [value, 0.0, 0.0, 0.0, 0.0, 0.0] }
    }

    /// Returns true if every coefficient is finite.
    pub(crate) const fn is_finite(&self) -> bool {
        let [c0, c1, c2, c3, c4, c5] = self.c;
        // A sum with zero is NaN where one of them is not finite.
        let sum = 0.0 * c0 + 0.0 * c1 + 0.0 * c2 + 0.0 * c3 + 0.0 * c4 + 0.0 * c5;
        !sum.is_nan()
    }

    /// Returns `p(x + shift)` as a polynomial in `x`.
    #[must_use]
    pub fn shifted(&self, shift: f64) -> Self {
        let mut shifted = *self;
        shift_coefficients(&mut shifted.c, shift);
        shifted
    }

    /// Returns `p(factor x)` as a polynomial in `x`.
    #[must_use]
    pub fn stretched(&self, factor: f64) -> Self {
        let mut stretched = *self;
        stretch_coefficients(&mut stretched.c, factor);
        stretched
    }

    /// Returns true if the polynomial is positive throughout [0, `length`].
    ///
    /// The control points of halves of the interval come as near to the polynomial as is needed (de Casteljau's
    /// algorithm; Farouki 2012).
    #[inline(never)]
    pub(crate) const fn is_positive_to(&self, length: f64) -> bool {
        const BINOMIALS: [f64; DEGREE + 1] = binomials();
        let mut points = self.c;
        let mut power = 1.0;
        let mut n = 0;
        while n <= DEGREE {
            points[n] *= power / BINOMIALS[n];
            power *= length;
            n += 1;
        }
        let mut done = 1;
        while done <= DEGREE {
            let mut before = points[done - 1];
            let mut n = done;
            while n <= DEGREE {
                let here = points[n];
                points[n] += before;
                before = here;
                n += 1;
            }
            done += 1;
        }
        are_positive(points, 30)
    }
}

/// Returns true if the polynomial with these control points is positive throughout, which halving `depth` times
/// must show.
#[inline(never)]
const fn are_positive(points: [f64; DEGREE + 1], depth: u32) -> bool {
    // A comparison with what is not a number is false.
    let are_ends = points[0] > 0.0 && points[DEGREE] > 0.0;
    if !are_ends {
        return false;
    }
    let (mut all, mut n) = (true, 1);
    while n < DEGREE {
        all = all && points[n] > 0.0;
        n += 1;
    }
    if all || depth == 0 {
        return all;
    }
    let (mut left, mut right) = (points, points);
    let mut n = 1;
    while n <= DEGREE {
        let mut m = 0;
        while m + n <= DEGREE {
            right[m] = 0.5 * (right[m] + right[m + 1]);
            m += 1;
        }
        left[n] = right[0];
        n += 1;
    }
    are_positive(left, depth - 1) && are_positive(right, depth - 1)
}

/// Turns the coefficients of p(x), lowest order first, into those of p(x + shift), by repeated Horner
/// division (Taylor shift).
pub(crate) fn shift_coefficients(c: &mut [f64], shift: f64) {
    let Some((highest, lower)) = c.split_last_mut() else {
        return;
    };
    for stop in 0..lower.len() {
        let mut above = *highest;
        for c in lower.iter_mut().skip(stop).rev() {
            *c += shift * above;
            above = *c;
        }
    }
}

/// Returns the coefficients of p(x + shift) for those of p(x), lowest order first, as [`shift_coefficients`] does.
#[inline]
pub(crate) fn shifted_quartic([mut c0, mut c1, mut c2, mut c3, c4]: [f64; 5], shift: f64) -> [f64; 5] {
    c3 += shift * c4;
    c2 += shift * c3;
    c1 += shift * c2;
    c0 += shift * c1;
    c3 += shift * c4;
    c2 += shift * c3;
    c1 += shift * c2;
    c3 += shift * c4;
    c2 += shift * c3;
    c3 += shift * c4;
    [c0, c1, c2, c3, c4]
}

/// Turns the coefficients of p(x), lowest order first, into those of p(factor x).
fn stretch_coefficients(c: &mut [f64], factor: f64) {
    let mut power = 1.0;
    for c in c {
        *c *= power;
        power *= factor;
    }
}

/// Returns the binomial coefficients of a polynomial with `C` coefficients.
const fn binomials<const C: usize>() -> [f64; C] {
    let mut row = [1.0; C];
    let mut n = 1;
    while n < C {
        row[n] = row[n - 1] * (C - n) as f64 / n as f64;
        n += 1;
    }
    row
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn five_roots_are_found_to_the_last_bits() {
        // (x-1)(x-2)(x-3)(x-4)(x-5)
        let p = Polynomial { c: [-120.0, 274.0, -225.0, 85.0, -15.0, 1.0] };
        let roots = p.roots_in(0.0, 6.0);
        assert_eq!(roots.as_slice().len(), 5);
        for (root, expected) in roots.as_slice().iter().zip([1.0, 2.0, 3.0, 4.0, 5.0]) {
            assert!((root - expected).abs() < 1e-11, "{root}");
        }
        assert_eq!(p.roots_in(2.5, 4.5).as_slice().len(), 2);
        assert!(Polynomial::constant(1.0).roots_in(0.0, 1.0).as_slice().is_empty());
        assert!(Polynomial::default().roots_in(0.0, 1.0).as_slice().is_empty());
    }

    #[test]
    fn control_points_on_one_side_mean_no_root() {
        // (x - 2)² + 0.1 and 1 - x⁵ / 2 have none in [0, 1]; x - 1/2 and 3x² - 3x + 0.7 cross or nearly touch
        // zero.
        assert!(Polynomial { c: [4.1, -4.0, 1.0, 0.0, 0.0, 0.0] }.keeps_its_sign());
        assert!(Polynomial { c: [-1.0, 0.0, 0.0, 0.0, 0.0, 0.5] }.keeps_its_sign());
        assert!(!Polynomial { c: [-0.5, 1.0, 0.0, 0.0, 0.0, 0.0] }.keeps_its_sign());
        assert!(!Polynomial { c: [0.7, -3.0, 3.0, 0.0, 0.0, 0.0] }.keeps_its_sign());
        assert!(!Polynomial::default().keeps_its_sign());
    }

    #[test]
    fn shifting_and_stretching_agree_with_evaluation() {
        let p = Polynomial { c: [0.3, -1.0, 2.0, 0.7, -0.2, 0.05] };
        for x in [-1.3, 0.0, 0.4, 2.0] {
            assert!((p.shifted(0.7).at(x) - p.at(x + 0.7)).abs() < 1e-13);
            assert!((p.stretched(-2.0).at(x) - p.at(-2.0 * x)).abs() < 1e-11);
        }
    }

    #[test]
    fn a_value_outside_the_range_gives_the_nearer_end() {
        let p = Polynomial { c: [0.0, 1.0, 0.0, 1.0, 0.0, 0.0] };
        assert_eq!(p.solve_monotone(5.0, 0.0, 1.0), 1.0);
        assert_eq!(p.solve_monotone(-5.0, 0.0, 1.0), 0.0);
        assert!((p.solve_monotone(0.625, 0.0, 1.0) - 0.5).abs() < 1e-15);
    }
}
