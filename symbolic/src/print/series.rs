//! `fn series() -> …`: the recurrences of power series as data.

use crate::lower::{Place, Recurrence, Series};

/// The function that gives them.
pub(super) fn recurrences(series: &Series) -> String {
    let place = |place: &Place| match place {
        Place::Constant(constant) => format!("P::Constant({constant})"),
        Place::Row(row) => format!("P::Row({row})"),
    };
    let places = |list: &[Place]| list.iter().map(place).collect::<Vec<_>>().join(", ");
    let entries = |list: &[(usize, usize, Place)]| {
        let entry = |(i, j, x): &(usize, usize, Place)| format!("({i}, {j}, {})", place(x));
        list.iter().map(entry).collect::<Vec<_>>().join(", ")
    };
    let rows: Vec<String> = series.rows.iter().map(|row| format!("R::{}", recurrence(*row))).collect();
    let list = |list: String| format!("List::Borrowed(&[{list}])");
    format!(
        "\n    fn series() -> ::core::option::Option<&'static ::dalembert::mechanism::Series> {{\n        \
         use ::dalembert::mechanism::{{List, Place as P, Recurrence as R}};\n        \
         static SERIES: ::dalembert::mechanism::Series = ::dalembert::mechanism::Series {{\n            \
         constants: {},\n            rows: {},\n            mass: {},\n            bias: {},\n            \
         matrix: {},\n            constraint_bias: {},\n        }};\n        \
         ::core::option::Option::Some(&SERIES)\n    }}\n",
        series.constants.len(),
        list(rows.join(", ")),
        list(entries(&series.mass)),
        list(places(&series.bias)),
        list(entries(&series.matrix)),
        list(places(&series.constraint_bias)),
    )
}

fn recurrence(row: Recurrence) -> String {
    let function = |function: crate::expr::Unary| format!("f64::{}", function.name());
    match row {
        Recurrence::Grown { function: f, of, by, falls } => {
            format!("Grown {{ function: {}, of: {of}, by: {by}, falls: {falls} }}", function(f))
        }
        Recurrence::Divided { function: f, of, by, falls } => {
            format!("Divided {{ function: {}, of: {of}, by: {by}, falls: {falls} }}", function(f))
        }
        // All others are written as they are made.
        row => format!("{row:?}"),
    }
}
