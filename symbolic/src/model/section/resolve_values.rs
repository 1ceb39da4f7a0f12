//! Values of definitions, points, angles, inputs and derived parameters, in whatever order they need each other.

use std::cell::{Cell, RefCell};
use std::rc::Rc;

use crate::diagnose::Place;
use crate::diagnose::catalogue::{mechanics, names};
use crate::expr::{Id, Symbol, Tape, vectors};
use crate::file::{Text, Written};
use crate::language::{Ast, AstKind, Unit};
use crate::model::expression::builder::ExprBuilder;
use crate::model::expression::dimension::{Dimension, Measure};
use crate::model::expression::families::Locals;
use crate::model::expression::joints;
use crate::model::expression::lower::Lower;
use crate::model::expression::names::Solid;
use crate::model::expression::quantities::stands_alone;
use crate::model::expression::radians;
use crate::model::expression::rules::Rules;
use crate::model::expression::scope::{JointRow, Member, Scope};
use crate::model::expression::value::{self, Value};
use crate::model::gimbals::Angle;
use crate::model::rotation::{Orientation, Quaternion, Turn};

/// Something with a value that expressions may name.
#[derive(Clone, Debug)]
pub struct Item {
    /// Its expanded name, for messages.
    pub name: String,
    /// Its expression; `None` when that was refused already.
    pub written: Option<Written>,
    /// What it is and may depend on.
    pub rules: Rules,
    /// What it must be.
    pub want: Want,
    /// Its indices.
    pub locals: Locals,
    /// The frame that an angle is measured from, or that is turned.
    pub from: Option<Text>,
    /// In space: the axes of its turns, one for each angle.
    pub axes: Vec<Axis>,
    /// Its unit as written.
    pub unit: Option<Unit>,
}

/// An axis to turn about.
#[derive(Clone, Debug)]
pub enum Axis {
    /// x, y or z of the frame itself.
    Own(usize),
    /// A direction that is fixed in it, of parameters.
    Direction(Written),
    /// None: what stands for the angle is a coordinate of kind `rotation`.
    Rotation,
    /// None: a fixed turn by a quaternion of parameters, whose scalar part stands for the angle; its vector part.
    Quaternion(Box<[Text; 3]>),
}

/// What the value of an item must be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Want {
    /// A number.
    Scalar,
    /// A vector.
    Vector,
    /// Either.
    Any,
    /// The difference of both sides of an equation, either.
    Equation,
    /// How a frame is turned in space.
    Orientation,
    /// What a row of a joint states, of other items; nothing is written.
    Joint(JointRow),
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum State {
    New,
    Open,
    Done,
}

/// Gives every item its value.  A worklist instead of recursion: chains of definitions may be long.
pub fn resolve_values(builder: &mut ExprBuilder, scope: &mut Scope, items: &[Item]) {
    scope.values = vec![None; items.len()];
    scope.units.items = vec![Measure::Unknown; items.len()];
    let mut states = vec![State::New; items.len()];
    let mut stack = Vec::new();
    for first in 0..items.len() {
        stack.push(first);
        while let Some(&top) = stack.last() {
            if states[top] == State::Done {
                stack.pop();
                continue;
            }
            let mark = builder.problems.len();
            builder.needs.clear();
            let value = evaluate(builder, scope, &items[top]);
            let mut needs = std::mem::take(&mut builder.needs);
            needs.retain(|need| states[*need] != State::Done);
            if needs.is_empty() || builder.exhausted() {
                scope.values[top] = Some(if builder.exhausted() { Value::Poison } else { value });
                scope.units.items[top] = builder.measured;
                note_radians(scope, top, &items[top]);
                states[top] = State::Done;
                stack.pop();
                continue;
            }
            // What was computed without the values that are missing is thrown away, with its problems.
            builder.problems.truncate(mark);
            states[top] = State::Open;
            if let Some(&again) = needs.iter().find(|need| states[**need] == State::Open) {
                report_cycle(builder, items, &stack, &states, again);
                scope.values[top] = Some(Value::Poison);
                states[top] = State::Done;
                stack.pop();
                continue;
            }
            needs.sort_unstable();
            needs.dedup();
            stack.extend(needs.into_iter().rev());
        }
    }
}

