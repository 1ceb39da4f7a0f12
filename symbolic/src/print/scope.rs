//! Identifiers in generated functions: one scope that knows all others.

use std::collections::HashSet;

use crate::model::{KEYWORDS, Model, local_name};

/// Identifiers that generated functions have of themselves: arguments, results, and what helps them.
///
/// `symbolic/tests/generated.rs` finds every binding of generated code here or among those that a scope gave out.
pub const OWN: &[&str] = &[
    "c",
    "t",
    "u",
    "q",
    "v",
    "a",
    "l",
    "out",
    "dq",
    "dv",
    "matrix",
    "right",
    "packed",
    "pivots",
    "sizes",
    "mobilities",
    "alone",
    "lane",
    "i",
    "index",
    "motion",
    "scene",
    "system",
    "value",
    "values",
    "start",
    "x",
    "S",
    "DESCRIPTION",
    "SAMPLING",
];

/// Names given out, on top of those of the scopes around.
pub(super) struct Scope<'a> {
    outer: Option<&'a Scope<'a>>,
    taken: HashSet<String>,
    temporaries: usize,
}

impl<'a> Scope<'a> {
    /// The outermost of Rust: keywords, and the names that generated functions have of themselves.
    pub fn root() -> Scope<'static> {
        Scope::with(KEYWORDS.iter().chain(OWN).map(|name| (*name).to_owned()))
    }

    /// One in which these names are taken.
    pub fn with(taken: impl Iterator<Item = String>) -> Scope<'static> {
        Scope { outer: None, taken: taken.collect(), temporaries: 0 }
    }

    /// A scope inside this one.
    pub fn inside(&'a self) -> Scope<'a> {
        Scope { outer: Some(self), taken: HashSet::new(), temporaries: 0 }
    }

    fn knows(&self, name: &str) -> bool {
        self.taken.contains(name) || self.outer.is_some_and(|outer| outer.knows(name))
    }

    /// This name, or with underscores after it the first that nobody has.
    pub fn fresh(&mut self, wanted: &str) -> String {
        let mut name = wanted.to_owned();
        while self.knows(&name) {
            name.push('_');
        }
        self.taken.insert(name.clone());
        name
    }

    /// A name for an intermediate result: `w1`, `w2`, ….
    pub fn temporary(&mut self) -> String {
        self.temporaries += 1;
        self.fresh(&format!("w{}", self.temporaries))
    }
}

/// Names of a model's coordinates, their rates and accelerations, of its multipliers, and of its systems of balances.
pub(super) struct Names {
    /// All of them.
    pub scope: Scope<'static>,
    /// q, q' and q'' of each coordinate.
    pub coordinates: Vec<[String; 3]>,
    /// The multiplier of each row of the constraints.
    pub multipliers: Vec<String>,
    /// The function that writes each system of balances.
    pub balances: Vec<String>,
    /// Each number of the block of constants.
    pub constants: Vec<String>,
}

impl Names {
    /// Names in an outermost scope.
    pub fn of(model: &Model, mut scope: Scope<'static>) -> Names {
        // All coordinates first: one called `x_dot` keeps its name, and the rate of `x` gets another.
        let mechanical = &model.coordinates[..model.mechanical()];
        let own: Vec<String> = mechanical.iter().map(|c| scope.fresh(&local_name(&c.name))).collect();
        let states: Vec<String> = model.states.iter().map(|state| scope.fresh(&local_name(&state.name))).collect();
        let rate = |scope: &mut Scope<'_>, name: &str, suffix: &str| scope.fresh(&joined(name, suffix));
        let mut coordinates: Vec<[String; 3]> = own
            .into_iter()
            .map(|name| {
                let (dot, ddot) = (rate(&mut scope, &name, "dot"), rate(&mut scope, &name, "ddot"));
                [name, dot, ddot]
            })
            .collect();
        // A state is the speed of its hidden coordinate.
        for name in states {
            let (integral, dot) = (scope.fresh(&joined("integral_of", &name)), rate(&mut scope, &name, "dot"));
            coordinates.push([integral, name, dot]);
        }
        let multipliers = model.constraints.iter().flat_map(|c| {
            let one = c.value.len() == 1;
            (0..c.value.len()).map(move |k| if one { c.name.clone() } else { format!("{}_{}", c.name, k + 1) })
        });
        let multipliers: Vec<String> =
            multipliers.map(|name| scope.fresh(&joined("lambda", &local_name(&name)))).collect();
        let function = |system: &str| joined("balances", &local_name(system));
        let balances = model.balances.iter().map(|system| scope.fresh(&function(&system.name))).collect();
        Names { scope, coordinates, multipliers, balances, constants: Vec::new() }
    }
}

/// Two words of one name, in snake case.
pub(super) fn joined(first: &str, second: &str) -> String {
    format!("{}_{}", first.trim_end_matches('_'), second.trim_start_matches('_'))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_name_is_given_out_twice() {
        let mut outer = Scope::root();
        assert_eq!(outer.fresh("theta"), "theta");
        let mut inner = outer.inside();
        assert_eq!(inner.fresh("theta"), "theta_");
        assert_eq!(inner.fresh("theta"), "theta__");
        assert_eq!(inner.fresh("in"), "in_");
        assert_eq!(inner.fresh("out"), "out_");
        assert_eq!(inner.fresh("w1"), "w1");
        assert_eq!(inner.temporary(), "w1_");
        assert_eq!(inner.temporary(), "w2");
    }
}
