//! The rows of joints: for each kind the constraints that a person would write.

use std::rc::Rc;

use super::joints::{At, Fixed, JointText, Kind, place_of, words};
use super::resolve_values::Want;
use crate::diagnose::catalogue::{mechanics, names};
use crate::expr::{Id, vectors};
use crate::file::{Text, Written};
use crate::language::{Ast, AstKind};
use crate::model::expression::dimension::Dimension;
use crate::model::expression::facts::Depends;
use crate::model::expression::families::Locals;
use crate::model::expression::lower::Lower;
use crate::model::expression::names::Solid;
use crate::model::expression::rules::Rules;
use crate::model::expression::scope::{ConstraintNames, JointNames, JointRow};
use crate::model::expression::value::Value;
use crate::model::resolver::Resolver;

const AXES: [&str; 3] = ["x", "y", "z"];

/// The rows of one joint while they are made.
struct Rows<'a, 'b> {
    resolver: &'a mut Resolver<'b>,
    text: &'a JointText,
    sides: [Option<Solid>; 2],
    locals: Locals,
    made: JointNames,
}

impl Resolver<'_> {
    /// Declares the rows of a joint, each as a constraint of its own.
    pub fn joint_rows(&mut self, text: &JointText, sides: [Option<Solid>; 2], name: String, locals: &Locals) {
        let one_point = matches!(text.at, At::One(_));
        let made = JointNames { name, rows: Vec::new(), one_point };
        let mut rows = Rows { resolver: self, text, sides, locals: Rc::clone(locals), made };
        rows.make();
        let made = rows.made;
        self.scope.joints.push(made);
    }

    /// Refuses joints whose points and axes move in their sides, now that values are known.
    pub fn judge_joints(&mut self) {
        let fixed = std::mem::take(&mut self.fixed);
        let (mut rows, mut looked_at) = (Vec::new(), Vec::new());
        for what in &fixed {
            if let Some(motion) = self.motion_in_side(what) {
                rows.push(motion);
                looked_at.push(what);
            }
        }
        let still = self.still(&rows);
        for (what, still) in looked_at.into_iter().zip(still) {
            if !still {
                let [point, side] = &what.words;
                self.builder.problems.push(mechanics::not_fixed_in_side(what.place.clone(), point, side));
            }
        }
    }

    /// How fast a point or a direction moves in the side in which it is to rest; `None` where nothing can be said: a frame has no place.
    fn motion_in_side(&mut self, what: &Fixed) -> Option<Vec<Id>> {
        let Some(Value::Vector(value)) = self.scope.value(what.item).cloned() else { return None };
        let (body, orientation) = match what.side {
            // A point that depends on time and inputs only belongs to the ground, as everywhere.
            Solid::Ground if self.builder.depends(&value).meets(Depends::COORDINATE) => {
                return Some(self.builder.rates(&value));
            }
            Solid::Ground => return None,
            Solid::Frame(_) if !what.direction => return None,
            Solid::Frame(item) => (None, Some(item)),
            Solid::Body(body) => (Some(body), self.scope.bodies[body].orientation),
        };
        let omega = match orientation.map(|item| self.scope.value(item).cloned()) {
            Some(Some(Value::Orientation(frame))) => Some(frame.velocity.to_vec()),
            Some(Some(Value::Scalar(angle))) => Some(vec![self.builder.rate(angle)]),
            Some(_) => return None,
            None => None,
        };
        let rate = self.builder.rates(&value);
        if what.direction {
            let turning = vectors::swept(&mut self.builder.graph, &omega?, &value);
            return Some(vectors::difference(&mut self.builder.graph, &turning, &rate));
        }
        let Some(Value::Vector(centre)) = self.scope.value(self.scope.bodies[body?].position).cloned() else {
            return None;
        };
        let arm = vectors::difference(&mut self.builder.graph, &centre, &value);
        // The material of a particle is in one place.
        let Some(omega) = omega else { return Some(arm) };
        let velocity = self.builder.rates(&centre);
        let graph = &mut self.builder.graph;
        let turning = vectors::swept(graph, &omega, &arm);
        let material = vectors::add(graph, &velocity, &turning);
        Some(vectors::difference(graph, &material, &rate))
    }
}

