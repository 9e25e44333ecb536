//! A motor in real time, the drops that fall from its tube, and the balance under the vessel.

use std::sync::{Arc, Mutex};
use std::thread::sleep;
use std::time::{Duration, Instant};

use pump_bench::balance::{Balance, BalanceError, BalanceReading};
use pump_bench::drives::{Drive, DriveFault, Gate, Leave, StopRequest};
use pump_ctl::plan::Plan;
use pump_model::Pump;

/// Fault of the balance once the pump has delivered a part.
#[derive(Debug, Clone, Copy, PartialEq)]
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
}

/// Truth about pump, nozzle, vessel and balance.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Truth {
    /// True volume over the model's.
    pub(crate) factor: f64,
    /// Angle at which the rollers stand at first, rad.
    pub(crate) start_rad: f64,
    /// Grams on a balance for each mL.
    pub(crate) g_ml: f64,
    /// Volume of a drop, mL.
    pub(crate) drop_ml: f64,
    /// Volume that hangs at the nozzle at first, mL.
    pub(crate) hangs_ml: f64,
    /// Time in which a drop falls, s.
    pub(crate) fall_s: f64,
    /// Time constant of the balance's filter, s.
    pub(crate) lag_s: f64,
    /// Step of the balance's last digit, g.
    pub(crate) digit_g: f64,
    pub(crate) defect: Defect,
    /// Volume delivered from which on the defect shows, mL.
    pub(crate) defect_from_ml: f64,
}

#[derive(Debug)]
struct State {
    truth: Truth,
    /// Angle at which the rollers stand, rad.
    angle_rad: f64,
    /// Volume that has left the tube, mL.
    left_ml: f64,
    hangs_ml: f64,
    /// Masses in the air: when each lands, and how much.
    falling: Vec<(Instant, f64)>,
    landed_g: f64,
    /// Filtered mass, and the instant at which it was last computed.
    shown_g: f64,
    at: Instant,
    /// Readings of the last half second.
    history: Vec<(Instant, f64)>,
    motor_moves: bool,
    /// Steps that the motor made after the balance failed.
    steps: u64,
}

impl State {
    /// Goes on to the present.
    fn advance(&mut self) {
        let now = Instant::now();
        let mut due: Vec<(Instant, f64)> = Vec::new();
        self.falling.retain(|drop| {
            if drop.0 <= now {
                due.push(*drop);
                false
            } else {
                true
            }
        });
        due.sort_by_key(|drop| drop.0);
        for (lands, mass_g) in due {
            self.filter_to(lands.max(self.at));
            self.landed_g += mass_g;
        }
        self.filter_to(now);
    }

    fn filter_to(&mut self, to: Instant) {
        let passed_s = (to - self.at).as_secs_f64();
        self.shown_g += (self.landed_g - self.shown_g) * (1.0 - (-passed_s / self.truth.lag_s).exp());
        self.at = to;
    }

    fn push(&mut self, volume_ml: f64) {
        self.left_ml += volume_ml;
        self.hangs_ml += volume_ml;
        let lands = Instant::now() + Duration::from_secs_f64(self.truth.fall_s);
        while self.hangs_ml >= self.truth.drop_ml {
            self.hangs_ml -= self.truth.drop_ml;
            if self.truth.defect != Defect::TubeOff || self.left_ml < self.truth.defect_from_ml {
                self.falling.push((lands, self.truth.drop_ml * self.truth.g_ml));
            }
        }
    }

    fn fails(&self) -> bool {
        self.truth.defect != Defect::None && self.left_ml >= self.truth.defect_from_ml
    }

    fn reading(&mut self) -> BalanceReading {
        self.advance();
        let digit_g = self.truth.digit_g;
        let removed_g = if self.fails() && self.truth.defect == Defect::Removed { 60.0 } else { 0.0 };
        let mass_g = ((50.0 + self.shown_g - removed_g) / digit_g).round() * digit_g;
        let now = self.at;
        self.history.push((now, mass_g));
        self.history.retain(|(at, _)| now - *at < Duration::from_millis(500));
        BalanceReading { mass_g, step_g: digit_g }
    }
}

/// Motor, nozzle and balance.
#[derive(Debug, Clone)]
pub(crate) struct Plant(Arc<Mutex<State>>);

impl Plant {
    pub(crate) fn new(truth: Truth) -> Self {
        Self(Arc::new(Mutex::new(State {
            truth,
            angle_rad: truth.start_rad,
            left_ml: 0.0,
            hangs_ml: truth.hangs_ml,
            falling: Vec::new(),
            landed_g: 0.0,
            shown_g: 0.0,
            at: Instant::now(),
            history: Vec::new(),
            motor_moves: false,
            steps: 0,
        })))
    }

    pub(crate) fn balance(&self) -> PlantBalance {
        PlantBalance(self.clone())
    }

    pub(crate) fn motor(&self, model: Pump) -> PlantMotor {
        PlantMotor { plant: self.clone(), model }
    }

