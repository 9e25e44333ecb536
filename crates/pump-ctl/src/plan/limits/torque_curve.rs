//! The torque that the motor has over its speed.

/// Largest number of points of a [`TorqueCurve`].
pub const TORQUE_POINTS: usize = 8;

/// The torque that the motor has at the pump head over its speed, as straight lines between points.
///
/// ```
/// use pump_ctl::plan::TorqueCurve;
///
/// let curve = TorqueCurve::new(&[(0.0, 1.2), (10.0, 1.0), (20.0, 0.4)]).unwrap();
/// assert!((curve.at(15.0) - 0.7).abs() < 1e-12);
/// assert_eq!(curve.at(21.0), 0.0);
/// // The first point must be at speed 0.
/// assert_eq!(TorqueCurve::new(&[(1.0, 1.2), (10.0, 1.0)]), None);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "StoredCurve"))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct TorqueCurve {
    /// Points (rad/s, N m), rising in speed. The last point fills the places left.
    points: [(f64, f64); TORQUE_POINTS],
}

/// A torque curve as serde reads it, unchecked.
#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
struct StoredCurve {
    points: [(f64, f64); TORQUE_POINTS],
}

#[cfg(feature = "serde")]
impl TryFrom<StoredCurve> for TorqueCurve {
    type Error = &'static str;

    fn try_from(StoredCurve { points }: StoredCurve) -> Result<Self, &'static str> {
        Self::of_places(points).ok_or(
            "the points of a torque curve begin at speed 0, rise in speed and have torques from 0 to 1e6 N m; \
             the last point fills the places left",
        )
    }
}

impl TorqueCurve {
    /// Makes a curve from points (speed in rad/s, torque in N m) at the pump head.
    ///
    /// A curve has 2 to [`TORQUE_POINTS`] points. The first is at speed 0, speeds rise, and torques are 0 to
    /// 1e6. Other points give `None`. Beyond the last speed the motor has no torque.
    pub fn new(points: &[(f64, f64)]) -> Option<Self> {
        let last = points.last()?;
        let mut curve = Self { points: [*last; TORQUE_POINTS] };
        let rising = points.windows(2).all(|two| matches!(two, [a, b] if a.0 < b.0));
        let starts = points.first().is_some_and(|first| first.0 == 0.0);
        let allowed = |(speed, torque): &(f64, f64)| speed.is_finite() && (0.0..=1e6).contains(torque);
        let counts = (2..=TORQUE_POINTS).contains(&points.len());
        for (slot, point) in curve.points.iter_mut().zip(points) {
            *slot = *point;
        }
        (counts && rising && starts && points.iter().all(allowed)).then_some(curve)
    }

    /// Makes a curve from all its places. Returns none of points that [`Self::new`] refuses.
    pub(crate) const fn of_places(points: [(f64, f64); TORQUE_POINTS]) -> Option<Self> {
        let [(mut last_rad_s, mut last_n_m), rest @ ..] = points;
        let mut is_valid = last_rad_s == 0.0 && last_n_m >= 0.0 && last_n_m <= 1e6;
        let mut rest: &[(f64, f64)] = &rest;
        let mut filling = false;
        while let [(speed_rad_s, torque_n_m), others @ ..] = rest {
            let repeats = *speed_rad_s == last_rad_s && *torque_n_m == last_n_m && last_rad_s > 0.0;
            let rises = *speed_rad_s > last_rad_s && speed_rad_s.is_finite() && !filling;
            is_valid = is_valid && (repeats || rises) && *torque_n_m >= 0.0 && *torque_n_m <= 1e6;
            filling = filling || repeats;
            (last_rad_s, last_n_m) = (*speed_rad_s, *torque_n_m);
            rest = others;
        }
        if is_valid { Some(Self { points }) } else { None }
    }

    /// Returns the points in all places (rad/s, N m), rising in speed. The last point fills the places left.
    pub(crate) fn places(&self) -> [(f64, f64); TORQUE_POINTS] {
        self.points
    }

    /// Returns the torque at a speed, N m, not negative. It is 0 beyond the last point.
    pub fn at(&self, speed_rad_s: f64) -> f64 {
        let [.., (last_rad_s, _)] = self.points;
        // A speed at the end of the curve may round to a hair more.
        let rounded = speed_rad_s > last_rad_s && speed_rad_s <= last_rad_s * (1.0 + 1e-9);
        let speed_rad_s = if rounded { last_rad_s } else { speed_rad_s };
        let parts = self.points.iter().zip(self.points.iter().skip(1));
        for ((from, torque), (to, next)) in parts {
            if speed_rad_s <= *to && to > from {
                return torque + (next - torque) * ((speed_rad_s - from) / (to - from));
            }
        }
        0.0
    }

    /// Returns the smallest torque at any speed up to this one, N m.
    pub(in crate::plan) fn least_to(&self, speed_rad_s: f64) -> f64 {
        let below = self.points.iter().filter(|(speed, _)| *speed <= speed_rad_s);
        below.fold(self.at(speed_rad_s), |least, (_, torque)| least.min(*torque))
    }
}
