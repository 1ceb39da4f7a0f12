// Faults inside the program: one derivation's expressions altered after the file was read.

use dalembert_symbolic::expr::{Binary, Graph, Id, Node, Rational, Unary};
use dalembert_symbolic::model::{Model, Rotation, Way, Ways, Work};

use super::judge::Window;
use super::{Fault, Plant, Watch};

/// What is done to one expression: it is multiplied by a factor.
#[derive(Clone)]
pub struct Change {
    /// In words, before what is changed.
    words: String,
    /// What it adds to the kind of fault.
    kind: &'static str,
    factor: Factor,
}

#[derive(Clone)]
enum Factor {
    /// This number.
    Ratio(i128, i128),
    /// Two within this window, one elsewhere.
    Within(Window),
}

impl Change {
    /// Wrong altogether.
    pub fn coarse() -> Vec<Change> {
        let all = [("opposite", -1, 1), ("zero", 0, 1), ("twice", 2, 1), ("half", 1, 2)];
        all.map(|(words, n, d)| Change { words: words.to_owned(), kind: "", factor: Factor::Ratio(n, d) }).to_vec()
    }

    /// Off by 10^−digits of its size.
    pub fn slight(digits: u32) -> Change {
        let power = 10_i128.pow(digits);
        let kind = if digits == 6 { ", off by 1e-6" } else { ", off by 1e-12" };
        Change { words: format!("1 + 1e-{digits} times"), kind, factor: Factor::Ratio(power + 1, power) }
    }

    /// Twice within a window.
    pub fn within(kind: &'static str, words: String, window: Window) -> Change {
        Change { words: format!("{words}, twice"), kind, factor: Factor::Within(window) }
    }

    fn is_coarse(&self) -> bool {
        self.kind.is_empty()
    }

    /// True where the factor is a number.
    fn is_constant(&self) -> bool {
        matches!(self.factor, Factor::Ratio(..))
    }

    fn window(&self) -> Window {
        match &self.factor {
            Factor::Within(window) => window.clone(),
            Factor::Ratio(..) => Window::new(),
        }
    }

    fn apply(&self, graph: &mut Graph, list: &mut [Id]) {
        let factor = match &self.factor {
            Factor::Ratio(n, d) => Rational::new(*n, *d).map_or(Id::ONE, |ratio| graph.rational(ratio)),
            Factor::Within(window) => {
                let mut inside = Id::ONE;
                for (symbol, low, high) in window {
                    let x = graph.symbol(*symbol);
                    for (beyond, bound) in [(true, *low), (false, *high)] {
                        let bound = graph.float(bound);
                        let argument = if beyond { graph.sub(x, bound) } else { graph.sub(bound, x) };
                        let step = graph.unary(Unary::Step, argument);
                        inside = graph.mul(inside, step);
                    }
                }
                graph.add(Id::ONE, inside)
            }
        };
        for id in list {
            *id = graph.mul(factor, *id);
        }
    }
}

/// The fault of one change.
fn fault(
    subject: &str,
    change: &Change,
    watch: Watch,
    what: &str,
    alter: impl Fn(&mut Model, &Change) + Send + Sync + 'static,
) -> Fault {
    let applied = change.clone();
    Fault {
        kind: format!("{subject}{}", change.kind),
        what: format!("{} {what}", change.words),
        watch,
        plant: Plant::Engine(Box::new(move |model| alter(model, &applied))),
        window: change.window(),
    }
}

/// Parts of balances scaled, and one summand inside a part flipped.
pub fn of_balances(model: &Model, changes: &[Change]) -> Vec<Fault> {
    let mut faults = Vec::new();
    for (s, system) in model.balances.iter().enumerate() {
        for (b, balance) in system.balances.iter().enumerate() {
            for (p, part) in balance.parts.iter().enumerate() {
                if part.value.iter().all(|x| *x == Id::ZERO) {
                    continue;
                }
                let watch = || Watch::System(system.name.clone());
                for change in changes {
                    let what = format!("of {} in {}", part.name, balance.label);
                    let subject = "derived balances: a part scaled";
                    faults.push(fault(subject, change, watch(), &what, move |model, change| {
                        change.apply(&mut model.graph, &mut model.balances[s].balances[b].parts[p].value);
                    }));
                }
                for (k, id) in part.value.iter().enumerate().filter(|_| changes.iter().any(Change::is_coarse)) {
                    let flipped = match model.graph.node(*id) {
                        Node::Binary(Binary::Add, x, y) => (Binary::Sub, x, y),
                        Node::Binary(Binary::Sub, x, y) => (Binary::Add, x, y),
                        _ => continue,
                    };
                    faults.push(Fault {
                        kind: "derived balances: a sign inside a part".to_owned(),
                        what: format!("a sign inside {} in {}", part.name, balance.label),
                        watch: watch(),
                        plant: Plant::Engine(Box::new(move |model| {
                            let (operation, x, y) = flipped;
                            model.balances[s].balances[b].parts[p].value[k] = model.graph.binary(operation, x, y);
                        })),
                        window: Window::new(),
                    });
                }
            }
        }
    }
    faults
}

