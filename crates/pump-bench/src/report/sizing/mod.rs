//! The report of a sizing, in words and as JSON.

mod json;
mod text;

pub use json::sizing_json;
pub use text::{sizing_text, sizing_title};
