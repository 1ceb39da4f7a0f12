//! Many runs at once give what each gives by itself.

use dalembert::ensemble::{Ending, Ensemble, Lanes, f64x4, f64x8};
use dalembert::mechanism::Dynamic;
use dalembert::prelude::*;
use dalembert::{Cause, Error, Simulation};

dalembert::model!("../models/double_pendulum.yaml", name = DoublePendulum);
dalembert::model!("../models/figure_eight.yaml", name = FigureEight);

dalembert::model!(
    yaml = r#"
name: Hung
parameters: {m: 1 kg, l: 1 m, g: 10 m/s^2, k: 200 N/m, w: 3 rad/s, f: 2 N}
coordinates: {x: m, y: m}
points: {hinge: [0, 0]}
bodies: {bob: {mass: m, position: "[x, y]"}}
gravity: [0, -g]
springs: {cord: {between: [hinge, bob], stiffness: k, rest: l}}
forces: {wind: {on: bob, force: "[f*sin(w*t), 0]"}}
outputs: {speed: "sqrt(x'^2 + y'^2)"}
scene: {start: {x: 0.3, y: -1.2}, until: 5, tolerance: 1e-9}
"#
);

dalembert::model!(
    yaml = r#"
name: Ball
parameters: {m: 1 kg, g: 10 m/s^2}
coordinates: {y: m}
bodies: {ball: {mass: m, position: "[0, y]"}}
gravity: [0, -g]
events: {landing: {when: y, direction: falling, then: stop}}
scene: {start: {y: 1}, until: 5}
"#
);

/// A double pendulum of its own angles, lengths and time.
fn pendulum(k: u32) -> Simulation<Dynamic<DoublePendulum, 2, 0>> {
    let k = f64::from(k);
    let model = DoublePendulum { l: 0.5 + 0.01 * k, ..DoublePendulum::default() };
    model.simulate().start(&[0.3 + 0.02 * k, -0.1 * k], &[0.0, 0.5]).until(1.0 + 0.02 * k).tolerance(1e-9)
}

fn pendulums(count: u32) -> Ensemble<Dynamic<DoublePendulum, 2, 0>> {
    (0..count).map(pendulum).collect()
}

fn all(ends: Vec<Result<Ending, Error>>) -> Vec<Ending> {
    ends.into_iter().map(|end| end.expect("an end")).collect()
}

