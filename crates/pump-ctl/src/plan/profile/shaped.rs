//! Profiles whose ramps have a shape.

use super::course::Course;
use super::down::Down;
use super::envelope::Envelope;
use super::profile::Profile;
use super::shape::Shape;

impl Profile {
    /// Makes the profile below a constant limit whose ramps have a shape.
    pub(super) fn shaped(course: Course, shape: Shape, cruise_rad_s: f64) -> Self {
        let Course { start_rad_s, turn_rad, .. } = course;
        let Shape { up_s, down_s: [first_s, last_s], between } = shape;
        let plateau_rad_s = shape.plateau_rad_s(&course, cruise_rad_s).max(0.0);
        let between_rad_s = between * plateau_rad_s;
        let ramp_rad = 0.5 * (start_rad_s + plateau_rad_s) * up_s;
        let between_rad = turn_rad - 0.5 * between_rad_s * last_s;
        let left_rad = between_rad - 0.5 * (plateau_rad_s + between_rad_s) * first_s;
        let along_s =
            if plateau_rad_s > 0.0 { ((left_rad - ramp_rad) / plateau_rad_s).max(0.0) } else { 0.0 };
        Self {
            course,
            envelope: None,
            phase_rad: 0.0,
            reached_s: 0.0,
            corners_rad: [ramp_rad, left_rad],
            corner_rad_s: [plateau_rad_s; 2],
            ramp_s: up_s,
            along_s,
            ramp_rad_s2: (plateau_rad_s - start_rad_s) / up_s,
            down: Down {
                legs_s: [first_s, last_s],
                legs_rad_s2: [(plateau_rad_s - between_rad_s) / first_s, between_rad_s / last_s],
                between_rad,
                between_rad_s,
            },
            reaches_limit: plateau_rad_s >= cruise_rad_s,
        }
    }

    /// Makes the profile below an envelope whose ramps have a shape, as for a plateau of the envelope's mean.
    ///
    /// A gentle ramp may be less steep than the envelope. So the motion leaves the envelope for good where the
    /// way down, followed back from the end, first meets it. The way up ends where it first meets it. A rotor
    /// that turns already goes to the envelope as fast as it can.
    pub(super) fn shaped_along(course: Course, shape: Shape, envelope: Envelope, phase_rad: f64) -> Self {
        let Course { start_rad_s, turn_rad, .. } = course;
        let mean_rad_s = envelope.mean_rad_s();
        let short = || {
            // The dose is over before it flows smoothly.
            Self {
                envelope: Some(envelope),
                phase_rad,
                ..Self::shaped(course, shape, mean_rad_s).unreached()
            }
        };
        // A short turn has a shape for the speed that a constant limit lets it reach, which is less than the mean.
        let Shape { up_s, down_s: [first_s, last_s], between } = shape.within(&course, mean_rad_s);
        let end_rad = phase_rad + turn_rad;
        let (reached_rad, ramp_rad_s2) = if start_rad_s > 0.0 {
            let fastest = Self::along(Course { shape: None, ..course }, envelope, phase_rad);
            if !fastest.reaches_limit {
                return fastest;
            }
            (phase_rad + fastest.corners_rad[0], fastest.ramp_rad_s2)
        } else {
            let ramp_rad_s2 = mean_rad_s / up_s;
            let line = |angle_rad: f64| 2.0 * ramp_rad_s2 * (angle_rad - phase_rad);
            match envelope.meeting(phase_rad, end_rad, line) {
                Some(reached_rad) => (reached_rad, ramp_rad_s2),
                None => return short(),
            }
        };
        let between_rad_s = between * mean_rad_s;
        let legs_rad_s2 = [(mean_rad_s - between_rad_s) / first_s, between_rad_s / last_s];
        let between_rad = end_rad - 0.5 * between_rad_s * last_s;
        let last = |angle_rad: f64| 2.0 * legs_rad_s2[1] * (end_rad - angle_rad);
        let first =
            |angle_rad: f64| between_rad_s * between_rad_s + 2.0 * legs_rad_s2[0] * (between_rad - angle_rad);
        let in_last = envelope.meeting(end_rad, between_rad.max(reached_rad), last);
        let in_first = || envelope.meeting(between_rad, reached_rad, first);
        let Some(left_rad) = in_last.or_else(|| if between_rad > reached_rad { in_first() } else { None })
        else {
            return short();
        };
        let corner_rad_s = [reached_rad, left_rad].map(|angle_rad| envelope.speed_at(angle_rad));
        let down = if in_last.is_some() {
            let time_s = corner_rad_s[1] / legs_rad_s2[1];
            Down::plain(left_rad - phase_rad, corner_rad_s[1], time_s, legs_rad_s2[1])
        } else {
            let first_s = (corner_rad_s[1] - between_rad_s) / legs_rad_s2[0];
            let between_rad = between_rad - phase_rad;
            Down { legs_s: [first_s, last_s], legs_rad_s2, between_rad, between_rad_s }
        };
        let reached_s = envelope.time_at(reached_rad);
        Self {
            course,
            envelope: Some(envelope),
            phase_rad,
            reached_s,
            corners_rad: [reached_rad - phase_rad, left_rad - phase_rad],
            corner_rad_s,
            ramp_s: (corner_rad_s[0] - start_rad_s) / ramp_rad_s2,
            along_s: envelope.time_at(left_rad) - reached_s,
            ramp_rad_s2,
            down,
            reaches_limit: true,
        }
    }

    /// Returns the profile as one that does not reach its limit.
    fn unreached(self) -> Self {
        Self { reaches_limit: false, ..self }
    }
}
