//! A TMC2209: its registers over one wire (Analog Devices, TMC2209 datasheet, chapters 4 and 5).

use std::collections::BTreeMap;

/// First byte of a datagram, without its reserved bits.
const SYNC: u8 = 0x05;

/// Registers that can be read, with their values after power-up.
const READABLE: [(u8, u32); 12] = [
    // GCONF, GSTAT (reset), IFCNT.
    (0x00, 0x101),
    (0x01, 1),
    (0x02, 0),
    // IOIN, with the version 0x21 of a TMC2209, and FACTORY_CONF.
    (0x06, 0x2100_0000),
    (0x07, 0),
    // TSTEP of a motor that stands, SG_RESULT, MSCNT.
    (0x12, 0xf_ffff),
    (0x41, 0),
    (0x6a, 0),
    // CHOPCONF, DRV_STATUS, PWMCONF, PWM_SCALE.
    (0x6c, 0x1000_0053),
    (0x6f, 0),
    (0x70, 0xc10d_0024),
    (0x71, 0),
];

/// Registers that can be written.
const WRITABLE: [u8; 13] = [0x00, 0x01, 0x03, 0x04, 0x10, 0x11, 0x13, 0x14, 0x22, 0x40, 0x42, 0x6c, 0x70];

/// Numbers of GSTAT, whose bits a written 1 clears, of IFCNT, of IOIN, of IHOLD_IRUN and of DRV_STATUS.
const GSTAT: u8 = 0x01;
const IFCNT: u8 = 0x02;
const IOIN: u8 = 0x06;
const IHOLD_IRUN: u8 = 0x10;
const DRV_STATUS: u8 = 0x6f;

/// Names of the faults and warnings of DRV_STATUS, in the order of their bits.
const FAULTS: [&str; 8] = ["otpw", "ot", "s2ga", "s2gb", "s2vsa", "s2vsb", "ola", "olb"];

/// Those of them that switch the motor off, and the bit of GSTAT that tells of them afterwards.
const SWITCH_OFF: u32 = 0b11_1110;
const DRV_ERR: u32 = 1 << 1;

/// Returns the checksum of a datagram: x^8 + x^2 + x + 1, over the bits of each byte from the lowest.
fn checksum(bytes: &[u8]) -> u8 {
    let mut sum = 0_u8;
    for byte in bytes {
        for bit in 0..8 {
            let is_one = (sum >> 7) ^ (byte >> bit & 1) == 1;
            sum <<= 1;
            if is_one {
                sum ^= 0x07;
            }
        }
    }
    sum
}

/// State of a driver's motor and of its pins.
#[derive(Debug, Clone, Copy, Default)]
pub(in super::super) struct State {
    /// True while the motor moves.
    pub(in super::super) is_moving: bool,
    /// True while the enable input takes the motor's current away.
    pub(in super::super) is_off: bool,
}

/// Driver.
#[derive(Debug, Clone)]
pub(in super::super) struct Driver {
    address: u8,
    registers: BTreeMap<u8, u32>,
    /// Faults and warnings that it has, as bits of DRV_STATUS.
    faults: u32,
}

impl Driver {
    pub(in super::super) fn new(address: u8) -> Self {
        Self { address, registers: READABLE.into_iter().collect(), faults: 0 }
    }

    /// Forgets what was written, as a driver does whose supply is cut.
    pub(in super::super) fn power_up(&mut self) {
        self.registers = READABLE.into_iter().collect();
    }

    /// Returns what a register holds, whether it can be read or not.
    pub(in super::super) fn register(&self, number: u8) -> u32 {
        self.registers.get(&number).copied().unwrap_or(0)
    }

    /// Begins or ends a fault by its name.
    pub(in super::super) fn set_fault(&mut self, name: &str, is_there: bool) -> Result<(), String> {
        let bit = FAULTS.iter().position(|fault| *fault == name);
        let bit = bit.ok_or_else(|| format!("`{name}` is none of {}", FAULTS.join(", ")))?;
        self.faults = self.faults & !(1 << bit) | u32::from(is_there) << bit;
        if SWITCH_OFF >> bit & u32::from(is_there) == 1 {
            // drv_err stays until it is cleared.
            *self.registers.entry(GSTAT).or_default() |= DRV_ERR;
        }
        Ok(())
    }

    /// Answers a datagram, or says nothing to one that is damaged or for another driver.
    pub(in super::super) fn answer(&mut self, datagram: &[u8], state: State) -> Option<Vec<u8>> {
        let (sum, inner) = datagram.split_last()?;
        let (start, address, register) = (*inner.first()?, *inner.get(1)?, *inner.get(2)?);
        if start & 0x0f != SYNC || address != self.address || checksum(inner) != *sum {
            return None;
        }
        match inner.get(3..7) {
            Some(&[a, b, c, d]) if register & 0x80 != 0 => {
                self.write(register & 0x7f, u32::from_be_bytes([a, b, c, d]));
                None
            }
            None if register & 0x80 == 0 => Some(self.reply(register, state)),
            _ => None,
        }
    }

