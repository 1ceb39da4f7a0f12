//! Order conditions, stability limits, observed orders, and work.

use nalgebra::Complex;

use super::RKN8;
use super::tableau::{END, STAGES};
use crate::integrate::Stability;
use crate::integrate::explicit::Term;
use crate::integrate::test_problems::{kepler, orders, proportionality, run};
use crate::mechanism::Method;
use crate::simulate::simulate;
use crate::testing::Toy;
use crate::{Error, Inseparable, Settings};

/// A tree of q'' = a(t, q) with an acceleration for its root: how often it is differentiated by what moves evenly, and the
/// accelerations by which places bend.
///
/// Source: Hairer, Nørsett, Wanner, Solving Ordinary Differential Equations I (1993), section II.14.
#[derive(Clone, Debug)]
struct Tree {
    evenly: i32,
    bent: Vec<Tree>,
}

impl Tree {
    /// Its part of a speed has this power of h, one less than its part of a place.
    fn order(&self) -> i32 {
        1 + self.evenly + self.bent.iter().map(|tree| tree.order() + 1).sum::<i32>()
    }

    /// What the acceleration at θ should be times θ^(1 − order).
    fn exact(&self) -> f64 {
        self.bent.iter().map(Tree::place).product()
    }

    /// What the place at θ should be times θ^(−1 − order).
    fn place(&self) -> f64 {
        self.speed() / f64::from(self.order() + 1)
    }

    /// What the speed at θ should be times θ^−order.
    fn speed(&self) -> f64 {
        self.exact() / f64::from(self.order())
    }

    /// The accelerations of the stages.
    fn stages(&self) -> [f64; END + 1] {
        let node = |i: usize| RKN8.rows.get(i).map_or(1.0, |row| row.0);
        let row = |i: usize| RKN8.rows.get(i).map_or(RKN8.places, |row| row.1);
        let mut product = std::array::from_fn(|i| node(i).powi(self.evenly));
        for tree in &self.bent {
            let inner = tree.stages();
            product.iter_mut().enumerate().for_each(|(i, product)| *product *= sum(row(i), &inner));
        }
        product
    }
}

fn sum(terms: &[Term], values: &[f64]) -> f64 {
    terms.iter().map(|term| term.value * values[term.stage]).sum()
}

/// All trees of an order.
fn trees(order: i32) -> Vec<Tree> {
    /// All sets of trees, none of a larger order than this, whose orders and one for each come to `rest`.
    fn sets(rest: i32, largest: i32) -> Vec<Vec<Tree>> {
        let mut found = if rest == 0 { vec![Vec::new()] } else { Vec::new() };
        for order in 1..=largest.min(rest - 1) {
            for (place, tree) in trees(order).into_iter().enumerate() {
                for mut set in sets(rest - order - 1, order) {
                    // Trees of one order in their own, so that each set appears once.
                    let first = set.first().filter(|first: &&Tree| first.order() == order);
                    if first.is_none_or(|first| trees(order).iter().position(|t| same(t, first)) <= Some(place)) {
                        set.insert(0, tree.clone());
                        found.push(set);
                    }
                }
            }
        }
        found
    }
    let of = |evenly: i32| sets(order - 1 - evenly, order).into_iter().map(move |bent| Tree { evenly, bent });
    (0..order).flat_map(of).collect()
}

fn same(a: &Tree, b: &Tree) -> bool {
    a.evenly == b.evenly && a.bent.len() == b.bent.len() && a.bent.iter().zip(&b.bent).all(|(a, b)| same(a, b))
}

#[test]
fn there_are_as_many_trees_as_hairer_norsett_and_wanner_count() {
    let counts: Vec<usize> = (1..=8).map(|order| trees(order).len()).collect();
    assert_eq!(counts, [1, 1, 2, 3, 6, 10, 20, 36]);
}

/// The largest error of the weights in an order condition up to this order, and the smallest beyond it.
fn residuals(terms: &[Term], order: i32, expected: impl Fn(&Tree) -> f64) -> (f64, f64) {
    let of = |order: i32| {
        let errors = trees(order).into_iter().map(|tree| (sum(terms, &tree.stages()) - expected(&tree)).abs());
        errors.collect::<Vec<f64>>()
    };
    let within = (1..=order).flat_map(of).fold(0.0, f64::max);
    (within, of(order + 1).into_iter().fold(0.0, f64::max))
}

#[test]
fn order_conditions_hold_to_rounding_and_no_further() {
    let embedded = [(RKN8.places, RKN8.errors[0]), (RKN8.speeds, RKN8.errors[1])].map(|(weights, error)| {
        let less = error.iter().map(|term| Term { value: -term.value, ..*term });
        weights.iter().copied().chain(less).collect::<Vec<Term>>()
    });
    for (name, weights, order) in [("places", RKN8.places, 7), ("places, embedded", &*embedded[0], 5)] {
        let (within, beyond) = residuals(weights, order, Tree::place);
        assert!(within < 1e-15 && beyond > 1e-7, "{name}: {within:e}, {beyond:e}");
    }
    for (name, weights, order) in [("speeds", RKN8.speeds, 8), ("speeds, embedded", &*embedded[1], 6)] {
        let (within, beyond) = residuals(weights, order, Tree::speed);
        assert!(within < 1e-15 && beyond > 1e-7, "{name}: {within:e}, {beyond:e}");
    }
}