/// Masses, inertias, positions, gravity and loads as Lagrange's equations see them; the balances, derived
/// before, keep the right ones.
pub fn of_lagrange(model: &Model, changes: &[Change]) -> Vec<Fault> {
    let mut faults = Vec::new();
    // What is wrong in some places only has no mass matrix of its own: loads alone are spoilt so.
    for change in changes.iter().filter(|c| c.is_constant()) {
        let inertial = !change.is_coarse() || ["twice", "half"].contains(&change.words.as_str());
        for (b, body) in model.bodies.iter().enumerate() {
            if inertial {
                let what = format!("the mass of {}", body.name);
                faults.push(fault("Lagrange: a mass", change, Watch::Systems, &what, move |m, change| {
                    change.apply(&mut m.graph, std::slice::from_mut(&mut m.bodies[b].mass));
                }));
            }
            if inertial && body.rotation.is_some() {
                let what = format!("the inertia of {}", body.name);
                faults.push(fault("Lagrange: an inertia", change, Watch::Systems, &what, move |m, change| {
                    if let Some(rotation) = &mut m.bodies[b].rotation {
                        change.apply(&mut m.graph, rotation.inertias_mut());
                    }
                }));
            }
            if let Some(Rotation::Space { frame, .. }) = &body.rotation {
                for k in (0..3).filter(|k| frame.own_velocity[*k] != Id::ZERO) {
                    let subject = "Lagrange: a component of an angular velocity";
                    let what = format!("of component {k} of the angular velocity of {}", body.name);
                    faults.push(fault(subject, change, Watch::Systems, &what, move |m, change| {
                        if let Some(Rotation::Space { frame, .. }) = &mut m.bodies[b].rotation {
                            change.apply(&mut m.graph, &mut frame.own_velocity[k..=k]);
                        }
                    }));
                }
            }
            for k in (0..body.position.len()).filter(|k| body.position[*k] != Id::ZERO) {
                let (subject, what) =
                    ("Lagrange: a component of a position", format!("of component {k} of {}", body.name));
                faults.push(fault(subject, change, Watch::Systems, &what, move |m, change| {
                    let body = &mut m.bodies[b];
                    change.apply(&mut m.graph, &mut body.position[k..=k]);
                    // All that is derived from places has this one.
                    let place = body.position.as_slice().try_into().map(|place| (0, place));
                    body.ways = Ways(vec![Way { stages: Vec::new(), pieces: place.into_iter().collect() }]);
                }));
            }
        }
    }
    for change in changes {
        if model.gravity.is_some() {
            faults.push(fault("Lagrange: gravity", change, Watch::Systems, "of gravity", |m, change| {
                if let Some(gravity) = &mut m.gravity {
                    change.apply(&mut m.graph, gravity);
                }
            }));
        }
        for (l, load) in model.loads.iter().enumerate() {
            let (subject, what) = ("Lagrange: a spring, damper or force", format!("of {}", load.name));
            faults.push(fault(subject, change, Watch::Systems, &what, move |m, change| {
                let load = &mut m.loads[l];
                match &mut load.work {
                    Work::Potential(v) => change.apply(&mut m.graph, std::slice::from_mut(v)),
                    Work::Resistance { tension, .. } => change.apply(&mut m.graph, std::slice::from_mut(tension)),
                    Work::Pushes => {
                        for push in &mut load.pushes {
                            change.apply(&mut m.graph, &mut push.force);
                            change.apply(&mut m.graph, &mut push.couple);
                        }
                    }
                }
            }));
        }
    }
    faults
}
