//! Which bodies carry a mode's kinetic energy.

use dalembert_symbolic::expr::{Graph, Id, Symbol, Tape};
use dalembert_symbolic::model::{Model, Rotation};

use super::super::Problem;
use super::super::load::Loaded;
use super::failed;
use crate::linear::{Kind, Linearised, Mode, Part, name_free_modes};
use nalgebra::{DMatrix, DVector};

/// Parts of the energy below this are not named.
const LEAST: f64 = 0.01;

/// For each mode the bodies that carry at least a hundredth of its kinetic energy, largest first; empty lists for a
/// model with one body or none.
pub fn shares(loaded: &Loaded, linear: &Linearised, modes: &[Mode]) -> Result<Vec<Vec<(String, f64)>>, Problem> {
    let mut model = loaded.model()?;
    if model.bodies.len() < 2 || linear.equilibrium.q.len() > 10 * super::MOST_PRINTED {
        return Ok(vec![Vec::new(); modes.len()]);
    }
    let parameters = loaded.system.parameters();
    let bodies = moving(&mut model);
    let of_mode = |mode: &Mode| {
        let (re, im): (Vec<f64>, Vec<f64>) = mode.shape.iter().map(|x| (x.re, x.im)).unzip();
        let part =
            |body: &Moving| body.twice_energy(linear, &parameters, &re) + body.twice_energy(linear, &parameters, &im);
        // The shape has unit modal mass: twice the kinetic energy at unit amplitude of the speeds is 1.
        let mut list: Vec<(String, f64)> = bodies.iter().map(|body| (body.name.clone(), part(body))).collect();
        list.retain(|(_, part)| *part >= LEAST);
        list.sort_by(|a, b| b.1.total_cmp(&a.1));
        list
    };
    Ok(modes.iter().map(of_mode).collect())
}

/// Tells rigid motions of all bodies together from mechanisms, and names them; with constraints `motions` says how all
/// coordinates follow those of the model.
pub fn name_free(
    loaded: &Loaded,
    linear: &Linearised,
    motions: Option<&DMatrix<f64>>,
    modes: &mut [Mode],
) -> Result<(), Problem> {
    let n = linear.equilibrium.q.len();
    if n > 10 * super::MOST_PRINTED || modes.iter().all(|mode| mode.kind != Kind::Rigid) {
        return Ok(());
    }
    let mut model = loaded.model()?;
    let parameters = loaded.system.parameters();
    let mut parts = Vec::new();
    let moving = moving(&mut model);
    for (body, moving) in model.bodies.clone().into_iter().zip(moving) {
        let mut of = |function: &str| model.expression(&format!("{function}({})", body.name)).unwrap_or_default();
        let (position, velocity) = (of("position"), of("velocity"));
        let turning = if body.rotation.is_some() { of("angular_velocity") } else { Vec::new() };
        let (d, r) = (position.len(), turning.len());
        let tape = Tape::new(&model.graph, &[&[body.mass], &position[..], &velocity, &turning].concat());
        let still = evaluate(&tape, linear, &parameters, None);
        let mut rows = DMatrix::zeros(d + r, n);
        for j in 0..n {
            let moving = evaluate(&tape, linear, &parameters, Some(j));
            for i in 0..d + r {
                rows[(i, j)] = moving[1 + d + i] - still[1 + d + i];
            }
        }
        let rows = motions.map_or(rows.clone(), |motions| rows * motions);
        parts.push(Part {
            mass: still[0],
            position: still[1..=d].to_vec(),
            velocity: rows.rows(0, d).into_owned(),
            turning: rows.rows(d, r).into_owned(),
            inertia: moving.inertia(linear, &parameters, motions),
        });
    }
    name_free_modes(linear, &parts, modes).map_err(failed)
}

/// Values at the equilibrium, with the speed of one coordinate greater by 1.
fn evaluate(tape: &Tape, linear: &Linearised, parameters: &[f64], moving: Option<usize>) -> Vec<f64> {
    let at = &linear.equilibrium;
    tape.evaluate(|symbol| match symbol {
        Symbol::Coordinate(i) => at.q[i as usize],
        Symbol::Speed(i) => at.v[i as usize] + f64::from(u8::from(moving == Some(i as usize))),
        Symbol::Parameter(i) => parameters[i as usize],
        Symbol::Input(i, 0) => at.inputs.get(i as usize).copied().unwrap_or(0.0),
        _ => 0.0,
    })
}

