//! Order conditions, stability limits and observed order, from the tableaux themselves.

use std::fmt::Debug;
use std::ops::{Add, Mul};

use nalgebra::Complex;

use super::tableau::{Estimate, Tableau, Term};
use super::{DOP853, DOPRI5, EULER, MIDPOINT, RK4};
use crate::Settings;
use crate::integrate::Stability;
use crate::integrate::trees::{Tree, trees};
use crate::mechanism::Method;
use crate::run::Run;
use crate::simulate::simulate;
use crate::testing::Toy;

/// An exact fraction.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Fraction(i128, i128);

impl Fraction {
    fn new(n: i128, d: i128) -> Self {
        let (mut a, mut b) = (n.abs(), d.abs());
        while b != 0 {
            (a, b) = (b, a % b);
        }
        let common = a.max(1) * d.signum();
        Fraction(n / common, d / common)
    }
}

impl Add for Fraction {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let common = Fraction::new(self.1, other.1);
        // self.1·k = other.1·l is the least common denominator.
        let (k, l) = (common.1, common.0);
        Fraction::new(self.0 * k + other.0 * l, self.1 * k)
    }
}

impl Mul for Fraction {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let (a, b) = (Fraction::new(self.0, other.1), Fraction::new(other.0, self.1));
        Fraction::new(a.0 * b.0, a.1 * b.1)
    }
}

/// Numbers in which order conditions can be evaluated.
trait Number: Copy + Add<Output = Self> + Mul<Output = Self> + Debug {
    fn of(term: &Term) -> Self;
    fn whole(n: i128) -> Self;
}

impl Number for Fraction {
    fn of(term: &Term) -> Self {
        let (n, d) = term.ratio.expect("a rational tableau");
        assert_eq!(n as f64 / d as f64, term.value);
        Fraction::new(n.into(), d.into())
    }
    fn whole(n: i128) -> Self {
        Fraction(n, 1)
    }
}

impl Number for f64 {
    fn of(term: &Term) -> Self {
        term.value
    }
    fn whole(n: i128) -> Self {
        n as f64
    }
}

impl Tree {
    /// Φᵢ(t) for each stage: the product over the subtrees of Σⱼ aᵢⱼ Φⱼ.
    fn weights<N: Number>(&self, rows: &[(f64, &[Term])]) -> Vec<N> {
        let mut product = vec![N::whole(1); rows.len()];
        for subtree in &self.0 {
            let inner: Vec<N> = subtree.weights(rows);
            for (product, (_, row)) in product.iter_mut().zip(rows) {
                *product = *product * sum(row, &inner);
            }
        }
        product
    }
}

fn sum<N: Number>(terms: &[Term], values: &[N]) -> N {
    terms.iter().fold(N::whole(0), |total, term| total + N::of(term) * values[term.stage])
}

#[test]
fn rational_tableaux_satisfy_their_order_conditions_exactly() {
    for tableau in [EULER, MIDPOINT, RK4, DOPRI5] {
        for order in 1..=tableau.order as usize {
            for tree in trees(order) {
                let left: Fraction = sum(tableau.weights, &tree.weights(tableau.rows));
                assert_eq!(left * Fraction::whole(tree.density()), Fraction::whole(1), "{tree:?}");
            }
        }
        let beyond = trees(tableau.order as usize + 1);
        let holds = |tree: &Tree| {
            let left: Fraction = sum(tableau.weights, &tree.weights(tableau.rows));
            left * Fraction::whole(tree.density()) == Fraction::whole(1)
        };
        assert!(!beyond.iter().all(holds), "the order is higher than stated");
    }
}

#[test]
fn dopri5_estimates_its_error_with_a_method_of_order_four() {
    let Estimate::Single(difference) = DOPRI5.estimate else { panic!("an embedded method") };
    for order in 1..=4 {
        for tree in trees(order) {
            let left: Fraction = sum(difference, &tree.weights(DOPRI5.rows));
            assert_eq!(left, Fraction::whole(0), "{tree:?}");
        }
    }
}

#[test]
fn dop853_satisfies_its_order_conditions_to_rounding() {
    let Estimate::Pair { higher, lower } = DOP853.estimate else { panic!("two embedded methods") };
    for order in 1..=8 {
        for tree in trees(order) {
            let weights: Vec<f64> = tree.weights(DOP853.rows);
            let left = sum(DOP853.weights, &weights) * tree.density() as f64;
            assert!((left - 1.0).abs() < 2e-13, "{tree:?}: {left}");
            for (difference, its_order) in [(higher, 5), (lower, 3)] {
                let left = sum(difference, &weights);
                assert!(order > its_order || left.abs() < 1e-14, "{tree:?}: {left}");
            }
        }
    }
}

