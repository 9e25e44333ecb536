//! Numbers that a matrix may have as entries: real and complex ones.

use core::ops::{Add, Mul, Sub};

/// Entry of a matrix that [`super::lu::Lu`] factors.
pub(super) trait Entry:
    Copy + PartialEq + core::fmt::Debug + Add<Output = Self> + Mul<Output = Self> + Sub<Output = Self> + 'static
{
    /// Returns a size by which pivots are compared.
    fn size(self) -> f64;
    /// Returns the reciprocal.
    fn reciprocal(self) -> Self;
}

impl Entry for f64 {
    #[inline]
    fn size(self) -> f64 {
        self.abs()
    }
    #[inline]
    fn reciprocal(self) -> Self {
        1.0 / self
    }
}

/// Complex number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Complex {
    pub(super) re: f64,
    pub(super) im: f64,
}

impl Add for Complex {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        Self { re: self.re + other.re, im: self.im + other.im }
    }
}

impl Sub for Complex {
    type Output = Self;
    #[inline]
    fn sub(self, other: Self) -> Self {
        Self { re: self.re - other.re, im: self.im - other.im }
    }
}

impl Mul for Complex {
    type Output = Self;
    #[inline]
    fn mul(self, other: Self) -> Self {
        Self { re: self.re * other.re - self.im * other.im, im: self.re * other.im + self.im * other.re }
    }
}

impl Entry for Complex {
    #[inline]
    fn size(self) -> f64 {
        self.re.abs() + self.im.abs()
    }
    #[inline]
    fn reciprocal(self) -> Self {
        let per_square = 1.0 / (self.re * self.re + self.im * self.im);
        Self { re: self.re * per_square, im: -self.im * per_square }
    }
}
