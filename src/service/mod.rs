//! The command and a service: it asks a running one, or is carried out for one.

#[cfg(feature = "serve")]
pub(crate) mod asking;
pub(crate) mod supervised;
