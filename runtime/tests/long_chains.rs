//! Mechanisms whose M is not formed against the same ones with M.
#![cfg(feature = "interpret")]

use dalembert::mechanism::{At, Interpreted, System};
use dalembert_symbolic::lower::{compile, compile_for_runs_in};

/// Links with springs and dampers between them, and a force at the end that time drives.
const SPRUNG: &str = "name: Sprung
sizes: {n: 20}
parameters: {m: 1 kg, l: 1 m, g: 10 m/s^2, k: 3 N*m/rad, F: 2 N, w: 3 rad/s}
coordinates: {\"phi[i in 1..n]\": rad}
inputs: {push: F*cos(w*t)}
define: {\"theta[i in 1..n]\": \"sum(phi[j], j in 1..i)\"}
points:
  \"tip[0]\": [0, 0]
  \"tip[i in 1..n]\": \"tip[i-1] + l*[sin(theta[i]), -cos(theta[i])]\"
bodies:
  \"bar[i in 1..n]\": {mass: m, inertia: m*l^2/12, angle: \"theta[i]\", position: \"(tip[i-1] + tip[i])/2\"}
gravity: [0, -g]
springs:
  \"spring[i in 2..n]\": {stretch: \"phi[i]\", stiffness: k, on: \"bar[i]\", from: \"bar[i-1]\"}
forces: {push: {on: \"bar[n]\", at: \"tip[n]\", force: \"[push, 0]\"}}
scene: {start: {\"phi[i in 1..n]\": 0.1}, until: 1}
";

fn both(text: &str, n: i64) -> [Interpreted; 2] {
    let sizes = [("n".to_owned(), n)];
    let long = compile_for_runs_in(None, text, &sizes).unwrap_or_else(|problems| panic!("{problems:?}"));
    assert!(long.unformed);
    let formed = compile(text, &sizes).unwrap_or_else(|problems| panic!("{problems:?}"));
    assert!(!formed.unformed && !formed.mass.is_empty());
    [Interpreted::new(long, text), Interpreted::new(formed, text)]
}

/// What a function puts out, by place.
fn filled(size: usize, put: impl FnOnce(&mut [f64])) -> Vec<f64> {
    let mut values = vec![f64::NAN; size];
    put(&mut values);
    values
}

fn square(pattern: &[(u32, u32)], values: &[f64], n: usize) -> Vec<f64> {
    let mut matrix = vec![0.0; n * n];
    pattern.iter().zip(values).for_each(|((i, j), x)| matrix[*i as usize * n + *j as usize] = *x);
    matrix
}

#[track_caller]
fn close(what: &str, a: &[f64], b: &[f64]) {
    let size = b.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    assert_eq!(a.len(), b.len(), "{what}");
    for (k, (a, b)) in a.iter().zip(b).enumerate() {
        assert!((a - b).abs() <= 1e-12 * size, "{what} {k}: {a} and {b}, of {size}");
    }
}

#[test]
fn slopes_of_forces_are_the_matrices() {
    let chain = include_str!("../../models/chain.yaml");
    for (text, n) in [(chain, 18), (SPRUNG, 20)] {
        let systems = both(text, n);
        let n = n as usize;
        let [q, v, a] = [1.0, 2.0, 3.0].map(|k: f64| (0..n).map(|i| (k + i as f64 * 1.7).sin()).collect::<Vec<f64>>());
        let at = At::new(0.3, &q, &v).accelerated(&a);
        let [long, formed] = systems.each_ref().map(|system| {
            let known = system.description();
            let mass = filled(known.mass_pattern.len(), |m| system.mass_matrix(at, m));
            let (mut dq, mut dv) = (vec![0.0; known.stiffness_pattern.len()], vec![0.0; known.damping_pattern.len()]);
            system.jacobians(at, &mut dq, &mut dv);
            let mut room = Vec::new();
            [
                ("M", square(&known.mass_pattern, &mass, n)),
                ("h", filled(n, |h| system.bias(at, h))),
                ("F by q", square(&known.stiffness_pattern, &dq, n)),
                ("F by q'", square(&known.damping_pattern, &dv, n)),
                ("q''", filled(n, |a| assert!(system.accelerations(at, a).is_ok()))),
                ("inertias", filled(n, |m| system.inertias(at, &mut room, m))),
            ]
        });
        for ((what, a), (_, b)) in long.iter().zip(&formed) {
            match *what {
                "inertias" => {
                    assert!(a.iter().zip(b).all(|(a, b)| *a > 0.0 && *a < 2.0 * b && *b < 20.0 * a), "{a:?} {b:?}")
                }
                _ => close(what, a, b),
            }
        }
    }
}

#[test]
fn long_chains_run_by_any_method() {
    use dalembert::{Method, Simulation};
    let end = |system: &Interpreted, method| {
        let run = Simulation::new(system.clone()).until(0.5).method(method).run();
        run.unwrap_or_else(|error| panic!("{method:?}: {error}")).last().q.to_vec()
    };
    let [long, formed] = both(SPRUNG, 20);
    for method in [Method::Dop853, Method::Radau5, Method::Rodas5P, Method::Taylor] {
        let apart =
            end(&long, method).iter().zip(end(&formed, method)).fold(0.0_f64, |most, (a, b)| most.max((a - b).abs()));
        assert!(apart < 1e-7, "{method:?} {apart:e}");
    }
}
