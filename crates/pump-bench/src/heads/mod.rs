//! Bought heads: the volume of a revolution as makers publish it, by head and tubing.
//!
//! The rows stand in `heads.toml`. Each names the document that it is from.

mod bought_head;
mod list;
mod nearest;
mod path;
mod rows;
mod table;
#[cfg(test)]
mod tests;

pub use bought_head::{BoughtHead, HeadSource, Provenance};
pub use list::{heads_json, heads_text};
pub use nearest::nearest_heads;
pub(crate) use path::{path_mm, possible_ml, usual_ml};
pub use rows::{bought_head, bought_heads, heads_matching};
