//! The pump that really stands behind the board, and what its vessel weighs.

use std::f64::consts::TAU;

use pump_model::{DefaultPulse, Line, Pump};

use crate::simulated::Simulated;
use crate::simulated::options::Options;
use crate::simulated_node::SimulatedNode;

/// Density of water at 25 °C, kg/m³ (Kell, 1975).
const WATER_KG_M3: f64 = 997.047;

/// Density of air at 95.46 kPa, 20 °C and 50 % humidity (ISO 8655-6), and of a balance's weights, kg/m³.
const AIR_KG_M3: f64 = 1.130;
const WEIGHTS_KG_M3: f64 = 8000.0;

/// Board with a motor on its axis X.
pub(crate) trait TrueBoard {
    /// Returns the steps of the motor once it stands.
    fn steps(&self) -> i64;

    /// Returns the device of the board.
    fn device(&self) -> String;
}

impl TrueBoard for Simulated {
    fn steps(&self) -> i64 {
        self.rest().steps
    }

    fn device(&self) -> String {
        self.path().display().to_string()
    }
}

impl TrueBoard for SimulatedNode {
    fn steps(&self) -> i64 {
        while self.truth().moving {
            std::thread::sleep(std::time::Duration::from_millis(10));
        }
        self.truth().steps[0]
    }

    fn device(&self) -> String {
        self.path().display().to_string()
    }
}

/// A pump behind a board.
pub(crate) struct TruePump<B = Simulated> {
    pub(crate) board: B,
    pump: Pump,
    steps_per_rev: f64,
    zero_rad: f64,
    /// Steps of the board at the start of the present dose.
    from: i64,
}

impl TruePump {
    /// Starts a board with a pump of so many mL and steps per revolution. `pulse` is the roller's share of a pitch
    /// and its angle in deg; the rollers stand `zero_rad` from where a roller leaves the outlet.
    pub(crate) fn new(ml_per_rev: f64, steps_per_rev: f64, pulse: (f64, f64), zero_rad: f64) -> Self {
        Self::at(
            Options { time_scale: 20.0, patient: true, ..Options::default() },
            ml_per_rev,
            steps_per_rev,
            pulse,
            zero_rad,
        )
    }

    /// Starts a board that goes on by itself once its command is gone.
    pub(crate) fn left_alone(ml_per_rev: f64, steps_per_rev: f64, pulse: (f64, f64), zero_rad: f64) -> Self {
        Self::at(
            Options { time_scale: 4.0, ..Options::default() },
            ml_per_rev,
            steps_per_rev,
            pulse,
            zero_rad,
        )
    }

    fn at(options: Options, ml_per_rev: f64, steps_per_rev: f64, pulse: (f64, f64), zero_rad: f64) -> Self {
        let board = Simulated::start(options).unwrap();
        Self::behind(board, ml_per_rev, steps_per_rev, pulse, zero_rad)
    }
}

impl<B: TrueBoard> TruePump<B> {
    /// Puts a pump behind `board`, as [`TruePump::new`] does.
    pub(crate) fn behind(
        board: B,
        ml_per_rev: f64,
        steps_per_rev: f64,
        pulse: (f64, f64),
        zero_rad: f64,
    ) -> Self {
        let pulse = DefaultPulse::new(pulse.0, pulse.1);
        let pump = Pump::from_ml_per_rev(ml_per_rev, 4, pulse, Line::PUBLISHED, Line::PUBLISHED).unwrap();
        Self { board, pump, steps_per_rev, zero_rad, from: 0 }
    }

    /// Tares the vessel.
    pub(crate) fn tare(&mut self) {
        self.from = self.board.steps();
    }

    /// Turns of the head since the vessel was tared.
    pub(crate) fn turns(&self) -> f64 {
        (self.board.steps() - self.from) as f64 / self.steps_per_rev
    }

    /// Volume that the vessel received since it was tared, mL.
    pub(crate) fn volume_ml(&self) -> f64 {
        let angle_rad = |steps: i64| self.zero_rad + steps as f64 * TAU / self.steps_per_rev;
        let curve = self.pump.outlet_curve();
        curve.volume_ml(angle_rad(self.board.steps())) - curve.volume_ml(angle_rad(self.from))
    }

    /// Reading of a balance of 0.01 g for that volume, with its buoyancy (OIML R 111-1, C.4).
    pub(crate) fn reading(&self) -> String {
        let buoyant = (1.0 - AIR_KG_M3 / WATER_KG_M3) / (1.0 - AIR_KG_M3 / WEIGHTS_KG_M3);
        format!("{:.2}g", self.volume_ml() * 1e-3 * WATER_KG_M3 * buoyant)
    }

    /// The device of the board.
    pub(crate) fn port(&self) -> String {
        self.board.device()
    }
}
