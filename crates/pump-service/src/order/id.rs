//! Names of orders.

use std::fmt::{self, Display, Formatter, Write};

use serde::{Deserialize, Serialize};

/// Name of an order: 16 hexadecimal digits, which no other order has.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct OrderId(String);

impl OrderId {
    /// Makes a new name from the system's random numbers.
    ///
    /// # Errors
    ///
    /// [`getrandom::Error`] if the system has none.
    pub fn random() -> Result<Self, getrandom::Error> {
        Ok(Self(random_hex::<8>()?))
    }

    /// Takes the name as it was told before.
    pub fn of(text: &str) -> Self {
        Self(text.to_owned())
    }

    /// Returns the digits.
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

/// Returns `BYTES` random bytes as hexadecimal digits.
pub(crate) fn random_hex<const BYTES: usize>() -> Result<String, getrandom::Error> {
    let mut bytes = [0; BYTES];
    getrandom::fill(&mut bytes)?;
    Ok(bytes.iter().fold(String::new(), |mut text, byte| {
        let _ = write!(text, "{byte:02x}");
        text
    }))
}

impl Display for OrderId {
    fn fmt(&self, to: &mut Formatter<'_>) -> fmt::Result {
        to.write_str(&self.0)
    }
}
