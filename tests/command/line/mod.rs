//! The command line: its help, the order of its words, and what it refuses.

mod help;
mod order;
mod refusals;
