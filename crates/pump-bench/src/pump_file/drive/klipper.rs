//! `[drive.klipper]`: the pins and the stepper driver of a motor at a board with the Klipper firmware.

use serde::{Deserialize, Serialize};

use super::klipper_pin::{KlipperPin, PinPull};
use super::tmc_range;
use crate::pump_file::motor::MotorTable;
use crate::pump_file::range::{WrongValue, allow, within_if_given};

/// Longest pulse, in us. A board makes a pause of the same length.
const LONGEST_PULSE_US: f64 = 100.0;

/// Usual pulse, in us: as long as a DRV8825 needs, the slowest of the common drivers (Texas Instruments, SLVSA73F,
/// section 6.6).
const USUAL_PULSE_US: f64 = 2.0;

/// The table `[drive.klipper]`.
///
/// ```
/// use pump_bench::pump_file::KlipperTable;
///
/// let table = KlipperTable::new("PB13".parse()?, "!PB12".parse()?).with_enable("!PB14".parse()?);
/// assert_eq!((table.pulse_us(), table.dir.inverted), (2.0, true));
/// # Ok::<(), pump_bench::pump_file::KlipperPinError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct KlipperTable {
    /// Pin that makes a step.
    pub step: KlipperPin,
    /// Pin that sets the direction.
    pub dir: KlipperPin,
    /// Pin that gives the motor current. `None` if the motor always has it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub enable: Option<KlipperPin>,
    /// Pin of the index sensor. `None` if there is no sensor.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub index: Option<KlipperPin>,
    /// Time for which the step pin is active, in us. `None` takes 2 us.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub step_pulse_us: Option<f64>,
    /// Stepper driver TMC2209 that is set over its line. `None` leaves the driver as it is.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tmc: Option<TmcTable>,
}

/// The table `[drive.klipper.tmc]`: a stepper driver TMC2209 at a line of the board.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct TmcTable {
    /// Pin that reads the line to the driver, and writes it unless `tx` is given.
    pub uart: KlipperPin,
    /// Pin that writes the line to the driver. `None` if the same pin reads and writes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tx: Option<KlipperPin>,
    /// Address of the driver on its line, 0 to 3.
    #[serde(default)]
    pub address: u8,
    /// Sense resistor of the driver, in ohm.
    #[serde(default = "usual_sense_ohm")]
    pub sense_ohm: f64,
    /// Current of the motor while it turns, in A of root mean square.
    pub run_a: f64,
    /// Current of the motor while it holds, in A of root mean square. `None` takes that of the turning motor.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hold_a: Option<f64>,
}

/// Returns the sense resistor of most boards, in ohm.
fn usual_sense_ohm() -> f64 {
    TmcTable::USUAL_SENSE_OHM
}

impl KlipperTable {
    /// Returns the table of a motor with these pins for its steps and its direction.
    pub fn new(step: KlipperPin, dir: KlipperPin) -> Self {
        Self { step, dir, enable: None, index: None, step_pulse_us: None, tmc: None }
    }

    /// Returns the table with the pin that gives the motor current.
    #[must_use]
    pub fn with_enable(self, enable: KlipperPin) -> Self {
        Self { enable: Some(enable), ..self }
    }

    /// Returns the table with the pin of an index sensor.
    #[must_use]
    pub fn with_index(self, index: KlipperPin) -> Self {
        Self { index: Some(index), ..self }
    }

    /// Returns the table with a stepper driver that is set over its line.
    #[must_use]
    pub fn with_tmc(self, tmc: TmcTable) -> Self {
        Self { tmc: Some(tmc), ..self }
    }

    /// Returns the pins that turn this motor and no other, and its stepper driver, in words. An enable pin may be that
    /// of several motors.
    pub fn own_pins(&self) -> Vec<String> {
        let driver =
            self.tmc.as_ref().map(|tmc| format!("TMC2209 at address {} of {}", tmc.address, tmc.uart.name));
        [&self.step, &self.dir].map(|pin| format!("pin {}", pin.name)).into_iter().chain(driver).collect()
    }

    /// Returns a pin, or the stepper driver, that this motor and another one of the board both claim, in words. `None`
    /// if they can turn side by side: the line to their stepper drivers may be one.
    pub(crate) fn clash(&self, other: &Self) -> Option<String> {
        let (mine, theirs) = (self.motor_pins(), other.motor_pins());
        let lines = |table: &Self| {
            let pins = table.tmc.iter().flat_map(|tmc| [Some(&tmc.uart), tmc.tx.as_ref()]).flatten();
            pins.map(|pin| pin.name.clone()).collect::<Vec<_>>()
        };
        let has = |pins: &[&KlipperPin], name: &str| pins.iter().any(|pin| pin.name == name);
        let own = mine.iter().map(|pin| pin.name.clone()).find(|name| has(&theirs, name));
        let pin = own
            .or_else(|| lines(self).into_iter().find(|name| has(&theirs, name)))
            .or_else(|| lines(other).into_iter().find(|name| has(&mine, name)));
        // A line is shared as a whole, or not at all.
        let (own_line, other_line) = (lines(self), lines(other));
        let is_one_line = own_line == other_line;
        let pin = pin.or_else(|| own_line.into_iter().find(|name| !is_one_line && other_line.contains(name)));
        let drivers = self.tmc.as_ref().zip(other.tmc.as_ref());
        let driver =
            drivers.filter(|(one, other)| (&one.uart.name, one.address) == (&other.uart.name, other.address));
        let driver =
            driver.map(|(tmc, _)| format!("TMC2209 at address {} of {}", tmc.address, tmc.uart.name));
        pin.map(|name| format!("pin {name}")).or(driver)
    }