fn evaluate(builder: &mut ExprBuilder, scope: &Scope, item: &Item) -> Value {
    if let Want::Joint(row) = item.want {
        return joints::value(builder, scope, row);
    }
    let Some(written) = &item.written else { return Value::Poison };
    let value = match item.want {
        Want::Equation => match written {
            Written::One(text) => match builder.sides(scope, text, item.rules, &item.locals) {
                Some((left, right)) => value::add(&mut builder.graph, &left, &right, true).unwrap_or(Value::Poison),
                None => Value::Poison,
            },
            Written::List(..) => builder.written(scope, written, item.rules, &item.locals),
        },
        Want::Joint(_) => return Value::Poison,
        Want::Orientation => return orientation(builder, scope, item).map_or(Value::Poison, Value::Orientation),
        Want::Any => builder.written(scope, written, item.rules, &item.locals),
        Want::Vector => builder.vector(scope, written, item.rules, &item.locals).map_or(Value::Poison, Value::Vector),
        Want::Scalar => match written {
            Written::One(text) => {
                let value = builder.scalar(scope, text, item.rules, &item.locals);
                if item.rules.signals && stands_alone(text, &item.locals) {
                    // An input has no place for a unit.
                    builder.measured = Measure::Unknown;
                }
                value.map_or(Value::Poison, Value::Scalar)
            }
            Written::List(_, place) => {
                builder.problems.push(names::not_a_scalar(Place::clone(place), "a list"));
                Value::Poison
            }
        },
    };
    let value = match (&item.unit, &item.written) {
        (Some(unit), Some(Written::One(text))) => value.map(|x| builder.converted(x, unit, text)),
        _ => value,
    };
    match &item.from {
        Some(from) => {
            let start = frame_angle(builder, scope, from, item);
            value::add(&mut builder.graph, &start, &value, false).unwrap_or(Value::Poison)
        }
        None => value,
    }
}

/// The angle that a frame's angle is measured from.
fn frame_angle(builder: &mut ExprBuilder, scope: &Scope, from: &Text, item: &Item) -> Value {
    match turned_from(builder, scope, from, item) {
        None => Value::Poison,
        Some(None) => Value::Scalar(Id::ZERO),
        Some(Some(value)) => value,
    }
}

/// So many turns that move are derived: the expressions of a chain grow as the square of their number.
const MOST_TURNS: usize = 64;
/// Factors of all parameters' defaults at which the length of an axis is looked at.
const FACTORS: [f64; 4] = [1.0, 1.37, 0.71, 2.9];

/// How an item is turned in space: from its frame, about its axes in turn.
fn orientation(builder: &mut ExprBuilder, scope: &Scope, item: &Item) -> Option<Box<Orientation>> {
    let mut frame = match item.from.as_ref().map(|from| turned_from(builder, scope, from, item)) {
        None | Some(Some(None)) => Orientation::ground(),
        Some(Some(Some(Value::Orientation(frame)))) => *frame,
        Some(_) => return None,
    };
    let Some(Written::List(angles, _)) = &item.written else { return None };
    for (axis, text) in item.axes.iter().zip(angles) {
        if frame.depth >= MOST_TURNS {
            builder.problems.push(mechanics::too_many_turns(
                text.place.at(text.ast.span),
                format!("a frame may have {MOST_TURNS} turns that move, from the ground on"),
            ));
            return None;
        }
        if let Axis::Quaternion(vector) = axis {
            frame = fixed_turn(builder, scope, (text, vector), item).map(|q| set(builder, &frame, q))?;
            continue;
        }
        if matches!(axis, Axis::Rotation) {
            let index = rotation_of(builder, scope, text, item)?;
            let first = scope.rotations[index] as u32;
            let symbols = |symbol: fn(u32) -> Symbol| [0, 1, 2, 3].map(|k| symbol(first + k));
            let graph = &mut builder.graph;
            let pair = [symbols(Symbol::Coordinate), symbols(Symbol::Speed)]
                .map(|symbols| Quaternion(symbols.map(|symbol| graph.symbol(symbol))));
            frame = frame.rotated(graph, index, pair);
            continue;
        }
        let angle = builder.scalar(scope, text, item.rules, &item.locals);
        let direction = match axis {
            Axis::Own(_) | Axis::Rotation | Axis::Quaternion(_) => None,
            Axis::Direction(written) => {
                let vector = builder.vector(scope, written, Rules::constant("an axis"), &item.locals)?;
                let square = vectors::dot(&mut builder.graph, &vector, &vector);
                let at = |factor: f64| {
                    let scaled = |k: u32| match builder.defaults[k as usize] {
                        0.0 => factor - 1.0,
                        default => factor * default,
                    };
                    let value = |symbol| if let Symbol::Parameter(k) = symbol { scaled(k) } else { 0.0 };
                    Tape::new(&builder.graph, &[square]).evaluate(value)[0]
                };
                let squares = FACTORS.map(at);
                let place = Place::clone(written.place());
                builder.lengths.push((square, place.clone()));
                if !has_direction(squares[0]) {
                    builder.problems.push(mechanics::no_axis(place));
                    return None;
                }
                // [sin(a), 0, cos(a)] has length 1 as it stands.
                let is_unit = squares.iter().all(|square| (square - 1.0).abs() < 4.0 * f64::EPSILON);
                let graph = &mut builder.graph;
                Some(if is_unit { vector } else { vectors::unit(graph, &vector) })
            }
        };
        let angle = angle?;
        let known = angle_in_numbers(builder, angle);
        frame.depth += usize::from(!matches!(known, Angle::Fixed(_)));
        let in_numbers = match (axis, direction.as_deref()) {
            (Axis::Own(k), _) => std::array::from_fn(|i| f64::from(u8::from(i == *k))),
            (_, Some(components)) => at_defaults(builder, components).try_into().ok()?,
            _ => return None,
        };
        let rate = builder.rate(angle);
        let graph = &mut builder.graph;
        let turn = Turn::by(graph, angle, rate);
        frame = match (axis, direction.as_deref()) {
            (_, Some(&[x, y, z])) => frame.turned_about(graph, [x, y, z], turn),
            (Axis::Own(k), _) => frame.turned(graph, *k, turn),
            _ => return None,
        };
        frame.turns.push(&item.name, in_numbers, known);
    }
    Some(Box::new(frame))
}

