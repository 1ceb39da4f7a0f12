//! `balances`: the second derivation, from momentum balance (LANGUAGE, section 7).
//!
//! Every balance becomes a residual, inertia less forces, in named parts: what each body's acceleration, gravity,
//! each load and each unknown reaction contributes.  The deriver solves the residuals for the accelerations.

use std::collections::BTreeMap;

use super::reactions::Unknown;
use super::running_sums::Asked;
use crate::diagnose::catalogue::{mechanics, sections};
use crate::expr::{Id, Symbol, partial, vectors};
use crate::file::{Node, Spot, Text};
use crate::model::expression::dimension::Dimension;
use crate::model::expression::families::Locals;
use crate::model::expression::rules::Rules;
use crate::model::resolved::{Balance, BalanceSystem, Body, Part, Push, Work};
use crate::model::resolver::Resolver;
use crate::model::rotation::Rotation;

/// The kinds of balances.
const KINDS: [&str; 5] = ["moment", "force", "power", "energy", "equation"];

/// One system's bodies, loads and reactions at hand.
pub struct Sums<'s> {
    unknowns: &'s [Unknown],
    phases: &'s [usize],
}

impl Sums<'_> {
    /// Whether it names no reaction.
    pub fn has_no_unknowns(&self) -> bool {
        self.unknowns.is_empty()
    }
}

impl<'a> Resolver<'a> {
    /// The balances themselves, and how loads at shared points would change them.
    pub fn balances(&mut self) {
        let before = self.builder.problems.len();
        self.model.balances = self.systems();
        if self.builder.sound_since(before) {
            self.shared_ends();
        }
    }

    /// Every system that is complete.
    pub fn systems(&mut self) -> Vec<BalanceSystem> {
        let mut systems = Vec::new();
        for (name, system) in self.balance_systems() {
            if !system.only(&["equations", "reactions", "phase"], "a system of balances", &mut self.builder.problems) {
                continue;
            }
            let before = self.builder.problems.len();
            let phases = self.claimed_phases(&system, &Self::no_locals()).flatten();
            let phases = phases.unwrap_or_else(|| self.phases_of_a_system());
            let unknowns = self.unknowns(&system);
            let mut balances: Vec<Option<Balance>> = Vec::new();
            let Some(equations) = system.need("equations", "a system of balances", &mut self.builder.problems) else {
                continue;
            };
            let sums = Sums { unknowns: &unknowns, phases: &phases };
            match equations.items() {
                Some(items) => {
                    for (k, item) in items.iter().enumerate() {
                        balances.push(self.balance(item, &format!("balance {}", k + 1), &Locals::default(), &sums));
                    }
                }
                None => {
                    let mut seen = BTreeMap::new();
                    for (key, spot) in equations.entries(&mut self.builder.problems) {
                        let Some(family) = self.expand(key, &spot) else { continue };
                        for member in &family.members {
                            let label = member.name();
                            if self.unique(&mut seen, &label, "`equations`", &spot.place) {
                                balances.push(self.balance(&spot, &label, &member.locals, &sums));
                            }
                        }
                    }
                }
            }
            if !self.builder.sound_since(before) {
                continue;
            }
            // One that is missing needs something whose mistake was told elsewhere.
            let Some(mut balances) = balances.into_iter().collect::<Option<Vec<Balance>>>() else { continue };
            balances.extend(unknowns.iter().flat_map(free_directions));
            balances.extend(self.radial_balances());
            let reactions: Vec<usize> = (0..self.scope.reactions.len())
                .filter(|&k| unknowns.iter().any(|u| u.name == self.scope.reactions[k].name))
                .collect();
            // What is written out may be wrong about a reaction; balances of bodies are not.
            let written = balances.iter().any(Balance::is_written) && !reactions.is_empty();
            let bodies = if written { self.of_bodies(&sums) } else { Vec::new() };
            self.reaction_pushes.extend(unknowns.into_iter().map(|unknown| (unknown.name, unknown.pushes)));
            let place = system.place.of_key();
            let mut system = BalanceSystem { name, balances, reactions, bodies, phases, place };
            self.with_states(&mut system);
            if self.determines(&system) {
                systems.push(system);
            }
        }
        systems
    }

