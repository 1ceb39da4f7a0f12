// Faults inside the program: one derivation's expressions altered after the file was read.

use dalembert_symbolic::expr::{Binary, Graph, Id, Node, Rational};
use dalembert_symbolic::model::{Model, Work};

use super::{Fault, Plant, Watch};

/// What is done to one expression.
const CHANGES: [(&str, i128, i128); 4] = [("opposite", -1, 1), ("zero", 0, 1), ("twice", 2, 1), ("half", 1, 2)];

fn fault(kind: &'static str, watch: Watch, what: String, alter: impl Fn(&mut Model) + Send + Sync + 'static) -> Fault {
    Fault { kind: kind.to_owned(), what, watch, plant: Plant::Engine(Box::new(alter)) }
}

fn scale(graph: &mut Graph, list: &mut [Id], numerator: i128, denominator: i128) {
    let Some(factor) = Rational::new(numerator, denominator) else { return };
    let factor = graph.rational(factor);
    for id in list {
        *id = graph.mul(factor, *id);
    }
}

/// Parts of balances scaled, and one summand inside a part flipped.
pub fn of_balances(model: &Model) -> Vec<Fault> {
    let mut faults = Vec::new();
    for (s, system) in model.balances.iter().enumerate() {
        for (b, balance) in system.balances.iter().enumerate() {
            for (p, part) in balance.parts.iter().enumerate() {
                if part.value.iter().all(|x| *x == Id::ZERO) {
                    continue;
                }
                let watch = || Watch::System(system.name.clone());
                for (words, numerator, denominator) in CHANGES {
                    let what = format!("{words} of {} in {}", part.name, balance.label);
                    faults.push(fault("derived balances: a part scaled", watch(), what, move |model| {
                        let list = &mut model.balances[s].balances[b].parts[p].value;
                        scale(&mut model.graph, list, numerator, denominator);
                    }));
                }
                for (k, id) in part.value.iter().enumerate() {
                    let flipped = match model.graph.node(*id) {
                        Node::Binary(Binary::Add, x, y) => (Binary::Sub, x, y),
                        Node::Binary(Binary::Sub, x, y) => (Binary::Add, x, y),
                        _ => continue,
                    };
                    let what = format!("a sign inside {} in {}", part.name, balance.label);
                    faults.push(fault("derived balances: a sign inside a part", watch(), what, move |model| {
                        let (operation, x, y) = flipped;
                        model.balances[s].balances[b].parts[p].value[k] = model.graph.binary(operation, x, y);
                    }));
                }
            }
        }
    }
    faults
}

/// Masses, inertias, positions, gravity and loads as Lagrange's equations see them; the balances, derived
/// before, keep the right ones.
pub fn of_lagrange(model: &Model) -> Vec<Fault> {
    let mut faults = Vec::new();
    let mut add = |kind, what: String, alter: Box<dyn Fn(&mut Model) + Send + Sync>| {
        faults.push(fault(kind, Watch::Systems, what, alter));
    };
    for (b, body) in model.bodies.iter().enumerate() {
        for (words, numerator, denominator) in [CHANGES[2], CHANGES[3]] {
            add(
                "Lagrange: a mass",
                format!("{words} the mass of {}", body.name),
                Box::new(move |m| {
                    scale(&mut m.graph, std::slice::from_mut(&mut m.bodies[b].mass), numerator, denominator)
                }),
            );
            if body.rotation.is_some() {
                add(
                    "Lagrange: an inertia",
                    format!("{words} the inertia of {}", body.name),
                    Box::new(move |m| {
                        if let Some(rotation) = &mut m.bodies[b].rotation {
                            scale(&mut m.graph, std::slice::from_mut(&mut rotation.inertia), numerator, denominator);
                        }
                    }),
                );
            }
        }
        for k in (0..body.position.len()).filter(|k| body.position[*k] != Id::ZERO) {
            for (words, numerator, denominator) in CHANGES {
                add(
                    "Lagrange: a component of a position",
                    format!("{words} of component {k} of {}", body.name),
                    Box::new(move |m| scale(&mut m.graph, &mut m.bodies[b].position[k..=k], numerator, denominator)),
                );
            }
        }
    }
    for (words, numerator, denominator) in CHANGES {
        if model.gravity.is_some() {
            add(
                "Lagrange: gravity",
                format!("{words} of gravity"),
                Box::new(move |m| {
                    if let Some(gravity) = &mut m.gravity {
                        scale(&mut m.graph, gravity, numerator, denominator);
                    }
                }),
            );
        }
        for (l, load) in model.loads.iter().enumerate() {
            add(
                "Lagrange: a spring, damper or force",
                format!("{words} of {}", load.name),
                Box::new(move |m| {
                    let load = &mut m.loads[l];
                    match &mut load.work {
                        Work::Potential(v) => scale(&mut m.graph, std::slice::from_mut(v), numerator, denominator),
                        Work::Resistance { tension, .. } => {
                            scale(&mut m.graph, std::slice::from_mut(tension), numerator, denominator);
                        }
                        Work::Pushes => {
                            for push in &mut load.pushes {
                                scale(&mut m.graph, &mut push.force, numerator, denominator);
                                scale(&mut m.graph, &mut push.couple, numerator, denominator);
                            }
                        }
                    }
                }),
            );
        }
    }
    faults
}
