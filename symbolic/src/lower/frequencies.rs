//! The angular frequencies with which a mechanism depends on time by itself.

use std::collections::BTreeMap;

use super::Program;
use crate::expr::{Binary, DoubleDouble, Graph, Id, Node, Symbol, Unary};
use crate::model::EventAction;

/// |ω| of every sine, cosine, tangent or periodic table of an argument ω t + … in the equations of motion, their constraints and
/// discontinuities, the inputs that they contain, and the events that do more than record; ω is made of parameters, in rad/s.
/// `None` where time stands elsewhere too, so that the mechanism does not repeat itself.
///
/// With all frequencies multiples of one, ω₀, everything repeats itself after 2π/ω₀; that may be a multiple of the shortest period, as it
/// is of cos(ω t)².
pub(super) fn frequencies(program: &mut Program) -> Option<Vec<Id>> {
    // Nor where a clock ticks, or what was remembered differs.
    if !program.model.memory.is_empty() || !program.model.clocks.is_empty() {
        return None;
    }
    let roots = functions_of_time(program);
    let mut search = Search::default();
    for root in roots {
        if search.drift(&mut program.model.graph, root)? != Id::ZERO {
            return None;
        }
    }
    Some(search.found)
}

/// All that time may stand in; where it cancels in an equation of motion it is not looked for, but inputs are.
fn functions_of_time(program: &Program) -> Vec<Id> {
    let Program { residual, constraints, model, .. } = program;
    let acting = model.events.iter().filter(|event| event.actions.iter().any(|action| *action != EventAction::Record));
    let timed = |row: &usize| program.time.iter().any(|entry| entry.0 == *row);
    let mut roots: Vec<Id> = (0..residual.len()).filter(timed).map(|row| residual[row]).collect();
    // The integral of a row with speeds only tells how far a motion has left it: the motion follows the rate.
    let from = |row: usize| usize::from(constraints.integral[row]);
    roots.extend(constraints.values.chunks(3).enumerate().flat_map(|(row, triple)| &triple[from(row)..2]));
    roots.extend(&constraints.bias);
    roots.extend(constraints.matrix.iter().chain(&constraints.friction).map(|entry| entry.2));
    roots.extend(acting.flat_map(|event| [Some(event.when), event.condition]).flatten());
    let contained = contained(program, [&roots[..], residual].concat());
    roots.extend(contained);
    roots
}

/// The functions of inputs, and the arguments of switches, that some expressions contain, directly or by each other.
fn contained(program: &Program, mut next: Vec<Id>) -> Vec<Id> {
    let mut found = Vec::new();
    while !next.is_empty() {
        for symbol in program.model.graph.symbols(std::mem::take(&mut next)) {
            let function = match symbol {
                Symbol::Input(k, order) => program.signals[k as usize].get(usize::from(order)),
                Symbol::Mode(k) => program.switches.get(k as usize).map(|switch| &switch.argument),
                _ => None,
            };
            if let Some(function) = function.filter(|function| !found.contains(*function)) {
                found.push(*function);
                next.push(*function);
            }
        }
    }
    found
}

#[derive(Default)]
struct Search {
    /// Frequencies, each once.
    found: Vec<Id>,
    /// ω of nodes: what is left of them without ω t repeats itself; none where nothing is.
    known: BTreeMap<Id, Option<Id>>,
}

impl Search {
    /// ω such that the expression less ω t repeats itself.
    fn drift(&mut self, graph: &mut Graph, root: Id) -> Option<Id> {
        for id in graph.needed([root]) {
            if !self.known.contains_key(&id) {
                let drift = self.of(graph, id);
                self.known.insert(id, drift);
            }
        }
        self.known[&root]
    }

    /// The same of a node whose children are known.
    fn of(&mut self, graph: &mut Graph, id: Id) -> Option<Id> {
        match graph.node(id) {
            Node::Number(_) => Some(Id::ZERO),
            Node::Symbol(symbol) => Some(if symbol == Symbol::Time { Id::ONE } else { Id::ZERO }),
            Node::Unary(function, x) => {
                let drift = self.known[&x]?;
                match function {
                    Unary::Neg => return Some(graph.neg(drift)),
                    _ if drift == Id::ZERO => return Some(Id::ZERO),
                    Unary::Sin | Unary::Cos | Unary::Tan => self.note(graph, drift),
                    Unary::Table(table) if table.order() > 0 || table.rise() == 0.0 => {
                        self.note_period(graph, drift, table.period()?);
                    }
                    _ => return None,
                }
                Some(Id::ZERO)
            }
            Node::Binary(operation, x, y) => {
                let (dx, dy) = (self.known[&x]?, self.known[&y]?);
                match operation {
                    Binary::Add => Some(graph.add(dx, dy)),
                    Binary::Sub => Some(graph.sub(dx, dy)),
                    _ if dx == Id::ZERO && dy == Id::ZERO => Some(Id::ZERO),
                    Binary::Table(table) => {
                        for (drift, period) in [dx, dy].into_iter().zip(table.periods()) {
                            if drift != Id::ZERO {
                                self.note_period(graph, drift, period?);
                            }
                        }
                        Some(Id::ZERO)
                    }
                    Binary::Mul if dx == Id::ZERO && constant(graph, x) => Some(graph.mul(x, dy)),
                    Binary::Mul if dy == Id::ZERO && constant(graph, y) => Some(graph.mul(dx, y)),
                    Binary::Div if dy == Id::ZERO && constant(graph, y) => Some(graph.div(dx, y)),
                    _ => None,
                }
            }
        }
    }