    /// The phases of a system that names none: the first, or all where contacts make them.
    fn phases_of_a_system(&self) -> Vec<usize> {
        if self.contacts.is_empty() { vec![0] } else { (0..self.model.phases.len()).collect() }
    }

    /// The systems by name; a single one is called `balances`.
    pub fn balance_systems(&mut self) -> Vec<(String, Spot<'a>)> {
        let Some(root) = self.root.get("balances") else { return Vec::new() };
        if root.get("equations").is_some() || root.get("reactions").is_some() {
            return vec![("balances".to_owned(), root)];
        }
        let mut seen = BTreeMap::new();
        let mut systems = Vec::new();
        for (key, spot) in root.entries(&mut Vec::new()) {
            let Some(name) = self.label(key, &spot, "`balances`") else { continue };
            if self.unique(&mut seen, &name, "`balances`", &spot.place) {
                systems.push((name, spot));
            }
        }
        systems
    }

    /// One entry of `equations`: a mapping with one kind.
    fn balance(&mut self, spot: &Spot<'_>, label: &str, locals: &Locals, sums: &Sums<'_>) -> Option<Balance> {
        if !spot.only(&KINDS, "a balance", &mut self.builder.problems) {
            return None;
        }
        let Some((kind, inner)) = KINDS.iter().find_map(|kind| Some((*kind, spot.get(kind)?))) else {
            self.builder.problems.push(sections::missing_key(spot.place.of_key(), "moment", "a balance"));
            return None;
        };
        if matches!(kind, "moment" | "force" | "power") {
            for key in ["kinetic_energy", "potential_energy", "dissipation", "generalized_forces"] {
                if let Some(raw) = self.root.get(key) {
                    self.builder.problems.push(mechanics::raw_beside_balances(raw.place.of_key(), key));
                    return None;
                }
            }
        }
        let (mut terms, mut products) = (Vec::new(), Vec::new());
        let parts = match kind {
            "moment" => self.moment(&inner, locals, sums)?,
            "force" => self.momentum(&inner, locals, sums)?,
            "power" => self.power(&inner, locals, sums)?,
            "energy" => self.energy_rate(&inner, sums)?,
            _ => {
                let text = inner.equation(&mut self.builder.problems)?;
                let (left, right) = self.sides(&text, locals)?;
                (terms, products) = self.terms(&text, left.len(), locals);
                let minus = vectors::negative(&mut self.builder.graph, &right);
                vec![
                    Part { name: "the left side".to_owned(), value: left },
                    Part { name: "the right side".to_owned(), value: minus },
                ]
            }
        };
        let components = parts.first().map_or(0, |p| p.value.len());
        let void_at_rest = matches!(kind, "power" | "energy");
        let instantaneous = matches!(kind, "force" | "moment");
        let (label, place) = (format!("{label} ({kind})"), spot.place.clone());
        Some(Balance { label, parts, terms, products, components, void_at_rest, instantaneous, place })
    }

    /// Σ (r − P) × m a + I α − moments about P.
    fn moment(&mut self, spot: &Spot<'_>, locals: &Locals, sums: &Sums<'_>) -> Option<Vec<Part>> {
        let problems = &mut self.builder.problems;
        let keys: &[&str] = if self.scope.dimension == 3 { &["about", "of", "along"] } else { &["about", "of"] };
        spot.only(keys, "a moment balance", problems);
        let about = spot.need("about", "a moment balance", problems)?.written(problems)?;
        let about = self.vector(&about, Rules::position("a point").si(Dimension::LENGTH), locals)?;
        let along = self.along(spot, locals)?;
        let set = self.of(spot, locals)?;
        let parts = self.moment_of(&set, &about, sums);
        Some(self.projected(parts, along))
    }

