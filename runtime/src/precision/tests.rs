//! Charts of motions whose laws are known.

use std::ops::ControlFlow;

use super::{AccuracyControl, Candidate, Curve, Measured, Plan, Point, Profile, WorkPrecision};
use crate::integrate::test_problems::kepler;
use crate::mechanism::{Method, System};
use crate::run::Work;
use crate::show::Scale;
use crate::testing::Toy;
use crate::{Error, Settings};

/// q'' = −q from q = 1 over 100 units of time, some 16 periods.
fn oscillator(until: f64) -> Toy {
    let mut toy = Toy::new(&["q"], (&[1.0], &[0.0]), until, |_, q, _, _, a| a[0] = -q[0]).separable();
    toy.jacobian = std::sync::Arc::new(|_, _, _, dq, dv| (dq[0], dv[0]) = (1.0, 0.0));
    toy.description.name = "Oscillator".into();
    toy
}

fn measured(toy: &Toy, methods: &[Method]) -> WorkPrecision {
    let settings = Settings::new(&toy.scene);
    let of = |method: &Method| Candidate::new(method.name(), toy, Settings { method: *method, ..settings.clone() });
    let candidates: Vec<Candidate> = methods.iter().map(of).collect();
    let plan = Plan { repetitions: 1, ..Plan::default() };
    WorkPrecision::measure(&candidates, &plan, &mut |_| ControlFlow::Continue(())).unwrap()
}

#[test]
fn errors_follow_the_laws_of_fixed_steps_on_the_oscillator() {
    let found = measured(&oscillator(100.0), &[Method::Verlet, Method::Rk4]);
    // Phases, for a range of 2 (`docs/stability.md`, laws of charts).
    for (name, law) in
        [("verlet", (|h: f64| 100.0 * h.powi(2) / 24.0) as fn(f64) -> f64), ("rk4", |h| 100.0 * h.powi(4) / 120.0)]
    {
        let curve = found.curve(name).unwrap();
        let mut looked = 0;
        for point in &curve.points {
            let (AccuracyControl::Step(step), Ok(found)) = (point.control, &point.outcome) else { continue };
            let expected = law(step) / 2.0;
            if found.error < 0.02 && found.error > 1e-8 {
                assert!((found.error / expected - 1.0).abs() < 0.06, "{name} {step}: {} {expected}", found.error);
                looked += 1;
            }
        }
        assert!(looked >= 5, "{name}: {looked}");
    }
}

#[test]
fn errors_fall_at_the_order_of_each_method() {
    let methods = [
        (Method::Euler, 1.0),
        (Method::Midpoint, 2.0),
        (Method::Rk4, 4.0),
        (Method::Dopri5, 5.0),
        (Method::Verlet, 2.0),
        (Method::Srkn4, 4.0),
        (Method::Suzuki4, 4.0),
        (Method::KahanLi8, 8.0),
        (Method::Rkn8, 8.0),
        (Method::Gauss2, 2.0),
        (Method::Gauss4, 4.0),
        (Method::Gauss6, 6.0),
        // Between the ends of its steps.
        (Method::Radau5, 4.0),
        (Method::Rodas5P, 5.0),
    ];
    let found = measured(&oscillator(30.0), &methods.map(|(method, _)| method));
    for (method, order) in methods {
        let slope = found.curve(method.name()).unwrap().order().unwrap();
        // Iterations cost less where steps are short, which makes a curve steeper.
        let above = if method.is_symplectic() && !method.splits() { 1.2 } else { 0.4 };
        assert!(slope > order - 0.6 && slope < order + above, "{method}: {slope}");
    }
}

#[test]
fn the_reference_is_what_two_methods_agree_on() {
    let found = measured(&kepler(0.6, 12.0), &[Method::Dop853]);
    assert_eq!(found.reference.methods, [Method::Dop853, Method::Dopri5]);
    assert!(found.reference.agreement < 1e-11, "{:e}", found.reference.agreement);
    assert_eq!(found.reference.times().len(), 401);
    assert!(!found.reference.is_cut);
    let points = &found.curves[0].points;
    let finest = points.last().unwrap().outcome.as_ref().unwrap();
    assert!(finest.error >= found.reference.floor() && finest.error < 1e-10);
    assert!(finest.growth.windows(2).all(|pair| pair[0] <= pair[1]));
}

#[test]
fn a_chaotic_scene_is_judged_as_far_as_two_methods_agree() {
    // Hénon and Heiles' galaxy near its energy of escape, in its chaotic sea.
    let mut toy = Toy::new(&["x", "y"], (&[0.0, -0.15], &[0.555, 0.0]), 2000.0, |_, q, _, _, a| {
        a[0] = -q[0] - 2.0 * q[0] * q[1];
        a[1] = -q[1] - q[0] * q[0] + q[1] * q[1];
    });
    toy.description.name = "Galaxy".into();
    let found = measured(&toy, &[Method::Dop853]);
    let end = *found.reference.times().last().unwrap();
    assert!(found.reference.is_cut && end < 1900.0 && end > 20.0, "{end}");
    assert!(found.reference.agreement <= 1e-8);
    assert!(found.curves[0].measured().count() > 5);
}

#[test]
fn what_fails_is_drawn_with_its_reason() {
    let found = measured(&oscillator(100.0), &[Method::Euler, Method::Verlet]);
    let euler = found.curve("euler").unwrap();
    assert_eq!(euler.points[0].outcome, Err("unstable"));
    let chart = &found.figure().charts[0];
    assert_eq!(chart.series[0].failures[0].label, "unstable");
    assert!(chart.x.reversed && chart.x.scale == Scale::Log);
    let svg = found.figure().to_svg();
    assert!(svg.contains("unstable") && svg.contains("verlet"));
}

