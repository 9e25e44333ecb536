//! The line to a stepper driver, which the board's software serves.

use super::board::Talk;
use super::configuration::{Configuration, oid};
use crate::drives::klipper::dictionary::Dictionary;
use crate::drives::klipper::error::KlipperError;
use crate::drives::klipper::tmc::{ANSWER_LEN, Tmc, TmcLine, TmcSettings, TmcStatus, bit_ticks};
use crate::pump_file::{PinPull, TmcTable};

/// Command that makes the line.
///
/// Source: Klipper3d/klipper, `docs/MCU_Commands.md`, "TMC2208 UART Configuration"; `src/tmcuart.c`.
const CONFIG: &str = "config_tmcuart oid=%c rx_pin=%u pull_up=%c tx_pin=%u bit_time=%u";

/// Command that sends bits, and its answer.
const SEND: &str = "tmcuart_send oid=%c write=%*s read=%c";
const RESPONSE: &str = "tmcuart_response oid=%c read=%*s";

/// Adds the line of a driver to a configuration.
pub(super) fn add(
    configuration: &mut Configuration,
    table: Option<&TmcTable>,
    dictionary: &Dictionary,
    hz: u32,
) -> Result<(), KlipperError> {
    let Some(table) = table else { return Ok(()) };
    dictionary.command(SEND)?;
    dictionary.response(RESPONSE)?;
    let writes = table.tx.as_ref().unwrap_or(&table.uart);
    let values = [
        oid::DRIVER_LINE.into(),
        dictionary.pin(&table.uart.name)?.into(),
        (table.uart.pull == PinPull::Up).into(),
        dictionary.pin(&writes.name)?.into(),
        bit_ticks(hz).into(),
    ];
    configuration.push(dictionary.command(CONFIG)?.encode(&values)?);
    Ok(())
}

/// Writes the settings of a driver whose motor has no current. Returns what a person is to know of it.
pub(super) fn set(talk: &mut Talk, driver: &(u8, TmcSettings)) -> Result<Vec<String>, KlipperError> {
    let (_, settings) = driver;
    let status = Tmc::configure(talk, settings)?;
    Ok(warning(status).into_iter().collect())
}

/// Refuses the driver at an address if it was reset, or has switched its motor off. Returns its warning, if it has one.
pub(in crate::drives::klipper) fn check(
    talk: &mut Talk,
    address: u8,
) -> Result<Option<String>, KlipperError> {
    Tmc::new(talk, address).check().map(warning)
}

/// Has the board put a question to a driver, and waits for no answer.
pub(in crate::drives::klipper) fn ask(talk: &mut Talk, question: &[u8]) -> Result<(), KlipperError> {
    let size = u8::try_from(ANSWER_LEN).unwrap_or(u8::MAX);
    let send = talk.dictionary.command(SEND)?;
    talk.link.queue(&send.encode(&[oid::DRIVER_LINE.into(), question.into(), size.into()])?)?;
    Ok(())
}

fn warning(status: TmcStatus) -> Option<String> {
    status.warnings().map(|warning| format!("the stepper driver warns: {warning}"))
}

impl TmcLine for Talk {
    type Error = KlipperError;

    fn exchange(&mut self, bits: &[u8], answer: usize) -> Result<Vec<u8>, KlipperError> {
        self.hear()?;
        let send = self.dictionary.command(SEND)?;
        let size = u8::try_from(answer).unwrap_or(u8::MAX);
        let message =
            self.ask(&send, &[oid::DRIVER_LINE.into(), bits.into(), size.into()], "tmcuart_response")?;
        Ok(message.bytes("read")?.to_vec())
    }
}