#[test]
fn nodes_are_the_sums_of_their_rows() {
    for tableau in [EULER, MIDPOINT, RK4, DOPRI5, DOP853] {
        for (node, row) in tableau.rows.iter().chain(tableau.dense_rows) {
            let sum: f64 = row.iter().map(|term| term.value).sum();
            assert!((sum - node).abs() < 4e-14, "{node}: {sum}");
        }
    }
}

/// The first x at which |R(x·direction)| exceeds 1, to 10⁻⁹.
fn limit(tableau: &Tableau, direction: Complex<f64>) -> f64 {
    let stability = Stability::Polynomial(tableau.stability());
    let stable = |x: f64| stability.amplification(direction * x) <= 1.0 + 1e-13;
    let Some(first) = (1..20_000).map(|k| f64::from(k) * 1e-3).find(|x| !stable(*x)) else { panic!("no limit") };
    let (mut low, mut high) = (first - 1e-3, first);
    while high - low > 1e-9 {
        let middle = 0.5 * (low + high);
        if stable(middle) { low = middle } else { high = middle }
    }
    low
}

#[test]
fn stability_limits_are_those_of_the_catalogue_a1() {
    let (imaginary, real) = (Complex::new(0.0, 1.0), Complex::new(-1.0, 0.0));
    for (tableau, along_imaginary, along_real) in [
        (EULER, 0.0, 2.0),
        (MIDPOINT, 0.0, 2.0),
        (RK4, 2.828_43, 2.785_29),
        (DOPRI5, 0.997_19, 3.306_57),
        (DOP853, 5.960_36, 6.393_65),
    ] {
        // What grows by less than rounding per step cannot be told from what does not.
        assert!((limit(tableau, imaginary) - along_imaginary).abs() < 1e-3, "{}", limit(tableau, imaginary));
        if along_imaginary > 0.0 {
            assert!((limit(tableau, imaginary) - along_imaginary).abs() < 1e-4);
        }
        assert!((limit(tableau, real) - along_real).abs() < 1e-4, "{}", limit(tableau, real));
    }
}

#[test]
fn steps_inside_the_limit_stay_bounded_and_outside_grow_a4() {
    for (method, limit) in [(Method::Rk4, 2.0 * 2.0_f64.sqrt()), (Method::Dop853, 5.960_36)] {
        let amplitude = |h: f64, steps: f64| {
            let mut toy = Toy::oscillator(1.0, h * steps);
            let settings = Settings { method, step: Some(h), dense: false, watch: false, ..Settings::new(&toy.scene) };
            let last = simulate(&mut toy, &settings).unwrap().last();
            last["x"].hypot(last["x'"])
        };
        assert!(amplitude(0.99 * limit, 1e4) <= 1.0);
        assert!(amplitude(1.01 * limit, 3e3) > 1e6);
    }
}

/// A pendulum from 1 rad at rest with g = l, at t = 4 by another method to 10⁻¹⁴.
fn pendulum(method: Method, step: f64) -> Run {
    let mut toy = Toy::pendulum(1.0, 1.0, 4.0);
    let settings = Settings { method, step: Some(step), ..Settings::new(&toy.scene) };
    simulate(&mut toy, &settings).unwrap()
}

#[test]
fn errors_fall_with_the_order_of_the_method_and_of_its_dense_output() {
    let mut toy = Toy::pendulum(1.0, 1.0, 4.0);
    let settings = Settings { tolerance: 1e-14, longest_step: Some(0.05), ..Settings::new(&toy.scene) };
    let exact = simulate(&mut toy, &settings).unwrap();
    for (method, coarse, order, dense_order) in [
        (Method::Euler, 0.01, 1.0, 1.0),
        (Method::Midpoint, 0.02, 2.0, 2.0),
        (Method::Rk4, 0.05, 4.0, 4.0),
        (Method::Dopri5, 0.1, 5.0, 5.0),
        (Method::Dop853, 0.4, 8.0, 8.0),
    ] {
        let errors = [coarse, coarse / 2.0].map(|step| {
            let run = pendulum(method, step);
            let error = |t: f64| {
                let (found, exact) = (run.at(t).unwrap(), exact.at(t).unwrap());
                (found["theta"] - exact["theta"]).hypot(found["theta'"] - exact["theta'"])
            };
            let worst = |times: &mut dyn Iterator<Item = f64>| times.map(error).fold(0.0, f64::max);
            let at_end = worst(&mut (1..=10).map(|k| 0.4 * f64::from(k)));
            let between = worst(&mut (1..200).map(|k| 0.02 * f64::from(k) - 0.007));
            (at_end, between)
        });
        let observed = (errors[0].0 / errors[1].0).log2();
        let observed_between = (errors[0].1 / errors[1].1).log2();
        assert!((observed - order).abs() < 0.5, "{method}: {observed}, errors {errors:?}");
        assert!(observed_between > dense_order - 0.6, "{method}: dense {observed_between}, errors {errors:?}");
    }
}