/// Whether a vector has a direction, by the square of its length.
pub fn has_direction(square: f64) -> bool {
    square > 0.0 && square.is_finite()
}

/// The quaternion of a fixed turn.
fn fixed_turn(
    builder: &mut ExprBuilder,
    scope: &Scope,
    (scalar, vector): (&Text, &[Text; 3]),
    item: &Item,
) -> Option<Quaternion> {
    let rules = Rules::constant("a fixed turn").si(Dimension::ONE);
    let mut q = [Id::ZERO; 4];
    for (component, text) in q.iter_mut().zip(std::iter::once(scalar).chain(vector)) {
        *component = builder.scalar(scope, text, rules, &item.locals)?;
    }
    let square = vectors::dot(&mut builder.graph, &q, &q);
    let place = scalar.place.at(scalar.ast.span);
    builder.lengths.push((square, place.clone()));
    if !has_direction(at_defaults(builder, &[square])[0]) {
        builder.problems.push(mechanics::no_axis(place));
        return None;
    }
    Some(Quaternion(q))
}

/// A frame turned once and for all.
fn set(builder: &mut ExprBuilder, frame: &Orientation, q: Quaternion) -> Orientation {
    let mut new = frame.set(&mut builder.graph, q);
    let [w, x, y, z] = at_defaults(builder, &q.0)[..] else { return new };
    let sine = (x * x + y * y + z * z).sqrt();
    if sine > 0.0 {
        new.turns.push("", [x / sine, y / sine, z / sine], Angle::Fixed(2.0 * sine.atan2(w)));
    }
    new
}

/// The components of an axis at the parameters' defaults.
fn at_defaults(builder: &ExprBuilder, components: &[Id]) -> Vec<f64> {
    let value = |symbol| match symbol {
        Symbol::Parameter(k) => builder.defaults[k as usize],
        _ => 0.0,
    };
    Tape::new(&builder.graph, components).evaluate(value)
}

/// Where an angle is tried: whether it is linear in its coordinate.
const TRIED: [f64; 3] = [0.0, 0.83, -2.9];

/// An angle in numbers, at the parameters' defaults.
fn angle_in_numbers(builder: &ExprBuilder, angle: Id) -> Angle {
    let tape = Tape::new(&builder.graph, &[angle]);
    let (found, other) = (RefCell::new(Vec::new()), Cell::new(false));
    let at = |q: f64| {
        let value = |symbol| match symbol {
            Symbol::Parameter(k) => builder.defaults[k as usize],
            Symbol::Coordinate(k) => {
                found.borrow_mut().push(k as usize);
                q
            }
            _ => {
                other.set(true);
                0.0
            }
        };
        tape.evaluate(value)[0]
    };
    let [offset, first, second] = TRIED.map(at);
    let mut found = found.take();
    found.sort_unstable();
    found.dedup();
    match found.as_slice() {
        _ if other.get() => Angle::Other,
        [] => Angle::Fixed(offset),
        &[coordinate] => {
            let factor = (first - offset) / TRIED[1];
            let linear = (offset + factor * TRIED[2] - second).abs() < 1e-12 * (1.0 + second.abs());
            if linear { Angle::Linear { coordinate, factor, offset } } else { Angle::Other }
        }
        _ => Angle::Other,
    }
}