    /// Returns the pins of the motor, without the line to its stepper driver.
    pub(crate) fn motor_pins(&self) -> Vec<&KlipperPin> {
        let others = [self.enable.as_ref(), self.index.as_ref()];
        [Some(&self.step), Some(&self.dir)].into_iter().chain(others).flatten().collect()
    }

    /// Returns the time for which the step pin is active, in us: the one that is given, or the usual one.
    pub fn pulse_us(&self) -> f64 {
        self.step_pulse_us.unwrap_or(USUAL_PULSE_US)
    }

    /// Refuses the first value outside its range, and a pin that is named twice.
    pub(super) fn check(&self, has_index_angle: bool) -> Result<(), WrongValue> {
        let tmc = self.tmc.as_ref();
        let outputs = [
            ("[drive.klipper] step", Some(&self.step)),
            ("[drive.klipper] dir", Some(&self.dir)),
            ("[drive.klipper] enable", self.enable.as_ref()),
            ("[drive.klipper.tmc] tx", tmc.and_then(|tmc| tmc.tx.as_ref())),
        ];
        for (key, pin) in outputs {
            let is_pulled = pin.is_some_and(|pin| pin.pull != PinPull::None);
            allow(
                !is_pulled,
                key,
                pin.map(ToString::to_string).unwrap_or_default(),
                "without `^` and `~`, which are for inputs",
            )?;
        }
        let inputs = [
            ("[drive.klipper] index", self.index.as_ref()),
            ("[drive.klipper.tmc] uart", tmc.map(|tmc| &tmc.uart)),
        ];
        let named: Vec<_> =
            outputs.into_iter().chain(inputs).filter_map(|(key, pin)| Some((key, pin?))).collect();
        for (n, (key, pin)) in named.iter().enumerate() {
            // One pin may write and read the wire of the stepper driver.
            let is_wire =
                |before: &str| [before, *key].iter().all(|key| key.starts_with("[drive.klipper.tmc]"));
            let is_free =
                named.iter().take(n).all(|(other, before)| before.name != pin.name || is_wire(other));
            allow(is_free, key, pin, "a pin that no other key of the table names")?;
        }
        for (key, pin) in [
            ("[drive.klipper.tmc] uart", tmc.map(|tmc| &tmc.uart)),
            ("[drive.klipper.tmc] tx", tmc.and_then(|tmc| tmc.tx.as_ref())),
        ] {
            let inverted = pin.filter(|pin| pin.inverted);
            allow(
                inverted.is_none(),
                key,
                inverted.map(ToString::to_string).unwrap_or_default(),
                "without `!`",
            )?;
        }
        let agree = self.index.is_some() == has_index_angle;
        let allowed = "beside [drive] index_angle_deg, and each needs the other";
        let given = if self.index.is_some() { "given alone" } else { "missing" };
        allow(agree, "[drive.klipper] index", given, allowed)?;
        within_if_given("[drive.klipper] step_pulse_us", self.step_pulse_us, 0.1..=LONGEST_PULSE_US)?;
        tmc.map_or(Ok(()), TmcTable::check)
    }
}

impl TmcTable {
    /// Sense resistor of most boards, in ohm (Klipper3d/klipper, `docs/Config_Reference.md`, `[tmc2209]`).
    pub const USUAL_SENSE_OHM: f64 = 0.11;

    /// Returns the table of a driver at address 0 of the wire of this pin, for a motor of this current in A (RMS).
    pub fn new(uart: KlipperPin, run_a: f64) -> Self {
        Self { uart, tx: None, address: 0, sense_ohm: usual_sense_ohm(), run_a, hold_a: None }
    }

    /// Returns the table with a pin of its own that writes the line.
    #[must_use]
    pub fn with_tx(self, tx: KlipperPin) -> Self {
        Self { tx: Some(tx), ..self }
    }

    /// Returns the current of the motor while it holds, in A: the one that is given, or that of the turning motor.
    pub fn hold_a(&self) -> f64 {
        self.hold_a.unwrap_or(self.run_a)
    }

    /// Refuses the first value outside its range.
    fn check(&self) -> Result<(), WrongValue> {
        tmc_range::check(self.address, self.sense_ohm, (self.run_a, self.hold_a()))
    }

    /// Refuses a motor whose microsteps the driver does not make.
    pub(in crate::pump_file) fn check_motor(&self, motor: &MotorTable) -> Result<(), WrongValue> {
        tmc_range::microsteps(motor.steps_per_rev, motor.full_steps_per_rev).map(drop)
    }
}
