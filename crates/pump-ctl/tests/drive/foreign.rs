//! A back end other than a stepper on pins.

use pump_ctl::drive::{Actuator, Fault, Motion, OnFault, StepFault};
use pump_ctl::step::Stepper;

use super::wires::Bench;
use super::{MOTOR, TICK_HZ, dose, start, there_and_back, turn, turn_on_time};

/// A servo on a bus. It takes position set-points and loses its link after some of them.
#[derive(Debug, Default)]
struct Servo {
    set_point: i64,
    energised: bool,
    /// Number of set-points until the link is lost, and true if the last one is still obeyed.
    link: Option<(u32, bool)>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct LinkLost;

impl Motion for Servo {
    type Error = LinkLost;

    fn step(&mut self, direction: i8) -> Result<(), StepFault<LinkLost>> {
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
            self.set_point += i64::from(direction);
        }
        made.map_or(Ok(()), |made| Err(StepFault { error: LinkLost, made }))
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
    let mut actuator = Actuator::new(servo, Stepper::new(MOTOR.brake(TICK_HZ)), OnFault::Disable);
    actuator.enable().unwrap();
    actuator
}

#[test]
fn any_motion_follows_the_plan() {
    let bench = Bench::default();
    let mut actuator = enabled(None);
    let due = start(&mut actuator, &bench, there_and_back(2.0)).unwrap();
    assert_eq!(turn_on_time(&mut actuator, &bench, due), Ok(()));
    let expected = dose(2.0, 5.0).steps + dose(-1.0, 5.0).steps;
    assert_eq!((actuator.motion().set_point, actuator.stepper().position()), (expected, expected));
}

#[test]
fn its_own_error_comes_back_and_its_word_on_the_step_is_taken() {
    for made in [false, true] {
        for good in 0..1200 {
            let bench = Bench::default();
            let mut actuator = enabled(Some((good, made)));
            let due = start(&mut actuator, &bench, there_and_back(2.0)).unwrap();
            let end = turn_on_time(&mut actuator, &bench, due);
            let position = actuator.motion().set_point;
            assert_eq!(end, Err(Fault::Motion { error: LinkLost, position }), "{made} {good}");
            assert!(!actuator.motion().energised);
        }
    }
}

#[test]
fn it_is_decelerated_when_called_late() {
    let bench = Bench::default();
    let mut actuator = enabled(None);
    let due = start(&mut actuator, &bench, dose(2.0, 5.0).segments(TICK_HZ)).unwrap();
    let end = turn(&mut actuator, &bench, due, |n| if n == 300 { 10_000 } else { 0 });
    let position = actuator.motion().set_point;
    assert_eq!(end, Err(Fault::Late { late_ticks: 10_000, position }));
    assert!((300..310).contains(&position), "{position}");
    assert!(actuator.motion().energised, "it holds");
}