    /// The same for these bodies.
    fn moment_of(&mut self, set: &[usize], about: &[Id], sums: &Sums<'_>) -> Vec<Part> {
        let sum = self.running_sum(set, &Asked::MomentAbout(about), sums);
        let summed = sum.is_some();
        let mut parts: Vec<Part> = sum.into_iter().collect();
        for &b in set.iter().filter(|_| !summed) {
            let body = self.model.bodies[b].clone();
            let arm = vectors::difference(&mut self.builder.graph, about, &body.position);
            let momentum = self.mass_times_acceleration(b);
            let turning = self.cross(&arm, &momentum);
            parts.push(self.part(format!("m a of {}", body.name), turning, false));
            if let Some(rotation) = &body.rotation {
                let turning = self.rate_of_turning(rotation);
                parts.push(self.part(turning_name(&body.name, turning.len()), turning, false));
            }
            if let Some(gravity) = self.model.gravity.clone() {
                let weight: Vec<Id> = gravity.iter().map(|g| self.builder.graph.mul(body.mass, *g)).collect();
                let turning = self.cross(&arm, &weight);
                parts.push(self.part(format!("the weight of {}", body.name), turning, true));
            }
        }
        for (name, pushes) in self.all_pushes(sums, summed) {
            let mut total = vec![Id::ZERO; vectors::moment_size(self.scope.dimension)];
            let mut touches = false;
            for push in pushes.iter().filter(|p| p.body.is_some_and(|b| set.contains(&b))) {
                touches = true;
                let arm = vectors::difference(&mut self.builder.graph, about, &push.at);
                let turning = self.cross(&arm, &push.force);
                for (k, sum) in total.iter_mut().enumerate() {
                    *sum = self.builder.graph.add(*sum, turning[k]);
                    if let Some(couple) = push.couple.get(k) {
                        *sum = self.builder.graph.add(*sum, *couple);
                    }
                }
            }
            if touches {
                parts.push(self.part(name, total, true));
            }
        }
        parts
    }

    /// Σ m a − forces.
    fn momentum(&mut self, spot: &Spot<'_>, locals: &Locals, sums: &Sums<'_>) -> Option<Vec<Part>> {
        spot.only(&["of", "along"], "a force balance", &mut self.builder.problems);
        let along = self.along(spot, locals)?;
        let set = self.of(spot, locals)?;
        let parts = self.momentum_of(&set, sums);
        Some(self.projected(parts, along))
    }

    /// The same for these bodies.
    fn momentum_of(&mut self, set: &[usize], sums: &Sums<'_>) -> Vec<Part> {
        let sum = self.running_sum(set, &Asked::Force, sums);
        let summed = sum.is_some();
        let mut parts: Vec<Part> = sum.into_iter().collect();
        for &b in set.iter().filter(|_| !summed) {
            let body = self.model.bodies[b].clone();
            let momentum = self.mass_times_acceleration(b);
            parts.push(self.part(format!("m a of {}", body.name), momentum, false));
            if let Some(gravity) = self.model.gravity.clone() {
                let weight = gravity.iter().map(|g| self.builder.graph.mul(body.mass, *g)).collect();
                parts.push(self.part(format!("the weight of {}", body.name), weight, true));
            }
        }
        for (name, pushes) in self.all_pushes(sums, summed) {
            let mut total = vec![Id::ZERO; self.scope.dimension];
            let mut touches = false;
            for push in pushes.iter().filter(|p| p.body.is_some_and(|b| set.contains(&b))) {
                touches = true;
                for (sum, f) in total.iter_mut().zip(&push.force) {
                    *sum = self.builder.graph.add(*sum, *f);
                }
            }
            if touches {
                parts.push(self.part(name, total, true));
            }
        }
        parts
    }

