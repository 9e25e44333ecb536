//! A dose by a motor that the library does not know: a servo that is sent from position to position.

use std::io;
use std::ops::ControlFlow;

use pump_bench::drives::{Abilities, Drive, DriveError, DriveFault, DriveLimits, Gate, Leave};
use pump_bench::{Bench, DoseReport, DoseRequest, Session, built_in};
use pump_ctl::plan::{Phase, Plan};

/// Bus to a servo. Here your own bus speaks. This one stands for the servo too, and a motion may fail.
#[derive(Debug)]
struct Bus {
    position: i64,
    /// Position at which the servo is stopped once, as by a door that opens.
    stops_at: Option<i64>,
}

impl Bus {
    /// Sends the servo to a position, and waits until it is there.
    fn send_to(&mut self, target: i64) -> io::Result<()> {
        if let Some(stop) = self.stops_at.take_if(|stop| (self.position..target).contains(stop)) {
            self.position = stop;
            return Err(io::Error::other("the servo was stopped"));
        }
        self.position = target;
        Ok(())
    }

    /// Asks the servo for its position.
    fn position(&mut self) -> io::Result<i64> {
        Ok(self.position)
    }
}

/// Servo on a bus. It has ramps of its own, and rests at its target until it is sent on.
#[derive(Debug)]
struct Servo {
    bus: Bus,
    /// Position that the servo told last. `None` if it could not be asked.
    position: Option<i64>,
}

impl Servo {
    /// Asks the servo where it stands.
    fn ask(&mut self) -> io::Result<i64> {
        let told = self.bus.position();
        self.position = told.as_ref().ok().copied();
        told
    }

    /// Sends the servo to a position. Wherever that ends, the servo is asked where it stands.
    fn go_to(&mut self, target: i64) -> io::Result<()> {
        let went = self.bus.send_to(target);
        let stands = self.ask();
        went.and(stands.map(drop))
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

    // The session compares the count after a fault with the record, so it must be the servo's own.
    fn count(&self) -> Option<i64> {
        self.position
    }

    fn connect(&mut self) -> Result<(), DriveError> {
        self.ask().map(drop).map_err(DriveError::device)
    }

    fn run(&mut self, plan: &Plan, gate: &mut Gate<'_>) -> Result<u64, DriveFault> {
        let start = self.ask().map_err(|error| DriveFault::at(0, DriveError::device(error)))?;
        let sign = i64::from(plan.direction().sign());
        let (mut made, all) = (0, plan.each_step().count() as u64);
        while made < all {
            let next = (made + 100).min(all);
            match gate(made, next) {
                // Until the next stretch is on record, the servo rests at the end of this one.
                Leave::Wait => continue,
                Leave::Stop => break,
                Leave::Go => {}
            }
            if let Err(error) = self.go_to(start + sign * next as i64) {
                let (least, most) = (made as i64, next as i64);
                let error = DriveError::device(error);
                // A servo that answers tells how far it came. Otherwise nobody knows more than these bounds.
                return Err(match self.position {
                    Some(position) => DriveFault::at(sign * (position - start), error),
                    None => DriveFault::between(least, most, error),
                });
            }
            made = next;
        }
        Ok(made)
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let state = tempfile::tempdir()?;
    let pump = built_in("three-roller").ok_or("a built-in pump")?;
    let bus = Bus { position: 1000, stops_at: Some(1150) };
    let mut servo = Servo { bus, position: None };
    // A motor does not move by the values of a built-in pump until somebody says that they are those of the pump here.
    let bench = Bench::new(pump, None, state.path())?.driven_by(&servo)?.confirming_pump(true);
    let mut session = Session::with_drive(&bench, Box::new(&mut servo))?;
    session.set_angle(Some(Phase::known(0.0)))?;
    let prepared = session.prepare(DoseRequest::dose(5.0))?;
    // The servo is stopped on the way. Its own count tells how far it came, and the rest is made.
    let fault = session.run(&prepared, |_steps| ControlFlow::Continue(()));
    println!("{}", fault.err().ok_or("a servo that is stopped")?);
    let rest = session.prepare_rest(DoseRequest::dose(0.0))?;
    let delivered = session.run(&rest, |_steps| ControlFlow::Continue(()))?;
    let report = DoseReport::new(&bench, &rest, Some(&delivered));
    let planned = prepared.plan.steps();
    drop(session);
    assert!(report.completed && report.driver == "servo" && report.steps == planned - 150);
    assert_eq!(servo.bus.position, 1000 + planned);
    println!("{:.4} mL in {} steps after the first 150", delivered.volume_ml, report.steps);
    Ok(())
}
