//! The length of a rotation's quaternion: nothing depends on it, and M does not know it.

use dalembert_symbolic::expr::{Symbol, Tape};
use dalembert_symbolic::gate::judged;
use dalembert_symbolic::lower::compile;
use dalembert_symbolic::model::load;

use super::accepted;

/// Two bodies on ball joints, loaded, with a spring between them.
const CHAIN: &str = "name: Chain
parameters: {m: 1 kg, l: 0.5 m, k: 3 N/m, c: 0.2 N*m*s, g: 9.81 m/s^2}
coordinates: {upper: rotation, lower: rotation, s: m}
frames: {A: {rotate: upper}, B: {rotate: lower}}
points: {knee: l*A.x, foot: knee + l*B.z, slide: \"[s, 0, 0]\"}
bodies:
  first: {mass: m, inertia: [2, 3, 4], frame: A, position: knee}
  second: {mass: m, inertia: [0.3, 0.4, 0.5], frame: B, position: foot}
  bead: {mass: m, position: slide}
springs: {pull: {between: [foot, slide], stiffness: k}}
torques: {rub: {on: second, from: first, torque: c*(angular_velocity(first) - angular_velocity(second))}}
gravity: [0, 0, -g]
";

#[test]
fn no_acceleration_depends_on_a_length() {
    accepted(CHAIN);
    let judged = judged(load(CHAIN, &[]).expect("a model")).expect("a good model");
    let names: Vec<&str> = judged.report.lengths.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["upper", "lower"]);
    // Another length has other roundings, and no more than these.
    assert!(judged.report.lengths.iter().all(|(_, worst)| *worst < 1e-27), "{:?}", judged.report.lengths);
    assert!(judged.report.lengths.iter().any(|(_, worst)| *worst > 0.0), "{:?}", judged.report.lengths);
}

/// No file can name the four numbers; a model made by hand can.
#[test]
fn a_length_that_matters_is_found() {
    for (name, what) in [("upper", "upper"), ("lower", "lower")] {
        let mut model = load(CHAIN, &[]).expect("a model");
        let first = model.rotations.iter().find(|rotation| rotation.name == name).expect("the rotation").first as u32;
        let graph = &mut model.graph;
        let x = graph.symbol(Symbol::Coordinate(first + 1));
        let square = graph.mul(x, x);
        model.raw_potential_energy = square;
        let problems = judged(model).err().unwrap_or_default();
        let found = problems.iter().find(|problem| problem.code == "E520").expect("an error of the length");
        assert!(found.message.contains(&format!("`{what}`")), "{}", found.message);
        assert_eq!(found.place.path.len(), 2, "{:?}", found.place);
    }
    // The same over |q|² is as good as any.
    let mut model = load(CHAIN, &[]).expect("a model");
    let graph = &mut model.graph;
    let numbers: Vec<_> = (0..4).map(|k| graph.symbol(Symbol::Coordinate(k))).collect();
    let squares: Vec<_> = numbers.iter().map(|q| graph.mul(*q, *q)).collect();
    let length = squares.iter().skip(1).fold(squares[0], |sum, square| graph.add(sum, *square));
    let part = graph.div(squares[1], length);
    model.raw_potential_energy = part;
    let problems = judged(model).err().unwrap_or_default();
    assert!(problems.iter().all(|problem| problem.code != "E520"), "{problems:?}");
}

/// SplitMix64, as the program draws its states.
fn random(state: &mut u64) -> f64 {
    *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let mut z = *state;
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
}

/// Eigenvalues of a symmetric matrix by Jacobi's rotations.
fn eigenvalues(mut a: [[f64; 4]; 4]) -> [f64; 4] {
    for _ in 0..20 {
        for p in 0..3 {
            for q in p + 1..4 {
                if a[p][q] == 0.0 {
                    continue;
                }
                let tau = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
                let t = if tau < 0.0 { -1.0 } else { 1.0 } / (tau.abs() + tau.hypot(1.0));
                let c = 1.0 / t.hypot(1.0);
                let s = t * c;
                for row in &mut a {
                    (row[p], row[q]) = (c * row[p] - s * row[q], s * row[p] + c * row[q]);
                }
                let (first, second) = (a[p], a[q]);
                for k in 0..4 {
                    a[p][k] = c * first[k] - s * second[k];
                    a[q][k] = s * first[k] + c * second[k];
                }
            }
        }
    }
    std::array::from_fn(|k| a[k][k])
}

/// Four times the inertia, and that of the length, over |q|²: the condition of M is that of the inertia, 4.7/1.3, wherever the body is turned
/// and however long the quaternion.
#[test]
fn the_condition_of_a_free_body_is_that_of_its_inertia() {
    let text = "name: Free
coordinates: {attitude: rotation}
frames: {B: {rotate: attitude}}
bodies: {body: {mass: 1 kg, inertia: [1.3, 3.9, 4.7], frame: B, position: [0, 0, 0]}}
";
    let program = compile(text, &[]).expect("a good model");
    let roots: Vec<_> = program.mass.iter().map(|entry| entry.2).collect();
    let tape = Tape::new(&program.model.graph, &roots);
    let mut seed = 0x9e37_79b9_7f4a_7c15;
    for _ in 0..1000 {
        let length = 10_f64.powf(4.0 * random(&mut seed) - 2.0);
        let q: [f64; 4] = std::array::from_fn(|_| length * (2.0 * random(&mut seed) - 1.0));
        let values = tape.evaluate(|symbol| if let Symbol::Coordinate(k) = symbol { q[k as usize] } else { 0.0 });
        let mut mass = [[0.0; 4]; 4];
        for ((i, j, _), value) in program.mass.iter().zip(values) {
            (mass[*i][*j], mass[*j][*i]) = (value, value);
        }
        let found = eigenvalues(mass);
        let (least, most) = found.iter().fold((f64::INFINITY, 0.0_f64), |(a, b), x| (a.min(*x), b.max(*x)));
        let condition = most / least / (4.7 / 1.3);
        assert!(condition < 1.0001 && condition > 0.9999, "{condition} at {q:?}");
    }
}