    /// Force on every body, and the moment about its centre of mass on what turns: inertia less all forces and the reactions of
    /// a system.
    fn of_bodies(&mut self, sums: &Sums<'_>) -> Vec<Id> {
        let mut rows = Vec::new();
        for b in 0..self.model.bodies.len() {
            let force = self.momentum_of(&[b], sums);
            let (about, turns) = (self.model.bodies[b].position.clone(), self.model.bodies[b].rotation.is_some());
            let moment = if turns { self.moment_of(&[b], &about, sums) } else { Vec::new() };
            let turning = if turns { vectors::moment_size(self.scope.dimension) } else { 0 };
            for (parts, components) in [(force, self.scope.dimension), (moment, turning)] {
                let graph = &mut self.builder.graph;
                let sum = |k: usize| parts.iter().fold(Id::ZERO, |sum, part| graph.add(sum, part.value[k]));
                rows.extend((0..components).map(sum));
            }
        }
        rows
    }

    /// d/dt of the set's kinetic energy less the power of all forces on it.
    fn power(&mut self, spot: &Spot<'_>, locals: &Locals, sums: &Sums<'_>) -> Option<Vec<Part>> {
        spot.only(&["of"], "a power balance", &mut self.builder.problems);
        let set = self.of(spot, locals)?;
        let half = self.half();
        let mut parts = Vec::new();
        for &b in &set {
            let body = self.model.bodies[b].clone();
            let velocity = self.builder.rates(&body.position);
            let square = vectors::dot(&mut self.builder.graph, &velocity, &velocity);
            let mut doubled = self.builder.graph.mul(body.mass, square);
            if let Some(rotation) = &body.rotation {
                let omega = rotation.angular_velocity(|angle| self.builder.rate(angle));
                let spin = rotation.angular_momentum(&mut self.builder.graph, &omega);
                let turning = vectors::dot(&mut self.builder.graph, &omega, &spin);
                doubled = self.builder.graph.add(doubled, turning);
            }
            let kinetic = self.builder.graph.mul(half, doubled);
            let rate = self.builder.rate(kinetic);
            let rate = self.less_gained_energy(rate, &body, square);
            parts.push(self.part(format!("the kinetic energy of {}", body.name), vec![rate], false));
            if let Some(gravity) = self.model.gravity.clone() {
                let falling = vectors::dot(&mut self.builder.graph, &gravity, &velocity);
                let power = self.builder.graph.mul(body.mass, falling);
                parts.push(self.part(format!("the weight of {}", body.name), vec![power], true));
            }
        }
        for (name, pushes) in self.all_pushes(sums, false) {
            let on_set: Vec<Push> = pushes.into_iter().filter(|p| p.body.is_some_and(|b| set.contains(&b))).collect();
            if !on_set.is_empty() {
                let power = self.power_of(&on_set);
                parts.push(self.part(name, vec![power], true));
            }
        }
        Some(parts)
    }

    /// d/dt (T + V) less the power of everything without a potential.
    fn energy_rate(&mut self, spot: &Spot<'_>, sums: &Sums<'_>) -> Option<Vec<Part>> {
        spot.only(&[], "an energy balance", &mut self.builder.problems);
        let energies = self.scope.energies?;
        let symbols = self.builder.graph.symbols([energies.kinetic, energies.potential]);
        let masses = self.builder.graph.symbols(self.model.bodies.iter().map(|body| body.mass));
        let of_time = |s: &Symbol| matches!(s, Symbol::Time | Symbol::Input(..) | Symbol::State(_));
        if symbols.iter().any(of_time) || masses.into_iter().any(Symbol::may_change) {
            self.builder.problems.push(mechanics::energy_with_time(spot.place.of_key()));
            return None;
        }
        if let Some(name) = self.driven(sums.phases) {
            self.builder.problems.push(mechanics::energy_with_driven_constraint(spot.place.of_key(), name));
            return None;
        }
        let (kinetic, potential) = (self.builder.rate(energies.kinetic), self.builder.rate(energies.potential));
        let mut parts = vec![
            Part { name: "the kinetic energy".to_owned(), value: vec![kinetic] },
            Part { name: "the potential energy".to_owned(), value: vec![potential] },
        ];
        let loads = self.model.loads.clone();
        for load in loads.iter().filter(|load| !matches!(load.work, Work::Potential(_))) {
            let power = self.power_of(&load.pushes);
            parts.push(self.part(load.name.clone(), vec![power], true));
        }
        for unknown in sums.unknowns {
            let power = self.power_of(&unknown.pushes);
            parts.push(self.part(unknown.name.clone(), vec![power], true));
        }
        parts.extend(self.raw_powers());
        Some(parts)
    }

