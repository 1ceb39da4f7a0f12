//! `springs` and `dampers`.

use super::ends::{End, EndText};
use super::loads::{AttachedTo, Draft, DraftPush, Drafts};
use crate::diagnose::catalogue::{mechanics, sections};
use crate::expr::{Id, Symbol, vectors};
use crate::file::{Spot, Text, Written};
use crate::model::expression::antiderivative::antiderivative;
use crate::model::expression::dimension::{Dimension, Measure};
use crate::model::expression::facts::Depends;
use crate::model::expression::families::{Family, Locals};
use crate::model::expression::lower::Local;
use crate::model::expression::rules::Rules;
use crate::model::expression::substitute::substitute;
use crate::model::resolved::Work;
use crate::model::resolver::Resolver;

/// The law of a spring in the distance of its ends.
enum Law {
    /// ½ k (d − l₀)².
    Linear(Text, Option<Text>),
    /// V(length).
    Energy(Text),
    /// F(length), positive when it pulls.
    Tension(Text),
}

/// Where a stretch acts: a couple on `on` and its opposite on `from`, or a force along a direction.
#[derive(Clone)]
pub struct Placement {
    on: Option<Text>,
    from: Option<Text>,
    along: Option<Written>,
    at: Option<Written>,
    axis: Option<Written>,
}

impl Placement {
    /// The unit of the stretch: a length along a direction, an angle about a body, anything where no body is named.
    pub fn unit(&self, resolver: &Resolver<'_>) -> Measure {
        match (&self.on, &self.along) {
            (_, Some(_)) => resolver.scope.units.of(Dimension::LENGTH),
            (Some(_), None) => resolver.scope.units.of(Dimension::ONE),
            (None, None) => Measure::Unknown,
        }
    }
}

