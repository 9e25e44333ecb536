//! The vessel on a simulated balance: drops fall into it, and the balance shows it with a delay.

use std::collections::VecDeque;
use std::f64::consts::TAU;
use std::time::{Duration, Instant};

use pump_model::Pump;

/// Time for which the balance must show one mass before it says that it stands still.
const STILL_FOR: Duration = Duration::from_millis(300);

/// Truth about pump, nozzle, vessel and balance.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Truth {
    /// True volume of the pump over that of its model.
    pub factor: f64,
    /// Angle of the rotor before the motor's first step, rad.
    pub zero_rad: f64,
    /// Motor steps of a revolution.
    pub steps_per_rev: f64,
    /// Grams that the balance shows for each mL.
    pub g_ml: f64,
    /// Volume of a drop, mL.
    pub drop_ml: f64,
    /// Time in which a drop falls, s.
    pub fall_s: f64,
    /// Time constant of the balance's filter, s.
    pub lag_s: f64,
    /// Decimals of a gram that the balance shows.
    pub decimals: usize,
    /// Mass of the empty vessel, g.
    pub vessel_g: f64,
    /// Defect, once the pump has delivered `defect_from_ml`.
    pub defect: Defect,
    pub defect_from_ml: f64,
}

/// Defect of a balance, or of what stands on it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Defect {
    None,
    Silent,
    Garbage,
    OtherUnit,
    Overload,
    /// The vessel is taken away.
    Removed,
    /// Nothing arrives in the vessel.
    TubeOff,
    /// The load never stands still.
    Restless,
}

/// Reading of the balance.
#[derive(Debug, Clone, Copy)]
pub(super) struct Reading {
    pub(super) mass_g: f64,
    pub(super) decimals: usize,
    pub(super) is_still: bool,
}

/// Vessel under the tube of a pump.
#[derive(Debug)]
pub(crate) struct Vessel {
    pump: Pump,
    pub(crate) truth: Truth,
    /// Volume that has left the tube, mL.
    left_ml: f64,
    /// Volume that hangs at the nozzle, mL.
    hangs_ml: f64,
    /// Drops in the air: when each lands, and its mass, g.
    falling: VecDeque<(Instant, f64)>,
    landed_g: f64,
    /// Mass behind the filter, g, and the instant of its last computation.
    filtered_g: f64,
    at: Instant,
    /// Mass that is shown, in steps of the last digit, and since when.
    shown: i64,
    since: Instant,
}

impl Vessel {
    /// Returns an empty vessel under a pump.
    pub(crate) fn new(pump: Pump, truth: Truth) -> Self {
        let now = Instant::now();
        Self {
            pump,
            truth,
            left_ml: 0.0,
            hangs_ml: 0.0,
            falling: VecDeque::new(),
            landed_g: 0.0,
            filtered_g: truth.vessel_g,
            at: now,
            shown: 0,
            since: now,
        }
    }

    /// Returns the true volume that `steps` of the motor deliver from its first one, mL.
    pub(crate) fn delivered_ml(&self, steps: i64) -> f64 {
        self.truth.factor * self.modelled_ml(steps)
    }

    /// Returns the volume of these steps by the pump's model, mL.
    pub(crate) fn modelled_ml(&self, steps: i64) -> f64 {
        let Truth { zero_rad, steps_per_rev, .. } = self.truth;
        let (curve, turned_rad) = (self.pump.outlet_curve(), steps as f64 * TAU / steps_per_rev);
        curve.volume_ml(zero_rad + turned_rad) - curve.volume_ml(zero_rad)
    }

    /// Returns the mass in the vessel once all drops have landed, g.
    pub(crate) fn landed_g(&self) -> f64 {
        self.landed_g + self.falling.iter().map(|drop| drop.1).sum::<f64>()
    }

    /// Goes on to the present, where the motor has made `steps`.
    pub(super) fn advance(&mut self, steps: i64) {
        let now = Instant::now();
        let Truth { g_ml, drop_ml, fall_s, decimals, .. } = self.truth;
        let delivered_ml = self.delivered_ml(steps);
        self.hangs_ml += delivered_ml - self.left_ml;
        self.left_ml = delivered_ml;
        while self.hangs_ml >= drop_ml {
            self.hangs_ml -= drop_ml;
            if self.defect() != Defect::TubeOff {
                self.falling.push_back((now + Duration::from_secs_f64(fall_s), drop_ml * g_ml));
            }
        }
        while let Some((lands, mass_g)) = self.falling.front().copied().filter(|drop| drop.0 <= now) {
            self.falling.pop_front();
            self.filter_to(lands.max(self.at));
            self.landed_g += mass_g;
        }
        self.filter_to(now);
        let shown = (self.filtered_g * 10_f64.powi(decimals as i32)).round() as i64;
        if shown != self.shown {
            (self.shown, self.since) = (shown, now);
        }
    }

    /// Returns the defect that shows now.
    pub(super) fn defect(&self) -> Defect {
        if self.left_ml >= self.truth.defect_from_ml { self.truth.defect } else { Defect::None }
    }

    /// Returns what the balance shows.
    pub(super) fn reading(&self) -> Reading {
        let decimals = self.truth.decimals;
        let is_still = self.defect() != Defect::Restless && self.since.elapsed() >= STILL_FOR;
        Reading { mass_g: self.shown as f64 * 10_f64.powi(-(decimals as i32)), decimals, is_still }
    }

    fn filter_to(&mut self, to: Instant) {
        let passed_s = to.saturating_duration_since(self.at).as_secs_f64();
        let vessel_g =
            if self.defect() == Defect::Removed { 0.0 } else { self.truth.vessel_g + self.landed_g };
        self.filtered_g += (vessel_g - self.filtered_g) * (1.0 - (-passed_s / self.truth.lag_s).exp());
        self.at = to;
    }
}