impl Rows<'_, '_> {
    /// All rows of its kind.
    fn make(&mut self) {
        let points = self.points();
        match self.text.kind {
            Kind::Free => {}
            Kind::Ball => self.meet(points),
            Kind::Weld => {
                self.meet(points);
                self.weld();
            }
            Kind::Hinge if self.resolver.scope.dimension == 2 => self.meet(points),
            Kind::Universal => {
                let [a, b] = [0, 1].map(|side| self.direction(side));
                self.meet(points);
                self.turn([a, b], "about");
            }
            _ => self.with_parallel_axes(points),
        }
    }

    /// Kinds whose two axes are parallel.
    fn with_parallel_axes(&mut self, points: Option<[usize; 2]>) {
        let kind = self.text.kind;
        let Some((frame, k)) = self.own_axis(0) else { return };
        let axis = self.own(0, &frame, k);
        self.watch_axis(axis, 0);
        let b = self.direction(1);
        let letters: &[usize] = match self.resolver.scope.dimension {
            2 => &[1 - k],
            _ => &[(k + 1) % 3, (k + 2) % 3],
        };
        let across: Vec<usize> = letters.iter().map(|letter| self.own(0, &frame, *letter)).collect();
        match (kind, points) {
            (Kind::Hinge, _) => self.meet(points),
            (Kind::Plane, Some(points)) => self.keep(points, axis, k),
            (_, Some(points)) => across.iter().zip(letters).for_each(|(u, letter)| self.keep(points, *u, *letter)),
            _ => {}
        }
        // u·b with u across the axis a keeps b from turning about u × a.
        for (place, u) in across.iter().enumerate() {
            let about = if across.len() == 1 { 2 } else { (k + 2 - place) % 3 };
            self.turn([*u, b], &format!("about_{}", AXES[about]));
        }
        match (kind, points) {
            (Kind::Screw, Some(points)) => self.advance(points, axis),
            (Kind::Slider, _) => self.keep_from_turning(&across, k),
            _ => {}
        }
    }

    /// The row that a slider has beside those of a cylinder, with the axes across that of the first side.
    fn keep_from_turning(&mut self, across: &[usize], k: usize) {
        let &[first, _] = across else { return };
        let Some((frame, l)) = self.own_axis(1) else { return };
        let second = self.own(1, &frame, (l + 2) % 3);
        self.turn([first, second], &format!("about_{}", AXES[k]));
    }

    /// Each axis of the first side is across the next one of the second.
    fn weld(&mut self) {
        let pairs: &[(usize, usize)] =
            if self.resolver.scope.dimension == 2 { &[(0, 1)] } else { &[(0, 1), (1, 2), (2, 0)] };
        let [a, b] = [0, 1].map(|side| self.text.sides[side].clone());
        for (i, j) in pairs {
            let across = [self.own(0, &a, *i), self.own(1, &b, *j)];
            self.turn(across, &format!("about_{}", AXES[3 - i - j]));
        }
    }

    /// The points of both sides as items; one that both have is looked at and makes no row.
    fn points(&mut self) -> Option<[usize; 2]> {
        match &self.text.at {
            At::None => None,
            At::Two(written) => Some([0, 1].map(|side| {
                let point = self.point(&written[side], side);
                self.watch(point, &written[side], side);
                point
            })),
            At::One(written) => {
                let point = self.point(written, 0);
                for side in [0, 1] {
                    self.watch(point, written, side);
                }
                None
            }
        }
    }

    fn point(&mut self, written: &Written, side: usize) -> usize {
        let rules = Rules::joint("a point of a joint").si(Dimension::LENGTH);
        let name = format!("point {} of {}", side + 1, self.made.name);
        self.resolver.item(name, Some(written.clone()), rules, Want::Vector, &self.locals)
    }

    fn watch(&mut self, item: usize, written: &Written, side: usize) {
        let Some(solid) = self.sides[side] else { return };
        let words = [words(written), self.text.sides[side].source.to_string()];
        self.resolver.fixed.push(Fixed { item, direction: false, side: solid, words, place: place_of(written) });
    }

    /// Looks whether an axis rests in its side.
    fn watch_axis(&mut self, item: usize, side: usize) {
        let (Some(solid), Some(axes)) = (self.sides[side], &self.text.axes) else { return };
        let axis = &axes[side];
        let words = [axis.source.to_string(), self.text.sides[side].source.to_string()];
        let place = axis.place.at(axis.ast.span);
        self.resolver.fixed.push(Fixed { item, direction: true, side: solid, words, place });
    }

