//! ∂F/∂t, and which equations depend on time at all.

use super::Entry;
use super::magnitude::Magnitudes;
use crate::derive::Switch;
use crate::expr::{Forward, Graph, Id, Node, Symbol, Tape, Unary, rewrite};
use crate::random::Random;

/// What of the equations of motion depends on time by itself, not by way of inputs.
#[derive(Clone, Debug, Default)]
pub(super) struct OfTime {
    /// ∂F/∂t of the equations that depend on time; the column is 0.
    pub entries: Vec<Entry>,
    /// The same, with generic numbers in the place of functions of time that can be as small as none (a pulse far away).
    pub generic: Vec<Id>,
    /// Switches whose argument depends on time.
    pub switches: Vec<usize>,
}

/// Differentiates by time.  What cancels (a hoop that turns at a constant rate) is left out: it vanishes, beside its
/// own terms, at random states, times and parameters.
pub(super) fn of_time(graph: &mut Graph, residual: &[Id], switches: &[Switch]) -> OfTime {
    let arguments: Vec<Id> = switches.iter().map(|switch| switch.argument).collect();
    let all: Vec<Id> = residual.iter().chain(&arguments).copied().collect();
    if !graph.symbols(all.iter().copied()).contains(&Symbol::Time) {
        return OfTime::default();
    }
    let mut by_time = Forward::new(|_: &mut Graph, s| if s == Symbol::Time { Id::ONE } else { Id::ZERO });
    let rates: Vec<Id> = all.iter().map(|f| by_time.of(graph, *f)).collect();
    let generic = with_generic_functions(graph, &rates);
    let changes = changing(graph, &rates, &generic);
    let (rows, rest) = changes.split_at(residual.len());
    let kept: Vec<usize> = (0..rows.len()).filter(|i| rows[*i]).collect();
    OfTime {
        entries: kept.iter().map(|i| (*i, 0, rates[*i])).collect(),
        generic: kept.iter().map(|i| generic[*i]).collect(),
        switches: (0..rest.len()).filter(|k| rest[*k]).collect(),
    }
}

/// Functions of time alone, but for sine and cosine (which are nowhere small for long), become numbers.
fn with_generic_functions(graph: &mut Graph, roots: &[Id]) -> Vec<Id> {
    let moves = |s: &Symbol| {
        matches!(
            s,
            Symbol::Coordinate(_)
                | Symbol::Speed(_)
                | Symbol::Acceleration(_)
                | Symbol::Multiplier(_)
                | Symbol::Mode(_)
                | Symbol::Memory(_)
                | Symbol::Phase(_)
        )
    };
    let mut random = Random::new();
    rewrite(graph, roots, |graph, node| {
        let Node::Unary(function, x) = node else { return None };
        if matches!(function, Unary::Neg | Unary::Abs | Unary::Sin | Unary::Cos | Unary::Tan) {
            return None;
        }
        let symbols = graph.symbols([x]);
        let of_time = symbols.contains(&Symbol::Time) && !symbols.iter().any(moves);
        of_time.then(|| graph.float(random.between(0.4, 0.9)))
    })
}

/// Which expressions are not zero, in one form or the other, at some random state.
fn changing(graph: &mut Graph, rates: &[Id], generic: &[Id]) -> Vec<bool> {
    let forms: Vec<Id> = rates.iter().chain(generic).copied().collect();
    let mut magnitudes = Magnitudes::default();
    let sizes: Vec<Id> = forms.iter().map(|form| magnitudes.of(graph, *form)).collect();
    let tape = Tape::new(graph, &[forms.as_slice(), &sizes].concat());
    let mut random = Random::new();
    let n = rates.len();
    let mut changes: Vec<bool> = vec![false; n];
    let mut seen = vec![false; n];
    for sample in 0..12 {
        let symbols: std::cell::RefCell<std::collections::BTreeMap<Symbol, f64>> = Default::default();
        let draw = std::cell::RefCell::new(&mut random);
        let span = [1.0, 3.0, 0.1, 30.0][sample % 4];
        let values = tape.evaluate(|symbol| {
            *symbols.borrow_mut().entry(symbol).or_insert_with(|| match symbol {
                Symbol::Parameter(_) | Symbol::Memory(_) => draw.borrow_mut().between(0.3, 2.0),
                Symbol::Mode(_) | Symbol::Phase(_) => 1.0,
                Symbol::Time => draw.borrow_mut().between(0.0, span),
                _ => draw.borrow_mut().between(-0.9, 0.9) * span.min(1.0),
            })
        });
        let (forms, sizes) = values.split_at(2 * n);
        for k in 0..2 * n {
            if forms[k].is_finite() && sizes[k].is_finite() {
                seen[k % n] = true;
                changes[k % n] |= forms[k].abs() > 1e-9 * sizes[k];
            }
        }
    }
    // What could not be evaluated is not known to stand still.
    (0..n).map(|k| rates[k] != Id::ZERO && (changes[k] || !seen[k])).collect()
}

#[cfg(test)]
mod tests {
    use crate::lower::compile;

    fn rows(force: &str) -> usize {
        let text = format!(
            "name: Block\nparameters: {{m: 1, k: 4, W: 2}}\ncoordinates: {{x: 1, y: 1}}\n\
             kinetic_energy: m*(x'^2 + y'^2)/2\npotential_energy: k*x^2/2\ngeneralized_forces: {{x: \"{force}\"}}\n"
        );
        compile(&text, &[]).map_or(99, |program| program.time.len())
    }

    /// Time that cancels, also by the theorem of addition, is none; a pulse that no sample meets is.
    #[test]
    fn equations_depend_on_time_or_do_not() {
        assert_eq!(rows("-3*k*y"), 0);
        assert_eq!(rows("k*(cos(W*t)^2 + sin(W*t)^2)"), 0);
        assert_eq!(rows("k*(cos(W*t + y)*cos(W*t) + sin(W*t + y)*sin(W*t))"), 0);
        assert_eq!(rows("exp(-(t - 700)^2)"), 1);
        assert_eq!(rows("-x*cos(W*t)"), 1);
        assert_eq!(rows("tanh(t - 1e6)"), 1);
        assert_eq!(rows("k*tanh((t - 1e4*W)/W)"), 1);
    }
}
