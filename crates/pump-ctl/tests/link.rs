//! Values that cross a link to an executor come back from postcard's bytes as they were, without an allocator.
#![cfg(feature = "serde")]
#![allow(clippy::unwrap_used, reason = "a test may panic")]

use std::fmt::Debug;

use pump_ctl::drive::{Fault, OnFault, Timer};
use pump_ctl::plan::Motor;
use pump_ctl::step::{
    Action, Brake, Direction, Junction, PushError, Segment, StartError, StopPlan, TickRate, Ticks,
};
use serde::Serialize;
use serde::de::DeserializeOwned;

const MEGAHERTZ: TickRate = TickRate::from_hz(1_000_000).unwrap();

/// Sends a value through bytes. Returns the number of bytes.
fn cross<T: Serialize + DeserializeOwned + PartialEq + Debug>(value: T) -> usize {
    let mut bytes = [0; 2048];
    let sent = postcard::to_slice(&value, &mut bytes).unwrap();
    let (back, rest) = postcard::take_from_bytes::<T>(sent).unwrap();
    assert_eq!(back, value);
    assert!(rest.is_empty());
    sent.len()
}

const SEGMENT: Segment = Segment { count: -40, interval: 123_456, add: -(1 << 40), frac: u32::MAX };

#[test]
fn orders_to_an_executor_come_back_as_they_were() {
    for segment in [
        SEGMENT,
        Segment::default(),
        Segment { count: i32::MIN, interval: u64::MAX, add: i64::MIN, frac: u32::MAX },
    ] {
        // Postcard's largest numbers of 32, 64, 64 and 32 bits take 5, 10, 10 and 5 bytes.
        assert!(cross(segment) <= 30);
    }
    let brake: Brake = Motor::new(12_800.0, 17.8, 500.0).brake(MEGAHERTZ).unwrap();
    cross(brake);
    cross((MEGAHERTZ, Ticks { whole: u64::MAX, frac: 1 }, OnFault::Disable));
}

#[test]
fn answers_of_an_executor_come_back_as_they_were() {
    for direction in [Direction::Forward, Direction::Reverse] {
        cross(Action::Step { direction, next: u64::MAX });
    }
    for action in [Action::Wait, Action::Starved, Action::Done] {
        cross(action);
    }
    cross((Timer::At(1 << 50), Timer::Done));
    cross(StopPlan { last_step_at: u64::MAX, final_count: i64::MIN });
    cross(Some(Junction { position: -9000, at: 1 << 40, interval: 333 }));
}

#[test]
fn faults_and_refusals_come_back_as_they_were() {
    let kilohertz = TickRate::from_hz(1000).unwrap();
    let refused = [
        PushError::Full,
        PushError::Segment(SEGMENT),
        PushError::TickRate { segments: kilohertz, brake: MEGAHERTZ },
        PushError::Beyond { end: -1, reaches: i64::MAX },
        PushError::Finished,
        PushError::Stopped,
    ];
    for error in refused {
        cross(error);
        cross(Fault::<u8>::Push(error));
    }
    for error in [StartError::Empty, StartError::Moving, StartError::Stopped] {
        cross(Fault::<u8>::Start(error));
    }
    cross(Fault::Motor { error: 7_u8, position: -3 });
    cross(Fault::<u8>::Starved { position: i64::MIN });
    cross(Fault::<u8>::Late { late_ticks: 12, position: 5 });
    cross(Fault::<u8>::NotEnabled);
}