#[test]
fn what_does_not_suit_is_left_out_with_the_reason() {
    let mut toy = oscillator(3.0);
    toy.description.structure.constant_mass = false;
    let found = measured(&toy, &[Method::Rk4, Method::Verlet]);
    assert_eq!(found.curves.len(), 1);
    assert_eq!(
        found.refused,
        [("verlet".to_owned(), "not separable, since its mass matrix changes along the motion".to_owned())]
    );
}

#[test]
fn a_motion_that_ends_at_once_has_no_reference() {
    let toy = Toy::new(&["q"], (&[1.0], &[0.0]), 1.0, |_, _, _, _, a| a[0] = f64::NAN);
    let candidates = [Candidate::new("rk4", &toy as &dyn System, Settings::new(&toy.scene))];
    let outcome = WorkPrecision::measure(&candidates, &Plan::default(), &mut |_| ControlFlow::Continue(()));
    assert!(matches!(outcome, Err(Error::NoReference { .. })));
}

#[test]
fn an_unknown_column_is_an_error() {
    let toy = oscillator(1.0);
    let candidates = [Candidate::new("rk4", &toy as &dyn System, Settings::new(&toy.scene))];
    let plan = Plan { columns: vec!["psi".to_owned()], ..Plan::default() };
    let outcome = WorkPrecision::measure(&candidates, &plan, &mut |_| ControlFlow::Continue(()));
    assert!(matches!(outcome, Err(Error::UnknownName { name, .. }) if name == "psi"));
}

/// A curve through (error, cost).
fn curve(name: &str, points: &[(f64, f64)]) -> Curve {
    let of = |(error, cost): &(f64, f64)| Point {
        control: AccuracyControl::Tolerance(*error),
        outcome: Ok(Measured {
            method: Method::Dop853,
            error: *error,
            growth: vec![*error],
            cost: *cost,
            work: Work::default(),
            seconds: 1e-6 * cost,
            drift: None,
            residual: None,
        }),
    };
    Curve { name: name.to_owned(), method: Method::Dop853, points: points.iter().map(of).collect() }
}

fn drawn(curves: Vec<Curve>) -> WorkPrecision {
    let mut found = measured(&oscillator(1.0), &[Method::Rk4]);
    found.curves = curves;
    found
}

#[test]
fn the_sentence_says_which_to_take() {
    let coarse = curve("coarse", &[(1e-1, 10.0), (1e-3, 40.0), (1e-5, 160.0), (1e-7, 640.0)]);
    let fine = curve("fine", &[(1e-1, 80.0), (1e-5, 120.0), (1e-9, 160.0)]);
    let poor = curve("poor", &[(1e-1, 1e3), (1e-2, 1e4)]);
    let found = drawn(vec![coarse, fine, poor]);
    assert_eq!(
        found.sentence(),
        "By work and by time above 1e-5 take coarse, below that fine. An error of 1e-6 costs fine 129 evaluations; \
         times as many coarse 2.5; not reached by poor."
    );
    let bands = found.bands(|point| point.cost);
    assert_eq!(bands.iter().map(|band| band.best.as_str()).collect::<Vec<_>>(), ["coarse", "fine"]);
}

#[test]
fn an_error_that_is_small_by_chance_does_not_count() {
    let curve = curve("lucky", &[(1e-1, 10.0), (1e-9, 20.0), (1e-2, 30.0), (1e-4, 60.0)]);
    let cost = curve.at(1e-3, |point| point.cost).unwrap();
    assert!((cost - (30.0_f64 * 60.0).sqrt()).abs() < 1e-9, "{cost}");
    assert_eq!(curve.at(1e-5, |point| point.cost), None);
}

#[test]
fn a_profile_counts_scenes_and_failures() {
    let mut profile = Profile::new(1e-6);
    let pair = |a: f64, b: &[(f64, f64)]| drawn(vec![curve("a", &[(1e-6, a)]), curve("b", b)]);
    profile.add(&pair(100.0, &[(1e-6, 200.0)]));
    profile.add(&pair(100.0, &[(1e-2, 200.0)]));
    assert_eq!(profile.scenes, 2);
    let means = profile.means();
    assert_eq!((means[0].0, means[1].0), ("a", "b"));
    assert!((means[0].1 - 1.0).abs() < 1e-12 && (means[1].1 - (2.0_f64 * 100.0).sqrt()).abs() < 1e-9);
    let chart = profile.chart();
    assert_eq!(chart.series[1].points.last().unwrap().unwrap().1, 0.5);
}

#[test]
fn the_table_holds_every_point() {
    let found = measured(&oscillator(10.0), &[Method::Rk4, Method::Dop853]);
    let text = found.to_csv();
    let rows: usize = found.curves.iter().map(|curve| curve.points.len()).sum();
    assert_eq!(text.lines().count(), rows + 1);
    let names: Vec<&str> = text.lines().next().unwrap().split(',').collect();
    assert!(text.lines().all(|line| line.split(',').count() == names.len()));
    assert!(found.table().lines().nth(1).unwrap().starts_with("rk4"));
}

#[test]
fn instants_of_convergence_are_equally_apart_where_the_reference_is_cut_too() {
    let mut reference = measured(&kepler(0.6, 12.0), &[Method::Dop853]).reference;
    for times in [401, 399, 287, 101, 57, 45] {
        reference.times.truncate(times);
        let (every, interval) = reference.instants(10);
        let instants: Vec<f64> = reference.times.iter().step_by(every).take(11).copied().collect();
        assert!(instants.len() > 2, "{times}");
        let apart = instants.windows(2).map(|pair| (pair[1] - pair[0] - interval).abs()).fold(0.0, f64::max);
        assert!(apart < 1e-12, "{times}: {instants:?}");
    }
}