    /// Mass in the vessel once all drops have fallen, g.
    pub(crate) fn landed_g(&self) -> f64 {
        let state = self.0.lock().unwrap();
        state.landed_g + state.falling.iter().map(|drop| drop.1).sum::<f64>()
    }

    pub(crate) fn left_ml(&self) -> f64 {
        self.0.lock().unwrap().left_ml
    }

    pub(crate) fn steps(&self) -> u64 {
        self.0.lock().unwrap().steps
    }

    pub(crate) fn moves(&self) -> bool {
        self.0.lock().unwrap().motor_moves
    }
}

/// Motor in real time, which looks at its clock every 5 ms.
#[derive(Debug)]
pub(crate) struct PlantMotor {
    plant: Plant,
    model: Pump,
}

impl PlantMotor {
    /// Makes the steps of a plan as they are due. Returns those made.
    fn make(&self, plan: &Plan, gate: &mut Gate<'_>) -> (u64, bool) {
        let (mut made, all, began) = (0, plan.steps().unsigned_abs(), Instant::now());
        let mut steps = plan.each_step().peekable();
        let from_rad = self.plant.0.lock().unwrap().angle_rad;
        let curve = self.model.outlet_curve();
        let (mut last, mut waited) = (0, Duration::ZERO);
        while made < all {
            let now_s = (began.elapsed() - waited).as_secs_f64();
            while steps.next_if(|step| step.time_s <= now_s).is_some() {
                last += 1;
            }
            if last > made {
                let asked = Instant::now();
                loop {
                    match gate(made, last) {
                        Leave::Go => break,
                        Leave::Wait => sleep(Duration::from_millis(1)),
                        Leave::Stop => return (made, true),
                    }
                }
                waited += asked.elapsed();
                made = last;
                let to_rad = from_rad + plan.angle_after(made) - plan.start().angle_rad();
                let mut state = self.plant.0.lock().unwrap();
                let volume_ml = curve.volume_ml(to_rad) - curve.volume_ml(state.angle_rad);
                let factor = state.truth.factor;
                state.push(factor * volume_ml);
                state.steps += 1;
                state.angle_rad = to_rad;
            }
            sleep(Duration::from_millis(5));
        }
        (made, false)
    }
}

impl Drive for PlantMotor {
    fn id(&self) -> &str {
        "plant"
    }

    fn run(&mut self, plan: &Plan, gate: &mut Gate<'_>) -> Result<u64, DriveFault> {
        self.plant.0.lock().unwrap().motor_moves = true;
        let (mut made, stopped) = self.make(plan, gate);
        if stopped && let Some(stop) = plan.stop(&self.model, made) {
            made += self.make(&stop, &mut |_, _| Leave::Go).0;
        }
        self.plant.0.lock().unwrap().motor_moves = false;
        Ok(made)
    }
}

/// Balance under the vessel.
#[derive(Debug)]
pub(crate) struct PlantBalance(Plant);

impl PlantBalance {
    fn read(&self, longest: Duration) -> Result<BalanceReading, BalanceError> {
        let (fails, defect) = {
            let state = self.0.0.lock().unwrap();
            (state.fails(), state.truth.defect)
        };
        let said = |text: &str| text.to_owned();
        match defect {
            Defect::Silent if fails => {
                sleep(longest.min(Duration::from_secs(1)));
                Err(BalanceError::Silent { within: longest })
            }
            Defect::Garbage if fails => Err(BalanceError::Unreadable { said: said("S S  #") }),
            Defect::OtherUnit if fails => Err(BalanceError::Unreadable { said: said("S D  1.9 oz") }),
            Defect::Overload if fails => {
                Err(BalanceError::OutOfRange { state: "overloaded", said: said("S +") })
            }
            _ => Ok(self.0.0.lock().unwrap().reading()),
        }
    }
}

impl Balance for PlantBalance {
    fn read_still(&mut self, longest: Duration, stop: &StopRequest) -> Result<BalanceReading, BalanceError> {
        let until = Instant::now() + longest;
        loop {
            if stop.is_made() {
                return Err(BalanceError::Stopped);
            }
            let reading = self.read(longest)?;
            let state = self.0.0.lock().unwrap();
            let old = state.history.first().is_some_and(|(at, _)| at.elapsed() > Duration::from_millis(300));
            let steady = state.history.iter().all(|(_, mass_g)| (mass_g - reading.mass_g).abs() < 1e-9);
            drop(state);
            if old && steady {
                return Ok(reading);
            }
            if Instant::now() >= until {
                return Err(BalanceError::NotStill { within: longest, last: format!("{}", reading.mass_g) });
            }
            sleep(Duration::from_millis(50));
        }
    }

    fn read_now(&mut self, longest: Duration, _: &StopRequest) -> Result<BalanceReading, BalanceError> {
        sleep(Duration::from_millis(20));
        self.read(longest)
    }
}
