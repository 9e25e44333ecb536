//! The fault output of a stepper driver, as it is connected to a node.

use serde::{Deserialize, Serialize};

/// Fault output of a stepper driver, as it is connected. A pump file writes `false`, `true` (low in a fault) or
/// `"high"`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "Written", into = "Written")]
pub enum DriverFault {
    /// Nothing is connected.
    None,
    /// The output is low in a fault, as nFAULT of a DRV8825.
    Low,
    /// The output is high in a fault, as DIAG of a TMC2209.
    High,
}

/// Fault output as a pump file writes it.
#[derive(Serialize, Deserialize)]
#[serde(untagged)]
enum Written {
    Connected(bool),
    Level(String),
}

impl From<DriverFault> for Written {
    fn from(fault: DriverFault) -> Self {
        match fault {
            DriverFault::None => Self::Connected(false),
            DriverFault::Low => Self::Connected(true),
            DriverFault::High => Self::Level("high".to_owned()),
        }
    }
}

impl TryFrom<Written> for DriverFault {
    type Error = String;

    fn try_from(written: Written) -> Result<Self, String> {
        match written {
            Written::Connected(false) => Ok(Self::None),
            Written::Connected(true) => Ok(Self::Low),
            Written::Level(level) => match level.as_str() {
                "low" => Ok(Self::Low),
                "high" => Ok(Self::High),
                _ => Err(format!("driver_fault is {level:?}; allowed: true or \"low\", \"high\", false")),
            },
        }
    }
}
