//! `dose home`, `dose release`, `dose tube --new` and `dose discard`: what is known and what a person says of the rotor, of
//! the tube and of an unfinished dose. Turning the rotor to its mark is `mark.rs`.

use std::io::{self, BufRead, IsTerminal, Write};
use std::ops::ControlFlow;

use pump_bench::Bench;
use pump_bench::bench::{AngleSet, NewTube};
use pump_bench::record::State;
use pump_ctl::plan::Phase;
use pump_model::math::degrees;

use super::dose::{announce, warn, watch};
use crate::failure::{Failure, print};
use crate::options::Options;

/// Options that name the motor.
pub(crate) const DEVICE: [&str; 3] = ["--driver", "--port", "--configure"];

/// Records the angle, or that it is unknown. A journal that cannot be read is moved aside, once all else is well.
pub(crate) fn set(angle_rad: Option<f64>, options: &Options) -> Result<(), Failure> {
    options.accept_only("dose home", &DEVICE)?;
    let bench = options.bench()?;
    let (mut session, AngleSet { state, owed_ml, aside }) = bench.set_angle(angle_rad.map(Phase::known))?;
    warn(&session.notes());
    let aside = aside.map(|aside| format!("the damaged journal is now {}\n", aside.display()));
    print(&format!("{}{}{}", aside.unwrap_or_default(), stands(&bench, &state), zeroed(owed_ml)))
}

/// Finds the angle by the index sensor.
pub(crate) fn sensor(yes: bool, options: &Options) -> Result<(), Failure> {
    options.accept_only("dose home --sensor", &DEVICE)?;
    let bench = options.bench()?;
    let mut session = bench.session()?;
    let owed_ml = session.owed_ml();
    session.index_rad()?;
    warn(&session.notes());
    if !yes {
        let most_ml = bench.model().revolution_ml();
        agree(&format!("the pump turns forward until the sensor answers, and pumps up to {most_ml:.1} mL"))?;
    }
    announce(&bench, options)?;
    let interrupt = watch()?;
    let stopped =
        || if interrupt.signal().is_some() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) };
    match session.seek_index(|_| stopped())? {
        Some(state) => print(&format!("{}{}", stands(&bench, &state), zeroed(owed_ml))),
        None => Err(Failure::Stopped(
            interrupt.signal().unwrap_or(0),
            "stopped by the user before the sensor answered; the rotor is where the record says".to_owned(),
        )),
    }
}

/// Asks a person at a terminal; nobody else can agree.
fn agree(what: &str) -> Result<(), Failure> {
    let refused = |why: &str| Err(Failure::refused(format!("{what}; {why}")));
    if !io::stdin().is_terminal() {
        return refused("nobody is there to agree: say --yes");
    }
    let mut answer = String::new();
    let asked = write!(io::stderr(), "{what}. Go on? [y/N] ")
        .and_then(|()| io::stdin().lock().read_line(&mut answer));
    match asked {
        Ok(_) if ["y", "yes"].contains(&answer.trim().to_lowercase().as_str()) => Ok(()),
        Ok(_) => refused("nobody agreed, and nothing was moved"),
        Err(error) => refused(&format!("the answer could not be read: {error}")),
    }
}

/// Lets go of the rotor.
pub(crate) fn release(options: &Options) -> Result<(), Failure> {
    options.accept_only("dose release", &DEVICE)?;
    let bench = options.bench()?;
    let mut session = bench.session()?;
    session.connect()?;
    warn(&session.notes());
    let state = session.release()?;
    print(&format!("the motor is without current\n{}", stands(&bench, &state)))
}

pub(crate) fn new_tube(options: &Options) -> Result<(), Failure> {
    options.accept_only("dose tube", &DEVICE)?;
    let bench = options.bench()?;
    let mut session = bench.session()?;
    let NewTube { state, worn_ml, owed_ml, unused } = session.new_tube()?;
    let unused = unused.map_or(String::new(), |version| {
        format!("calibration {version} is not used any more; `dose calibrate use {version}` uses it again\n")
    });
    print(&format!(
        "a new tube is on record; the one before pumped {worn_ml:.1} mL\n{}{}{unused}warning: a new tube gives another volume per \
         revolution: calibrate it\nif the rotor was turned by hand, say where it stands with `dose home --set <ANGLE>`\n",
        stands(&bench, &state),
        zeroed(owed_ml)
    ))
}

pub(crate) fn discard(options: &Options) -> Result<(), Failure> {
    options.accept_only("dose discard", &DEVICE)?;
    let bench = options.bench()?;
    let mut session = bench.session()?;
    let owed_ml = session.owed_ml();
    let (state, unasked) = session.discard()?;
    let unasked = unasked.map(|error| format!("the device could not be asked what it has counted: {error}"));
    warn(&unasked.into_iter().chain(session.notes()).collect::<Vec<_>>());
    print(&format!("the unfinished dose is accepted as it is\n{}{}", stands(&bench, &state), zeroed(owed_ml)))
}

pub(crate) fn stands(bench: &Bench, state: &State) -> String {
    if !state.phase().is_known(bench.model().pitch_rad()) {
        return "the rollers stand at an unknown angle; `dose home` finds it, or `dose home --set <ANGLE>` says it\n"
            .to_owned();
    }
    let width = match degrees(state.half_width_rad) {
        0.0 => String::new(),
        width => format!(" ± {width:.2}°"),
    };
    format!("the rollers stand at {:.2}°{width}\n", degrees(state.angle_rad))
}

pub(crate) fn zeroed(owed_ml: f64) -> String {
    match owed_ml {
        0.0 => String::new(),
        owed => format!("warning: {:.2} µL that doses owed are forgotten\n", 1e3 * owed),
    }
}
