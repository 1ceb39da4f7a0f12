//! What deriving can find wrong with a model.

use crate::diagnose::{Place, Problem, Step};

fn section(names: &[&str]) -> Place {
    Place { path: names.iter().map(|n| Step::Key((*n).to_owned())).collect(), key: false, span: None }
}

/// The graph has a million nodes.
pub(crate) fn too_large() -> Problem {
    Problem {
        code: "E201",
        message: "the equations need more than 1 000 000 operations".to_owned(),
        label: "this model".to_owned(),
        help: "make families smaller, or choose coordinates in which positions are short".to_owned(),
        place: section(&["coordinates"]),
    }
}

/// A coordinate does not appear in the kinetic energy.
pub(super) fn massless(name: &str, place: Place) -> Problem {
    Problem {
        code: "E202",
        message: format!("coordinate `{name}` carries no mass"),
        label: "no body moves when this coordinate alone moves".to_owned(),
        help: "give a mass or an inertia to a body that it moves, or remove the coordinate".to_owned(),
        place,
    }
}

/// The mass matrix is singular though every coordinate moves something.
pub(super) fn dependent(name: &str, place: Place) -> Problem {
    Problem {
        code: "E203",
        message: format!("coordinate `{name}` moves nothing that the coordinates before it do not move"),
        label: "the mass matrix is singular".to_owned(),
        help: "remove the coordinate, or give mass to what it moves by itself".to_owned(),
        place,
    }
}

/// Two derivations give different equations.
pub(super) fn disagree(first: &str, second: &str, coordinate: &str, values: (f64, f64), state: &str) -> Problem {
    Problem {
        code: "E204",
        message: format!(
            "{first} and {second} disagree in the equation of `{coordinate}`: {:e} against {:e}",
            values.0, values.1
        ),
        label: format!("at {state}"),
        help: "two derivations of one mechanism must agree; a force on the wrong body or point is the usual cause"
            .to_owned(),
        place: section(&["bodies"]),
    }
}

/// Something said to be conserved is not.
pub(super) fn not_conserved(name: &str, rate: f64, scale: f64, state: &str, place: Place) -> Problem {
    Problem {
        code: "E205",
        message: format!("`{name}` is not conserved: its rate is {rate:.6e} where its terms change at up to {scale:.3e}"),
        label: format!("at {state}"),
        help: "remove it, or say with `when` for which parameters it holds".to_owned(),
        place,
    }
}

/// An identity does not hold.
pub(super) fn check_fails(name: &str, left: f64, right: f64, state: &str, place: Place) -> Problem {
    Problem {
        code: "E206",
        message: format!("check `{name}` does not hold: {left:.12e} is not {right:.12e}"),
        label: format!("at {state}"),
        help: "correct it, or say with `when` for which parameters it holds".to_owned(),
        place,
    }
}

/// Too few random states gave finite numbers.
pub(super) fn too_few_states(tried: usize, found: usize, place: Place) -> Problem {
    Problem {
        code: "E207",
        message: format!("only {found} of {tried} random states gave finite numbers"),
        label: "cannot be tested".to_owned(),
        help: "say where the coordinates may be: `sample: {x: [-0.9*l, 0.9*l]}`".to_owned(),
        place,
    }
}
