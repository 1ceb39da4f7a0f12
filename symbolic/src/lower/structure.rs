//! What is recognised in the equations.

use super::candidates::Chosen;
use super::constraints::Constraints;
use super::count::varying;
use super::{Accelerations, Entry};
use crate::derive::Switch;
use crate::derive::elimination::Forms;
use crate::expr::{Binary, Graph, Id, Node, Symbol, Unary};
use crate::gate::Direction;

/// What was recognised.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Structure {
    /// M does not change along a run.
    pub constant_mass: bool,
    /// M's diagonal does not change along a run; where M is not formed, the squares that it is made of do not.
    pub constant_inertias: bool,
    /// M is diagonal.
    pub diagonal_mass: bool,
    /// Sizes of M's diagonal blocks, in the order of their first coordinates.
    pub mass_blocks: Vec<usize>,
    /// M does not change, and nothing in the forces depends on speeds, nor switches with them.
    pub separable: bool,
    /// Linear equations with constant coefficients (forced, perhaps, by what time switches too).
    pub linear: bool,
    /// Nothing does work but what has a potential, and T and V do not contain time.
    pub conservative: bool,
    /// The equations contain time or inputs.
    pub time_dependent: bool,
    /// Accelerations are constant between discontinuities, in every phase.
    pub uniformly_accelerated: bool,
    /// Cyclic coordinates and their momenta.
    pub cyclic: Vec<(usize, Id)>,
    /// Directions of other coordinates that are ignorable, too, with their momenta.
    pub directions: Vec<Direction>,
    /// Decoupled sets of coordinates.
    pub parts: Vec<Vec<usize>>,
}

impl Structure {
    /// With so many states among the coordinates: states of first order move with the speeds, and places and speeds are not moved in turn.
    pub(super) fn with_states(self, states: usize, n: usize) -> Structure {
        let in_turn = states == 0;
        Structure {
            separable: self.separable && in_turn,
            uniformly_accelerated: self.uniformly_accelerated && in_turn,
            conservative: self.conservative && n > states,
            ..self
        }
    }

    /// Where M is not formed, since it is large and changes along a run: what its own forms say of it.
    pub(super) fn without_masses(self, graph: &Graph, forms: &Forms, accelerations: &Accelerations) -> Structure {
        let varying = varying(graph);
        let constant_inertias = match accelerations {
            Accelerations::Unrolled { pivots, .. } => pivots.iter().all(|(_, _, size)| !varying[size.index()]),
            Accelerations::Loop => false,
        };
        Structure {
            constant_mass: false,
            constant_inertias,
            diagonal_mass: false,
            mass_blocks: forms.blocks(),
            separable: false,
            linear: false,
            uniformly_accelerated: false,
            ..self
        }
    }
}

pub(super) fn recognise(
    graph: &Graph,
    n: usize,
    (chosen, rows): (&Chosen, &Constraints),
    (stiffness, damping): (&[Entry], &[Entry]),
    (power, jacobi): (Id, Id),
    switches: &[Switch],
    cyclic: &[(usize, Id)],
) -> Structure {
    let varying = varying(graph);
    let constant = |entries: &[Entry]| entries.iter().all(|e| !varying[e.2.index()]);
    let time = |s: Symbol| matches!(s, Symbol::Time | Symbol::Input(..));
    let constant_mass = constant(&chosen.mass);
    let constant_inertias = chosen.mass.iter().filter(|e| e.0 == e.1).all(|e| !varying[e.2.index()]);
    let moves = |s: Symbol| matches!(s, Symbol::Mode(_) | Symbol::Phase(_) | Symbol::Multiplier(_));
    let by_time = |s: Symbol| matches!(s, Symbol::Mode(k) if switches.get(k as usize).is_some_and(|s| s.time_only));
    let separable = constant_mass && !depends_on_speeds(graph, &chosen.bias, switches);
    let time_dependent = graph.symbols(chosen.residual.iter().copied()).into_iter().any(time);
    let along_rows = rows.matrix.iter().map(|e| e.2).chain(rows.bias.iter().copied());
    let driven_rows = graph.symbols(along_rows).into_iter().any(time);
    let whole = !breaks(graph, &chosen.residual);
    let slopes = [stiffness, damping, &rows.stiffness, &rows.damping, &rows.friction];
    Structure {
        constant_mass,
        constant_inertias,
        diagonal_mass: chosen.mass.iter().all(|e| e.0 == e.1),
        mass_blocks: blocks(n, &chosen.mass),
        separable,
        linear: constant_mass
            && whole
            && constant(stiffness)
            && constant(damping)
            && !graph.symbols(chosen.residual.iter().copied()).into_iter().any(|s| moves(s) && !by_time(s)),
        // A potential that time switches changes the energy at once.
        conservative: power == Id::ZERO && !graph.symbols([jacobi]).into_iter().any(by_time),
        time_dependent,
        uniformly_accelerated: separable
            && whole
            && !time_dependent
            && !driven_rows
            && slopes.iter().all(|entries| entries.is_empty()),
        cyclic: cyclic.to_vec(),
        directions: Vec::new(),
        parts: Vec::new(),
    }
}

