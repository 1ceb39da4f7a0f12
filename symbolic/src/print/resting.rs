//! Where a coordinate would rest, as an expression of the model language.

use rustc_hash::FxHashMap as HashMap;

use super::formula::{Formulas, Notation, Text};
use crate::expr::{Graph, Id, Symbol, partial, substitute};
use crate::lower::Program;

/// What is longer says nothing to a person.
const LONGEST: usize = 240;

/// The place z(q, t) at which all that acts on a coordinate without motion vanishes, F(q, q' = 0, q'' = 0, t) = 0, where that is
/// linear in z: `(k1*a + k2*c)/(k1 + k2)` of what hangs between two springs.
///
/// `None` where it is not, where nothing holds the coordinate, where a discontinuity, a reaction or a phase has a say, or where it
/// would be too long to read.  It is constant where nothing but parameters is in it.
pub fn resting_place(program: &Program, coordinate: usize) -> Option<String> {
    let graph = &mut program.model.graph.clone();
    let own = Symbol::Coordinate(coordinate as u32);
    let residual = still(graph, *program.residual.get(coordinate)?);
    let slope = partial(graph, residual, own);
    let says = |graph: &Graph, id: Id, which: fn(Symbol) -> bool| graph.symbols([id]).into_iter().any(which);
    if graph.symbols([slope]).contains(&own) || slope == graph.integer(0) {
        return None;
    }
    let zero = graph.integer(0);
    let rest = substitute(graph, &[residual], &HashMap::from_iter([(own, zero)]))[0];
    let rest = graph.neg(rest);
    let place = graph.div(rest, slope);
    let unfit = |symbol: Symbol| {
        matches!(
            symbol,
            Symbol::Mode(_)
                | Symbol::Memory(_)
                | Symbol::Reaction(_)
                | Symbol::Multiplier(_)
                | Symbol::Phase(_)
                | Symbol::Dummy(_)
        )
    };
    if says(graph, place, unfit) {
        return None;
    }
    let formulas = Formulas::new(graph, &[place]);
    let (negative, formula) = formulas.roots.first()?;
    let text = Text { model: &program.model }.signed(*negative, formula);
    (formulas.parts.is_empty() && text.len() <= LONGEST).then_some(text)
}

/// An expression where nothing moves, inputs included.
fn still(graph: &mut Graph, root: Id) -> Id {
    let zero = graph.integer(0);
    let moves = |symbol: &Symbol| match symbol {
        Symbol::Speed(_) | Symbol::Acceleration(_) => true,
        Symbol::Input(_, order) => *order > 0,
        _ => false,
    };
    let values = graph.symbols([root]).into_iter().filter(moves).map(|symbol| (symbol, zero)).collect();
    substitute(graph, &[root], &values)[0]
}

#[cfg(test)]
mod tests {
    use super::resting_place;
    use crate::lower::compile;

    fn places(lines: &str) -> Vec<Option<String>> {
        let text = format!(
            "name: P\nparameters: {{m: 1 kg, k: 2 N/m, K: 3 N/m, c: 1 N*s/m, L: 1 m, g: 9.81 m/s^2}}\n\
             coordinates: {{x: m, y: m}}\nkinetic_energy: m*(x'^2 + y'^2)/2\n{lines}"
        );
        let program = compile(&text, &[]).unwrap_or_else(|problems| panic!("{problems:?}"));
        (0..2).map(|coordinate| resting_place(&program, coordinate)).collect()
    }

    #[test]
    fn places_are_given_where_they_are_linear() {
        let some = |text: &str| Some(text.to_owned());
        let hung = places("potential_energy: k*(x - L)^2/2 + K*(y - x)^2/2 - m*g*x\ndissipation: c*x'^2/2");
        assert_eq!(hung, [some("(m*g + k*L + K*y)/(k + K)"), some("x")]);
        // Nothing holds y; of a cubic law there is no formula; a drag says nothing of a place.
        assert_eq!(places("potential_energy: k*x^2/2"), [some("0"), None]);
        assert_eq!(places("potential_energy: k*x^4/L^2 + K*y^2/2\ngeneralized_forces: {y: -c*y'}"), [None, some("0")]);
        // A stop has a say.
        assert_eq!(places("potential_energy: k*max(0, x - L)^2/2 + K*(x - y)^2")[0], None);
    }
}
