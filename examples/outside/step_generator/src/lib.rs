//! Steps from hardware: a PIO or a DMA channel makes them, and is fed with intervals in whole ticks.
#![no_std]

use pump_ctl::plan::Plan;
use pump_ctl::step::{Brake, Direction, Segment};

/// Channel that makes a step after each interval that it is fed with.
pub trait Channel {
    /// Feeds an interval, and waits until there is room for it.
    fn feed(&mut self, ticks: u64, direction: Direction);

    /// Returns true once the user asks to stop.
    fn stops(&mut self) -> bool;
}

/// Feeds the steps of `plan`, or those up to a stop and the way to rest. Returns the number of steps.
pub fn run(plan: &Plan, brake: &Brake, channel: &mut impl Channel) -> u64 {
    let (mut made, mut carry) = (0, Segment::CARRY);
    let mut stopped_at = None;
    'steps: for segment in plan.segments(brake.tick_rate()) {
        for (number, ticks) in (1..).zip(segment.intervals(&mut carry)) {
            if made > 0 && channel.stops() {
                stopped_at = Some(segment.interval_before(number));
                break 'steps;
            }
            channel.feed(ticks, segment.direction());
            made += 1;
        }
    }
    for segment in stopped_at.into_iter().flat_map(|interval| brake.descent(interval, plan.direction())) {
        for ticks in segment.intervals(&mut carry) {
            channel.feed(ticks, segment.direction());
            made += 1;
        }
    }
    made
}

#[cfg(test)]
mod tests {
    use pump_ctl::plan::{Cruise, Doser, Limits, Motor, Phase, Request};
    use pump_ctl::step::TickRate;
    use pump_model::Pump;

    use super::*;

    /// Channel that adds up what it is fed with, and stops after some steps.
    struct Sum(u64, u64);

    impl Channel for Sum {
        fn feed(&mut self, ticks: u64, _: Direction) {
            (self.0, self.1) = (self.0 + ticks, self.1.saturating_sub(1));
        }

        fn stops(&mut self) -> bool {
            self.1 == 0
        }
    }

    #[test]
    fn a_dose_takes_its_time_and_a_stop_its_way() {
        let motor = Motor::new(12_800.0, 17.8, 500.0);
        let request = Request::new(25.0, Cruise::Flow { ml_s: 5.0 });
        let pump = Pump::three_roller();
        let plan = Doser::new(&pump, Limits::new(motor)).unwrap().plan(Phase::known(0.3), &request).unwrap();
        let brake = motor.brake(TickRate::from_hz(1_000_000).unwrap()).unwrap();
        let steps = plan.each_step().count() as u64;
        let mut channel = Sum(0, u64::MAX);
        assert_eq!(run(&plan, &brake, &mut channel), steps);
        assert!((channel.0 as f64 - 1e6 * plan.profile().duration_s()).abs() < 2.0);
        let stopped = run(&plan, &brake, &mut Sum(0, 1000));
        assert!((1001..1010).contains(&stopped), "{stopped}");
    }
}
