//! `dose home --mark`: a person turns the rotor with the arrow keys until its mark meets the housing's.

use std::io::{self, IsTerminal, Write};

use console::Key;
use pump_bench::report::{carry_dropped_text, rotor_text};
use pump_bench::{Bench, Session};
use pump_model::units::{degrees, rad_s, radians};
use signal_hook::consts::SIGINT;

use crate::advice;
use crate::failure::Failure;
use crate::interrupt::Interrupt;
use crate::terminal::{announce, noted, print, tell, warn};

use super::keys::next_key;

/// Angle to which two painted lines can be seen to meet, deg: half a millimetre on a rotor of 60 mm radius.
const TOLERANCE_DEG: f64 = 0.5;

/// Angles by which a key turns the rotor, deg.
const STEPS_DEG: [f64; 5] = [0.1, 0.5, 1.0, 5.0, 30.0];

/// Speed of these turns, r/min.
const JOG_RPM: f64 = 10.0;

/// The meaning of a key.
enum Wish {
    Turn(f64),
    Finer,
    Coarser,
    Meets,
    Leave,
    Nothing,
}

fn wish(key: &Key) -> Wish {
    match key {
        Key::ArrowRight => Wish::Turn(1.0),
        Key::ArrowLeft => Wish::Turn(-1.0),
        Key::ArrowDown => Wish::Finer,
        Key::ArrowUp => Wish::Coarser,
        Key::Enter => Wish::Meets,
        Key::Escape | Key::Char('q' | 'Q') => Wish::Leave,
        _ => Wish::Nothing,
    }
}

/// Turns the rotor to its mark and records the angle there.
pub(super) fn mark(
    tolerance_rad: Option<f64>,
    bench: impl FnOnce() -> Result<Bench, Failure>,
) -> Result<(), Failure> {
    let tolerance_rad = tolerance_rad.unwrap_or(radians(TOLERANCE_DEG));
    let bench = bench()?;
    let mut session = bench.session()?;
    let mark_deg = degrees(session.mark_rad()?);
    if !(io::stdin().is_terminal() && io::stderr().is_terminal()) {
        return Err(Failure::refused(
            "the rotor is turned to its mark with the arrow keys: run this in a terminal, or say where the rollers \
             stand with `dose home --set <ANGLE>`",
        ));
    }
    let connected = session.connect();
    noted(&mut session, connected)?;
    warn(&session.notes());
    let carry_ml = session.owed_ml();
    announce(&bench, false)?;
    say(&format!(
        "Turn the rotor until its mark meets the housing's (at {mark_deg:.2}°); the pump pumps as it turns.\n  \
         → ←    forward, back\n  ↑ ↓    coarser, finer\n  Enter  the marks meet\n  q      leave it\n"
    ))?;
    let turned = turn_to_mark(&mut session);
    warn(&session.notes());
    let set = turned.and_then(|step_deg| set_at(&bench, &mut session, step_deg, tolerance_rad, carry_ml));
    set.map_err(|failure| failure.of_session(&session))
}

/// Records that the marks meet, to a key's step and the tolerance. Without a step the person left.
fn set_at(
    bench: &Bench,
    session: &mut Session<'_>,
    step_deg: Option<f64>,
    tolerance_rad: f64,
    carry_ml: f64,
) -> Result<(), Failure> {
    let Some(step_deg) = step_deg else {
        return print("nothing was set; the turns are on record\n");
    };
    let set = session.set_at_mark(radians(0.5 * step_deg) + tolerance_rad);
    let state = noted(session, set)?;
    tell(&format!(
        "{}{}",
        rotor_text(bench, &state, advice::words),
        carry_dropped_text(carry_ml - state.carry_ml)
    ))
}

/// Obeys keys until the marks meet. Returns the step at that moment, deg; none if the person left.
fn turn_to_mark(session: &mut Session<'_>) -> Result<Option<f64>, Failure> {
    let interrupt = Interrupt::watch()?;
    let mut size = 2;
    loop {
        let step_deg = STEPS_DEG[size];
        say(&format!("\r  a key turns by {step_deg}°    "))?;
        let key = next_key(|| interrupt.signal().is_some());
        // The key Ctrl-C is the signal of a terminal that hands its keys on.
        let pressed = matches!(key, Ok(Some(Key::CtrlC))).then_some(SIGINT);
        if let Some(signal) = interrupt.signal().or(pressed) {
            return Err(left(session, signal));
        }
        let key = key.map_err(|error| Failure::refused(format!("the keys cannot be read: {error}")))?;
        let Some(key) = key else { continue };
        match wish(&key) {
            Wish::Turn(direction) => {
                let steps = session.steps_of(radians(direction * step_deg));
                session.jog(steps, rad_s(JOG_RPM), |_| interrupt.flow())?;
            }
            Wish::Finer => size = size.saturating_sub(1),
            Wish::Coarser => size = (size + 1).min(STEPS_DEG.len() - 1),
            Wish::Meets | Wish::Leave => {
                say("\n")?;
                return Ok(matches!(wish(&key), Wish::Meets).then_some(step_deg));
            }
            Wish::Nothing => {}
        }
        if let Some(signal) = interrupt.signal() {
            return Err(left(session, signal));
        }
    }
}

/// The end by a signal. The terminal may be gone, so that nothing more is said there than the error.
fn left(session: &Session<'_>, signal: i32) -> Failure {
    let _ = say("\n");
    Failure::stopped(signal, session.has_moved(), "stopped by the user; the turns are on record")
}

/// To the person at the keys.
fn say(text: &str) -> Result<(), Failure> {
    let said = io::stderr().write_all(text.as_bytes()).and_then(|()| io::stderr().flush());
    said.map_err(|error| Failure::refused(format!("the terminal cannot be written to: {error}")))
}
