//! The line to a stepper driver, which the board's software serves.

use super::board::Talk;
use super::objects::Objects;
use crate::drives::klipper::dictionary::Dictionary;
use crate::drives::klipper::error::KlipperError;
use crate::drives::klipper::tmc::{ANSWER_LEN, Tmc, TmcLine, TmcSettings, TmcStatus, bit_ticks};
use crate::pump_file::{KlipperPin, PinPull, TmcTable};

/// Command that makes the line.
///
/// Source: Klipper3d/klipper, `docs/MCU_Commands.md`, "TMC2208 UART Configuration"; `src/tmcuart.c`.
const CONFIG: &str = "config_tmcuart oid=%c rx_pin=%u pull_up=%c tx_pin=%u bit_time=%u";

/// Command that sends bits, and its answer.
const SEND: &str = "tmcuart_send oid=%c write=%*s read=%c";
const RESPONSE: &str = "tmcuart_response oid=%c read=%*s";

/// Returns true if two drivers are at one line.
pub(super) fn is_shared(one: &TmcTable, other: &TmcTable) -> bool {
    let pins = |table: &TmcTable| (table.uart.name.clone(), writes(table).name.clone());
    pins(one) == pins(other)
}

/// Returns the pin that writes the line of a driver.
fn writes(table: &TmcTable) -> &KlipperPin {
    table.tx.as_ref().unwrap_or(&table.uart)
}

/// Returns the command that makes the line of a driver.
pub(super) fn command(
    table: Option<&TmcTable>,
    objects: Objects,
    dictionary: &Dictionary,
    hz: u32,
) -> Result<Option<Vec<u8>>, KlipperError> {
    let Some(table) = table else { return Ok(None) };
    dictionary.command(SEND)?;
    dictionary.response(RESPONSE)?;
    let values = [
        objects.driver_line.into(),
        dictionary.pin(&table.uart.name)?.into(),
        (table.uart.pull == PinPull::Up).into(),
        dictionary.pin(&writes(table).name)?.into(),
        bit_ticks(hz).into(),
    ];
    Ok(Some(dictionary.command(CONFIG)?.encode(&values)?))
}

/// Writes the settings of a driver whose motor has no current. Returns what a person is to know of it.
pub(super) fn set(talk: &mut Talk, driver: &(u8, TmcSettings)) -> Result<Vec<String>, KlipperError> {
    let (_, settings) = driver;
    let status = Tmc::configure(talk, settings)?;
    Ok(warning(status).into_iter().collect())
}

/// Refuses the driver at an address if it was reset, has switched its motor off, or is off by its enable input. Returns
/// its warning, if it has one.
pub(in crate::drives::klipper) fn check(
    talk: &mut Talk,
    address: u8,
) -> Result<Option<String>, KlipperError> {
    let mut driver = Tmc::new(talk, address);
    let status = driver.check()?;
    driver.check_enable(true)?;
    Ok(warning(status))
}

/// Refuses the driver at an address if its enable input is not on, or not off, as the board's pin is to have it.
pub(super) fn check_enable(talk: &mut Talk, address: u8, is_on: bool) -> Result<(), KlipperError> {
    Tmc::new(talk, address).check_enable(is_on)
}

/// Has the board put a question to a driver, unless the line is taken by another motor's. Waits for no answer, after
/// which [`Talk::free_line`] is to follow. Returns the number of the question's block if it was put.
pub(in crate::drives::klipper) fn ask(talk: &mut Talk, question: &[u8]) -> Result<Option<u64>, KlipperError> {
    if !talk.take_line() {
        return Ok(None);
    }
    let size = u8::try_from(ANSWER_LEN).unwrap_or(u8::MAX);
    let send = talk.dictionary.command(SEND)?;
    let line = talk.objects.driver_line;
    talk.link.queue_alone(&send.encode(&[line.into(), question.into(), size.into()])?).map(Some)
}

fn warning(status: TmcStatus) -> Option<String> {
    status.warnings().map(|warning| format!("the stepper driver warns: {warning}"))
}

impl TmcLine for Talk {
    type Error = KlipperError;

    fn exchange(&mut self, bits: &[u8], answer: usize) -> Result<Vec<u8>, KlipperError> {
        self.hear()?;
        self.wait_for_line()?;
        let asked = self.dictionary.command(SEND).map_err(KlipperError::from).and_then(|send| {
            let size = u8::try_from(answer).unwrap_or(u8::MAX);
            let line = self.objects.driver_line;
            self.ask(&send, &[line.into(), bits.into(), size.into()], "tmcuart_response", Some(line))
        });
        self.free_line();
        Ok(asked?.bytes("read")?.to_vec())
    }
}
