//! Motions that several methods are tested with.

use std::sync::Arc;

use crate::Settings;
use crate::mechanism::Method;
use crate::run::Run;
use crate::simulate::simulate;
use crate::testing::Toy;

/// A run without dense output.
pub(crate) fn run(mut toy: Toy, change: impl Fn(&mut Settings)) -> Run {
    let mut settings = Settings::new(&toy.scene);
    (settings.dense, settings.watch) = (false, false);
    change(&mut settings);
    simulate(&mut toy, &settings).unwrap()
}

/// A method at a fixed step.
pub(crate) fn fixed(method: Method, step: f64) -> impl Fn(&mut Settings) {
    move |settings| (settings.method, settings.step) = (method, Some(step))
}

/// The two-body problem with the Sun's attraction 1, from the perihelion of an orbit of semiaxis 1: period 2π.
pub(crate) fn kepler(eccentricity: f64, until: f64) -> Toy {
    let (near, fast) = (1.0 - eccentricity, ((1.0 + eccentricity) / (1.0 - eccentricity)).sqrt());
    let mut toy = Toy::new(&["x", "y"], (&[near, 0.0], &[0.0, fast]), until, |_, q, _, _, a| {
        let cube = q[0].hypot(q[1]).powi(3);
        (a[0], a[1]) = (-q[0] / cube, -q[1] / cube);
    })
    .separable();
    toy.jacobian = Arc::new(|q, _, _, dq, dv| {
        let r = q[0].hypot(q[1]);
        for i in 0..2 {
            for j in 0..2 {
                let unit = if i == j { 1.0 } else { 0.0 };
                dq[2 * i + j] = unit / r.powi(3) - 3.0 * q[i] * q[j] / r.powi(5);
            }
        }
        dv.fill(0.0);
    });
    toy
}

/// Energy and angular momentum of a reported row of [`kepler`].
pub(crate) fn invariants(row: &[f64]) -> [f64; 2] {
    let [x, y, u, v] = row else { panic!("a planet") };
    [0.5 * (u * u + v * v) - 1.0 / x.hypot(*y), x * v - y * u]
}

/// A pendulum on a spring of stiffness k in Cartesian coordinates, length 1, mass 1, g = 9.81, let go at `angle` at rest;
/// `damping` is that of the air.
pub(crate) fn spring_pendulum(k: f64, angle: f64, damping: f64, until: f64) -> Toy {
    let start = [angle.sin(), -angle.cos()];
    let mut toy = Toy::new(&["x", "y"], (&start, &[0.0, 0.0]), until, move |_, q, v, _, a| {
        let pull = k * (1.0 - 1.0 / q[0].hypot(q[1]));
        a[0] = -pull * q[0] - damping * v[0];
        a[1] = -pull * q[1] - damping * v[1] - 9.81;
    });
    toy.jacobian = Arc::new(move |q, _, _, dq, dv| {
        let r = q[0].hypot(q[1]);
        for i in 0..2 {
            for j in 0..2 {
                let unit = if i == j { 1.0 } else { 0.0 };
                dq[2 * i + j] = k * (1.0 - 1.0 / r) * unit + k * q[i] * q[j] / r.powi(3);
                dv[2 * i + j] = damping * unit;
            }
        }
    });
    toy
}

