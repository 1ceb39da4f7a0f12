//! Coordinates of bodies of mass 0: the forces on them balance.
//!
//! Where nothing resists the acceleration of a coordinate z, its equation of motion is h_z(t, q, q') = 0, which contains no
//! acceleration.  As a constraint it determines z: its multiplier λ is 0, since the row of z is h_z = λ ∂h_z/∂z and h_z
//! vanishes, so that no other coordinate is pushed by it.
//!
//! Rows of dampers may depend on each other in the speeds, as those of both ends of a damper between two springs do: their sum c = h_z + h_w contains
//! no speed.  It determines a place, and stands for one of them.

use std::collections::BTreeSet;

use super::Equations;
use crate::diagnose::Place;
use crate::expr::{Graph, Id, Symbol, jacobian, substitute};
use crate::model::{Constraint, Model};

/// Adds a constraint for each coordinate of bodies of mass 0; none where one of them cannot be determined so.
pub(super) fn balance(model: &mut Model, equations: &Equations) {
    let resisted: BTreeSet<usize> = equations.mass.iter().filter(|e| e.0 == e.1).map(|e| e.0).collect();
    let massless: Vec<usize> = (0..model.coordinates.len()).filter(|i| !resisted.contains(i)).collect();
    let of_constraints: Vec<Id> = model.constraints.iter().flat_map(|c| c.value.iter().copied()).collect();
    let held = model.graph.symbols(of_constraints);
    let of_points: Vec<Id> =
        model.bodies.iter().filter(|body| body.mass == Id::ZERO).flat_map(|body| body.position.clone()).collect();
    let points = model.graph.symbols(of_points);
    let (mut forces, mut names) = (Vec::new(), Vec::new());
    for &i in &massless {
        let place = Symbol::Coordinate(i as u32);
        let constrained = held.contains(&place) || held.contains(&Symbol::Speed(i as u32));
        let Some(holonomic) = determines(&mut model.graph, equations.bias[i], i) else { return };
        if constrained || !points.contains(&place) {
            return;
        }
        forces.push(Force { value: equations.bias[i], holonomic });
        names.push(free_name(model, i));
    }
    let Some(forces) = independent(&mut model.graph, forces, &massless) else { return };
    for ((i, name), Force { value, holonomic }) in massless.into_iter().zip(names).zip(forces) {
        let first = model.constraints.iter().map(|constraint| constraint.value.len()).sum();
        let place = model.coordinates[i].place.clone();
        let constraint = Constraint { name, value: vec![value], scalar: true, holonomic, first, unit: None, place };
        let index = model.constraints.len();
        model.constraints.push(constraint);
        model.phases.iter_mut().for_each(|phase| phase.constraints.push(index));
    }
}

/// A force that is to vanish, and whether it contains no speeds.
struct Force {
    value: Id,
    holonomic: bool,
}

/// Forces of which none is, in the speeds, a sum of multiples of others: such a sum, which contains no speeds, stands for the last of them. `None`
/// where it contains no place that is to be determined.
fn independent(graph: &mut Graph, forces: Vec<Force>, massless: &[usize]) -> Option<Vec<Force>> {
    // Of each force with speeds what they make of it, by one of these, with the force.
    let mut pivots: Vec<(usize, Vec<Id>, Id)> = Vec::new();
    let mut found = Vec::with_capacity(forces.len());
    for force in forces {
        if force.holonomic {
            found.push(force);
            continue;
        }
        let (mut value, mut slopes) = (force.value, by_speeds(graph, force.value));
        slopes.resize(pivots.iter().fold(slopes.len(), |most, pivot| most.max(pivot.1.len())), Id::ZERO);
        for (column, others, other) in &pivots {
            let ratio = graph.div(slopes[*column], others[*column]);
            if ratio == Id::ZERO || graph.number(ratio).is_none() {
                continue;
            }
            let part = graph.mul(ratio, *other);
            value = graph.sub(value, part);
            for (slope, other) in slopes.iter_mut().zip(others) {
                let part = graph.mul(ratio, *other);
                *slope = graph.sub(*slope, part);
            }
        }
        match slopes.iter().position(|slope| *slope != Id::ZERO) {
            Some(column) => {
                pivots.push((column, slopes, value));
                found.push(force);
            }
            None => {
                let value = at_rest(graph, value);
                let places = graph.symbols([value]);
                if !massless.iter().any(|i| places.contains(&Symbol::Coordinate(*i as u32))) {
                    return None;
                }
                found.push(Force { value, holonomic: true });
            }
        }
    }
    Some(found)
}

/// ∂h/∂q' of a force that is affine in the speeds, by coordinate.
fn by_speeds(graph: &mut Graph, force: Id) -> Vec<Id> {
    let column = |s: Symbol| if let Symbol::Speed(k) = s { Some(k as usize) } else { None };
    let entries: Vec<(usize, Id)> = jacobian(graph, &[force], column).into_iter().flatten().collect();
    let mut slopes = vec![Id::ZERO; entries.iter().fold(0, |most, entry| most.max(entry.0 + 1))];
    entries.into_iter().for_each(|(k, slope)| slopes[k] = slope);
    slopes
}

/// A force without what speeds make of it.
fn at_rest(graph: &mut Graph, force: Id) -> Id {
    let speeds = graph.symbols([force]).into_iter().filter(|s| matches!(s, Symbol::Speed(_)));
    let still = speeds.map(|speed| (speed, Id::ZERO)).collect();
    substitute(graph, &[force], &still)[0]
}

/// How many of a model's constraints are such.
pub fn count(model: &Model) -> usize {
    let of_coordinate = |place: &Place| model.coordinates.iter().any(|coordinate| coordinate.place == *place);
    model.constraints.iter().filter(|constraint| of_coordinate(&constraint.place)).count()
}

/// Whether a force on a coordinate, set to 0, determines it, or its speed where it contains speeds (false): it must be smooth,
/// affine in the speeds and contain no reactions.
fn determines(graph: &mut Graph, force: Id, i: usize) -> Option<bool> {
    let symbols = graph.symbols([force]);
    let smooth = |s: &Symbol| {
        matches!(
            s,
            Symbol::Time | Symbol::Parameter(_) | Symbol::Coordinate(_) | Symbol::Speed(_) | Symbol::Input(_, 0)
        )
    };
    if !symbols.iter().all(smooth) {
        return None;
    }
    if !symbols.iter().any(|s| matches!(s, Symbol::Speed(_))) {
        return symbols.contains(&Symbol::Coordinate(i as u32)).then_some(true);
    }
    let column = |s: Symbol| if let Symbol::Speed(k) = s { Some(k as usize) } else { None };
    let slopes: Vec<Id> = jacobian(graph, &[force], column).into_iter().flatten().map(|entry| entry.1).collect();
    let affine = !graph.symbols(slopes).iter().any(|s| matches!(s, Symbol::Speed(_)));
    (affine && symbols.contains(&Symbol::Speed(i as u32))).then_some(false)
}

/// `z_balance`, or with more underscores where that is the name of another constraint.
fn free_name(model: &Model, i: usize) -> String {
    let coordinate = &model.coordinates[i].name;
    let (base, index) = coordinate.split_at(coordinate.find('[').unwrap_or(coordinate.len()));
    let mut name = format!("{base}_balance{index}");
    while model.constraints.iter().any(|constraint| constraint.name == name) {
        name = format!("{base}_{}", &name[base.len()..]);
    }
    name
}
