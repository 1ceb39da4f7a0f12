//! Time stepping: the midpoint rule with impulses (Moreau, Unilateral contact and dry friction in finite freedom dynamics, 1988; Jean, The non-smooth
//! contact dynamics method, 1999).
//!
//! Over each step M (v⁺ − v⁻) = h f + Σ Jᵀ p, at the places in the middle. Of each contact that is closed there
//! 0 ≤ pₙ ⟂ v⁺ₙ + e v⁻ₙ ≥ 0, and |pₜ| ≤ µ pₙ against the sliding rate, by projections in turn (Gauss and Seidel). Events are not looked for; the error
//! is of the first order in h.

use super::scene::{Scene, Touch};

/// Projections in turn end when impulses change by less than this part of the largest, or after so many.
const SETTLED: f64 = 1e-14;
const MOST_ROUNDS: usize = 2000;

/// Places and speeds, x, y and angle of each body.
#[derive(Clone, Debug)]
pub struct State {
    /// m and rad.
    pub q: Vec<f64>,
    /// m/s and rad/s.
    pub v: Vec<f64>,
}

/// Rates of a contact: of its gap, and of sliding, by the speeds of all bodies.
struct Rows {
    gap: f64,
    normal: Vec<f64>,
    tangent: Vec<f64>,
}

/// The states at `count` equal parts of the run, in so many steps each.
pub fn run(scene: &Scene, count: usize, steps: usize) -> Vec<State> {
    let h = scene.until / (count * steps) as f64;
    let all = |of: fn(&super::scene::Body) -> [f64; 3]| scene.bodies.iter().flat_map(of).collect();
    let mut state = State { q: all(|body| body.start), v: all(|body| body.speed) };
    let mut impulses = vec![[0.0; 2]; scene.contacts.len()];
    let mut states = Vec::with_capacity(count);
    for k in 0..count * steps {
        step(scene, k as f64 * h, h, &mut state, &mut impulses);
        if (k + 1) % steps == 0 {
            states.push(state.clone());
        }
    }
    states
}

