//! The catalogue of errors: data, and one constructor for each entry.
//!
//! By subject: [`yaml`] E001–, [`syntax`] E101– (inside expressions, keys and units), [`names`] E201– (names, sizes,
//! indices, kinds), [`units`] E241–, [`states`] E260– (states of first order), [`memory`] E270– (held values), [`contacts`] E278– (friction and contacts), [`noise`] E281–, [`sections`] E301– (the shape of a file), [`mechanics`] E401– (bodies, forces, scenes),
//! [`verdicts`] E501– (what deriving finds), [`later`] E901– (not supported yet).
//!
//! A constructor takes the [`Place`](super::Place) first and then what its message names.  An argument called
//! `help` is a whole sentence and may be empty.

pub mod contacts;
pub mod later;
pub mod mechanics;
pub mod memory;
pub mod names;
pub mod noise;
pub mod sections;
pub mod states;
pub mod syntax;
pub mod units;
pub mod verdicts;
pub mod yaml;

/// One kind of error, as templates with `{argument}` in them.
///
/// A file that raises it is `errors/E201.yaml` in this crate, and what is said about it `errors/E201.txt`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Entry {
    /// Its code, `E201`; with `W` for a warning.
    pub code: &'static str,
    /// The name of its constructor, `unknown_name`.
    pub name: &'static str,
    /// Short title.
    pub title: &'static str,
    /// One line, lower case, naming the offender in backticks.
    pub message: &'static str,
    /// What stands under the caret.
    pub label: &'static str,
    /// A way out; may be empty.
    pub help: &'static str,
    /// A paragraph on what is wrong and why it is refused.
    pub explanation: &'static str,
}

/// Every entry, by subject.
pub static CATALOGUE: &[&[Entry]] = &[
    yaml::ENTRIES,
    syntax::ENTRIES,
    names::ENTRIES,
    units::ENTRIES,
    states::ENTRIES,
    memory::ENTRIES,
    contacts::ENTRIES,
    noise::ENTRIES,
    sections::ENTRIES,
    mechanics::ENTRIES,
    verdicts::ENTRIES,
    later::ENTRIES,
];

/// The entry with this code.
pub fn entry(code: &str) -> Option<&'static Entry> {
    CATALOGUE.iter().copied().flatten().find(|entry| entry.code == code)
}

/// Writes the table of a subject and its constructors: code, constructor, title; message; label; help; explanation.
macro_rules! entries {
    ($($code:ident $name:ident($($argument:ident),*) $title:literal
        $message:literal $label:literal $help:literal $explanation:literal;)*) => {
        /// The entries of this subject.
        pub static ENTRIES: &[$crate::diagnose::Entry] = &[$($crate::diagnose::Entry {
            code: stringify!($code),
            name: stringify!($name),
            title: $title,
            message: $message,
            label: $label,
            help: $help,
            explanation: $explanation,
        }),*];
        $(
            #[doc = concat!(stringify!($code), ": ", $title, ".")]
            #[doc = ""]
            #[doc = $explanation]
            pub fn $name(
                place: $crate::diagnose::Place,
                $($argument: impl std::fmt::Display,)*
            ) -> $crate::diagnose::Problem {
                $crate::diagnose::Problem {
                    code: stringify!($code),
                    message: format!($message),
                    label: format!($label).into(),
                    help: format!($help),
                    place,
                }
            }
        )*
    };
}
use entries;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_rise_and_are_unique() {
        let codes: Vec<&str> = CATALOGUE.iter().copied().flatten().map(|entry| entry.code).collect();
        assert!(codes.windows(2).all(|pair| pair[0][1..] < pair[1][1..]), "{codes:?}");
    }
}