/// Whether expressions contain speeds, or modes of switches that do.
fn depends_on_speeds(graph: &Graph, expressions: &[Id], switches: &[Switch]) -> bool {
    // A switch's argument contains modes of earlier switches only.
    let mut switched: Vec<bool> = Vec::with_capacity(switches.len());
    let moves = |switched: &[bool], symbol: Symbol| match symbol {
        Symbol::Speed(_) => true,
        Symbol::Mode(k) => switched.get(k as usize).is_none_or(|moves| *moves),
        _ => false,
    };
    for switch in switches {
        let by_speed = graph.symbols([switch.argument]).into_iter().any(|symbol| moves(&switched, symbol));
        switched.push(by_speed);
    }
    graph.symbols(expressions.iter().copied()).into_iter().any(|symbol| moves(&switched, symbol))
}

/// Whether the state enters a function that jumps or has a pole somewhere: a slope that is the same everywhere between
/// does not make it linear, nor constant where it is 0.
fn breaks(graph: &Graph, roots: &[Id]) -> bool {
    let moves = graph.contains(|s| matches!(s, Symbol::Coordinate(_) | Symbol::Speed(_)));
    let moves = |x: Id| moves.get(x.index()).copied().unwrap_or(true);
    graph.needed(roots.iter().copied()).into_iter().any(|id| match graph.node(id) {
        Node::Unary(Unary::Tan | Unary::Asin | Unary::Acos | Unary::Sqrt | Unary::Ln, x) => moves(x),
        Node::Binary(Binary::Atan2, y, x) => moves(y) || moves(x),
        Node::Binary(Binary::Div, _, x) | Node::Binary(Binary::Pow, x, _) => moves(x),
        _ => false,
    })
}

/// Sizes of the sets of coordinates that M couples.
fn blocks(n: usize, mass: &[Entry]) -> Vec<usize> {
    let mut block: Vec<usize> = (0..n).collect();
    for &(i, j, _) in mass {
        let (a, b) = (block[i].min(block[j]), block[i].max(block[j]));
        for member in block.iter_mut().filter(|m| **m == b) {
            *member = a;
        }
    }
    (0..n).map(|k| block.iter().filter(|&&b| b == k).count()).filter(|&size| size > 0).collect()
}

#[cfg(test)]
mod tests {
    use crate::lower::{Structure, compile};

    fn of(force: &str, more: &str) -> Structure {
        let text = format!(
            "name: Block
parameters: {{m: 1 kg, F: 1 N, L: 1 m}}
coordinates: {{x: m}}
bodies: {{b: {{mass: m, position: \"[x, 0]\"}}}}
forces: {{f: {{on: b, force: \"[{force}, 0]\"}}}}
{more}
scene: {{start: {{x: 1}}}}
"
        );
        compile(&text, &[]).expect("a good file").structure
    }

    /// The slope of what jumps vanishes on both sides.
    #[test]
    fn what_jumps_is_not_called_linear() {
        for force in ["-F*atan(tan(x/L))", "-F*asin(sin(x/L))", "-F*acos(cos(x/L))", "-F*atan2(0, x/L)", "-F*atan(L/x)"]
        {
            let structure = of(force, "");
            assert!(!structure.linear, "{force}");
        }
        for force in ["-F*x/L", "-F*atan(tan(1))*x/L", "-F*atan2(2, 1)*x/L"] {
            assert!(of(force, "").linear, "{force}");
        }
    }

    /// Constant between the jumps is all that accelerations are, which are located.
    #[test]
    fn jumps_between_constants_are_discontinuities() {
        for force in ["-F*cos(atan2(0, x/L))", "-F*atan2(0, x/L)", "-F*atan2(x/L, 0)"] {
            let structure = of(force, "");
            assert!(structure.uniformly_accelerated && !structure.linear, "{force}");
        }
        assert!(!of("-F*cos(atan2(1, x/L))", "").uniformly_accelerated);
    }
}
