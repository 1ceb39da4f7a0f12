//! Springs, dampers and forces that have lost their direction.

use crate::mechanism::{Argument, At, System};

/// A load in force whose ends are at one place, or in which a norm or root vanishes.
pub(crate) fn ends_that_meet<S: System + ?Sized>(system: &S, at: At<'_>) -> Option<String> {
    let description = system.description();
    let mut pairs = vec![0.0; 2 * description.arguments.len()];
    system.arguments(at, &mut pairs);
    let parameters = system.parameters();
    let meets = |(argument, pair): &(&Argument, &[f64])| {
        !argument.load.is_empty() && pair[0] == 0.0 && argument.is_in_force(&parameters)
    };
    let found = description.arguments.iter().zip(pairs.chunks_exact(2)).find(meets);
    found.map(|(argument, _)| argument.load.to_string())
}
