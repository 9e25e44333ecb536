//! Faults and warnings of a driver in words (datasheet, chapter 5.5.3, DRV_STATUS).

use super::error::TmcError;
use super::register::gstat;

/// Faults that switch the motor off, by their bits of DRV_STATUS, with what to do.
const FAULTS: [(u32, &str); 5] = [
    (1 << 1, "it is too hot; less current, or more air at the chip"),
    (1 << 2, "coil A is shorted to ground; check the motor's cable"),
    (1 << 3, "coil B is shorted to ground; check the motor's cable"),
    (1 << 4, "coil A is shorted to the supply; check the motor's cable"),
    (1 << 5, "coil B is shorted to the supply; check the motor's cable"),
];

/// Fault of the charge pump, which GSTAT tells.
const SUPPLY: &str = "its supply is too low; check the motor supply";

/// Words for an error that has no flag any more.
const PASSED: &str = "an overload that has passed; check the motor's cable and the current";

/// Warning bits of DRV_STATUS, with their words.
const WARNINGS: [(u32, &str); 3] = [
    (1 << 0, "it is hot, and will switch its motor off if it gets hotter"),
    (1 << 6, "coil A seems to be open"),
    (1 << 7, "coil B seems to be open"),
];

/// Bit of DRV_STATUS that says that the motor stands.
#[cfg(test)]
const STANDS: u32 = 1 << 31;

/// Place and size of the current's scale in DRV_STATUS.
#[cfg(test)]
const CS_ACTUAL: (u32, u32) = (16, 0x1f);

/// State of a driver.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::drives::klipper) struct TmcStatus {
    /// Value of GSTAT.
    pub(super) events: u32,
    /// Value of DRV_STATUS.
    pub(super) flags: u32,
}

impl TmcStatus {
    /// Returns this state of the driver at an address, if its motor has had current since its settings were written.
    ///
    /// # Errors
    ///
    /// [`TmcError::Reset`] or [`TmcError::Off`] if the motor has lost its current.
    pub(super) fn checked(self, address: u8) -> Result<Self, TmcError> {
        if self.was_reset() {
            return Err(TmcError::Reset { address });
        }
        match self.faults() {
            Some(faults) => Err(TmcError::Off { address, faults }),
            None => Ok(self),
        }
    }

    /// Returns true if the driver was reset since its settings were written.
    pub(in crate::drives::klipper) fn was_reset(self) -> bool {
        self.events & gstat::RESET != 0
    }

    /// Returns the faults that keep the motor off, or have switched it off, in words. `None` if there is none.
    pub(in crate::drives::klipper) fn faults(self) -> Option<String> {
        let mut faults: Vec<_> = words(&FAULTS, self.flags).collect();
        if self.events & gstat::UV_CP != 0 {
            faults.push(SUPPLY);
        }
        if faults.is_empty() && self.events & gstat::DRV_ERR != 0 {
            faults.push(PASSED);
        }
        (!faults.is_empty()).then(|| faults.join(". "))
    }

    /// Returns the warnings in words. `None` if there is none.
    ///
    /// A coil seems to be open while a motor stands or runs fast too, so it is a warning after a slow motion alone.
    pub(in crate::drives::klipper) fn warnings(self) -> Option<String> {
        let warnings: Vec<_> = words(&WARNINGS, self.flags).collect();
        (!warnings.is_empty()).then(|| warnings.join(". "))
    }

    /// Returns true if the motor has made no step for 2^20 clocks of the chip, some 0.09 s.
    #[cfg(test)]
    pub(in crate::drives::klipper) fn stands(self) -> bool {
        self.flags & STANDS != 0
    }

    /// Returns the scale of the motor's current now, 0 to 31.
    #[cfg(test)]
    pub(in crate::drives::klipper) fn current_scale(self) -> u8 {
        (self.flags >> CS_ACTUAL.0 & CS_ACTUAL.1) as u8
    }
}

/// Returns the words of those bits that are set.
fn words(table: &[(u32, &'static str)], flags: u32) -> impl Iterator<Item = &'static str> {
    table.iter().filter(move |(bit, _)| flags & bit != 0).map(|(_, words)| *words)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn status(events: u32, flags: u32) -> TmcStatus {
        TmcStatus { events, flags }
    }

    #[test]
    fn a_healthy_driver_has_nothing_to_tell() {
        // stst, stealth, CS_ACTUAL of 10: a motor that stands with its current at rest.
        let rest = status(0, 0xc00a_0000);
        assert_eq!((rest.faults(), rest.warnings(), rest.was_reset()), (None, None, false));
        assert_eq!((rest.stands(), rest.current_scale()), (true, 10));
    }

    #[test]
    fn faults_and_warnings_are_told_in_words() {
        let faults = |events, flags| status(events, flags).faults().unwrap_or_default();
        // t120 and t143 beside ot.
        assert!(faults(0, 0x302).starts_with("it is too hot"));
        assert!(faults(0, 1 << 3).contains("coil B is shorted to ground"));
        assert!(faults(0, 1 << 4).contains("coil A is shorted to the supply"));
        assert!(faults(2, 1 << 2).starts_with("coil A is shorted to ground"));
        assert!(faults(2, 0).starts_with("an overload that has passed"));
        assert!(faults(4, 0).contains("supply is too low"));
        assert!(status(1, 0).was_reset());
        assert_eq!(faults(1, 0), "");
        let warnings = status(0, 0xc1).warnings().unwrap();
        assert!(warnings.contains("it is hot") && warnings.contains("coil A") && warnings.contains("coil B"));
    }
}
