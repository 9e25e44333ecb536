//! `dose setup`, as somebody who has never seen it uses it: on a simulated board with another pump behind it, by
//! answers, by options, left and continued.

#![allow(clippy::unwrap_used, reason = "a test may panic")]
#![cfg(unix)]

mod announced;
mod back;
#[allow(dead_code, reason = "the balance of other tests, with more defects")]
#[path = "../../examples/simulated_grbl/balance/mod.rs"]
mod balance;
mod contradictions;
mod course;
mod first_doses;
mod left;
mod node;
mod options;
mod page;
mod person;
mod ports;
#[path = "../faults/random.rs"]
mod random;
mod scale;
mod second;
#[allow(dead_code, reason = "the board of other tests, with more to look at")]
#[path = "../../examples/simulated_grbl/simulated/mod.rs"]
mod simulated;
#[allow(dead_code, unused_imports, reason = "the board of an example, with more to look at")]
#[path = "../../examples/simulated_klipper/simulated_klipper/mod.rs"]
mod simulated_klipper;
#[allow(dead_code, reason = "the board of an example, with more to look at")]
#[path = "../../examples/simulated_node/simulated_node/mod.rs"]
mod simulated_node;
mod slips;
mod truth;