fn step(scene: &Scene, t: f64, h: f64, state: &mut State, impulses: &mut [[f64; 2]]) {
    let n = state.q.len();
    let inverse: Vec<f64> = scene.bodies.iter().flat_map(|b| [1.0 / b.mass, 1.0 / b.mass, 1.0 / b.inertia]).collect();
    let before = state.v.clone();
    (0..n).for_each(|i| state.q[i] += 0.5 * h * state.v[i]);
    let forces = forces(scene, t + 0.5 * h, &state.q);
    (0..n).for_each(|i| state.v[i] += h * inverse[i] * forces[i]);
    let rows: Vec<Rows> = scene.contacts.iter().map(|contact| rows(&contact.touch, &state.q)).collect();
    let closed: Vec<usize> = (0..rows.len()).filter(|k| rows[*k].gap <= 0.0).collect();
    for (k, impulse) in impulses.iter_mut().enumerate() {
        if !closed.contains(&k) {
            *impulse = [0.0; 2];
        }
        // What the last step ended with is near what this one will.
        push(&mut state.v, &inverse, (&rows[k].normal, impulse[0]));
        push(&mut state.v, &inverse, (&rows[k].tangent, impulse[1]));
    }
    for _ in 0..MOST_ROUNDS {
        let (mut changed, mut largest) = (0.0_f64, 0.0_f64);
        for k in &closed {
            let (contact, row) = (&scene.contacts[*k], &rows[*k]);
            let mut project =
                |part: usize, row: &[f64], wanted: f64, [low, high]: [f64; 2], impulses: &mut [[f64; 2]]| {
                    let moves: f64 = (0..n).map(|i| row[i] * inverse[i] * row[i]).sum();
                    let old = impulses[*k][part];
                    let new = (old - (dot(row, &state.v) - wanted) / moves).clamp(low, high);
                    impulses[*k][part] = new;
                    push(&mut state.v, &inverse, (row, new - old));
                    changed = changed.max((new - old).abs());
                    largest = largest.max(new.abs());
                };
            let limit = match contact.touch {
                Touch::Pressed { limit, .. } => h * limit,
                _ => {
                    let wanted = -contact.restitution * dot(&row.normal, &before);
                    project(0, &row.normal, wanted, [0.0, f64::INFINITY], impulses);
                    contact.friction * impulses[*k][0]
                }
            };
            project(1, &row.tangent, 0.0, [-limit, limit], impulses);
        }
        if changed <= SETTLED * largest {
            break;
        }
    }
    (0..n).for_each(|i| state.q[i] += 0.5 * h * state.v[i]);
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn push(v: &mut [f64], inverse: &[f64], (row, impulse): (&[f64], f64)) {
    v.iter_mut().zip(inverse).zip(row).for_each(|((v, inverse), row)| *v += inverse * row * impulse);
}

fn forces(scene: &Scene, t: f64, q: &[f64]) -> Vec<f64> {
    let mut f = vec![0.0; q.len()];
    for (i, body) in scene.bodies.iter().enumerate() {
        f[3 * i] = body.mass * scene.gravity[0];
        f[3 * i + 1] = body.mass * scene.gravity[1];
    }
    f[0] += scene.drive[0] * (scene.drive[1] * t).sin();
    for (a, b, stiffness) in &scene.springs {
        for axis in 0..2 {
            let pull = stiffness * (q[3 * b + axis] - q[3 * a + axis]);
            f[3 * a + axis] += pull;
            f[3 * b + axis] -= pull;
        }
    }
    f
}

/// The rows of a contact between a body's point and another's, or the ground's, across a normal; arms are from the centres.
fn rows(touch: &Touch, q: &[f64]) -> Rows {
    let centre = |body: usize| [q[3 * body], q[3 * body + 1]];
    let (mut normal, mut tangent) = (vec![0.0; q.len()], vec![0.0; q.len()]);
    let mut at = |body: usize, arm: [f64; 2], [nx, ny]: [f64; 2], sign: f64| {
        // The tangent is the normal turned clockwise.
        for (row, [x, y]) in [(&mut normal, [nx, ny]), (&mut tangent, [ny, -nx])] {
            row[3 * body] += sign * x;
            row[3 * body + 1] += sign * y;
            row[3 * body + 2] += sign * (arm[0] * y - arm[1] * x);
        }
    };
    let gap = match touch {
        Touch::Corner { body, place: [x, y], plane } => {
            let (sin, cos) = q[3 * body + 2].sin_cos();
            let arm = [cos * x - sin * y, sin * x + cos * y];
            at(*body, arm, plane.normal, 1.0);
            let [cx, cy] = centre(*body);
            plane.normal[0] * (cx + arm[0] - plane.point[0]) + plane.normal[1] * (cy + arm[1] - plane.point[1])
        }
        Touch::Disc { body, radius, plane } => {
            at(*body, plane.normal.map(|n| -radius * n), plane.normal, 1.0);
            let [cx, cy] = centre(*body);
            plane.normal[0] * (cx - plane.point[0]) + plane.normal[1] * (cy - plane.point[1]) - radius
        }
        Touch::Discs { bodies: [a, b], radii: [r, s] } => {
            let ([ax, ay], [bx, by]) = (centre(*a), centre(*b));
            let distance = (bx - ax).hypot(by - ay);
            let across = [(bx - ax) / distance, (by - ay) / distance];
            at(*b, across.map(|n| -s * n), across, 1.0);
            at(*a, across.map(|n| r * n), across, -1.0);
            distance - r - s
        }
        Touch::Pressed { body, from, .. } => {
            tangent[3 * body] = 1.0;
            from.iter().for_each(|from| tangent[3 * from] = -1.0);
            0.0
        }
    };
    Rows { gap, normal, tangent }
}
