//! Programs to Rust, to Python, and to formulas for people.

mod body;
mod c;
mod constants;
mod contacts;
mod description;
mod dialect;
mod documentation;
mod expansion;
mod formula;
mod function;
mod linear;
mod linearisation;
mod literal;
mod mechanism;
mod memory;
mod momentum;
mod motions;
mod numpy;
mod parameters;
mod parts;
mod reading;
mod resting;
mod rust;
mod scenes;
mod scope;
mod series;
mod source_file;
mod units;
mod words;

pub use crate::model::{field_name, type_name};
pub use c::{CORE_HEADER, CORE_SOURCE, CText, c, c_float, core_file};
pub use description::{fnv1a, switch_text};
pub use linear::{About, Degree, LinearEnergies, linear_energies, linear_law};
pub use linearisation::{Linearisation, NotLinear};
pub use numpy::python;
pub use reading::{Reading, in_full};
pub use resting::resting_place;
pub use rust::{Purpose, rust};
pub use scope::OWN;
pub use source_file::{FORMAT, first_difference, source_file};
pub use units::si_unit;

/// What stands for a model that has errors: a type without coordinates that implements `Equations<0, 0>`, so that
/// the errors are the only ones.
pub fn skeleton(name: &str) -> String {
    let program = crate::lower::Program::empty(name);
    rust(&program, "", name)
}

/// The `name:` of a model file that may be wrong elsewhere.
pub fn name_in(text: &str) -> String {
    let line = text.lines().find_map(|line| line.strip_prefix("name:"));
    let name = line.unwrap_or("").split('#').next().unwrap_or("").trim().trim_matches(['"', '\'']);
    if name.is_empty() { "Model".to_owned() } else { name.to_owned() }
}
