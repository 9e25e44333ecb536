//! A board and a rotor that know the truth: where the rollers stand, and what each step delivers.

use std::any::Any;
use std::panic::resume_unwind;
use std::sync::{Arc, Mutex};

use pump_bench::drives::{
    Abilities, Disturbance, Drive, DriveError, DriveFault, Gate, IndexSearch, Leave, Watch,
};
use pump_ctl::plan::Plan;
use pump_model::Pump;

/// A SplitMix64 generator (Steele, Lea, Flood, OOPSLA 2014).
#[derive(Debug)]
pub(crate) struct Dice(pub(crate) u64);

impl Dice {
    /// Returns the next number in [0, 1).
    pub(crate) fn part(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub(crate) fn chance(&mut self, part: f64) -> bool {
        self.part() < part
    }

    /// Returns a number from 0 to `most`.
    pub(crate) fn up_to(&mut self, most: u64) -> u64 {
        ((self.part() * (most + 1) as f64) as u64).min(most)
    }

    /// Returns a number in [-1, 1).
    pub(crate) fn either_way(&mut self) -> f64 {
        2.0 * self.part() - 1.0
    }
}

/// End of the motions of an operation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Fate {
    Completes,
    /// The user stops the motion at this look.
    Stops(u64),
    /// The process dies at this look.
    Dies(u64),
    /// The drive fails at this look.
    Fails(u64),
    /// The cable is pulled at this look, so that nobody can ask for the count.
    Unplugs(u64),
    /// The drive fails at this look, and its count disagrees.
    Derails(u64),
}

/// One motion that was made.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Motion {
    /// Volume that it delivered, in mL, negative in reverse.
    pub(crate) volume_ml: f64,
    /// Volume that a tube as the pump file has it would have delivered, in mL.
    pub(crate) uncalibrated_ml: f64,
}

/// The truth.
#[derive(Debug)]
pub(crate) struct Plant {
    /// Pump of the drawing. Tests of `pump-ctl` hold its volume over the angle against a quadrature of their own.
    pub(crate) pump: Pump,
    /// Volume of the tube in the head, as a part of the drawing's.
    pub(crate) factor: f64,
    pub(crate) angle_rad: f64,
    pub(crate) count: i64,
    pub(crate) has_count: bool,
    /// True if the board tells each reset, so that its count of zero is one as any other.
    pub(crate) tells_resets: bool,
    /// False once the cable is pulled, until it is met again.
    pub(crate) is_reachable: bool,
    /// True if the board lets the motor go after each motion.
    pub(crate) lets_go: bool,
    pub(crate) fall_rad: f64,
    pub(crate) event: Option<Disturbance>,
    pub(crate) fate: Fate,
    pub(crate) motions: Vec<Motion>,
    /// Angle, count and step angle (signed) of a motion during which the process died.
    pub(crate) died_in: Option<(f64, i64, f64)>,
    pub(crate) dice: Dice,
}

impl Plant {
    fn turn(&mut self, turn_rad: f64, steps: i64) {
        let curve = self.pump.outlet_curve();
        let uncalibrated_ml = curve.volume_ml(self.angle_rad + turn_rad) - curve.volume_ml(self.angle_rad);
        self.angle_rad += turn_rad;
        self.count += steps;
        self.motions.push(Motion { volume_ml: self.factor * uncalibrated_ml, uncalibrated_ml });
    }

    /// Ends the motion in which the process died after `made` steps.
    pub(crate) fn dead_after(&mut self, made: u64) {
        let (angle_rad, count, step_rad) = self.died_in.take().unwrap();
        (self.angle_rad, self.count) = (angle_rad, count);
        self.turn(made as f64 * step_rad, made as i64 * step_rad.signum() as i64);
        self.after_motion();
    }

    pub(crate) fn falls(&mut self) {
        self.angle_rad += self.fall_rad * self.dice.either_way();
    }

    /// Disturbs the rotor. A rotor that was let go twice unheard may have fallen twice, which no device can tell:
    /// here it falls once.
    pub(crate) fn disturb(&mut self, event: Disturbance) {
        if self.event.replace(event).is_none() {
            self.falls();
        }
    }

    fn after_motion(&mut self) {
        if self.lets_go {
            self.disturb(Disturbance::Disabled);
        }
    }
}

/// Payload of a panic that stands for the end of the process.
pub(crate) struct Killed;

impl Killed {
    pub(crate) fn is(payload: &(dyn Any + Send)) -> bool {
        payload.is::<Self>()
    }
}

#[derive(Debug, Clone)]
pub(crate) struct Board(pub(crate) Arc<Mutex<Plant>>);

impl Drive for Board {
    fn id(&self) -> &str {
        "board"
    }

    fn abilities(&self) -> Abilities {
        Abilities::new()
            .with_step_times(true)
            .with_angle_dependent_speed(true)
            .with_readback(true)
            .with_tells_resets(self.0.lock().unwrap().tells_resets)
            .with_release(true)
    }

    fn count(&self) -> Option<i64> {
        let plant = self.0.lock().unwrap();
        (plant.has_count && plant.is_reachable).then_some(plant.count)
    }

    fn disturbed(&mut self) -> Option<Disturbance> {
        self.0.lock().unwrap().event.take()
    }

    fn run(&mut self, plan: &Plan, gate: &mut Gate<'_>) -> Result<u64, DriveFault> {
        let (all, way) = (plan.steps().unsigned_abs(), plan.steps().signum());
        let mut plant = self.0.lock().unwrap();
        let fate = plant.fate;
        let ends = |plant: &mut Plant, made: u64| {
            plant.turn(way as f64 * made as f64 * plan.step_rad(), way * made as i64);
            plant.after_motion();
        };
        let (mut made, mut looks) = (0, 0);
        while made < all {
            let next = (made + 50).min(all);
            if fate == Fate::Dies(looks) {
                plant.died_in = Some((plant.angle_rad, plant.count, way as f64 * plan.step_rad()));
                drop(plant);
                resume_unwind(Box::new(Killed));
            }
            let stop = fate == Fate::Stops(looks);
            let leave = loop {
                match gate(made, next) {
                    Leave::Wait => {}
                    leave => break leave,
                }
            };
            if leave == Leave::Stop || stop {
                let slows = plant.dice.up_to(30).min(all - made);
                ends(&mut plant, made + slows);
                return Ok(made + slows);
            }
            if [Fate::Fails(looks), Fate::Unplugs(looks), Fate::Derails(looks)].contains(&fate) {
                let more = plant.dice.up_to(next - made);
                ends(&mut plant, made + more);
                let lost = fate == Fate::Derails(looks);
                if lost {
                    plant.angle_rad += plant.dice.part();
                    plant.count += 7;
                }
                if fate == Fate::Unplugs(looks) {
                    plant.is_reachable = false;
                    plant.disturb(Disturbance::LinkLost);
                }
                let error = DriveError::device("the board is gone");
                let fault = DriveFault::between(made as i64, next as i64, error);
                return Err(if lost { fault.lost() } else { fault });
            }
            (made, looks) = (next, looks + 1);
        }
        ends(&mut plant, all);
        Ok(all)
    }

    fn seek(&mut self, plan: &Plan, gate: &mut Gate<'_>) -> Result<IndexSearch, DriveFault> {
        self.run(plan, gate).map(|made| IndexSearch { made, beyond: None })
    }

    fn settle(&mut self, _settle_s: f64, _watch: &mut Watch<'_>) -> Result<Option<f64>, DriveError> {
        Ok(None)
    }

    fn release(&mut self) -> Result<(), DriveError> {
        Ok(())
    }
}
