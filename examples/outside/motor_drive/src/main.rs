//! A dose by a motor that the library does not know: a servo that is sent from position to position.

use std::ops::ControlFlow;

use pump_bench::drives::{Abilities, Drive, DriveError, DriveFault, DriveLimits, Gate, Leave};
use pump_bench::{Bench, DoseReport, DoseRequest, Session, built_in};
use pump_ctl::plan::{Phase, Plan};

/// Servo on a bus. It has ramps of its own, and rests at its target until it is sent on.
#[derive(Debug)]
struct Servo {
    position: i64,
}

impl Servo {
    /// Sends the servo to a position. Here your bus speaks.
    fn go_to(&mut self, target: i64) -> std::io::Result<()> {
        self.position = target;
        Ok(())
    }
}

impl Drive for Servo {
    fn id(&self) -> &str {
        "servo"
    }

    fn abilities(&self) -> Abilities {
        Abilities::new().with_readback(true)
    }

    fn limits(&self) -> Option<DriveLimits> {
        Some(DriveLimits::new(10.0, 100.0).with_min_speed(0.01))
    }

    fn count(&self) -> Option<i64> {
        Some(self.position)
    }

    fn run(&mut self, plan: &Plan, gate: &mut Gate<'_>) -> Result<u64, DriveFault> {
        let (start, sign) = (self.position, i64::from(plan.direction().sign()));
        let (mut made, all) = (0, plan.each_step().count() as u64);
        while made < all {
            let next = (made + 100).min(all);
            match gate(made, next) {
                // Until the next stretch is on record, the servo rests at the end of this one.
                Leave::Wait => continue,
                Leave::Stop => break,
                Leave::Go => {}
            }
            self.go_to(start + sign * next as i64)
                .map_err(|error| DriveFault::between(made as i64, next as i64, DriveError::device(error)))?;
            made = next;
        }
        Ok(made)
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let state = tempfile::tempdir()?;
    let pump = built_in("three-roller").ok_or("a built-in pump")?;
    let mut servo = Servo { position: 1000 };
    let bench = Bench::new(pump, None, state.path())?.driven_by(&servo)?;
    let mut session = Session::with_drive(&bench, Box::new(&mut servo))?;
    session.set_angle(Some(Phase::known(0.0)))?;
    let prepared = session.prepare(DoseRequest::dose(5.0))?;
    let delivered = session.run(&prepared, |_steps| ControlFlow::Continue(()))?;
    let report = DoseReport::new(&bench, &prepared, Some(&delivered));
    drop(session);
    assert!(report.completed && report.driver == "servo" && servo.position == 1000 + report.steps);
    println!("{:.4} mL in {} steps", delivered.volume_ml, report.steps);
    Ok(())
}
