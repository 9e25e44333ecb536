//! The service of a laboratory's pumps.
//!
//! - [`schedule`]: the doses that come by the clock, and what happens to those that were missed.
//!
//! The crate reads no file and no clock. Texts and times go in; runs and errors come out.
#![forbid(unsafe_code)]

pub mod schedule;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
