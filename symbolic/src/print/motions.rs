//! Motions that the file asks for, as Rust.

use std::fmt::Write;

use super::body::Bodies;
use super::description::{list, string};
use super::function::{argument, of_constants};
use super::literal::float;
use crate::lower::Program;
use crate::model::{Closes, Goal, Image, Motion};

/// `motions` and `motion_numbers`; those of the trait serve where there are none.
pub(super) fn motions(program: &Program, bodies: &Bodies<'_>) -> String {
    let motions = &program.model.motions;
    if motions.is_empty() {
        return String::new();
    }
    let entries: String = motions.iter().map(|motion| format!("            {},\n", entry(motion))).collect();
    let mut arms = String::new();
    for place in 0..motions.len() {
        let values = program.motion_numbers(place);
        let _ = write!(
            arms,
            "            {place} => {{\n{}                values(c).to_vec()\n            }}\n",
            of_constants(bodies, "values", &values, "                ")
        );
    }
    let c = argument("c", "&[S]", true);
    format!(
        "
    fn motions() -> &'static [::dalembert::mechanism::Motion] {{
        use ::dalembert::mechanism;
        static MOTIONS: &[mechanism::Motion] = &[
{entries}        ];
        MOTIONS
    }}

    fn motion_numbers<S: ::dalembert::mechanism::Real>({c}, motion: usize) -> ::std::vec::Vec<S> {{
        match motion {{
{arms}            _ => ::std::vec::Vec::new(),
        }}
    }}
"
    )
}

fn entry(motion: &Motion) -> String {
    let unknowns = list(motion.unknowns.iter().map(|(name, _)| string(name)));
    format!(
        "mechanism::Motion {{ name: {}, goal: {}, unknowns: {unknowns} }}",
        string(&motion.name),
        goal(&motion.goal)
    )
}

fn goal(goal: &Goal) -> String {
    match goal {
        Goal::Closes(closes) => format!("mechanism::Goal::Closes({})", closing(closes)),
        Goal::Meets { conditions, extreme } => {
            let conditions = list(conditions.iter().map(|(name, _)| string(name)));
            let extreme = extreme.as_ref().map(|(name, largest)| {
                let extreme = if *largest { "Largest" } else { "Smallest" };
                format!("({}, mechanism::Extreme::{extreme})", string(name))
            });
            format!("mechanism::Goal::Meets {{ conditions: {conditions}, extreme: {} }}", optional(extreme))
        }
        Goal::Fits(columns) => {
            let column = |(name, values): &(String, Vec<f64>)| {
                format!("({}, {})", string(name), list(values.iter().map(|x| float(*x))))
            };
            format!("mechanism::Goal::Fits({})", list(columns.iter().map(column)))
        }
    }
}

fn closing(closes: &Closes) -> String {
    let by = match closes.event {
        Some((event, count)) => format!("mechanism::ClosesBy::Event {{ event: {event}, count: {count} }}"),
        None => format!("mechanism::ClosesBy::Part({})", closes.part),
    };
    let between = closes.between.as_ref();
    let ends = between.map(|[from, to]| format!("[{}, {}]", images(from), images(to)));
    format!(
        "mechanism::Closes {{ by: {by}, period: {}, energy: {}, images: {}, phases: {}, shifts: {}, turns: {}, between: {} }}",
        closes.period.is_some(),
        closes.energy.is_some(),
        images(&closes.image),
        list(closes.image.phases.iter().map(ToString::to_string)),
        list(closes.shifts.iter().map(ToString::to_string)),
        list(closes.turns.iter().map(|(coordinate, turns)| format!("({coordinate}, {turns})"))),
        optional(ends),
    )
}

fn images(image: &Image) -> String {
    list(image.coordinates.iter().map(|(of, opposite)| format!("({of}, {opposite})")))
}

fn optional(value: Option<String>) -> String {
    match value {
        None => "::core::option::Option::None".to_owned(),
        Some(value) => format!("::core::option::Option::Some({value})"),
    }
}
