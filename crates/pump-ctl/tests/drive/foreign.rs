//! A back end other than a stepper on pins.

use pump_ctl::drive::{Actuator, Fault, OnFault, StepMotor};
use pump_ctl::step::{Direction, Stepper};

use super::wires::Bench;
use super::{MOTOR, TICK_RATE, dose, start, there_and_back, turn, turn_on_time};

/// A servo on a bus. It takes position set-points and loses its link after some of them.
#[derive(Debug, Default)]
struct Servo {
    set_point: i64,
    energised: bool,
    /// Number of set-points until the link is lost, and true if the last one is still obeyed.
    link: Option<(u32, bool)>,
}

/// The loss of the link. It says if the last set-point was still obeyed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct LinkLost {
    made: bool,
}

impl StepMotor for Servo {
    type Error = LinkLost;

    fn step(&mut self, direction: Direction) -> Result<(), LinkLost> {
        assert!(self.energised, "a step without power");
        let made = match &mut self.link {
            Some((0, made)) => Some(*made),
            Some((left, _)) => {
                *left -= 1;
                None
            }
            None => None,
        };
        if made != Some(false) {
            self.set_point += i64::from(direction.sign());
        }
        made.map_or(Ok(()), |made| Err(LinkLost { made }))
    }

    fn made_its_step(&self, error: &LinkLost) -> bool {
        error.made
    }

    fn enable(&mut self) -> Result<(), LinkLost> {
        self.energised = true;
        Ok(())
    }

    fn disable(&mut self) -> Result<(), LinkLost> {
        self.energised = false;
        Ok(())
    }
}

fn enabled(link: Option<(u32, bool)>) -> Actuator<Servo, 256> {
    let servo = Servo { link, ..Servo::default() };
    let mut actuator = Actuator::new(servo, Stepper::new(MOTOR.brake(TICK_RATE).unwrap()), OnFault::Disable);
    actuator.enable().unwrap();
    actuator
}

#[test]
fn any_motion_follows_the_plan() {
    let bench = Bench::default();
    let mut actuator = enabled(None);
    let due = start(&mut actuator, &bench, there_and_back(2.0)).unwrap();
    assert_eq!(turn_on_time(&mut actuator, &bench, due), Ok(()));
    let expected = dose(2.0, 5.0).steps() + dose(-1.0, 5.0).steps();
    assert_eq!((actuator.motor().set_point, actuator.stepper().position()), (expected, expected));
}

#[test]
fn its_own_error_comes_back_and_its_word_on_the_step_is_taken() {
    for made in [false, true] {
        for good in 0..1200 {
            let bench = Bench::default();
            let mut actuator = enabled(Some((good, made)));
            let due = start(&mut actuator, &bench, there_and_back(2.0)).unwrap();
            let end = turn_on_time(&mut actuator, &bench, due);
            let position = actuator.motor().set_point;
            assert_eq!(end, Err(Fault::Motor { error: LinkLost { made }, position }), "{made} {good}");
            assert!(!actuator.motor().energised);
        }
    }
}

#[test]
fn it_is_decelerated_when_called_late() {
    let bench = Bench::default();
    let mut actuator = enabled(None);
    let due = start(&mut actuator, &bench, dose(2.0, 5.0).segments(TICK_RATE)).unwrap();
    let end = turn(&mut actuator, &bench, due, |n| if n == 300 { 10_000 } else { 0 });
    let position = actuator.motor().set_point;
    assert_eq!(end, Err(Fault::Late { late_ticks: 10_000, position }));
    assert!((300..310).contains(&position), "{position}");
    assert!(actuator.motor().energised, "it holds");
}

/// A motor of which nothing is written but its step. It borrows what it counts.
struct Counter<'a>(&'a mut i64);

impl StepMotor for Counter<'_> {
    type Error = core::convert::Infallible;

    fn step(&mut self, direction: Direction) -> Result<(), Self::Error> {
        *self.0 += i64::from(direction.sign());
        Ok(())
    }
}

#[test]
fn a_borrowed_motor_and_a_borrowed_clock_make_a_move_and_come_back() {
    let (mut made, plan, bench) = (0, dose(-0.5, 5.0), Bench::default());
    bench.state().look_ns = [300, 1100];
    let mut counter = Counter(&mut made);
    let stepper = Stepper::<64>::new(MOTOR.brake(TICK_RATE).unwrap());
    let mut actuator = Actuator::new(&mut counter, stepper, OnFault::Hold);
    actuator.enable().unwrap();
    let mut clock = bench.clone();
    let mut feed = plan.segments(TICK_RATE).feed();
    assert_eq!(actuator.run(&mut &mut clock, &mut feed, || false), Ok(()));
    let (_, stepper) = actuator.release();
    assert_eq!((stepper.position(), made), (plan.steps(), plan.steps()));
}
