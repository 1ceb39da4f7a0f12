//! Order conditions, orders with exact and with wrong derivatives, and stiff motions.

use std::sync::Arc;

use nalgebra::{Complex, DMatrix, DVector};

use super::RODAS5P;
use super::tableau::STAGES;
use crate::integrate::Stability;
use crate::integrate::test_problems::{orders, polar_pendulum, proportionality, run, spring_pendulum};
use crate::integrate::trees::{Tree, trees};
use crate::mechanism::Method;
use crate::testing::Toy;

/// Φᵢ(t): along a single branch by α + γ, along several by α (Hairer and Wanner II, theorem IV.7.4).
fn weights(tree: &Tree, alpha: &DMatrix<f64>, beta: &DMatrix<f64>) -> DVector<f64> {
    match tree.0.as_slice() {
        [] => DVector::from_element(STAGES, 1.0),
        [only] => beta * weights(only, alpha, beta),
        several => several
            .iter()
            .map(|branch| alpha * weights(branch, alpha, beta))
            .fold(DVector::from_element(STAGES, 1.0), |product, branch| product.component_mul(&branch)),
    }
}

#[test]
fn coefficients_satisfy_their_order_conditions() {
    let square = |lines: &[&[f64]]| DMatrix::from_fn(STAGES, STAGES, |i, j| lines[i].get(j).copied().unwrap_or(0.0));
    // U = Γ k: the matrix with 1/γ on its diagonal less the couplings is Γ⁻¹.
    let inverse = DMatrix::identity(STAGES, STAGES) / RODAS5P.gamma - square(RODAS5P.couplings);
    let gamma = inverse.try_inverse().unwrap();
    let alpha = square(RODAS5P.arguments) * &gamma;
    let beta = &alpha + &gamma;
    let b = DVector::from_column_slice(RODAS5P.arguments[STAGES]).transpose() * &gamma;
    let mut embedded = RODAS5P.arguments[STAGES].to_vec();
    embedded[STAGES - 1] = 0.0;
    let embedded = DVector::from_vec(embedded).transpose() * &gamma;
    let mut left_over = 0.0_f64;
    for order in 1..=6 {
        for tree in trees(order) {
            let phi = weights(&tree, &alpha, &beta);
            let (left, lower) = ((&b * &phi)[0] * tree.density() as f64, (&embedded * &phi)[0] * tree.density() as f64);
            assert!(order > 5 || (left - 1.0).abs() < 1e-11, "{tree:?}: {left}");
            assert!(order > 4 || (lower - 1.0).abs() < 1e-11, "{tree:?}: embedded {lower}");
            left_over = if order == 6 { left_over.max((left - 1.0).abs()) } else { 0.0 };
        }
    }
    assert!(left_over > 1e-6, "the order is higher than stated");
    for i in 0..STAGES {
        assert!((alpha.row(i).sum() - RODAS5P.nodes[i]).abs() < 1e-12);
        assert!((gamma.row(i).sum() - RODAS5P.times[i]).abs() < 1e-12);
    }
}

#[test]
fn the_stability_function_is_that_of_the_catalogue_a4() {
    let size = |z| Stability::Rational(RODAS5P.stability).amplification(z);
    assert!((size(Complex::new(0.0, 1.0)) - 0.999_991).abs() < 1e-6);
    assert!((size(Complex::new(0.0, 10.0)) - 0.834_79).abs() < 1e-5);
    assert!(size(Complex::new(-1e6, 0.0)) < 1e-4);
    assert!(size(Complex::new(2.70, 0.0)) > 1.0 && size(Complex::new(2.71, 0.0)) < 1.0);
}

#[test]
fn errors_fall_with_the_order_of_the_method_and_of_its_dense_output() {
    let ([ends, between], errors) = orders(&polar_pendulum(4.0, 4.0), Method::Rodas5P, 0.05);
    assert!((ends - 5.0).abs() < 0.2, "{ends}, errors {errors:?}");
    assert!(between > 3.6, "dense {between}, errors {errors:?}");
}

#[test]
fn errors_are_proportional_to_the_tolerance() {
    let (slope, points) = proportionality(&polar_pendulum(4.0, 10.0), Method::Rodas5P, 3..=11);
    assert!((0.7..1.3).contains(&slope), "{slope}, {points:?}");
}

