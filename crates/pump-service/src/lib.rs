//! The service of a laboratory's pumps.
//!
//! - [`schedule`]: the doses that come by the clock, and what happens to those that were missed. It reads no file and
//!   no clock: texts and times go in; runs and errors come out.
//!
//! With the feature `serve`:
//!
//! - [`order`]: orders to a pump in the words of the command.
//! - [`worker`]: the process of the command that carries out an order.
//! - [`history`]: the orders and events on record, in a file of SQLite.
//! - [`service`]: the pumps, and the orders that are carried out now.
//! - [`guard`]: the inputs that must be alive, or their pumps stand.
//! - [`runner`]: the schedule in force, whose runs become orders.
//! - [`http`]: the service for programs and for the page.
//! - [`mqtt`]: the service at an MQTT broker.
#![cfg_attr(docsrs, feature(doc_cfg))]
#![forbid(unsafe_code)]

#[cfg(feature = "serve")]
pub mod guard;
#[cfg(feature = "serve")]
pub mod history;
#[cfg(feature = "serve")]
pub mod http;
#[cfg(feature = "serve")]
pub mod mqtt;
#[cfg(feature = "serve")]
pub mod order;
#[cfg(feature = "serve")]
pub mod runner;
pub mod schedule;
#[cfg(feature = "serve")]
pub mod service;
#[cfg(feature = "serve")]
mod shell;
#[cfg(feature = "serve")]
pub mod worker;

/// Makes a token that nobody guesses: 64 hexadecimal digits.
///
/// # Errors
///
/// [`getrandom::Error`] if the system has no random numbers.
#[cfg(feature = "serve")]
pub fn new_token() -> Result<String, getrandom::Error> {
    order::random_hex::<32>()
}

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