/// The rotation that a text names.
fn rotation_of(builder: &mut ExprBuilder, scope: &Scope, text: &Text, item: &Item) -> Option<usize> {
    let mut lower = Lower::new(builder, scope, text, item.rules, &item.locals);
    let place = text.place.at(text.ast.span);
    let found = match &text.ast.kind {
        AstKind::Name { name, indices, primes: 0 } => match lower.member(name, indices, text.ast.span)? {
            (_, Member::Rotation(index)) => return Some(index),
            (_, Member::Refused) => return None,
            (section, _) => section.noun(),
        },
        _ => "an expression",
    };
    let mut problem = names::wrong_thing(place, &text.source, "a rotation", found);
    problem.help =
        "a turn about an axis is `[axis, angle]`; a rotation is declared so: `coordinates: {attitude: rotation}`"
            .to_owned();
    lower.refuse(problem);
    None
}

/// What a frame or body from which another is turned is turned by; inside, `None` is the ground.  Outside, `None`: it is none (reported).
fn turned_from(builder: &mut ExprBuilder, scope: &Scope, from: &Text, item: &Item) -> Option<Option<Value>> {
    let mut lower = Lower::new(builder, scope, from, item.rules, &item.locals);
    let Ast { kind: AstKind::Name { name, indices, primes: 0 }, span } = &*from.ast else {
        let place = from.place.at(from.ast.span);
        lower.refuse(names::wrong_thing(place, &from.source, "a frame", "an expression"));
        return None;
    };
    let turned = match lower.solid(name, indices, *span)? {
        Solid::Ground => return Some(None),
        Solid::Frame(frame) => Some(frame),
        Solid::Body(body) => scope.bodies[body].orientation,
    };
    match turned {
        Some(turned) => Some(Some(lower.item(turned))),
        None => {
            let place = from.place.at(*span);
            lower.refuse(mechanics::needs_orientation(place, name, "a frame"));
            None
        }
    }
}

/// The open items on the stack, from the one that is needed again to the top, are a cycle.
/// Notes how many radians an item has: by its unit, where one is written, else by its expression; of a constraint, how many its reaction has.
fn note_radians(scope: &mut Scope, place: usize, item: &Item) {
    let Some(Written::One(text)) = &item.written else { return };
    let name = item.name.split('[').next().unwrap_or_default().to_owned();
    if let Some(constraint) = scope.constraints.iter().find(|constraint| constraint.item == place) {
        let radians = radians::of(&text.ast, &scope.units.radians);
        let name = constraint.name.split('[').next().unwrap_or_default();
        scope.units.radians.insert(radians::of_reaction(name), -radians);
        return;
    }
    let words = text.source.get(text.ast.span.end as usize..).unwrap_or_default().trim();
    let radians = match words {
        "" => radians::of(&text.ast, &scope.units.radians),
        words => radians::of_words(words),
    };
    if radians != 0 {
        scope.units.radians.insert(name, radians);
    }
}

fn report_cycle(builder: &mut ExprBuilder, items: &[Item], stack: &[usize], states: &[State], again: usize) {
    let mut open: Vec<usize> = Vec::new();
    for &item in stack {
        if states[item] == State::Open && !open.contains(&item) {
            open.push(item);
        }
    }
    let start = open.iter().position(|item| *item == again).unwrap_or(0);
    let cycle = &open[start..];
    let shown = 6;
    let mut listed: Vec<String> = cycle.iter().take(shown).map(|item| format!("`{}`", items[*item].name)).collect();
    if cycle.len() > shown {
        listed.push("…".to_owned());
    }
    listed.push(format!("`{}`", items[again].name));
    let place = cycle
        .first()
        .and_then(|item| items[*item].written.as_ref())
        .map(|written| Rc::clone(written.place()))
        .unwrap_or_default();
    builder.problems.push(names::definition_cycle(Place::clone(&place), listed.join(" → ")));
}