    /// The axis of a side as it is written: any direction that is fixed there.
    fn direction(&mut self, side: usize) -> usize {
        let written = self.text.axes.as_ref().map(|axes| Written::One(axes[side].clone()));
        let name = format!("axis {} of {}", side + 1, self.made.name);
        let rules = Rules::joint("an axis of a joint");
        let item = self.resolver.item(name, written, rules, Want::Vector, &self.locals);
        self.watch_axis(item, side);
        item
    }

    /// The frame of which an axis is one, and which; `None` where it is none (reported).
    fn own_axis(&mut self, side: usize) -> Option<(Text, usize)> {
        let text = &self.text.axes.as_ref()?[side];
        let place = text.place.at(text.ast.span);
        let (frame, k) = match &text.ast.kind {
            AstKind::Component(frame, k) => (frame, usize::from(*k)),
            _ => {
                self.resolver.builder.problems.push(mechanics::not_an_own_axis(place, &text.source));
                return None;
            }
        };
        let AstKind::Name { name, indices, primes: 0 } = &frame.kind else {
            self.resolver.builder.problems.push(mechanics::not_an_own_axis(place, &text.source));
            return None;
        };
        if k >= self.resolver.scope.dimension {
            self.resolver.builder.problems.push(names::no_such_component(place, AXES[k.min(2)]));
            return None;
        }
        let rules = Rules::joint("an axis of a joint");
        let resolver = &mut *self.resolver;
        Lower::new(&mut resolver.builder, &resolver.scope, text, rules, &self.locals)
            .solid(name, indices, frame.span)?;
        Some((Text { ast: Rc::new(Ast::clone(frame)), ..text.clone() }, k))
    }

    /// A unit vector of a frame.
    fn own(&mut self, side: usize, frame: &Text, k: usize) -> usize {
        let kind = AstKind::Component(Box::new(Ast::clone(&frame.ast)), k as u8);
        let ast = Rc::new(Ast { kind, span: frame.ast.span });
        let name = format!("{} {} of {}", AXES[k], side + 1, self.made.name);
        let rules = Rules::joint("an axis of a joint");
        let written = Written::One(Text { ast, ..frame.clone() });
        self.resolver.item(name, Some(written), rules, Want::Vector, &self.locals)
    }

    fn meet(&mut self, points: Option<[usize; 2]>) {
        if let Some(points) = points {
            let name = self.made.name.clone();
            self.row(name, JointRow::Meet { points });
        }
    }

    fn keep(&mut self, points: [usize; 2], along: usize, letter: usize) {
        let name = format!("{}.along_{}", self.made.name, AXES[letter]);
        self.row(name, JointRow::Keep { points, along });
    }

    fn turn(&mut self, across: [usize; 2], about: &str) {
        let name = format!("{}.{about}", self.made.name);
        self.row(name, JointRow::Turn { across });
    }

    fn advance(&mut self, points: [usize; 2], axis: usize) {
        let (Some(pitch), [Some(first), Some(second)]) = (self.text.pitch.clone(), [self.turned(0), self.turned(1)])
        else {
            return;
        };
        let rules = Rules::constant("a pitch").si(Dimension::LENGTH);
        let (item, written) = (format!("pitch of {}", self.made.name), Some(Written::One(pitch)));
        let pitch = self.resolver.item(item, written, rules, Want::Scalar, &self.locals);
        let name = format!("{}.advance", self.made.name);
        self.row(name, JointRow::Advance { points, axis, turned: [first, second], pitch });
    }

    /// How a side is turned; inside, `None` is the ground.  Outside, `None`: a particle, which does not turn (reported).
    fn turned(&mut self, side: usize) -> Option<Option<usize>> {
        match self.sides[side]? {
            Solid::Ground => Some(None),
            Solid::Frame(item) => Some(Some(item)),
            Solid::Body(body) => match self.resolver.scope.bodies[body].orientation {
                Some(item) => Some(Some(item)),
                None => {
                    let text = &self.text.sides[side];
                    let place = text.place.at(text.ast.span);
                    let problem = mechanics::needs_orientation(place, &text.source, "a screw");
                    self.resolver.builder.problems.push(problem);
                    None
                }
            },
        }
    }

    /// One more constraint.
    fn row(&mut self, name: String, row: JointRow) {
        let place = self.resolver.scope.constraints.len();
        let item = self.resolver.item(name.clone(), None, Rules::constraint(), Want::Joint(row), &self.locals);
        self.resolver.scope.constraints.push(ConstraintNames { name, item, first: None, scale: None, across: None });
        self.made.rows.push((place, row));
    }
}
