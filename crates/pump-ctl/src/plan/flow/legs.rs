//! The smooth motion through the steps of a flow over time, as legs of constant acceleration.

use pump_model::Leg;

use super::motion::FlowMotion;
use super::stretch::FlowStretch;

/// Parts of a pitch that a leg turns at most.
const PARTS: f64 = 64.0;

/// Most change of the flow per radian in a leg, as a part of it. The flow of a leg is then within 3 % of that of the
/// rows at each moment, and has their volume.
const BENDS: f64 = 0.05;

/// Most halvings of a leg.
const HALVINGS: u32 = 5;

/// Legs of a flow over time. Each begins with the speed that the flow has there, and leads to the next angle in time.
#[derive(Debug, Clone)]
pub struct FlowLegs<'a> {
    motion: FlowMotion<'a>,
    /// Number of the knot at the end of the stretch under way.
    knot: usize,
    /// Stretch under way, and the angle and the time reached in it.
    under_way: Option<(FlowStretch<'a>, f64, f64)>,
}

impl<'a> FlowMotion<'a> {
    /// Returns the smooth motion through the steps as legs. After them the motor holds.
    pub fn legs(&self) -> FlowLegs<'a> {
        FlowLegs { motion: *self, knot: 0, under_way: None }
    }
}

impl Iterator for FlowLegs<'_> {
    type Item = Leg;

    fn next(&mut self) -> Option<Leg> {
        let (stretch, from_rad, from_s) = loop {
            if let Some(reached) = self.under_way.take() {
                break reached;
            }
            self.knot += 1;
            if self.knot >= self.motion.knots.len() {
                return None;
            }
            self.under_way = self.motion.stretch(self.knot).map(|stretch| {
                let from_rad = stretch.angle_at_volume(stretch.before_ml);
                let from_s = stretch.from.time_s;
                (stretch, from_rad, from_s)
            });
        };
        let end_s = stretch.to.time_s;
        let sign = f64::from(self.motion.direction.sign());
        let end_rad = stretch.angle_at_volume(stretch.before_ml + stretch.volume_ml());
        let curve = self.motion.pump.outlet_curve();
        let flow_ml_rad = curve.flow_ml_rad(from_rad);
        let mut most_rad = self.motion.pump.pitch_rad() / PARTS;
        for _ in 0..HALVINGS {
            let change = curve.flow_ml_rad(from_rad + sign * most_rad) / flow_ml_rad - 1.0;
            if change.abs() <= BENDS {
                break;
            }
            most_rad *= 0.5;
        }
        let is_last = (end_rad - from_rad).abs() <= most_rad;
        let to_rad = if is_last { end_rad } else { from_rad + sign * most_rad };
        let to_s = if is_last { end_s } else { stretch.time_at_angle(to_rad).max(from_s) };
        let duration_s = to_s - from_s;
        let speed_rad_s = sign * stretch.speed_rad_s(from_s, from_rad);
        let turn_rad = to_rad - from_rad;
        // Rounding may leave nothing of a stretch.
        let leg = if duration_s > 0.0 {
            let acceleration_rad_s2 = 2.0 * (turn_rad - speed_rad_s * duration_s) / (duration_s * duration_s);
            Leg { start_s: from_s, duration_s, angle_rad: from_rad, speed_rad_s, acceleration_rad_s2 }
        } else {
            Leg { duration_s: 0.0, ..Leg::rest(from_s, from_rad) }
        };
        if !is_last {
            self.under_way = Some((stretch, to_rad, to_s));
        }
        Some(leg)
    }
}