/// A body's velocities, then the mass or moment of inertia of each.
struct Moving {
    name: String,
    tape: Tape,
}

fn moving(model: &mut Model) -> Vec<Moving> {
    let mut list = Vec::new();
    for body in model.bodies.clone() {
        let mut components = model.expression(&format!("velocity({})", body.name)).unwrap_or_default();
        let mut inertias = vec![body.mass; components.len()];
        let of_body = |function: &str| function.replace("BODY", &body.name);
        match &body.rotation {
            None => {}
            Some(Rotation::Plane { inertia, .. }) => {
                components.extend(model.expression(&of_body("angular_velocity(BODY)")).unwrap_or_default());
                inertias.push(*inertia);
            }
            Some(Rotation::Space { inertia, .. }) => {
                let own = model.expression(&of_body("components(angular_velocity(BODY), BODY)")).unwrap_or_default();
                for (velocity, inertia) in squares(&mut model.graph, &own, *inertia) {
                    components.push(velocity);
                    inertias.push(inertia);
                }
            }
        }
        components.extend(inertias);
        list.push(Moving { name: body.name, tape: Tape::new(&model.graph, &components) });
    }
    list
}

/// ω·I ω as a sum of squares: 2 Ixy ωx ωy = Ixy ((ωx + ωy)² − ωx² − ωy²), and so on.
fn squares(graph: &mut Graph, omega: &[Id], [xx, yy, zz, xy, xz, yz]: [Id; 6]) -> Vec<(Id, Id)> {
    let &[x, y, z] = omega else { return Vec::new() };
    let mut less = |moment: Id, first: Id, second: Id| {
        let products = graph.add(first, second);
        graph.sub(moment, products)
    };
    let own = [(x, less(xx, xy, xz)), (y, less(yy, xy, yz)), (z, less(zz, xz, yz))];
    let sums = [(graph.add(x, y), xy), (graph.add(x, z), xz), (graph.add(y, z), yz)];
    own.into_iter().chain(sums).filter(|(_, inertia)| *inertia != Id::ZERO).collect()
}

impl Moving {
    /// Its part of M; with constraints `motions` says how all coordinates follow those of the model.
    fn inertia(&self, linear: &Linearised, parameters: &[f64], motions: Option<&DMatrix<f64>>) -> DMatrix<f64> {
        let (n, count) = (linear.equilibrium.q.len(), self.tape.len() / 2);
        let still = evaluate(&self.tape, linear, parameters, None);
        let mut velocities = DMatrix::zeros(count, n);
        for j in 0..n {
            let moved = evaluate(&self.tape, linear, parameters, Some(j));
            (0..count).for_each(|i| velocities[(i, j)] = moved[i] - still[i]);
        }
        let velocities = motions.map_or(velocities.clone(), |motions| velocities * motions);
        let inertias = DMatrix::from_diagonal(&DVector::from_column_slice(&still[count..]));
        velocities.transpose() * inertias * velocities
    }

    /// Σ m v² and I ω² of the velocities that speeds q' add to the steady ones.
    fn twice_energy(&self, linear: &Linearised, parameters: &[f64], speeds: &[f64]) -> f64 {
        let at = &linear.equilibrium;
        let run = |part: f64| {
            let mut found = vec![0.0; self.tape.len()];
            let value = |symbol: Symbol| match symbol {
                Symbol::Coordinate(i) => at.q[i as usize],
                Symbol::Speed(i) => at.v[i as usize] + part * speeds[i as usize],
                Symbol::Parameter(i) => parameters[i as usize],
                Symbol::Input(i, 0) => at.inputs.get(i as usize).copied().unwrap_or(0.0),
                _ => 0.0,
            };
            self.tape.run(value, &mut Vec::new(), &mut found);
            found
        };
        let (with, without) = (run(1.0), run(0.0));
        let (velocities, inertias) = with.split_at(with.len() / 2);
        let each = velocities.iter().zip(&without).zip(inertias);
        each.map(|((with, without), inertia)| inertia * (with - without).powi(2)).sum()
    }
}
