//! Rows of least squares of which some parameters belong to every recording and others to one alone.
//!
//! A recording's rows are a triangle with its own parameters first. The rows below are free of these, so the shared
//! parameters follow from the lower rows of all recordings, and each recording's own from its upper rows: the matrix
//! of all parameters is never needed (Golub and Van Loan, "Matrix Computations", 4th edition, 4.5: block elimination).

use libm::sqrt;

use super::super::least_squares::Triangle;
use super::super::sought::{ANGLE, N, PRESSURE, START};

/// Number of parameters that all recordings share: ln R, ln C, ln L and the reservoir's pressure.
pub(super) const SHARED: usize = 4;

/// Number of parameters of one recording: angle and start.
pub(super) const OWN: usize = N - SHARED;

/// Order of a recording's parameters, its own first.
const ORDER: [usize; N] = [ANGLE, START, 0, 1, 2, PRESSURE];

/// Returns the parameters of a recording, in the order of the search for one recording.
pub(super) fn joined(shared: &[f64; SHARED], own: &[f64; OWN]) -> [f64; N] {
    [shared[0], shared[1], shared[2], own[0], own[1], shared[3]]
}

/// Rows of a recording, its own parameters first.
#[derive(Debug, Clone, Copy)]
pub(super) struct Block {
    rows: Triangle<N>,
    is_sought: [bool; N],
}

impl Block {
    /// Returns no rows.
    pub(super) fn new() -> Self {
        Self { rows: Triangle::new(), is_sought: [false; N] }
    }

    /// Returns the rows of a recording, each `weight` times as long.
    pub(super) fn of(rows: &Triangle<N>, flags: [bool; N], weight: f64) -> Self {
        let is_sought = ORDER.map(|n| flags[n]);
        let mut block = Self { rows: Triangle::holding(is_sought), is_sought };
        for ((row, right), flag) in rows.rows().zip(flags) {
            // The row of a parameter that is held holds it here too.
            if flag {
                block.rows.push(ORDER.map(|n| weight * row[n]), weight * right);
            }
        }
        block
    }

    /// Returns the lengths of the columns of the shared parameters.
    pub(super) fn shared_lengths(&self) -> [f64; SHARED] {
        let [_, _, shared @ ..] = self.rows.lengths();
        shared
    }

    /// Returns the block with a damping row for each parameter of its own, as long as its column.
    pub(super) fn damped(mut self, damping: f64) -> Self {
        for (n, length) in self.rows.lengths().into_iter().enumerate().take(OWN) {
            self.rows.push(damping_row(n, damping, length), 0.0);
        }
        self
    }

    /// Gives the rows that are free of the recording's own parameters to `shared`.
    pub(super) fn eliminate_into(&self, shared: &mut Triangle<SHARED>) {
        for ((row, right), is_sought) in self.rows.rows().zip(self.is_sought).skip(OWN) {
            if is_sought {
                let [_, _, row @ ..] = *row;
                shared.push(row, right);
            }
        }
    }

    /// Returns the part of the sum of squares by which the best parameters of its own are better than 0.
    pub(super) fn own_gained(&self) -> f64 {
        self.rows.rows().take(OWN).map(|(_, right)| right * right).sum()
    }

    /// Returns the index of a parameter of its own, in the order of the search for one recording, that the others
    /// replace.
    pub(super) fn singular(&self) -> Option<usize> {
        self.rows.singular().filter(|n| *n < OWN).map(|n| ORDER[n])
    }

    /// Returns the parameters of its own that go with the shared ones.
    pub(super) fn own(&self, shared: &[f64; SHARED]) -> [f64; OWN] {
        self.back(|row, right| {
            let [_, _, by_shared @ ..] = row;
            right - by_shared.iter().zip(shared).map(|(by, shared)| by * shared).sum::<f64>()
        })
    }

    /// Returns the change of each parameter of its own with each shared one.
    pub(super) fn responses(&self) -> [[f64; SHARED]; OWN] {
        let mut responses = [[0.0; SHARED]; OWN];
        for n in 0..SHARED {
            for (response, own) in responses.iter_mut().zip(self.back(|row, _| -row[OWN + n])) {
                response[n] = own;
            }
        }
        responses
    }

    /// Returns the covariances of the parameters of its own if the shared ones were known, and each right side had
    /// variance 1; 0 for what is held.
    pub(super) fn own_covariances(&self) -> [[f64; OWN]; OWN] {
        let mut covariances = [[0.0; OWN]; OWN];
        for n in 0..OWN {
            let mut at = 0;
            let column = self.back(|_, _| {
                at += 1;
                // The rows come from the last to the first.
                if OWN - at == n && self.is_sought[n] { 1.0 } else { 0.0 }
            });
            for (row, one) in covariances.iter_mut().zip(column) {
                for (covariance, other) in row.iter_mut().zip(column) {
                    *covariance += one * other;
                }
            }
        }
        covariances
    }