#[test]
fn places_and_speeds_between_the_ends_satisfy_the_conditions_of_their_orders() {
    for ((node, row), order) in RKN8.dense_rows.iter().zip([5, 6, 5]) {
        let (within, _) = residuals(row, order, |tree| node.powi(tree.order() + 1) * tree.place());
        assert!(within < 1e-16, "{node}: {within:e}");
    }
    for term in RKN8.speeds {
        let (node, row) = (RKN8.rows[term.stage].0, RKN8.speed_rows[term.stage]);
        let (within, _) = residuals(row, 5, |tree| node.powi(tree.order()) * tree.speed());
        assert!(within < 1e-15, "{node}: {within:e}");
    }
}

#[test]
fn rows_sum_to_what_even_acceleration_needs() {
    let all = || RKN8.rows.iter().chain(RKN8.dense_rows);
    assert_eq!(all().count() + 1, STAGES);
    for (node, row) in all() {
        let total: f64 = row.iter().map(|term| term.value).sum();
        assert!((total - 0.5 * node * node).abs() < 2e-15, "{node}: {total}");
    }
}

#[test]
fn speeds_are_such_that_powers_are_integrated_with_the_order_of_the_method() {
    let entry = |row: &[Term], stage: usize| row.iter().find(|term| term.stage == stage).map_or(0.0, |term| term.value);
    for j in 0..END {
        let node = RKN8.rows[j].0;
        let column = |power: i32| -> f64 {
            let parts = RKN8
                .speeds
                .iter()
                .map(|term| term.value * RKN8.rows[term.stage].0.powi(power) * entry(RKN8.speed_rows[term.stage], j));
            parts.sum()
        };
        assert!((column(0) - entry(RKN8.places, j)).abs() < 1e-16);
        assert!((column(1) - 0.5 * entry(RKN8.speeds, j) * (1.0 - node * node)).abs() < 1e-16);
    }
}

#[test]
fn undamped_modes_are_stable_up_to_3_29() {
    let stability = Stability::Nystrom(&RKN8);
    let growth = |y: f64| stability.amplification(Complex::new(0.0, y)) - 1.0;
    // At hω = π both eigenvalues meet at −1: a growth of 6e-4 in a band narrower than this.
    let resonates = |y: f64| (y - std::f64::consts::PI).abs() < 1e-3;
    let first = (1..8000).map(|k| 1e-3 * f64::from(k)).find(|y| !resonates(*y) && growth(*y) > 1e-7).expect("a limit");
    assert!((first - 3.294).abs() < 2e-3, "{first}");
    assert!(growth(std::f64::consts::PI - 6.6e-4) < 6e-4);
    // What is resolved is hardly damped.
    assert!(growth(1.0) < 0.0 && growth(1.0) > -2e-8);
}

#[test]
fn errors_fall_with_order_eight_at_the_ends_of_steps_and_between_them() {
    for (toy, coarse) in [(kepler(0.3, 5.0), 0.25), (Toy::pendulum(1.0, 1.0, 4.0).separable(), 0.4)] {
        let ([ends, between], errors) = orders(&toy, Method::Rkn8, coarse);
        assert!((ends - 8.0).abs() < 0.2, "{ends}, {errors:?}");
        assert!(between > 7.6, "{between}, {errors:?}");
        assert!(errors.iter().all(|[ends, between]| *between < 10.0 * ends), "{errors:?}");
    }
}

/// x'' = −x + sin 2t: the balance T + V − ∫ x' sin 2t dt is constant.
fn driven() -> Toy {
    let mut toy = Toy::new(&["x"], (&[1.0], &[0.3]), 8.0, |t, q, _, _, a| a[0] = -q[0] + (2.0 * t).sin())
        .energy(|t, q, v| [0.5 * v[0] * v[0], 0.5 * q[0] * q[0], v[0] * (2.0 * t).sin()])
        .separable();
    toy.description.structure.conservative = false;
    toy
}

/// A mass in the plane on a spring, with a force (−y, x)·c that has no potential.
fn stirred() -> Toy {
    let c = 0.3;
    let mut toy = Toy::new(&["x", "y"], (&[1.0, 0.2], &[0.1, 0.7]), 8.0, move |_, q, _, _, a| {
        let cubic = 1.0 + q[0] * q[0] + q[1] * q[1];
        (a[0], a[1]) = (-cubic * q[0] - c * q[1], -cubic * q[1] + c * q[0]);
    })
    .energy(move |_, q, v| {
        let square = q[0] * q[0] + q[1] * q[1];
        let kinetic = 0.5 * (v[0] * v[0] + v[1] * v[1]);
        [kinetic, 0.5 * square + 0.25 * square * square, c * (q[0] * v[1] - q[1] * v[0])]
    })
    .separable();
    toy.description.structure.conservative = false;
    toy
}

