//! Bad inputs and mishaps: refused by name, before anything moves and with nothing overwritten.

#[cfg(unix)]
mod inputs;
mod json;
mod names;
#[cfg(unix)]
mod outputs;
#[cfg(unix)]
mod readers;
mod values;
