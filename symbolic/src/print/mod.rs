//! Programs to Rust; expressions to text.

mod body;
mod description;
mod names;
mod rust;
mod text;

pub use names::{field_name, type_name};
pub use rust::rust;
pub use text::text;