    /// The frequency of what repeats itself after a period of an argument with this drift.
    fn note_period(&mut self, graph: &mut Graph, drift: Id, period: f64) {
        let turn = graph.double_double(DoubleDouble::PI * DoubleDouble::from(2.0));
        let (turns, period) = (graph.mul(turn, drift), graph.float(period));
        let frequency = graph.div(turns, period);
        self.note(graph, frequency);
    }

    fn note(&mut self, graph: &mut Graph, frequency: Id) {
        let opposite = graph.neg(frequency);
        if ![frequency, opposite].iter().any(|known| self.found.contains(known)) {
            self.found.push(frequency);
        }
    }
}

/// Whether an expression is made of parameters and numbers alone.
fn constant(graph: &Graph, id: Id) -> bool {
    graph.symbols([id]).iter().all(|symbol| matches!(symbol, Symbol::Parameter(_)))
}

#[cfg(test)]
mod tests {
    use crate::expr::Tape;
    use crate::lower::compile;

    /// The frequencies of a block that is pushed so, with k = 4, W = 2; sections of a file may follow.
    fn found(force: &str, more: &str) -> Option<Vec<f64>> {
        let text = format!(
            "name: Block\nparameters: {{m: 1, k: 4, W: 2}}\ncoordinates: {{x: 1, y: 1}}\n\
             kinetic_energy: m*(x'^2 + y'^2)/2\npotential_energy: k*x^2/2\ngeneralized_forces: {{x: \"{force}\"}}\n{more}"
        );
        let program = compile(&text, &[]).expect("a model");
        let frequencies = program.frequencies.clone()?;
        let parameters = [1.0, 4.0, 2.0];
        let tape = Tape::new(&program.model.graph, &frequencies);
        let values: Vec<f64> = tape.evaluate(|symbol| match symbol {
            crate::expr::Symbol::Parameter(k) => parameters[k as usize],
            _ => f64::NAN,
        });
        let mut values: Vec<f64> = values.into_iter().map(f64::abs).collect();
        values.sort_by(f64::total_cmp);
        Some(values)
    }

    /// What repeats itself has frequencies, what does not has none, and what does not depend on time has an empty list.
    #[test]
    fn frequencies_are_those_of_functions_that_repeat_themselves() {
        assert_eq!(found("-3*k*y", ""), Some(vec![]));
        assert_eq!(found("k*(cos(W*t)^2 + sin(W*t)^2)", ""), Some(vec![]), "time that cancels is none");
        assert_eq!(found("-x*cos(W*t)", ""), Some(vec![2.0]));
        assert_eq!(found("-x*cos(W*t) + sin(3*t + k)*exp(cos(W*t/k))", ""), Some(vec![0.5, 2.0, 3.0]));
        assert_eq!(found("cos(W*t + sin(5*t))", ""), Some(vec![2.0, 5.0]));
        assert_eq!(found("sign(sin(3*t) - y)", ""), Some(vec![3.0]), "also inside a discontinuity");
        assert_eq!(found("max(sin(3*t), 0)", ""), Some(vec![3.0]));
    }

    #[test]
    fn what_does_not_repeat_itself_has_no_frequencies() {
        assert_eq!(found("exp(-(t - 7)^2)", ""), None);
        assert_eq!(found("t*cos(W*t)", ""), None);
        assert_eq!(found("cos(W*t^2)", ""), None, "a chirp");
        assert_eq!(found("cos(x*t)", ""), None, "a frequency that is no parameter");
        assert_eq!(found("step(t - 1)", ""), None);
    }

    /// Inputs count where the equations contain them; so do periodic tables, and events that change the motion.
    #[test]
    fn inputs_tables_and_events_count() {
        let inputs = "inputs: {u: sin(7*t), idle: t}\n";
        assert_eq!(found("u*x", inputs), Some(vec![7.0]));
        assert_eq!(found("idle", inputs), None);
        let table = "tables: {cam: {points: [[0, 0], [1, 2], [3, 1], [4, 0]], periodic: true}}\n";
        assert_eq!(found("cam(W*t)", table), Some(vec![std::f64::consts::PI]), "two of four");
        let recorded = "events: {tick: {when: t - 3, then: record}}\n";
        assert_eq!(found("cos(W*t)", recorded), Some(vec![2.0]));
        assert_eq!(found("cos(W*t)", "events: {over: {when: t - 3, then: stop}}\n"), None);
        assert_eq!(
            found("-x", "constraints: {belt: y' - W}\n"),
            Some(vec![]),
            "its integral y - W t is no part of the motion"
        );
    }
}
