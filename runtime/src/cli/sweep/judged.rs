//! How many digits of a sweep's printed rows hold.

use std::collections::HashMap;

use super::table::{Row, Table};
use crate::Run;
use crate::numbers::short;
use crate::run::written;

/// Numbers of a sweep are printed with six digits: what is known to this part of itself has them.
const PRINTED: f64 = 1e-6;

/// The numbers of some rows with the digits that hold, by run and column, of which fewer than six do.
#[derive(Debug, Default)]
pub struct Judged {
    texts: HashMap<(usize, String), String>,
    /// Whether it was asked how many hold.
    pub asked: bool,
}

impl Judged {
    /// Notes what a run, which was told to estimate its digits, says of these columns of its row.
    pub fn note(&mut self, run: &Run, row: &Row, table: &Table, shown: &[String]) {
        for name in shown {
            let value = table.column(name).and_then(|place| row.cells[place]);
            if let Some(text) = value.and_then(|value| text(run, name, value)) {
                self.texts.insert((row.run, name.clone()), text);
            }
        }
    }

    /// A cell as text, with six digits where nothing is known of them.
    pub fn text(&self, run: usize, name: &str, value: f64) -> String {
        self.texts.get(&(run, name.to_owned())).cloned().unwrap_or_else(|| short(value))
    }
}

/// A value at the end, or an extreme, with at most six digits that hold; `None` where nothing is known of it, or all of them hold.
fn text(run: &Run, name: &str, value: f64) -> Option<String> {
    let extreme = name.strip_prefix("min ").or_else(|| name.strip_prefix("max "));
    let bounds = run.errors(extreme.unwrap_or(name))?;
    let error = match extreme {
        Some(_) => bounds.iter().copied().fold(0.0, f64::max),
        None => *bounds.last()?,
    };
    let known = error <= PRINTED * value.abs();
    (!known).then(|| if extreme.is_some() { written(value, error) } else { run.written(name, value) })
}
