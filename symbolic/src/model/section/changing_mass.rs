//! `loses` and `gains` of a body: with which velocity mass leaves or comes, and the force that this makes.

use super::declare::DeclaredBody;
use super::ends::End;
use super::loads::{AttachedTo, Draft, DraftPush, Drafts};
use crate::diagnose::Place;
use crate::diagnose::catalogue::{mechanics, sections};
use crate::expr::{Graph, Id, Node, Symbol, Unary, vectors};
use crate::file::{Spot, Written};
use crate::model::expression::dimension::Dimension;
use crate::model::expression::families::Locals;
use crate::model::expression::rules::Rules;
use crate::model::resolved::{Input, Work};
use crate::model::resolver::Resolver;

/// What is asked, and the way out, where the mass changes.
const MASS_GOES: (&str, &str) = (
    "with which velocity does what leaves or comes move?",
    "say it in the body, `loses: {velocity: [0, 0]}` or `gains: {velocity: [0, 0]}` with the velocity against the ground (in space of three components), `loses: {}` if it moves with the body",
);
/// The same where it does not.
const PARTS_MOVE: (&str, &str) = (
    "the mass does not change: which parts move?",
    "make them bodies of their own; or leave `inertia` and `angle` out, and write the energy of the turning: `kinetic_energy: (I + r*t)*phi'^2/2`",
);

/// `loses` or `gains`, as written.
#[derive(Clone, Debug)]
pub struct Exchange {
    /// Which of the two keys.
    pub key: &'static str,
    /// The absolute velocity of what leaves or comes; absent, that of the body's material.
    pub velocity: Option<Written>,
    /// Where, if not at the centre of mass.
    pub at: Option<Written>,
    /// Where it stands.
    pub place: Place,
}

