//! The motors of a board, as its configuration has them.

use serde::{Deserialize, Serialize};

use super::terms::Terms;
use crate::drives::Opening;
use crate::drives::klipper::dictionary::Dictionary;
use crate::pump_file::KlipperTable;

/// Most motors of a board. Each has six of its 255 objects.
const MOTORS_MOST: usize = 16;

/// Motor of a board, with the pump that it turns.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(in crate::drives::klipper) struct BoardMotor {
    /// Id of the pump. `None` if the drive was opened for no pump of a bench.
    pub(super) pump: Option<String>,
    pub(super) pins: KlipperTable,
    /// True once the motor was met at these pins. One that was refused before claims none from other pumps.
    #[serde(default)]
    pub(super) met: bool,
}

impl BoardMotor {
    /// Returns true if this motor and another one cannot be in one configuration: they turn one pump, or claim one pin.
    fn displaces(&self, other: &Self) -> bool {
        self.is_of_pump_of(other) || self.pins.clash(&other.pins).is_some()
    }

    fn is_of_pump_of(&self, other: &Self) -> bool {
        self.pump.is_some() && self.pump == other.pump
    }
}

/// Returns the motors that the board of these terms is configured with, and the place of the pump's own: beside it
/// those of the pumps that use the board at the same time, and those on record that are in no other one's way. So pumps
/// that take turns at a board find it as they left it.
pub(super) fn motors_of(
    terms: &Terms,
    recorded: &[BoardMotor],
    dictionary: &Dictionary,
) -> (Vec<BoardMotor>, usize) {
    let of = |pump: Option<String>, pins: KlipperTable| {
        let met = recorded.iter().any(|motor| motor.met && motor.pump == pump && motor.pins == pins);
        BoardMotor { pump, pins, met }
    };
    let own = of(terms.opening.pump.clone(), terms.pins.clone());
    let step = own.pins.step.name.clone();
    let beside = terms
        .opening
        .beside
        .iter()
        .filter_map(|(pump, table)| Some(of(Some(pump.clone()), table.klipper.clone()?)));
    let mut motors = vec![own];
    let (met, tried): (Vec<_>, Vec<_>) = recorded.iter().cloned().partition(|motor| motor.met);
    for motor in beside.chain(met).chain(tried) {
        let tmc = motor.pins.tmc.iter().flat_map(|tmc| [Some(&tmc.uart), tmc.tx.as_ref()]).flatten();
        let is_there =
            motor.pins.motor_pins().into_iter().chain(tmc).all(|pin| dictionary.pin(&pin.name).is_ok());
        let is_free = motors.iter().all(|other| !other.displaces(&motor));
        if is_there && is_free && motors.len() < MOTORS_MOST {
            motors.push(motor);
        }
    }
    // Pumps of one process find the same order, whichever comes first.
    motors.sort_by(|one, other| one.pins.step.name.cmp(&other.pins.step.name));
    let place = motors.iter().position(|motor| motor.pins.step.name == step).unwrap_or(0);
    (motors, place)
}

/// Tells of the other pumps whose motors a reset has left without current, since the board is configured for this one
/// from now on.
pub(super) fn left_without_current(configured: &[BoardMotor], opening: &Opening) -> Option<String> {
    let is_beside = |pump: &str| opening.beside.iter().any(|(beside, _)| beside == pump);
    let others = configured.iter().filter_map(|motor| motor.pump.as_deref());
    let others = others.filter(|pump| opening.pump.as_deref() != Some(*pump) && !is_beside(pump));
    let others: Vec<_> = others.map(|pump| format!("`{pump}`")).collect();
    (!others.is_empty()).then(|| {
        format!(
            "the board was reset to configure it for this pump: it turns {} too, without current meanwhile, so the \
             angle of those rollers is known less well",
            others.join(", ")
        )
    })
}

/// Tells of a motor on record that has to leave the configuration for these motors, because both claim a pin.
pub(super) fn displaced(motors: &[BoardMotor], recorded: &[BoardMotor]) -> Option<String> {
    let mut left = recorded.iter().filter(|motor| motor.met && !motors.contains(motor));
    left.find_map(|motor| {
        let other = motors.iter().find(|other| !other.is_of_pump_of(motor) && other.displaces(motor))?;
        let (pin, pump) = (other.pins.clash(&motor.pins)?, motor.pump.as_deref()?);
        Some(format!(
            "pump `{pump}` on record claims the {pin} of the board too, so the board is reset whenever one follows the \
             other, and its motors are without current meanwhile; give each pump pins of its own"
        ))
    })
}
