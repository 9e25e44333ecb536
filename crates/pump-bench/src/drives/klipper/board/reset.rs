//! A board is brought to rest, reset, and configured.

use std::time::Duration;

use super::board::{ConfigState, Talk};
use super::configuration::Configuration;
use super::objects::Objects;
use crate::drives::klipper::error::KlipperError;

/// Longest wait for a first answer.
pub(super) const ANSWER_LIMIT: Duration = Duration::from_secs(3);

/// Longest wait for a motion of an earlier program. Its steps end without that program, by the dead-man time.
const REST_LIMIT: Duration = Duration::from_secs(15);

/// Time that a board takes to start after a reset.
const START: Duration = Duration::from_millis(500);

/// Time for which a count stays as it is where no step is under way at a speed at which a motor could slip.
pub(super) const STILL: Duration = Duration::from_millis(150);

/// Waits until the count of the stepper stays as it is.
pub(in crate::drives::klipper) fn be_still(talk: &mut Talk) -> Result<(), KlipperError> {
    let began = talk.link.now();
    let (mut position, mut since) = (talk.position()?, began);
    loop {
        talk.link.sleep(STILL / 5);
        let (now, at) = (talk.position()?, talk.link.now());
        if now != position {
            (position, since) = (now, at);
        }
        if at.saturating_sub(since) >= STILL {
            return Ok(());
        }
        let waited = at.saturating_sub(began);
        if waited > REST_LIMIT {
            return Err(KlipperError::Moving { waited_s: waited.as_secs_f64() });
        }
    }
}

/// Brings a board to rest that is configured otherwise, or refuses one that is not known to stand. One of this bench
/// has the same objects, and a person may accept any other.
pub(super) fn bring_to_rest(
    talk: &mut Talk,
    state: ConfigState,
    is_known: bool,
    (motors, wanted): (usize, u32),
) -> Result<(), KlipperError> {
    if state.is_configured && !is_known {
        return Err(KlipperError::Configured { found: state.checksum, wanted });
    }
    if state.is_shut_down {
        return Ok(());
    }
    // A board of another program may have no stepper of this number, and then shuts down, which is a rest too.
    for place in 0..motors.max(1) {
        let place = u8::try_from(place).unwrap_or(u8::MAX);
        talk.objects = Objects::of(place, place);
        match be_still(talk) {
            Ok(()) => {}
            Err(KlipperError::Shutdown { .. } | KlipperError::NoAnswer { .. }) => break,
            Err(error) => return Err(error),
        }
    }
    if !talk.config()?.is_shut_down {
        let stop = talk.format.emergency_stop.clone();
        talk.tell(&stop, &[])?;
    }
    Ok(())
}

/// Resets a board that has shut down, so that it forgets its configuration.
pub(super) fn reset(talk: &mut Talk) -> Result<(), KlipperError> {
    let began = talk.link.now();
    if talk.dictionary.has_command("config_reset") {
        let command = talk.dictionary.command("config_reset")?;
        talk.tell(&command, &[])?;
    } else {
        let command = talk.dictionary.command("reset")?;
        talk.link.queue(&command.encode(&[])?)?;
        // The board does not confirm it, and counts blocks anew.
        talk.link.turn(Duration::ZERO)?;
        talk.link.sleep(START);
        talk.link.connect(ANSWER_LIMIT)?;
    }
    loop {
        talk.forget();
        let state = talk.config()?;
        if !state.is_configured && !state.is_shut_down {
            return Ok(());
        }
        if talk.link.now().saturating_sub(began) > ANSWER_LIMIT {
            return Err(KlipperError::NoReset);
        }
        talk.link.sleep(STILL / 5);
    }
}

/// Configures the board.
pub(super) fn configure(
    talk: &mut Talk,
    configuration: &Configuration,
    checksum: u32,
) -> Result<ConfigState, KlipperError> {
    talk.forget();
    for command in configuration.commands() {
        talk.link.queue(command)?;
    }
    let finalize = talk.format.finalize_config.clone();
    talk.tell(&finalize, &[checksum.into()])?;
    talk.hear()?;
    let state = talk.config()?;
    match state {
        ConfigState { is_configured: true, is_shut_down: false, checksum: told, .. } if told == checksum => {
            Ok(state)
        }
        _ => Err(KlipperError::Configured { found: state.checksum, wanted: checksum }),
    }
}