/// The same in polar coordinates, without damping: M depends on r.
pub(crate) fn polar_pendulum(k: f64, until: f64) -> Toy {
    let mut toy = Toy::new(&["r", "theta"], (&[1.1, 1.0], &[0.0, 0.0]), until, move |_, q, v, _, a| {
        a[0] = q[0] * v[1] * v[1] + q[1].cos() - k * (q[0] - 1.0);
        a[1] = -(2.0 * v[0] * v[1] + q[1].sin()) / q[0];
    })
    .mass(|_, q| vec![1.0, q[0] * q[0]])
    .energy(move |_, q, v| {
        let kinetic = 0.5 * (v[0] * v[0] + (q[0] * v[1]).powi(2));
        [kinetic, 0.5 * k * (q[0] - 1.0).powi(2) - q[0] * q[1].cos(), 0.0]
    });
    toy.jacobian = Arc::new(move |q, v, a, dq, dv| {
        dq[0] = k - v[1] * v[1];
        dq[1] = q[1].sin();
        dq[2] = 2.0 * q[0] * a[1] + 2.0 * v[0] * v[1] + q[1].sin();
        dq[3] = q[0] * q[1].cos();
        dv[0] = 0.0;
        dv[1] = -2.0 * q[0] * v[1];
        dv[2] = 2.0 * q[0] * v[1];
        dv[3] = 2.0 * q[0] * v[0];
    });
    toy
}

/// The orders with which errors fall at the ends of steps and between them as the step is halved, against a reference that
/// another method computes.
pub(crate) fn orders(toy: &Toy, method: Method, coarse: f64) -> ([f64; 2], [[f64; 2]; 2]) {
    let solve = |change: &dyn Fn(&mut Settings)| {
        let mut toy = toy.clone();
        let mut settings = Settings { watch: false, ..Settings::new(&toy.scene) };
        change(&mut settings);
        simulate(&mut toy, &settings).unwrap()
    };
    let exact = solve(&|settings| (settings.tolerance, settings.longest_step) = (1e-14, Some(0.02)));
    let until = toy.scene.until;
    let errors = [coarse, coarse / 2.0].map(|step| {
        let run = solve(&|settings| (settings.method, settings.step) = (method, Some(step)));
        let error = |t: f64| {
            let (found, exact) = (run.at(t).unwrap(), exact.at(t).unwrap());
            let names = exact.entries().map(|(name, value)| (found[&*name] - value).powi(2));
            names.sum::<f64>().sqrt()
        };
        let ends = (1..).map(|k| f64::from(k) * coarse).take_while(|t| *t <= until);
        let between = (1..).map(|k| 0.02 * f64::from(k) - 0.007).take_while(|t| *t <= until);
        [ends.map(error).fold(0.0, f64::max), between.map(error).fold(0.0, f64::max)]
    });
    ([0, 1].map(|k| (errors[0][k] / errors[1][k]).log2()), errors)
}

/// The slope of log(error) over log(tolerance), DETEST's E, and the points (tolerance, error).
pub(crate) fn proportionality(
    toy: &Toy,
    method: Method,
    powers: std::ops::RangeInclusive<i32>,
) -> (f64, Vec<[f64; 2]>) {
    let solve = |change: &dyn Fn(&mut Settings)| {
        let mut toy = toy.clone();
        let every = Some(toy.scene.until / 100.0);
        let mut settings = Settings { watch: false, dense: false, every, ..Settings::new(&toy.scene) };
        change(&mut settings);
        simulate(&mut toy, &settings).unwrap()
    };
    let exact = solve(&|settings| settings.tolerance = 1e-14);
    let points: Vec<[f64; 2]> = powers
        .map(|k| {
            let tolerance = 10.0_f64.powi(-k);
            let run = solve(&|settings| (settings.method, settings.tolerance) = (method, tolerance));
            let error = run.rows.iter().zip(&exact.rows).fold(0.0_f64, |most, (a, b)| most.max((a - b).abs()));
            [tolerance, error]
        })
        .collect();
    let logs: Vec<[f64; 2]> = points.iter().map(|point| point.map(f64::log10)).collect();
    let mean = |k: usize| logs.iter().map(|p| p[k]).sum::<f64>() / logs.len() as f64;
    let (x, y) = (mean(0), mean(1));
    let slope = logs.iter().map(|p| (p[0] - x) * (p[1] - y)).sum::<f64>()
        / logs.iter().map(|p| (p[0] - x).powi(2)).sum::<f64>();
    (slope, points)
}
