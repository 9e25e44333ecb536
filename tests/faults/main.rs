//! Claims about doses cut off at random instants. No dose is lost, none is counted twice, and the delivered
//! volume lies within the bounds on record.
//!
//! `cargo test` runs a few dozen doses. `make faults` runs 500 on the simulated drive, 500 on simulated boards,
//! 200 racks, 200 flows over time, 200 of the command on simulated nodes, and 40 on each firmware that this
//! machine has as a simulator. The program starts itself again, or the command, as a child that it can kill. It
//! compares the record with the words of the child and with the board's count of steps.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test may panic, and says what it did")]

mod boards;
mod child;
mod nodes;
mod profiles;
mod racks;
mod random;
#[path = "../../examples/simulated_grbl/simulated/mod.rs"]
mod simulated;
#[allow(dead_code, reason = "the board of an example, with more to look at")]
#[path = "../../examples/simulated_node/simulated_node/mod.rs"]
mod simulated_node;
mod simulation;
mod simulators;

use std::{env, thread};

use random::Random;

/// Name, usual number, largest number and function of a kind of cut.
type Kind = (&'static str, u32, u32, fn(u32, &mut Random));

const KINDS: [Kind; 5] = [
    ("simulation", 40, u32::MAX, simulation::run),
    ("racks", 12, 200, racks::run),
    ("profiles", 10, 200, profiles::run),
    ("boards", 16, u32::MAX, boards::run),
    ("nodes", 10, 200, nodes::run),
];

fn main() {
    let arguments: Vec<String> = env::args().collect();
    if arguments.get(1).is_some_and(|word| word == "child") {
        return child::main(&arguments[2..]);
    }
    if arguments.get(1).is_some_and(|word| word == "rack") {
        return racks::child(&arguments[2..]);
    }
    if arguments.get(1).is_some_and(|word| word == "profile") {
        return profiles::child(&arguments[2..]);
    }
    let wanted: Option<u32> = env::var("FAULTS_RUNS").ok().map(|runs| runs.parse().unwrap());
    let seed = env::var("FAULTS_SEED").map_or(u64::from(std::process::id()), |seed| seed.parse().unwrap());
    println!("FAULTS_SEED={seed}");
    // `FAULTS_OF=racks` runs that kind alone. Each kind has random numbers of its own, so it repeats alone.
    let of = env::var("FAULTS_OF").ok();
    let runs = |kind: &str| of.as_deref().is_none_or(|only| only == kind);
    // They mostly wait, so they run beside each other.
    thread::scope(|scope| {
        for (number, (kind, usual, most, run)) in (1..).zip(KINDS) {
            if runs(kind) {
                let mut random = Random((0x9E37_79B9_7F4A_7C15_u64 ^ seed).wrapping_mul(2 * number + 1));
                scope.spawn(move || run(wanted.unwrap_or(usual).min(most), &mut random));
            }
        }
    });
    if runs("simulators") {
        simulators::run(wanted.unwrap_or(0).min(40));
    }
}