#[test]
fn the_order_falls_where_the_jacobian_is_not_exact_b12() {
    let exact = polar_pendulum(4.0, 4.0);
    let mut wrong = exact.clone();
    let jacobian = exact.jacobian.clone();
    wrong.jacobian = Arc::new(move |q, v, a, dq, dv| {
        jacobian(q, v, a, dq, dv);
        dq.iter_mut().for_each(|slope| *slope *= 1.1);
    });
    let mut none = exact.clone();
    none.jacobian = Arc::new(|_, _, _, _, _| ());
    for toy in [wrong, none] {
        let ([ends, _], errors) = orders(&toy, Method::Rodas5P, 0.01);
        assert!(ends < 2.6, "{ends}, {errors:?}");
    }
    let ([ends, _], errors) = orders(&exact, Method::Rodas5P, 0.05);
    assert!(ends > 4.6, "{ends}, {errors:?}");
}

/// x'' = −λ²(x − cos t) − 2λ(x' + sin t) − cos t: x = cos t, whatever λ.
fn follower(lambda: f64) -> Toy {
    let mut toy = Toy::new(&["x"], (&[1.0], &[0.0]), 2.0, move |t, q, v, _, a| {
        a[0] = -lambda * lambda * (q[0] - t.cos()) - 2.0 * lambda * (v[0] + t.sin()) - t.cos();
    });
    toy.jacobian = Arc::new(move |_, _, _, dq, dv| (dq[0], dv[0]) = (lambda * lambda, 2.0 * lambda));
    toy.description.structure.time_dependent = true;
    toy.description.structure.conservative = false;
    toy
}

#[test]
fn followers_cost_hardly_more_the_stiffer_they_are_a5() {
    for method in [Method::Rodas5P, Method::Radau5] {
        let work = [1e3, 1e4, 1e5].map(|lambda| {
            let run = crate::integrate::test_problems::run(follower(lambda), |settings| {
                (settings.method, settings.tolerance) = (method, 1e-6);
            });
            assert!((run.last()["x"] - 2.0_f64.cos()).abs() < 1e-5, "{method}, {lambda}");
            run.work.evaluations
        });
        assert!(work.iter().max() < work.iter().min().map(|least| 2 * least).as_ref(), "{method}: {work:?}");
    }
}

#[test]
fn what_follows_a_function_of_time_is_known_between_the_ends_of_steps() {
    // x'' = −λ²(x − cos t) − 2λ x': once the start is forgotten the motion is Re λ²/(λ² − 1 + 2iλ) e^{it}, and steps might be of any length.
    let lambda = 1e4;
    let known = Complex::new(lambda * lambda, 0.0) / Complex::new(lambda * lambda - 1.0, 2.0 * lambda);
    for method in [Method::Rodas5P, Method::Radau5] {
        for tolerance in [1e-3, 1e-6, 1e-9, 1e-12] {
            let mut toy = Toy::new(&["x"], (&[1.0], &[0.0]), 10.0, move |t, q, v, _, a| {
                a[0] = -lambda * lambda * (q[0] - t.cos()) - 2.0 * lambda * v[0];
            });
            toy.jacobian = Arc::new(move |_, _, _, dq, dv| (dq[0], dv[0]) = (lambda * lambda, 2.0 * lambda));
            toy.description.structure.time_dependent = true;
            toy.description.structure.conservative = false;
            let run = run(toy, |settings| {
                (settings.method, settings.tolerance, settings.watch) = (method, tolerance, true);
                settings.every = Some(0.013);
            });
            let errors = run.times().iter().zip(run.states()).filter(|(t, _)| **t > 0.1);
            let errors = errors.map(|(t, state)| (state["x"] - (known * Complex::cis(*t)).re).abs());
            let largest = errors.fold(0.0, f64::max);
            assert!(largest < 30.0 * tolerance, "{method} {tolerance}: {largest}");
        }
    }
}

#[test]
fn what_moves_by_a_high_power_of_time_at_first_stops_no_start() {
    // Let go level: x moves only once y has, through a spring of 10⁶.
    for method in [Method::Radau5, Method::Rodas5P] {
        for tolerance in [1e-2, 1e-3, 1e-5, 1e-8] {
            let toy = spring_pendulum(1e6, std::f64::consts::FRAC_PI_2, 0.0, 0.01);
            let run = run(toy, |settings| (settings.method, settings.tolerance) = (method, tolerance));
            assert!(run.work.steps < 3000, "{method} {tolerance}: {:?}", run.work);
        }
    }
}
