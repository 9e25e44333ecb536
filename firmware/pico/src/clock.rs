//! The clocks: 200 MHz for the processor and the UART, and 48 MHz for the USB port.
//!
//! The chip is certified for 200 MHz with its core at 1.15 V (Raspberry Pi, pico-sdk 2.1.1, release notes of
//! 2025-02-19). The second boot stage divides that by 2 for the flash chip: 100 MHz, where a W25Q16JV takes 133 MHz.

use cortex_m::asm;
use rp2040_hal::Watchdog;
use rp2040_hal::clocks::ClocksManager;
use rp2040_hal::fugit::{HertzU32, RateExtU32};
use rp2040_hal::pac::vreg_and_chip_reset::vreg::VSEL_A;
use rp2040_hal::pac::{CLOCKS, PLL_SYS, PLL_USB, RESETS, VREG_AND_CHIP_RESET, WATCHDOG, XOSC};
use rp2040_hal::pll::common_configs::PLL_USB_48MHZ;
use rp2040_hal::pll::{PLLConfig, setup_pll_blocking};
use rp2040_hal::vreg::set_voltage;
use rp2040_hal::xosc::setup_xosc_blocking;

/// Rate of the crystal, Hz.
const CRYSTAL_HZ: u32 = 12_000_000;

/// Rate of the crystal for each tick of the timer: its ticks are 1 us, whatever the processor's clock.
const CRYSTAL_TICKS: u8 = (CRYSTAL_HZ / 1_000_000) as u8;

/// Voltage of the core, which 200 MHz need.
const CORE: VSEL_A = VSEL_A::VOLTAGE1_15;

/// Cycles for which the core's voltage settles: 1 ms, as pico-sdk waits, by the fastest that the ring oscillator is at
/// the start (12 MHz, RP2040 datasheet, section 2.17.1).
const SETTLE_CYCLES: u32 = 12_000;

/// 200 MHz: 12 MHz times 100, divided by 6 (RP2040 datasheet, section 2.18.2).
const SYSTEM: PLLConfig = PLLConfig { vco_freq: HertzU32::MHz(1_200), refdiv: 1, post_div1: 6, post_div2: 1 };

/// Parts of the chip that make its clocks.
pub(crate) struct Parts {
    pub(crate) crystal: XOSC,
    pub(crate) clocks: CLOCKS,
    pub(crate) system: PLL_SYS,
    pub(crate) usb: PLL_USB,
    pub(crate) regulator: VREG_AND_CHIP_RESET,
    pub(crate) watchdog: WATCHDOG,
}

/// Raises the core's voltage, and then sets up the clocks and the tick of the timer.
pub(crate) fn set_up(mut parts: Parts, resets: &mut RESETS) -> Option<ClocksManager> {
    set_voltage(&mut parts.regulator, CORE);
    asm::delay(SETTLE_CYCLES);
    let crystal = setup_xosc_blocking(parts.crystal, CRYSTAL_HZ.Hz()).ok()?;
    Watchdog::new(parts.watchdog).enable_tick_generation(CRYSTAL_TICKS);
    let mut clocks = ClocksManager::new(parts.clocks);
    let rate = crystal.operating_frequency();
    let system = setup_pll_blocking(parts.system, rate, SYSTEM, &mut clocks, resets).ok()?;
    let usb = setup_pll_blocking(parts.usb, rate, PLL_USB_48MHZ, &mut clocks, resets).ok()?;
    clocks.init_default(&crystal, &system, &usb).ok()?;
    Some(clocks)
}