impl Resolver<'_> {
    /// One entry of `springs`.
    pub fn spring(&mut self, spot: &Spot<'_>, family: &Family, drafts: &mut Drafts) {
        let keys =
            ["between", "stiffness", "rest", "energy", "tension", "stretch", "on", "from", "along", "at", "axis"];
        if !self.load_keys(spot, &keys, "a spring", family) {
            return;
        }
        match self.one_of(spot, ["between", "stretch"], "a spring") {
            Some("between") => self.spring_between(spot, family, drafts),
            Some(_) => self.spring_stretch(spot, family, drafts),
            None => {}
        }
    }

    /// Which of two keys is there; reports none and both.
    fn one_of<'k>(&mut self, spot: &Spot<'_>, keys: [&'k str; 2], section: &str) -> Option<&'k str> {
        let [first, second] = keys;
        match (spot.get(first).is_some(), spot.get(second).is_some()) {
            (true, false) => Some(first),
            (false, true) => Some(second),
            (true, true) => {
                let place = spot.place.key(second).of_key();
                self.builder.problems.push(sections::conflicting_keys(place, first, second, section));
                None
            }
            (false, false) if spot.misspelt(&self.builder.problems) => None,
            (false, false) => {
                let keys = format!("`{first}`, `{second}`");
                self.builder.problems.push(sections::needs_one_of(spot.place.of_key(), keys, section));
                None
            }
        }
    }

    /// Reports keys that do not go with `with`.
    fn without(&mut self, spot: &Spot<'_>, with: &str, keys: &[&str], section: &str) {
        for key in keys {
            if spot.get(key).is_some() {
                let place = spot.place.key(key).of_key();
                self.builder.problems.push(sections::conflicting_keys(place, with, key, section));
            }
        }
    }

    fn spring_between(&mut self, spot: &Spot<'_>, family: &Family, drafts: &mut Drafts) {
        self.without(spot, "between", &["on", "from", "along", "at"], "a spring");
        let law = self.law(spot);
        let Some(between) = spot.get("between") else { return };
        for member in &family.members {
            let Some([p, q]) = self.between(&between, &member.locals) else { return };
            let ends = self.spring_ends(&p, &q, &member.name(), spot, &member.locals, drafts);
            let Some(law) = &law else { continue };
            let Some((p, q)) = ends else {
                // Without its ends the law is still read, for what is wrong with it.
                let (here, there) = (vec![Id::ZERO; self.scope.dimension], vec![Id::ONE; self.scope.dimension]);
                self.pull(law, &here, &there, &member.locals);
                continue;
            };
            if let Some((work, pull)) = self.pull(law, &p.at, &q.at, &member.locals) {
                let pushes = self.pair(&p, &q, pull);
                drafts.loads.push(Draft { name: member.name(), work, pushes, place: spot.place.clone() });
            }
        }
    }

    /// The law of a spring between two points.
    fn law(&mut self, spot: &Spot<'_>) -> Option<Law> {
        let laws = ["stiffness", "energy", "tension"];
        let given: Vec<&str> = laws.into_iter().filter(|key| spot.get(key).is_some()).collect();
        let problems = &mut self.builder.problems;
        let law = match given.as_slice() {
            [law] => *law,
            [] if spot.misspelt(problems) => return None,
            [] => {
                let keys = "`stiffness`, `energy`, `tension`";
                problems.push(sections::needs_one_of(spot.place.of_key(), keys, "a spring"));
                return None;
            }
            [first, second, ..] => {
                let place = spot.place.key(second).of_key();
                problems.push(sections::conflicting_keys(place, first, second, "a spring"));
                return None;
            }
        };
        let text = spot.get(law).and_then(|spot| spot.text(problems));
        let rest = spot.get("rest");
        if let (Some(rest), true) = (&rest, law != "stiffness") {
            problems.push(sections::conflicting_keys(rest.place.of_key(), law, "rest", "a spring"));
            return None;
        }
        let rest = match rest {
            Some(rest) => Some(rest.text(problems)?),
            None => None,
        };
        let text = text?;
        Some(match law {
            "stiffness" => Law::Linear(text, rest),
            "energy" => Law::Energy(text),
            _ => Law::Tension(text),
        })
    }

    fn spring_ends(
        &mut self,
        p: &EndText,
        q: &EndText,
        name: &str,
        spot: &Spot<'_>,
        locals: &Locals,
        drafts: &mut Drafts,
    ) -> Option<(End, End)> {
        let wanted = drafts.wanted.len();
        let (p, q) = (self.end(p, locals, drafts), self.end(q, locals, drafts));
        let (p, q) = (p?, q?);
        if self.model.bodies.is_empty() {
            // Nothing could carry the ends, and energies do not ask.
            drafts.wanted.truncate(wanted);
        }
        if p.at == q.at {
            self.builder.problems.push(mechanics::same_ends(spot.place.key("between"), name));
            return None;
        }
        Some((p, q))
    }

    /// The work of a spring between P and Q, and the force on P.
    fn pull(&mut self, law: &Law, p: &[Id], q: &[Id], locals: &Locals) -> Option<(Work, Vec<Id>)> {
        let line = vectors::difference(&mut self.builder.graph, p, q);
        match law {
            Law::Linear(stiffness, rest) => {
                let k = self.scalar(stiffness, Rules::of_time("a stiffness").si(Dimension::STIFFNESS), locals);
                let rest = match rest {
                    Some(rest) => self.scalar(rest, Rules::of_time("a rest length").si(Dimension::LENGTH), locals)?,
                    None => Id::ZERO,
                };
                let (k, half) = (k?, self.half());
                let graph = &mut self.builder.graph;
                if rest == Id::ZERO {
                    // Without a rest length there is no square root: V = ½ k d·d, force k d.
                    let square = vectors::dot(graph, &line, &line);
                    let product = graph.mul(k, square);
                    let pull = line.iter().map(|x| graph.mul(k, *x)).collect();
                    return Some((Work::Potential(graph.mul(half, product)), pull));
                }
                let length = vectors::norm(graph, &line);
                let stretch = graph.sub(length, rest);
                let tension = graph.mul(k, stretch);
                let product = graph.mul(tension, stretch);
                let energy = graph.mul(half, product);
                Some((Work::Potential(energy), along(graph, tension, &line, length)))
            }
            Law::Energy(text) => {
                let energy =
                    self.law_of_length(text, Rules::of_time("the energy of a spring").si(Dimension::ENERGY), locals)?;
                let slope = self.builder.partial(energy, LENGTH, &text.place);
                let length = vectors::norm(&mut self.builder.graph, &line);
                let (energy, tension) = (self.put_length(energy, length, text), self.put_length(slope, length, text));
                Some((Work::Potential(energy), along(&mut self.builder.graph, tension, &line, length)))
            }
            Law::Tension(text) => {
                let tension = self.law_of_length(text, Rules::velocity("a tension").si(Dimension::FORCE), locals)?;
                let length = vectors::norm(&mut self.builder.graph, &line);
                let motion = Depends::COORDINATE.and(Depends::VELOCITY);
                let energy = if self.builder.depends(&[tension]).meets(motion) {
                    None
                } else {
                    antiderivative(&mut self.builder.graph, &mut self.builder.facts, tension, LENGTH)
                };
                let tension = self.put_length(tension, length, text);
                let work = match energy {
                    Some(energy) => Work::Potential(self.put_length(energy, length, text)),
                    // No antiderivative in closed form: the work is done by the rate of the length.
                    None => Work::Resistance { rate: self.builder.rate(length), tension },
                };
                Some((work, along(&mut self.builder.graph, tension, &line, length)))
            }
        }
    }

    fn law_of_length(&mut self, text: &Text, rules: Rules, locals: &Locals) -> Option<Id> {
        let mut locals = locals.to_vec();
        locals.push(("length".to_owned(), Local::Symbol(LENGTH, self.scope.units.of(Dimension::LENGTH))));
        self.builder.scalar(&self.scope, text, rules, &locals)
    }

    fn put_length(&mut self, law: Id, length: Id, text: &Text) -> Id {
        let builder = &mut self.builder;
        let (value, visited) = substitute(&mut builder.graph, &mut builder.facts, law, LENGTH, length);
        builder.spend(visited, &text.place);
        value
    }

    /// The force on P and its opposite on Q.
    fn pair(&mut self, p: &End, q: &End, pull: Vec<Id>) -> Vec<DraftPush> {
        let opposite = vectors::negative(&mut self.builder.graph, &pull);
        let push = |end: &End, force| DraftPush {
            attached: end.attached.clone(),
            at: end.at.clone(),
            force,
            couple: Vec::new(),
        };
        vec![push(p, pull), push(q, opposite)]
    }

    fn spring_stretch(&mut self, spot: &Spot<'_>, family: &Family, drafts: &mut Drafts) {
        self.without(spot, "stretch", &["rest", "energy", "tension"], "a spring");
        let problems = &mut self.builder.problems;
        let stretch = spot.get("stretch").and_then(|stretch| stretch.text(problems));
        let stiffness = spot.need("stiffness", "a spring", problems).and_then(|k| k.text(problems));
        let placement = self.placement(spot);
        let (Some(stretch), Some(stiffness), Some(placement)) = (stretch, stiffness, placement) else { return };
        for member in &family.members {
            let rules = Rules::potential("a stretch").like(placement.unit(self));
            let e = self.directed(&placement, &stretch, rules, &member.locals);
            let wanted = self.per_square(Dimension::ENERGY);
            let k = self.scalar(&stiffness, Rules::of_time("the stiffness here").like(wanted), &member.locals);
            let (Some(e), Some(k)) = (e, k) else { continue };
            let half = self.half();
            let graph = &mut self.builder.graph;
            let tension = graph.mul(k, e);
            let product = graph.mul(tension, e);
            let work = Work::Potential(graph.mul(half, product));
            let Some(pushes) = self.placed_pushes(&placement, tension, &member.locals, drafts) else { continue };
            drafts.loads.push(Draft { name: member.name(), work, pushes, place: spot.place.clone() });
        }
    }

    /// `on`, `from`, `along`, `at`.
    pub fn placement(&mut self, spot: &Spot<'_>) -> Option<Placement> {
        let problems = &mut self.builder.problems;
        let mut text = |key: &str| spot.optional(key, |spot| spot.text(problems));
        let (on, from) = (text("on"), text("from"));
        let mut written = |key: &str| spot.optional(key, |spot| spot.written(problems));
        let (along, at, axis) = (written("along"), written("at"), written("axis"));
        let placement = Placement { on: on?, from: from?, along: along?, at: at?, axis: axis? };
        let (on, along) = (placement.on.is_some(), placement.along.is_some());
        for (key, other, missing) in [
            ("from", "on", placement.from.is_some() && !on),
            ("at", "along", placement.at.is_some() && !along),
            ("along", "on", along && !on),
            ("axis", "on", placement.axis.is_some() && !on),
        ] {
            if missing {
                let place = spot.place.key(key).of_key();
                problems.push(sections::needs_another_key(place, key, other, "this entry"));
                return None;
            }
        }
        if placement.axis.is_some() && (along || self.scope.dimension == 2) {
            let (place, with) = (spot.place.key("axis").of_key(), if along { "along" } else { "plane" });
            let problem = match along {
                true => sections::conflicting_keys(place, with, "axis", "this entry"),
                false => sections::unknown_key(
                    place,
                    "axis",
                    "this entry",
                    "in the plane all couples are about the same axis".to_owned(),
                ),
            };
            problems.push(problem);
            return None;
        }
        if self.scope.dimension == 3 && on && !along && placement.axis.is_none() {
            problems.push(mechanics::needs_axis(spot.place.of_key(), "axis"));
            return None;
        }
        Some(placement)
    }

    /// What a tension along a stretch does to bodies: a couple −T, or a force −T u, and its opposite.
    pub fn placed_pushes(
        &mut self,
        placement: &Placement,
        tension: Id,
        locals: &Locals,
        drafts: &mut Drafts,
    ) -> Option<Vec<DraftPush>> {
        let Some(on) = &placement.on else { return Some(Vec::new()) };
        let nothing = vec![Id::ZERO; self.scope.dimension];
        let Some(along) = &placement.along else {
            let context = "a torsional spring or damper";
            let mut pushes = Vec::new();
            let pull = match &placement.axis {
                None => vec![tension],
                Some(axis) => {
                    let axis = self.vector(axis, Rules::position("an axis"), locals)?;
                    let axis = vectors::unit(&mut self.builder.graph, &axis);
                    vectors::scaled(&mut self.builder.graph, tension, &axis)
                }
            };
            let minus = vectors::negative(&mut self.builder.graph, &pull);
            for (text, couple) in [(Some(on), minus), (placement.from.as_ref(), pull)] {
                let Some(text) = text else { continue };
                let Some(body) = self.rigid_body(text, context, locals)? else { continue };
                let at = self.centre(body)?;
                pushes.push(DraftPush { attached: AttachedTo::Body(body), at, force: nothing.clone(), couple });
            }
            return Some(pushes);
        };
        let direction = self.vector(along, Rules::position("a direction"), locals)?;
        let end = self.placed(on, placement.at.as_ref(), locals, drafts)?;
        let force: Vec<Id> = direction.iter().map(|u| self.builder.graph.mul(tension, *u)).collect();
        let minus = vectors::negative(&mut self.builder.graph, &force);
        let mut pushes =
            vec![DraftPush { attached: end.attached, at: end.at.clone(), force: minus, couple: Vec::new() }];
        if let Some(from) = &placement.from {
            let opposite = self.opposite(from, &end.at, locals)?;
            pushes.push(DraftPush { attached: opposite.attached, at: opposite.at, force, couple: Vec::new() });
        }
        Some(pushes)
    }

    /// One entry of `dampers`.
    pub fn damper(&mut self, spot: &Spot<'_>, family: &Family, drafts: &mut Drafts) {
        let keys = ["between", "rate", "damping", "on", "from", "along", "at", "axis"];
        if !self.load_keys(spot, &keys, "a damper", family) {
            return;
        }
        let kind = self.one_of(spot, ["between", "rate"], "a damper");
        let problems = &mut self.builder.problems;
        let damping = spot.need("damping", "a damper", problems).and_then(|c| c.text(problems));
        match (kind, damping) {
            (Some("between"), Some(damping)) => {
                self.without(spot, "between", &["on", "from", "along", "at", "axis"], "a damper");
                let Some(between) = spot.get("between") else { return };
                for member in &family.members {
                    let Some([p, q]) = self.between(&between, &member.locals) else { return };
                    let ends = self.spring_ends(&p, &q, &member.name(), spot, &member.locals, drafts);
                    let Some((p, q)) = ends else { continue };
                    let line = vectors::difference(&mut self.builder.graph, &p.at, &q.at);
                    let length = vectors::norm(&mut self.builder.graph, &line);
                    let rate = self.builder.rate(length);
                    let unit = self.scope.units.of(Dimension::DAMPING);
                    let Some(tension) = self.damping(&damping, rate, unit, &member.locals) else { continue };
                    let pull = along(&mut self.builder.graph, tension, &line, length);
                    let pushes = self.pair(&p, &q, pull);
                    let work = Work::Resistance { rate, tension };
                    drafts.loads.push(Draft { name: member.name(), work, pushes, place: spot.place.clone() });
                }
            }
            (Some(_), Some(damping)) => self.damper_rate(spot, &damping, family, drafts),
            _ => {}
        }
    }

    fn damper_rate(&mut self, spot: &Spot<'_>, damping: &Text, family: &Family, drafts: &mut Drafts) {
        let rate = spot.get("rate").and_then(|rate| rate.text(&mut self.builder.problems));
        let placement = self.placement(spot);
        let (Some(rate), Some(placement)) = (rate, placement) else { return };
        for member in &family.members {
            let wanted = self.scope.units.rate(placement.unit(self));
            let rules = Rules::mechanical("a rate").like(wanted);
            let Some(rate) = self.directed(&placement, &rate, rules, &member.locals) else { continue };
            let unit = self.per_square(Dimension::POWER);
            let Some(tension) = self.damping(damping, rate, unit, &member.locals) else { continue };
            let Some(pushes) = self.placed_pushes(&placement, tension, &member.locals, drafts) else { continue };
            let work = Work::Resistance { rate, tension };
            drafts.loads.push(Draft { name: member.name(), work, pushes, place: spot.place.clone() });
        }
    }

    /// A stretch or a rate; one that is no angle and has no direction lacks this, and nothing else is said of it.
    fn directed(&mut self, placement: &Placement, text: &Text, rules: Rules, locals: &Locals) -> Option<Id> {
        let before = self.builder.problems.len();
        let value = self.scalar(text, rules, locals);
        let turns = placement.on.is_some() && placement.along.is_none() && placement.axis.is_none();
        match self.builder.problems.get_mut(before) {
            Some(problem) if turns && problem.code == "E242" => {
                problem.help =
                    "without `along` it is an angle between bodies that turn; along a line it has a direction: add \
                                `along: e`, such as `along: ground.y`"
                        .to_owned();
                None
            }
            _ => value,
        }
    }

    /// c times the rate; c is in this unit.
    fn damping(&mut self, damping: &Text, rate: Id, unit: Measure, locals: &Locals) -> Option<Id> {
        let c = self.scalar(damping, Rules::velocity("the damping here").like(unit), locals)?;
        Some(self.builder.graph.mul(c, rate))
    }

    /// The unit of a coefficient that gives something with the square of what was evaluated last.
    fn per_square(&self, dimension: Dimension) -> Measure {
        self.scope.units.of(dimension).over(self.builder.measured).over(self.builder.measured)
    }
}

/// The bound variable `length`.
pub const LENGTH: Symbol = Symbol::Dummy(u32::MAX);

/// A tension along a line of this length.
fn along(graph: &mut crate::expr::Graph, tension: Id, line: &[Id], length: Id) -> Vec<Id> {
    let share = graph.div(tension, length);
    line.iter().map(|x| graph.mul(share, *x)).collect()
}