    /// The power of `generalized_forces` and of `dissipation`, Q q' and −q'·∂D/∂q'.
    fn raw_powers(&mut self) -> Vec<Part> {
        let mut powers = Vec::new();
        let graph = &mut self.builder.graph;
        for raw in &self.model.generalized_forces {
            let speed = graph.symbol(Symbol::Speed(raw.coordinate as u32));
            let power = graph.mul(raw.force, speed);
            powers.push((format!("the generalized force on {}", self.model.coordinates[raw.coordinate].name), power));
        }
        let mut loss = Id::ZERO;
        for i in 0..self.model.coordinates.len() as u32 {
            let slope = partial(graph, self.model.dissipation, Symbol::Speed(i));
            let speed = graph.symbol(Symbol::Speed(i));
            let product = graph.mul(slope, speed);
            loss = graph.sub(loss, product);
        }
        if loss != Id::ZERO {
            powers.push(("the dissipation".to_owned(), loss));
        }
        powers.into_iter().map(|(name, power)| self.part(name, vec![power], true)).collect()
    }

    /// Σ F · velocity of the material + couple · ω.
    fn power_of(&mut self, pushes: &[Push]) -> Id {
        let mut total = Id::ZERO;
        for push in pushes {
            let Some(b) = push.body else { continue };
            let velocity = self.velocity_of_material(b, &push.at);
            if let Some(rotation) = self.model.bodies[b].rotation.clone() {
                let omega = rotation.angular_velocity(|angle| self.builder.rate(angle));
                let work = vectors::dot(&mut self.builder.graph, &push.couple, &omega);
                total = self.builder.graph.add(total, work);
            }
            let work = vectors::dot(&mut self.builder.graph, &push.force, &velocity);
            total = self.builder.graph.add(total, work);
        }
        total
    }

    /// d/dt of I ω, or R I Rᵀ ω, with moments of inertia that are held.
    pub fn rate_of_turning(&mut self, rotation: &Rotation) -> Vec<Id> {
        let omega = rotation.angular_velocity(|angle| self.builder.rate(angle));
        let spin = rotation.angular_momentum(&mut self.builder.graph, &omega);
        let whole = self.builder.rates(&spin);
        let gained = self.with_rates_of_inertia(rotation).angular_momentum(&mut self.builder.graph, &omega);
        vectors::difference(&mut self.builder.graph, &gained, &whole)
    }

    /// The rate of a body's kinetic energy less what a mass and moments of inertia that change add, ½ m' v² + ½ ω·I' ω.
    fn less_gained_energy(&mut self, rate: Id, body: &Body, square: Id) -> Id {
        let half = self.half();
        let gaining = self.builder.rate(body.mass);
        let mut doubled = self.builder.graph.mul(gaining, square);
        if let Some(rotation) = &body.rotation {
            let omega = rotation.own_angular_velocity(|angle| self.builder.rate(angle));
            let turning = self.with_rates_of_inertia(rotation).doubled_energy(&mut self.builder.graph, &omega);
            doubled = self.builder.graph.add(doubled, turning);
        }
        let gained = self.builder.graph.mul(half, doubled);
        self.builder.graph.sub(rate, gained)
    }