    fn write(&mut self, register: u8, value: u32) {
        if !WRITABLE.contains(&register) {
            return;
        }
        let before = self.register(register);
        self.registers.insert(register, if register == GSTAT { before & !value } else { value });
        let count = self.register(IFCNT);
        self.registers.insert(IFCNT, (count + 1) & 0xff);
    }

    /// Returns the answer to a read. Registers that can only be written read as 0.
    fn reply(&self, register: u8, state: State) -> Vec<u8> {
        let State { is_moving, is_off } = state;
        let is_readable = READABLE.iter().any(|(number, _)| *number == register);
        let value = match register {
            DRV_STATUS => {
                // stst, then CS_ACTUAL: the current of a run, or that of a hold.
                let current = self.register(IHOLD_IRUN) >> if is_moving { 8 } else { 0 } & 0x1f;
                self.faults | u32::from(!is_moving) << 31 | current << 16
            }
            // Bit 0 is the level of ENN.
            IOIN => self.register(IOIN) | u32::from(is_off),
            _ if is_readable => self.register(register),
            _ => 0,
        };
        let mut bytes = vec![SYNC, 0xff, register];
        bytes.extend(value.to_be_bytes());
        bytes.push(checksum(&bytes));
        bytes
    }
}

#[cfg(test)]
mod tests {
    use super::{Driver, State, checksum};

    fn read(driver: &mut Driver, address: u8, register: u8) -> Option<u32> {
        let mut datagram = vec![0xf5, address, register];
        datagram.push(checksum(&datagram));
        let reply = driver.answer(&datagram, State::default())?;
        assert_eq!((reply.len(), reply[..3].to_vec()), (8, vec![0x05, 0xff, register]));
        assert_eq!(checksum(&reply[..7]), reply[7]);
        Some(u32::from_be_bytes([reply[3], reply[4], reply[5], reply[6]]))
    }

    fn write(driver: &mut Driver, register: u8, value: u32) {
        let mut datagram = vec![0xf5, 0, register | 0x80];
        datagram.extend(value.to_be_bytes());
        datagram.push(checksum(&datagram));
        assert_eq!(driver.answer(&datagram, State::default()), None);
    }

    #[test]
    fn the_checksum_is_that_of_a_published_datagram() {
        // A read of GCONF at address 0 is 05 00 00 48 (an example of many hosts of the TMC2209).
        assert_eq!(checksum(&[0x05, 0x00, 0x00]), 0x48);
    }

    #[test]
    fn registers_are_read_and_writes_counted() {
        let mut driver = Driver::new(0);
        assert_eq!(read(&mut driver, 0, 0x06).map(|ioin| ioin >> 24), Some(0x21));
        assert_eq!(read(&mut driver, 0, 0x00), Some(0x101));
        write(&mut driver, 0x00, 0xc0);
        write(&mut driver, 0x6c, 0x1400_0053);
        write(&mut driver, 0x10, 0x0004_140a);
        assert_eq!(read(&mut driver, 0, 0x00), Some(0xc0));
        assert_eq!(read(&mut driver, 0, 0x02), Some(3));
        assert_eq!((read(&mut driver, 0, 0x10), driver.register(0x10)), (Some(0), 0x0004_140a));
        // IHOLD of 10, and the motor stands.
        assert_eq!(read(&mut driver, 0, 0x6f), Some(1 << 31 | 10 << 16));
        driver.set_fault("ot", true).unwrap();
        assert_eq!(read(&mut driver, 0, 0x6f).map(|status| status & 0xff), Some(2));
        assert_eq!(read(&mut driver, 0, 0x01), Some(3));
        write(&mut driver, 0x01, 1);
        driver.set_fault("ot", false).unwrap();
        driver.set_fault("otpw", true).unwrap();
        assert_eq!(
            read(&mut driver, 0, 0x01),
            Some(2),
            "the fault has passed, and is told until it is cleared"
        );
    }

    #[test]
    fn what_is_damaged_or_for_another_driver_has_no_answer() {
        let mut driver = Driver::new(2);
        assert_eq!(read(&mut driver, 1, 0x00), None);
        assert!(read(&mut driver, 2, 0x00).is_some());
        assert_eq!(driver.answer(&[0xf5, 2, 0, 0x11], State::default()), None);
        assert_eq!(driver.answer(&[], State::default()), None);
        assert!(driver.set_fault("smoke", true).is_err());
    }
}
