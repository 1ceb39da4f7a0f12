//! Shapes in space of `draw`: round ones with an axis, those along the axes of a frame, planes.

use crate::diagnose::Problem;
use crate::diagnose::catalogue::{mechanics, names, sections};
use crate::expr::{Id, Rational, vectors};
use crate::file::{Node, Spot};
use crate::language::AstKind;
use crate::model::expression::dimension::Dimension;
use crate::model::expression::families::Locals;
use crate::model::expression::lower::Lower;
use crate::model::expression::names::Solid as Turning;
use crate::model::expression::value::Value;
use crate::model::resolved::{Shape, Solid, Vector};
use crate::model::resolver::Resolver;
use crate::model::section::draw::RULES;

/// The keys that are shapes in space.
pub const KINDS: [&str; 7] = ["disc", "cylinder", "sphere", "box", "ellipsoid", "plane", "axes"];

/// A body or frame whose axes a shape has, and its centre of mass or the ground's origin.
struct Frame {
    name: String,
    axes: [Vector; 3],
    centre: Option<Vector>,
}

/// What to write in the plane in the place of a shape in space.
fn in_the_plane(kind: &str) -> &'static str {
    match kind {
        "disc" | "sphere" => "in the plane write `circle: {at: P, radius: r}`",
        "cylinder" => "in the plane write `line: [P, Q]`",
        "box" => "in the plane write its corners, `line: [A, B, C, D, A]`",
        "ellipsoid" => "in the plane write `curve: \"[a*cos(s), b*sin(s)]\", s: 0..2*pi`",
        "plane" => "in the plane write `line: [P, Q]`",
        "axes" => "in the plane write `line: [P, P + B.x]` and `line: [P, P + B.y]`",
        _ => "in the plane leave `axis` out",
    }
}

/// The problem of a shape in space in a model in the plane.
pub fn not_in_the_plane(spot: &Spot<'_>, kind: &str) -> Problem {
    sections::shape_in_space(spot.place.of_key(), kind, in_the_plane(kind))
}

