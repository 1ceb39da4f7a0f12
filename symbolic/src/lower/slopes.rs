//! How what is computed of a state changes along a direction: one forward pass, whatever the direction, instead of a matrix.

use super::Program;
use crate::expr::{Forward, Graph, Id, Symbol};

/// Changes along a direction, whose components are [`Symbol::Dummy`]s in this order: t, q, q', q'', λ, then u, u', u'' of each input, parameters,
/// held values.
#[derive(Clone, Debug)]
pub struct Slopes {
    /// Of F, then of J q'' + γ, row by row.
    pub equations: Vec<Id>,
    /// Of the outputs.
    pub outputs: Vec<Id>,
    /// Of the file's functions of time for the inputs: u, u', u'' of each.
    pub inputs: Vec<Id>,
}

impl Slopes {
    /// Differentiates; `None` where the model is too large for it.
    pub fn of(program: &mut Program) -> Option<Slopes> {
        let inputs: Vec<Id> = program.signals.iter().flatten().copied().collect();
        let (rows, outputs) = (row_accelerations(program), program.outputs.clone());
        let equations = [program.residual.as_slice(), &rows].concat();
        let places = Places::of(program);
        let graph = &mut program.model.graph;
        let mut forward = Forward::new(|graph: &mut Graph, symbol| match places.place(symbol) {
            Some(place) => graph.symbol(Symbol::Dummy(place)),
            None => Id::ZERO,
        });
        let mut along = |roots: &[Id]| roots.iter().map(|root| forward.of(graph, *root)).collect();
        let slopes = Slopes { equations: along(&equations), outputs: along(&outputs), inputs: along(&inputs) };
        (!program.model.graph.overflowed()).then_some(slopes)
    }
}

/// J q'' + γ of all rows.
fn row_accelerations(program: &mut Program) -> Vec<Id> {
    let graph = &mut program.model.graph;
    let mut sums = program.constraints.bias.clone();
    for &(row, i, slope) in &program.constraints.matrix {
        let acceleration = graph.symbol(Symbol::Acceleration(i as u32));
        let term = graph.mul(slope, acceleration);
        sums[row] = graph.add(sums[row], term);
    }
    sums
}

/// Where the components of a direction begin: t, q, q', q'', λ, then u, u', u'' of each input, parameters, held values.
struct Places {
    speeds: u32,
    accelerations: u32,
    multipliers: u32,
    inputs: u32,
    parameters: u32,
    memory: u32,
    end: u32,
}

impl Places {
    fn of(program: &Program) -> Places {
        let model = &program.model;
        let n = model.coordinates.len() as u32;
        let (speeds, accelerations, multipliers) = (1 + n, 1 + 2 * n, 1 + 3 * n);
        let inputs = multipliers + program.constraints.len() as u32;
        let parameters = inputs + 3 * model.inputs.len() as u32;
        let memory = parameters + model.parameters.len() as u32;
        let end = memory + model.memory.len() as u32;
        Places { speeds, accelerations, multipliers, inputs, parameters, memory, end }
    }

    fn place(&self, symbol: Symbol) -> Option<u32> {
        match symbol {
            Symbol::Time => Some(0),
            Symbol::Coordinate(i) => Some(1 + i),
            Symbol::Speed(i) => Some(self.speeds + i),
            Symbol::Acceleration(i) => Some(self.accelerations + i),
            Symbol::Multiplier(k) => Some(self.multipliers + k),
            Symbol::Input(k, order @ 0..=2) => Some(self.inputs + 3 * k + u32::from(order)),
            Symbol::Parameter(k) => Some(self.parameters + k),
            Symbol::Memory(k) => Some(self.memory + k),
            _ => None,
        }
    }
}

/// How many components a direction has.
pub fn direction_size(program: &Program) -> usize {
    Places::of(program).end as usize
}

#[cfg(test)]
mod tests {
    use std::collections::HashMap;

    use super::*;
    use crate::expr::Tape;
    use crate::lower::compile;

    /// F = m x'' + k x³ − c u' and the output k x, along a direction in which everything changes.
    #[test]
    fn slopes_are_those_by_hand() {
        let text = "name: Spring\nparameters: {m: 2, k: 3, c: 5}\ncoordinates: {x: 1}\ninputs: {u: \"sin(k*t)\"}\n\
                    kinetic_energy: m*x'^2/2\ngeneralized_forces: {x: \"c*u' - k*x^3\"}\noutputs: {pull: k*x}\n";
        let mut program = compile(text, &[]).unwrap();
        let slopes = Slopes::of(&mut program).unwrap();
        let (m, k, c, x, a, u) = (2.0, 3.0, 5.0, 0.7, 0.4, [0.1, 0.2, 0.3]);
        let (dt, dx, da, du, dm, dk, dc) = (0.9, 0.8, 0.6, 0.5, 1.1, 1.2, 1.3);
        // t, x, x', x'', u, u', u'', m, k, c.
        let along = [dt, dx, 0.0, da, 0.0, du, 0.0, dm, dk, dc];
        let values = HashMap::from([
            (Symbol::Parameter(0), m),
            (Symbol::Parameter(1), k),
            (Symbol::Parameter(2), c),
            (Symbol::Coordinate(0), x),
            (Symbol::Acceleration(0), a),
            (Symbol::Input(0, 1), u[1]),
            (Symbol::Time, 0.25),
        ]);
        assert_eq!(direction_size(&program), along.len());
        let roots = [slopes.equations, slopes.outputs, slopes.inputs[..1].to_vec()].concat();
        let found = Tape::new(&program.model.graph, &roots).evaluate(|symbol| match symbol {
            Symbol::Dummy(place) => along[place as usize],
            other => values[&other],
        });
        let right = [
            dm * a + m * da + dk * x * x * x + 3.0 * k * x * x * dx - dc * u[1] - c * du,
            dk * x + k * dx,
            f64::cos(k * 0.25) * (dk * 0.25 + k * dt),
        ];
        for (found, right) in found.iter().zip(right) {
            assert!((found - right).abs() < 1e-14, "{found} {right}");
        }
    }
}