    /// The same turning with I' in the place of I.
    fn with_rates_of_inertia(&mut self, rotation: &Rotation) -> Rotation {
        let mut gaining = rotation.clone();
        gaining.inertias_mut().iter_mut().for_each(|moment| *moment = self.builder.rate(*moment));
        gaining
    }

    pub fn mass_times_acceleration(&mut self, body: usize) -> Vec<Id> {
        let body = self.model.bodies[body].clone();
        let velocity = self.builder.rates(&body.position);
        let acceleration = self.builder.rates(&velocity);
        acceleration.iter().map(|a| self.builder.graph.mul(body.mass, *a)).collect()
    }

    /// Loads and reactions by name, but for loads that are `summed` already.
    fn all_pushes(&self, sums: &Sums<'_>, summed: bool) -> Vec<(String, Vec<Push>)> {
        let loads = self.model.loads.iter().filter(|load| !summed || load.is_moved());
        let loads = loads.map(|load| (load.name.clone(), load.pushes.clone()));
        loads.chain(sums.unknowns.iter().map(|u| (u.name.clone(), u.pushes.clone()))).collect()
    }

    fn cross(&mut self, a: &[Id], b: &[Id]) -> Vec<Id> {
        vectors::moment(&mut self.builder.graph, a, b)
    }

    /// A named part of a residual; forces count negative.
    fn part(&mut self, name: String, value: Vec<Id>, force: bool) -> Part {
        let value = if force { vectors::negative(&mut self.builder.graph, &value) } else { value };
        Part { name, value }
    }

    /// `along`, normalised, if it is there.  Outside, `None`: it is wrong (reported).
    fn along(&mut self, spot: &Spot<'_>, locals: &Locals) -> Option<Option<Vec<Id>>> {
        let Some(along) = spot.get("along") else { return Some(None) };
        let written = along.written(&mut self.builder.problems)?;
        let vector = self.vector(&written, Rules::velocity("a direction"), locals)?;
        Some(Some(vectors::unit(&mut self.builder.graph, &vector)))
    }

    fn projected(&mut self, parts: Vec<Part>, along: Option<Vec<Id>>) -> Vec<Part> {
        let Some(along) = along else { return parts };
        parts
            .into_iter()
            .map(|part| Part {
                name: part.name,
                value: vec![vectors::dot(&mut self.builder.graph, &part.value, &along)],
            })
            .collect()
    }

    /// The bodies of `of`.
    fn of(&mut self, spot: &Spot<'_>, locals: &Locals) -> Option<Vec<usize>> {
        let of = spot.need("of", "a balance", &mut self.builder.problems)?;
        let items = of.items().unwrap_or_else(|| vec![of.clone()]);
        let mut set = Vec::new();
        for item in items {
            if item.node == &Node::Scalar("all".to_owned()) {
                return Some((0..self.model.bodies.len()).collect());
            }
            if let Some(bodies) = self.bodies_of_family(&item, locals) {
                set.extend(bodies);
                continue;
            }
            let texts: Vec<Text> = self.listed(&item, locals);
            for text in texts {
                set.extend(self.body(&text, locals)?);
            }
        }
        Some(set)
    }
}

/// That a reaction has no component along its free directions.
fn free_directions(unknown: &Unknown) -> Option<Balance> {
    let components = unknown.free.len();
    let label = format!("the free directions of {}", unknown.name);
    let parts = vec![Part { name: unknown.name.clone(), value: unknown.free.clone() }];
    let (terms, products, place) = (Vec::new(), Vec::new(), unknown.place.clone());
    let balance =
        Balance { label, parts, terms, products, components, void_at_rest: false, instantaneous: true, place };
    (components > 0).then_some(balance)
}

/// What the turning of a body adds to a balance of moments.
fn turning_name(body: &str, components: usize) -> String {
    if components == 1 { format!("I alpha of {body}") } else { format!("the rate of I omega of {body}") }
}