    /// Solves the upper rows for right sides that follow from each row and its own right side.
    fn back(&self, mut right: impl FnMut(&[f64; N], f64) -> f64) -> [f64; OWN] {
        let mut rows = self.rows.rows();
        let (Some((first, first_right)), Some((second, second_right))) = (rows.next(), rows.next()) else {
            return [0.0; OWN];
        };
        let start = right(second, second_right) / second[1];
        [(right(first, first_right) - first[1] * start) / first[0], start]
    }
}

/// Returns the damping row of parameter `n`, whose column has this length.
pub(super) fn damping_row<const K: usize>(n: usize, damping: f64, length: f64) -> [f64; K] {
    // A parameter without effect stays where it is; the caller sees that it has none.
    let length = if length > 0.0 { length } else { 1.0 };
    core::array::from_fn(|k| if k == n { sqrt(damping) * length } else { 0.0 })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns rows of noise whose fifth column, the start, is held if `flags` say so.
    fn rows(flags: [bool; N], seed: u64) -> (Triangle<N>, [([f64; N], f64); 9]) {
        let mut state = seed;
        let mut noise = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 40) as f64 / (1_u64 << 24) as f64 - 0.5
        };
        let mut triangle = Triangle::holding(flags);
        let all = core::array::from_fn(|_| {
            let row = core::array::from_fn(|n| if flags[n] { noise() } else { 0.0 });
            (row, noise())
        });
        for (row, right) in all {
            triangle.push(row, right);
        }
        (triangle, all)
    }

    #[test]
    fn blocks_are_the_matrix_of_all_parameters() {
        const ALL: usize = SHARED + 2 * OWN;
        let flags = [[true; N], [true, true, true, true, false, true]];
        let weights = [1.0, 0.25];
        let (first, second) = (rows(flags[0], 1), rows(flags[1], 2));
        let mut whole = Triangle::<ALL>::holding([true, true, true, false, true, true, true, true]);
        for (place, (_, given)) in [&first, &second].into_iter().enumerate() {
            for (row, right) in given {
                let mut wide = [0.0; ALL];
                (wide[2 * place], wide[2 * place + 1]) = (row[ANGLE], row[START]);
                wide[4..].copy_from_slice(&[row[0], row[1], row[2], row[PRESSURE]]);
                // The shared columns are last here, as in the blocks.
                whole.push(wide.map(|x| weights[place] * x), weights[place] * right);
            }
        }
        // The order of `whole` is angle and start of the first, those of the second, and the shared.
        let mut shared = Triangle::holding([true; SHARED]);
        let blocks = [Block::of(&first.0, flags[0], weights[0]), Block::of(&second.0, flags[1], weights[1])];
        blocks.iter().for_each(|block| block.eliminate_into(&mut shared));
        let near = |one: f64, other: f64| assert!((one - other).abs() < 1e-11, "{one} {other}");
        let (all, found) = (whole.solution().unwrap(), shared.solution().unwrap());
        found.iter().zip(&all[4..]).for_each(|(one, other)| near(*one, *other));
        let (wide, narrow) = (whole.covariances().unwrap(), shared.covariances().unwrap());
        for (place, block) in blocks.iter().enumerate() {
            block.own(&found).iter().zip(&all[2 * place..]).for_each(|(one, other)| near(*one, *other));
            let (responses, own) = (block.responses(), block.own_covariances());
            for n in (0..OWN).filter(|n| block.is_sought[*n]) {
                for k in 0..SHARED {
                    let with_shared: f64 = (0..SHARED).map(|m| responses[n][m] * narrow[m][k]).sum();
                    near(with_shared, wide[2 * place + n][4 + k]);
                }
                for k in (0..OWN).filter(|k| block.is_sought[*k]) {
                    let through: f64 = (0..SHARED)
                        .flat_map(|m| (0..SHARED).map(move |l| (m, l)))
                        .map(|(m, l)| responses[n][m] * narrow[m][l] * responses[k][l])
                        .sum();
                    near(own[n][k] + through, wide[2 * place + n][2 * place + k]);
                }
            }
        }
        let gained = blocks.iter().map(Block::own_gained).sum::<f64>() + shared.gained();
        near(gained, whole.gained());
        assert_eq!(blocks[1].own(&found)[1], 0.0);
        assert_eq!(blocks[1].own_covariances()[1], [0.0; OWN]);
    }
}