#[test]
fn forces_of_time_keep_the_order_and_their_work_has_it() {
    for (name, toy, coarse) in [("driven", driven(), 0.4), ("stirred", stirred(), 0.2)] {
        let ([ends, _], errors) = orders(&toy, Method::Rkn8, coarse);
        assert!((ends - 8.0).abs() < 0.25, "{name}: {ends}, {errors:?}");
        let (_, errors) = orders(&toy, Method::Rkn8, 0.4);
        let drifts = [0.4, 0.2].map(|step| {
            let run = run(toy.clone(), |settings| {
                (settings.method, settings.step, settings.watch) = (Method::Rkn8, Some(step), true);
            });
            run.energy_balance.unwrap().abs()
        });
        let observed = (drifts[0] / drifts[1]).log2();
        assert!(observed > 7.3, "{name}: {observed}, {drifts:?}");
        // No more than the errors of the state alone explain.
        assert!(drifts[0] < 10.0 * errors[0][0], "{name}: {drifts:?}, {errors:?}");
    }
}

#[test]
fn errors_are_proportional_to_the_tolerance() {
    for (name, toy) in [("kepler", kepler(0.6, 20.0)), ("pendulum", Toy::pendulum(1.0, 1.0, 20.0).separable())] {
        let (slope, points) = proportionality(&toy, Method::Rkn8, 4..=11);
        assert!((0.8..1.25).contains(&slope), "{name}: {slope}, {points:?}");
        assert!(points.iter().all(|[tolerance, error]| *error < 250.0 * tolerance), "{name}: {points:?}");
    }
}

#[test]
fn between_the_ends_of_steps_errors_are_those_at_the_ends() {
    let exact = {
        let mut toy = kepler(0.6, 20.0);
        let settings = Settings { tolerance: 1e-14, longest_step: Some(0.02), ..Settings::new(&toy.scene) };
        simulate(&mut toy, &settings).unwrap()
    };
    for tolerance in [1e-6, 1e-8, 1e-10] {
        let along = |every: f64| {
            let run = run(kepler(0.6, 20.0), |settings| {
                (settings.method, settings.tolerance, settings.every) = (Method::Rkn8, tolerance, Some(every));
            });
            let states = run.times.iter().zip(run.rows.chunks_exact(4));
            let errors = states.map(|(t, row)| {
                let exact = exact.at(*t).unwrap();
                let names = ["x", "y", "x'", "y'"];
                row.iter().zip(names).fold(0.0_f64, |most, (found, name)| most.max((found - exact[name]).abs()))
            });
            (run.work.evaluations, errors.fold(0.0, f64::max))
        };
        let (fine, error) = along(0.01);
        let (coarse, at_end) = along(20.0);
        assert!(fine <= coarse + 4 * coarse / 8 && error < 12.0 * at_end, "{tolerance}: {error:e}, {at_end:e}");
    }
}

#[test]
fn rates_between_the_ends_of_short_steps_know_nothing_of_the_origin() {
    // x = 10⁶ + sin t, where x is rounded to 10⁻¹⁰: a hundred times what changes in a step.
    let toy = Toy::new(&["x"], (&[1e6], &[1.0]), 1e-10, |_, q, _, _, a| a[0] = 1e6 - q[0]).separable();
    let mut settings = Settings { watch: false, ..Settings::new(&toy.scene) };
    (settings.method, settings.step) = (Method::Rkn8, Some(1e-12));
    let run = simulate(&mut toy.clone(), &settings).unwrap();
    // Five reports a step.
    for state in run.states() {
        assert!((state.v[0] - 1.0).abs() < 1e-9 && (state.q[0] - 1e6).abs() < 1e-9, "{state:?}");
    }
}

#[test]
fn what_is_not_separable_is_refused_with_the_reason() {
    let reason = |mut toy: Toy| {
        let settings = Settings { method: Method::Rkn8, ..Settings::new(&toy.scene) };
        match simulate(&mut toy, &settings) {
            Err(Error::NotSeparable { reason, .. }) => Some(reason),
            outcome => outcome.map(|_| None).unwrap(),
        }
    };
    assert_eq!(reason(Toy::oscillator(1.0, 1.0).mass(|_, _| vec![1.0])), Some(Inseparable::MassMatrix));
    let damped = Toy::new(&["x"], (&[1.0], &[0.0]), 1.0, |_, q, v, _, a| a[0] = -q[0] - v[0]);
    assert_eq!(reason(damped), Some(Inseparable::Speeds));
    assert_eq!(reason(Toy::oscillator(1.0, 1.0)), None);
}