/// The largest difference between states.
fn apart(a: &State, b: &State) -> f64 {
    assert_eq!(a.t, b.t);
    let pairs = a.q.iter().zip(&b.q).chain(a.v.iter().zip(&b.v));
    pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

fn lanes_give_what_runs_give<L: Lanes>() {
    let ensemble = pendulums(50);
    let (ends, runs) = (all(ensemble.ends::<L>()), ensemble.run());
    for (k, (end, run)) in ends.iter().zip(runs).enumerate() {
        let run = run.expect("a run");
        assert!(apart(&end.state, &run.last()) < 1e-7, "{k}: {} and {}", end.state, run.last());
        assert!((end.state["tip.x"] - run.last()["tip.x"]).abs() < 1e-7);
        assert!(end.warnings.is_empty(), "{:?}", end.warnings);
        let (own, usual) = (end.work.evaluations as f64, run.work.evaluations as f64);
        assert!(own < 1.05 * usual, "{k}: {own} evaluations where {usual} are usual");
    }
}

#[test]
fn lanes_give_what_runs_give_whatever_their_number() {
    lanes_give_what_runs_give::<f64>();
    lanes_give_what_runs_give::<f64x4>();
    lanes_give_what_runs_give::<f64x8>();
}

#[test]
fn results_are_the_same_to_the_last_bit_whatever_the_number_of_threads() {
    let once = all(pendulums(700).threads(1).ends::<f64x8>());
    for threads in [2, 3, 7] {
        assert!(once == all(pendulums(700).threads(threads).ends::<f64x8>()), "{threads} threads");
    }
    let runs = |threads| pendulums(40).threads(threads).map(|index, run| (index, run.expect("a run").last()));
    assert_eq!(runs(1), runs(5));
}

#[test]
fn what_runs_beside_a_run_does_not_change_it() {
    let ends = all(pendulums(300).ends::<f64x8>());
    let few: Ensemble<_> = [299, 3, 7].into_iter().map(pendulum).collect();
    for (k, end) in [299, 3, 7].into_iter().zip(all(few.ends::<f64x8>())) {
        assert_eq!(end, ends[k as usize]);
    }
}

#[test]
fn a_driven_mechanism_goes_into_lanes() {
    let one = |k: i32| Hung { w: 1.0 + 0.1 * f64::from(k), ..Hung::default() }.simulate();
    let ensemble: Ensemble<_> = (0..40).map(one).collect();
    for (end, run) in all(ensemble.ends::<f64x8>()).iter().zip(ensemble.run()) {
        let last = run.expect("a run").last();
        assert!(apart(&end.state, &last) < 1e-6, "{} and {last}", end.state);
        assert!((end.state["speed"] - last["speed"]).abs() < 1e-6);
    }
}

/// Fewer evaluations than by `dop853` at one tolerance, for an error that is much smaller.
#[test]
fn separable_mechanisms_go_into_lanes_by_the_method_that_a_run_chooses() {
    let one = |k: u32| {
        let method = [Method::Auto, Method::Rkn8, Method::Dop853][k as usize % 3];
        FigureEight::default().simulate().until(5.0 + f64::from(k)).tolerance(1e-9).method(method)
    };
    let ensemble: Ensemble<_> = (0..20).map(one).collect();
    let (ends, runs) = (all(ensemble.ends::<f64x8>()), ensemble.run());
    for (k, (end, run)) in ends.iter().zip(runs).enumerate() {
        let run = run.expect("a run");
        assert!(apart(&end.state, &run.last()) < 1e-7, "{k}: {} and {}", end.state, run.last());
        let (own, usual) = (end.work.evaluations as f64, run.work.evaluations as f64);
        // A run that reports evaluates between the ends of its steps as well.
        assert!((0.6 * usual..1.05 * usual).contains(&own), "{k}: {own} evaluations where {usual} are usual");
    }
    let [nystrom, other] = [(&ends[0], 5), (&ends[2], 7)].map(|(end, until)| end.work.evaluations / until);
    assert!(nystrom < other, "{nystrom} and {other} evaluations a second");
}

#[test]
fn what_needs_a_closer_look_gets_it() {
    // Through the hinge, where the direction of the cord is lost; beside it; and nowhere near.
    let starts = [[0.0, 2.0], [1e-7, 2.0], [0.3, -1.2]];
    let one = |start: &[f64; 2]| Hung { f: 0.0, ..Hung::default() }.simulate().start(start, &[0.0, 0.0]).until(2.0);
    let ensemble: Ensemble<_> = starts.iter().map(one).collect();
    let (ends, runs) = (ensemble.ends::<f64x8>(), ensemble.run());
    for (end, run) in ends.iter().zip(&runs) {
        match (end, run) {
            (Ok(end), Ok(run)) => {
                assert!(apart(&end.state, &run.last()) < 1e-4, "{} and {}", end.state, run.last());
                assert_eq!(end.warnings.is_empty(), run.warnings.is_empty());
            }
            (Err(end), Err(run)) => assert_eq!(end.to_string(), run.to_string()),
            _ => panic!("{end:?} and {run:?}"),
        }
    }
    assert!(runs[0].is_err() || !runs[0].as_ref().is_ok_and(|run| run.warnings.is_empty()), "{:?}", ends[0]);
}

#[test]
fn errors_stand_in_their_places() {
    let one = |k: u32| match k {
        3 => DoublePendulum::default().simulate().starting("theta3", 1.0),
        5 => DoublePendulum { m: 0.0, ..DoublePendulum::default() }.simulate(),
        6 => DoublePendulum { m: -1.0, ..DoublePendulum::default() }.simulate(),
        8 => DoublePendulum::default().simulate().until(f64::NAN),
        9 => DoublePendulum::default().simulate().tolerance(1e-9).with(|settings| settings.max_steps = 5),
        _ => pendulum(k),
    };
    let ends = (0..12).map(one).collect::<Ensemble<_>>().ends::<f64x8>();
    let wrong: Vec<usize> = (0..12).filter(|k| ends[*k].is_err()).collect();
    assert_eq!(wrong, [3, 5, 6, 8, 9]);
    assert!(matches!(ends[3], Err(Error::UnknownName { .. })), "{:?}", ends[3]);
    let Err(Error::Run(failure)) = &ends[9] else { panic!("{:?}", ends[9]) };
    assert!(matches!(failure.cause, Cause::TooManySteps { limit: 5 }), "{failure}");
    assert_eq!(
        ends[4].as_ref().expect("an end"),
        &all([4].into_iter().map(pendulum).collect::<Ensemble<_>>().ends::<f64x8>())[0]
    );
}

#[test]
fn events_end_runs_of_an_ensemble_too() {
    let ensemble: Ensemble<_> = (1..20).map(|k| Ball::default().simulate().start(&[f64::from(k)], &[0.0])).collect();
    for (k, end) in all(ensemble.ends::<f64x8>()).iter().enumerate() {
        let fall = (2.0 * (k + 1) as f64 / 10.0).sqrt();
        assert!((end.state.t - fall).abs() < 1e-12, "{} and {fall}", end.state.t);
    }
}

#[test]
fn a_long_orbit_keeps_its_energy_in_lanes() {
    let ensemble: Ensemble<_> =
        (0..8).map(|_| FigureEight::default().simulate().until(60.0).tolerance(1e-12)).collect();
    let run = FigureEight::default().simulate().until(60.0).tolerance(1e-12).run().expect("a run");
    for end in all(ensemble.ends::<f64x4>()) {
        assert!(apart(&end.state, &run.last()) < 1e-8, "{} and {}", end.state, run.last());
    }
}

#[test]
fn nothing_to_run_is_no_error() {
    let none: Ensemble<Dynamic<DoublePendulum, 2, 0>> = std::iter::empty().collect();
    assert!(none.is_empty() && none.ends::<f64x8>().is_empty() && none.run().is_empty());
}
