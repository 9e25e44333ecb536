//! The second boot stage: the 256 bytes that the boot ROM runs first, which set up the flash.
#![allow(unsafe_code)]

/// Boot stage of the Pico's flash chip, a W25Q16 (Raspberry Pi Pico datasheet, section 1).
#[unsafe(link_section = ".boot2")]
#[used]
pub(crate) static BOOT2_FIRMWARE: [u8; 256] = rp2040_boot2::BOOT_LOADER_W25Q080;