impl Resolver<'_> {
    /// `loses` or `gains` of a body.
    pub fn exchange_of(&mut self, body: &Spot<'_>) -> Option<Exchange> {
        let problems = &mut self.builder.problems;
        let (loses, gains) = (body.get("loses"), body.get("gains"));
        if let (Some(_), Some(gains)) = (&loses, &gains) {
            problems.push(sections::conflicting_keys(gains.place.of_key(), "loses", "gains", "a body"));
        }
        let (key, spot) = loses.map(|spot| ("loses", spot)).or(gains.map(|spot| ("gains", spot)))?;
        if !spot.only(&["velocity", "at"], "what a body loses or gains", problems) {
            return None;
        }
        let mut written = |key: &str| spot.get(key).and_then(|spot| spot.written(problems));
        Some(Exchange { key, velocity: written("velocity"), at: written("at"), place: spot.place.of_key() })
    }

    /// Refuses bodies whose mass or inertia changes in a way that is not said, or jumps, and what is said of one that does not change.
    pub fn changing_masses(&mut self, declared: &[DeclaredBody]) {
        for (body, DeclaredBody { text, .. }) in self.model.bodies.iter().zip(declared) {
            let graph = &self.builder.graph;
            let (of_mass, moments) = (graph.symbols([body.mass]), body.rotation.iter().flat_map(|r| r.inertias()));
            let of_inertia = graph.symbols(moments.copied());
            let turns_otherwise = of_inertia.iter().any(|s| s.may_change());
            let changing = of_mass.iter().any(|s| s.may_change());
            let by_place = of_mass.iter().any(|s| matches!(s, Symbol::Coordinate(_)));
            let first = text.inertia.iter().flatten().next().filter(|_| !by_place && turns_otherwise);
            let written = first.or(text.mass.as_ref()).map(|written| &written.text);
            let place = || written.map_or_else(|| body.place.clone(), |text| text.place.at(text.ast.span));
            let problem = match &text.exchange {
                // A mass that is wrong was reported, and is 0 here.
                Some(exchange) if !changing && body.mass != Id::ZERO => {
                    Some(mechanics::mass_stays(exchange.place.clone(), &body.name, exchange.key))
                }
                None if by_place || turns_otherwise => {
                    let what = if by_place { "mass" } else { "inertia" };
                    let (label, help) = if changing { MASS_GOES } else { PARTS_MOVE };
                    Some(mechanics::exchange_unsaid(place(), what, &body.name, label, help))
                }
                _ if changing && jumps(graph, &self.model.inputs, body.mass) => {
                    Some(mechanics::mass_jumps(place(), &body.name))
                }
                _ => None,
            };
            self.builder.problems.extend(problem);
        }
    }

    /// The forces m' (w − v) of what leaves bodies or comes to them, with v the velocity of the material where it does.
    pub fn exchanges(&mut self, declared: &[DeclaredBody], drafts: &mut Drafts) {
        for (b, DeclaredBody { text, locals, .. }) in declared.iter().enumerate() {
            let Some(exchange) = &text.exchange else { continue };
            let Some(velocity) = &exchange.velocity else { continue };
            let rules = Rules::velocity("the velocity of what leaves or comes").si(Dimension::VELOCITY);
            let velocity = self.vector(velocity, rules, locals);
            let end = self.exchange_end(b, exchange, locals, drafts);
            let (Some(velocity), Some(end)) = (velocity, end) else { continue };
            let material = self.velocity_of_material(b, &end.at);
            let gaining = self.builder.rate(self.model.bodies[b].mass);
            let graph = &mut self.builder.graph;
            let relative = vectors::difference(graph, &material, &velocity);
            let force = vectors::scaled(graph, gaining, &relative);
            let name = format!("what {} {}", self.model.bodies[b].name, exchange.key);
            let pushes = vec![DraftPush { attached: AttachedTo::Body(b), at: end.at, force, couple: Vec::new() }];
            drafts.loads.push(Draft { name, work: Work::Pushes, pushes, place: exchange.place.clone() });
        }
    }

    fn exchange_end(&mut self, body: usize, exchange: &Exchange, locals: &Locals, drafts: &mut Drafts) -> Option<End> {
        let centre = self.centre(body)?;
        let Some(at) = &exchange.at else { return Some(End { attached: AttachedTo::Body(body), at: centre }) };
        let point = self.vector(at, Rules::position("a point").si(Dimension::LENGTH), locals)?;
        self.own_point(body, point, at, drafts)
    }

    /// v + ω × arm, of a body's material at a point.
    pub fn velocity_of_material(&mut self, body: usize, at: &[Id]) -> Vec<Id> {
        let body = self.model.bodies[body].clone();
        let velocity = self.builder.rates(&body.position);
        let Some(rotation) = &body.rotation else { return velocity };
        let omega = rotation.angular_velocity(|angle| self.builder.rate(angle));
        let graph = &mut self.builder.graph;
        let arm = vectors::difference(graph, &body.position, at);
        let turning = vectors::swept(graph, &omega, &arm);
        vectors::add(graph, &velocity, &turning)
    }
}

/// Whether an expression has steps, by itself or by an input, of which no rate tells.
fn jumps(graph: &Graph, inputs: &[Input], value: Id) -> bool {
    let signal = |symbol: Symbol| match symbol {
        Symbol::Input(place, _) => inputs.get(place as usize).map(|input| input.signal[0]),
        _ => None,
    };
    let signals = graph.symbols([value]).into_iter().filter_map(signal);
    has_steps(graph, value) || signals.into_iter().any(|signal| has_steps(graph, signal))
}

/// Whether an expression has steps of its own, or held values.
pub(in crate::model) fn has_steps(graph: &Graph, value: Id) -> bool {
    let steps = |id: &Id| {
        matches!(graph.node(*id), Node::Unary(Unary::Sign | Unary::Step, _) | Node::Symbol(Symbol::Memory(_)))
    };
    graph.needed([value]).iter().any(steps)
}