impl Resolver<'_> {
    /// A shape of this kind, in a model in space.
    pub fn solid(&mut self, kind: &str, spot: &Spot<'_>, locals: &Locals) {
        let shape = match kind {
            "disc" => self.round(spot, Solid::Disc, locals),
            "cylinder" => self.cylinder(spot, locals),
            "sphere" => self.sphere(spot, locals),
            "box" => self.along_a_frame(spot, "a box", locals),
            "ellipsoid" => self.along_a_frame(spot, "an ellipsoid", locals),
            "plane" => self.plane(spot, locals),
            _ => self.axes(spot, locals),
        };
        self.model.draw.extend(shape);
    }

    /// `{at: P, axis: e, radius: r}`.
    pub fn round(&mut self, spot: &Spot<'_>, kind: Solid, locals: &Locals) -> Option<Shape> {
        let what = if kind == Solid::Disc { "a disc" } else { "a circle in space" };
        if !spot.only(&["at", "axis", "radius"], what, &mut self.builder.problems) {
            return None;
        }
        let at = self.needed_point(spot, "at", what, locals);
        let axis = self.unit_along(spot, "axis", what, locals);
        let radius = self.needed_length(spot, "radius", what, locals);
        let axis = vectors::scaled(&mut self.builder.graph, radius?, &axis?);
        Some(Shape::Solid(kind, [at?, axis].concat()))
    }

    fn cylinder(&mut self, spot: &Spot<'_>, locals: &Locals) -> Option<Shape> {
        let what = "a cylinder";
        if !spot.only(&["from", "to", "radius"], what, &mut self.builder.problems) {
            return None;
        }
        let [from, to] = ["from", "to"].map(|key| self.needed_point(spot, key, what, locals));
        let radius = self.needed_length(spot, "radius", what, locals);
        Some(Shape::Solid(Solid::Cylinder, [from?, to?, vec![radius?]].concat()))
    }

    fn sphere(&mut self, spot: &Spot<'_>, locals: &Locals) -> Option<Shape> {
        let what = "a sphere";
        if !spot.only(&["at", "radius"], what, &mut self.builder.problems) {
            return None;
        }
        let at = self.needed_point(spot, "at", what, locals);
        let radius = self.needed_length(spot, "radius", what, locals);
        Some(Shape::Solid(Solid::Sphere, [at?, vec![radius?]].concat()))
    }

    /// `{at: P, normal: n, size: L}`: a square.
    fn plane(&mut self, spot: &Spot<'_>, locals: &Locals) -> Option<Shape> {
        let what = "a plane";
        if !spot.only(&["at", "normal", "size"], what, &mut self.builder.problems) {
            return None;
        }
        let at = self.needed_point(spot, "at", what, locals);
        let normal = self.unit_along(spot, "normal", what, locals);
        let size = self.needed_length(spot, "size", what, locals);
        let normal = vectors::scaled(&mut self.builder.graph, size?, &normal?);
        Some(Shape::Solid(Solid::Plane, [at?, normal].concat()))
    }

    /// `{frame: B, at: P, size: [a, b, c]}`: the edges of a box, the half axes of an ellipsoid.
    fn along_a_frame(&mut self, spot: &Spot<'_>, what: &str, locals: &Locals) -> Option<Shape> {
        if !spot.only(&["frame", "at", "size"], what, &mut self.builder.problems) {
            return None;
        }
        let frame = spot.need("frame", what, &mut self.builder.problems);
        let frame = frame.and_then(|frame| self.frame_of(&frame, what, locals));
        let lengths = self.three_lengths(spot, what, locals);
        let frame = frame?;
        let at = match (spot.get("at"), &frame.centre) {
            (None, Some(centre)) => Some(centre.clone()),
            _ => self.needed_point(spot, "at", what, locals),
        };
        let graph = &mut self.builder.graph;
        let (kind, half) = match what {
            "a box" => (Solid::Box, graph.rational(Rational::HALF)),
            _ => (Solid::Ellipsoid, Id::ONE),
        };
        let mut numbers = at?;
        for (axis, length) in frame.axes.iter().zip(lengths?) {
            let length = graph.mul(half, length);
            numbers.extend(vectors::scaled(graph, length, axis));
        }
        Some(Shape::Solid(kind, numbers))
    }

    /// `axes: B`, or `{frame: B, at: P, size: L}`.
    fn axes(&mut self, spot: &Spot<'_>, locals: &Locals) -> Option<Shape> {
        let what = "axes";
        let detailed = matches!(spot.node, Node::Map(_));
        if detailed && !spot.only(&["frame", "at", "size"], what, &mut self.builder.problems) {
            return None;
        }
        let named = if detailed { spot.need("frame", what, &mut self.builder.problems)? } else { spot.clone() };
        let frame = self.frame_of(&named, what, locals)?;
        let at = match (spot.get("at"), frame.centre) {
            (Some(at), _) => self.point(&at, locals)?,
            (None, Some(centre)) => centre,
            (None, None) => {
                let problem = sections::axes_without_place(named.place.clone(), &frame.name);
                self.builder.problems.push(problem);
                return None;
            }
        };
        let size = match spot.get("size") {
            Some(_) => Some(self.needed_length(spot, "size", what, locals)?),
            None => None,
        };
        let graph = &mut self.builder.graph;
        let axes = frame.axes.iter().flat_map(|axis| vectors::scaled(graph, size.unwrap_or(Id::ONE), axis));
        let numbers = at.into_iter().chain(axes).collect();
        Some(Shape::Solid(if size.is_some() { Solid::Axes } else { Solid::UnitAxes }, numbers))
    }

    /// The axes of a body, a frame or the ground; reports what has none.
    fn frame_of(&mut self, spot: &Spot<'_>, what: &str, locals: &Locals) -> Option<Frame> {
        let text = spot.text(&mut self.builder.problems)?;
        let mut lower = Lower::new(&mut self.builder, &self.scope, &text, RULES, locals);
        let AstKind::Name { name, indices, primes: 0 } = &text.ast.kind else {
            let place = text.place.at(text.ast.span);
            lower.refuse(names::wrong_thing(place, &text.source, "a body or frame", "an expression"));
            return None;
        };
        let turning = lower.solid(name, indices, text.ast.span)?;
        let centre = match turning {
            Turning::Frame(_) => None,
            Turning::Ground => Some(vec![Id::ZERO; 3]),
            Turning::Body(body) => {
                let names = &self.scope.bodies[body];
                if names.orientation.is_none() {
                    let place = text.place.at(text.ast.span);
                    lower.refuse(mechanics::needs_orientation(place, &names.name, what));
                    return None;
                }
                Some(vector(lower.item(names.position))?)
            }
        };
        let axes: Option<Vec<Vector>> =
            (0..3).map(|axis| vector(lower.unit_vector(turning, name, axis, text.ast.span))).collect();
        let axes = <[Vector; 3]>::try_from(axes?).ok()?;
        Some(Frame { name: text.source.to_string(), axes, centre })
    }

    fn needed_point(&mut self, spot: &Spot<'_>, key: &str, what: &str, locals: &Locals) -> Option<Vector> {
        let point = spot.need(key, what, &mut self.builder.problems)?;
        self.point(&point, locals)
    }

    fn point(&mut self, spot: &Spot<'_>, locals: &Locals) -> Option<Vector> {
        let written = spot.written(&mut self.builder.problems)?;
        self.vector(&written, RULES, locals)
    }

    fn needed_length(&mut self, spot: &Spot<'_>, key: &str, what: &str, locals: &Locals) -> Option<Id> {
        let problems = &mut self.builder.problems;
        let quantity = spot.need(key, what, problems)?.quantity(problems)?;
        self.setting(&quantity, RULES.si(Dimension::LENGTH), locals)
    }

    fn three_lengths(&mut self, spot: &Spot<'_>, what: &str, locals: &Locals) -> Option<Vec<Id>> {
        let problems = &mut self.builder.problems;
        let size = spot.need("size", what, problems)?;
        let items = size.list(problems);
        if items.is_empty() && size.items().is_none() {
            return None;
        }
        if items.len() != 3 {
            problems.push(sections::list_length(size.place.clone(), "size", 3, items.len()));
            return None;
        }
        let mut lengths = Vec::new();
        for item in items {
            let quantity = item.quantity(&mut self.builder.problems)?;
            lengths.push(self.setting(&quantity, RULES.si(Dimension::LENGTH), locals)?);
        }
        Some(lengths)
    }

    /// The unit vector along a vector; reports one whose length is 0.
    fn unit_along(&mut self, spot: &Spot<'_>, key: &str, what: &str, locals: &Locals) -> Option<Vector> {
        let direction = spot.need(key, what, &mut self.builder.problems)?;
        let vector = self.point(&direction, locals)?;
        if vector.iter().all(|component| *component == Id::ZERO) {
            self.builder.problems.push(sections::no_direction(direction.place.clone(), key));
            return None;
        }
        Some(vectors::unit(&mut self.builder.graph, &vector))
    }
}

fn vector(value: Value) -> Option<Vector> {
    if let Value::Vector(components) = value { Some(components) } else { None }
}
