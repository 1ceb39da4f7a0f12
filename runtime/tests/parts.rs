//! Decoupled subsystems, run apart.

use std::ops::ControlFlow;

use dalembert::mechanism::{At, Dynamic, System};
use dalembert::{Cause, Error, Method, Run, Settings, Simulate, Work, simulate_with};

dalembert::model!(
    yaml = r#"
name: ThreeParts
parameters: {m: 1 kg, l: 1 m, g: 9.81 m/s^2, k: 4e4 N/m, c: 2 N*s/m, drag: 1e5 N*s/m, k3: 10 N/m^3, A: 0.1 m, w: 2 rad/s}
coordinates: {x: m, theta: rad, y: m}
inputs: {base: A*sin(w*t)}
bodies:
  block: {mass: m, position: "[x, 0]"}
  bob: {mass: m, position: "[base, 0] + l*[sin(theta), -cos(theta)]"}
  slow: {mass: m, position: "[y, 0]"}
gravity: [0, -g]
springs: {spring: {stretch: x, stiffness: k}}
dampers: {oil: {rate: x', damping: c}, tar: {rate: y', damping: drag}}
potential_energy: k3*y^4/4
conserved: {none: 0*m}
outputs: {all: x + y + l*theta, push: "m*(x'' + y'')"}
scene: {start: {x: 0.01, theta: 1, y: 1}, until: 10, tolerance: 1e-9}
"#
);

dalembert::model!(
    yaml = r#"
name: Blows
coordinates: {x: , y: }
kinetic_energy: (x'^2 + y'^2)/2
potential_energy: -x^4/2 + 2*y^2 + y^4/4
scene: {start: {x: 1, y: 1}, until: 10, tolerance: 1e-9}
"#
);

dalembert::model!(
    yaml = r#"
name: Sized
parameters: {scale: 1}
coordinates: {x: , y: }
kinetic_energy: (x'^2 + (y'/scale)^2)/2
potential_energy: x^4/4 + (y/scale)^4/4
scene: {start: {x: 1, y: 1}, until: 20, tolerance: 1e-10}
"#
);

dalembert::model!(
    yaml = r#"
name: Watched
coordinates: {x: , y: }
kinetic_energy: (x'^2 + y'^2)/2
potential_energy: x^4/4 + y^4/4
events: {meet: {when: x - y, then: record}}
scene: {start: {x: 1, y: 2}, until: 1}
"#
);

dalembert::model!(
    yaml = r#"
name: Shot
parameters: {m: 1 kg, g: 10 m/s^2, k: 400 N/m, b: 0.2 N*s/m, c: 0.001 kg/m, s: 1 m/s, w: 4 m/s^2}
coordinates: {x: m, y: m, z: m}
bodies: {ball: {mass: m, position: "[x, y]"}}
kinetic_energy: m*z'^2/2
potential_energy: k*z^2/2
gravity: [0, -g]
generalized_forces: {x: -b*x', y: -c*y'*sqrt(y'^2 + s^2)}
events:
  land: {when: y, direction: falling, then: stop}
  apex: {when: y', direction: falling, then: record}
  swing: {when: z', direction: falling, if: z, then: record}
  hasty: {when: x'' + w, then: record}
outputs: {distance: sqrt(x^2 + y^2)}
scene: {start: {x': 30, y': 40, z: 0.1}, until: 20, tolerance: 1e-10}
scenes: {short: {start: {x': 30, y': 40, z: 0.1}, until: 3}}
"#
);

dalembert::model!(
    yaml = r#"
name: Rubbed
parameters: {mu: 0.1}
coordinates: {x: , y: }
kinetic_energy: (x'^2 + y'^2)/2
potential_energy: x^4/4 + y^4/4
generalized_forces: {x: -mu*sign(x')}
scene: {start: {x: 1, y: 2}, until: 1}
"#
);

dalembert::model!(
    yaml = r#"
name: TwoFalls
parameters: {m: 1 kg, g: 10 m/s^2, h: 3 m, d: 0 m}
coordinates: {x: m, y: m}
kinetic_energy: m*(x'^2 + y'^2)/2
potential_energy: m*g*(x + y/3)
events:
  low: {when: y, direction: falling, then: stop}
  middle: {when: x - h/2, direction: falling, then: record}
  high: {when: x, direction: falling, then: stop}
scene: {start: {x: h, y: h/3 + d}, until: 5, tolerance: 1e-9}
"#
);

fn of(run: &Run, name: &str) -> f64 {
    run.last().get(name).unwrap_or_else(|| panic!("no {name}"))
}

/// Numbers in −1..1 that look random.
fn drawn(count: usize) -> Vec<f64> {
    (1..=count).map(|k| (12.9898 * k as f64 * k as f64).sin()).collect()
}

#[test]
fn a_part_is_computed_of_its_own_state_alone() {
    let system = Dynamic::new(ThreeParts::default());
    assert_eq!(system.description().parts.len(), 3);
    let numbers = drawn(60);
    for state in numbers.chunks_exact(6) {
        let (q, v, t) = (&state[..3], &state[3..], state[0]);
        let mut all = [0.0; 3];
        system.accelerations(At::new(t, q, v), &mut all).unwrap();
        let whole = system.energy(At::new(t, q, v));
        let mut sums = [0.0; 3];
        for (index, part) in system.description().parts.iter().enumerate() {
            // What is not the part's own is not a number.
            let only = |numbers: &[f64]| -> Vec<f64> {
                let own = |i: usize| part.coordinates.contains(&(i as u32));
                numbers.iter().enumerate().map(|(i, x)| if own(i) { *x } else { f64::NAN }).collect()
            };
            let (q, v, mut a) = (only(q), only(v), [0.0; 3]);
            system.part_accelerations(index, At::new(t, &q, &v), &mut a).unwrap();
            for i in part.coordinates.iter().map(|i| *i as usize) {
                assert!((a[i] - all[i]).abs() <= 1e-14 * all[i].abs(), "{a:?} {all:?}");
            }
            let energy = system.part_energy(index, At::new(t, &q, &v));
            assert_eq!(part.conservative, energy.power == 0.0, "{energy:?}");
            let numbers = [energy.kinetic, energy.potential, energy.power];
            sums.iter_mut().zip(numbers).for_each(|(sum, number)| *sum += number);
        }
        for (sum, whole, scale) in [
            (sums[0], whole.kinetic, whole.scale),
            (sums[1], whole.potential, whole.scale),
            (sums[2], whole.power, whole.power.abs().max(1.0)),
        ] {
            assert!((sum - whole).abs() <= 1e-12 * scale, "{sum} {whole}");
        }
    }
}

#[test]
fn each_part_has_its_own_method_and_steps() {
    let apart = ThreeParts::default().simulate().run().unwrap();
    let methods: Vec<_> = apart.parts.iter().map(|part| (part.coordinates.concat(), part.method)).collect();
    let expected = [("x", Method::Exact), ("theta", Method::Rkn8), ("y", Method::Rodas5P)];
    assert_eq!(methods, expected.map(|(name, method)| (name.to_owned(), method)));
    assert!(apart.trust().to_string().contains("parts run apart: x (exact); theta (rkn8); y (rodas5p)"));
    let together = ThreeParts::default().simulate().together().run().unwrap();
    assert!(together.parts.is_empty());
    let reference = ThreeParts::default().simulate().method(Method::Radau5).tolerance(1e-12).run().unwrap();
    assert_eq!(apart.times(), reference.times());
    for name in reference.column_names() {
        let (found, exact) = (apart.column(&name).unwrap(), reference.column(&name).unwrap());
        let range = exact.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        let error = found.iter().zip(&exact).fold(0.0_f64, |most, (a, b)| most.max((a - b).abs()));
        assert!(error < 1e-6 * range, "{name}: {error:e} of {range:e}");
    }
    // Jacobians and matrices counted as 40 operations each, more than they have here.
    let system = Dynamic::new(ThreeParts::default());
    let matrices = |work: &Work| 40 * (work.jacobians + work.factorizations);
    let own = apart.parts.iter().zip(system.description().parts.iter());
    let own = own.map(|(part, of)| part.work.evaluations * u64::from(of.accelerations) + matrices(&part.work));
    let accelerations = u64::from(system.description().counts.accelerations);
    let whole = together.work.evaluations * accelerations + matrices(&together.work);
    let operations = own.sum::<u64>();
    println!("{operations} operations apart, {whole} together");
    assert!(10 * operations < whole, "{operations} and {whole}");
}

#[test]
fn the_digits_of_parts_hold() {
    let run = ThreeParts::default().simulate().tolerance(1e-7).digits().run().unwrap();
    let exact = ThreeParts::default().simulate().method(Method::Radau5).tolerance(1e-13).run().unwrap();
    for name in run.column_names() {
        let error = (of(&run, &name) - of(&exact, &name)).abs();
        let bound = *run.errors(&name).unwrap().last().unwrap();
        assert!(error <= 2.0 * bound + 1e-12, "{name}: {error:e}, bound {bound:e}");
    }
    assert!(run.warnings.is_empty(), "{:?}", run.warnings);
    assert!(run.energy_balance.unwrap() < 1e-5 && run.drift.len() == 1, "{}", run.trust());
}

#[test]
fn a_part_that_fails_ends_the_run_with_all_that_was_computed() {
    let Err(Error::Run(failure)) = Blows::default().simulate().run() else { panic!("x has a pole") };
    assert!(matches!(failure.cause, Cause::StepTooSmall { .. }), "{}", failure.cause);
    // x' = −x² from x = 1 with x'² = x⁴ − 1: the pole of the lemniscate's function, at a quarter of its period.
    assert!((failure.state.t - 1.311_028_777_146_06).abs() < 1e-9, "{}", failure.state.t);
    let run = &failure.run;
    assert_eq!(run.parts.len(), 2);
    assert_eq!(run.last().t, failure.state.t);
    assert_eq!(run.last().q, failure.state.q);
    let alone = Blows::default().simulate().starting("x", 0.0).method(Method::Dop853).tolerance(1e-12).run().unwrap();
    for state in run.states() {
        let expected = alone.at(state.t).unwrap();
        assert!((state.q[1] - expected.q[1]).abs() < 1e-7, "{state:?} {expected:?}");
    }
    let middle = run.at(0.5 * failure.state.t).unwrap();
    assert!((middle.q[1] - alone.at(middle.t).unwrap().q[1]).abs() < 1e-7);
    assert!(run.at(1.0001 * failure.state.t).is_none());
}

#[test]
fn a_run_that_is_interrupted_has_all_parts_until_then() {
    let mut system = Dynamic::new(ThreeParts::default());
    let settings = Settings::new(&system.scene(0));
    let mut stop = |t: f64| if t < 3.0 { ControlFlow::Continue(()) } else { ControlFlow::Break(()) };
    let Err(Error::Run(failure)) = simulate_with(&mut system, &settings, &mut stop) else { panic!("it goes on") };
    assert_eq!(failure.cause, Cause::Interrupted);
    assert!((3.0..4.0).contains(&failure.state.t), "{}", failure.state.t);
    let whole = ThreeParts::default().simulate().run().unwrap();
    let expected = whole.at(failure.state.t).unwrap();
    for (found, expected) in failure.state.q.iter().zip(&expected.q) {
        assert!((found - expected).abs() < 1e-8, "{failure:?} {expected:?}");
    }
}

#[test]
fn events_of_parts_are_those_of_the_whole() {
    let apart = Shot::default().simulate().run().unwrap();
    let together = Shot::default().simulate().together().run().unwrap();
    assert_eq!((apart.parts.len(), together.parts.len()), (3, 0));
    let ended = apart.ended_by().map(|event| (event.name.as_str(), event.event));
    assert_eq!(ended, Some(("land", 0)));
    let landed = &apart.ended_by().unwrap().state;
    assert!((apart.last().t - landed.t).abs() < 1e-14 * landed.t, "{landed:?}");
    assert!(apart.last().q.iter().zip(&landed.q).all(|(a, b)| (a - b).abs() < 1e-12), "{landed:?}");
    assert_eq!(apart.events.len(), together.events.len());
    assert!(apart.events.len() > 20);
    for (found, expected) in apart.events.iter().zip(&together.events) {
        assert_eq!((&found.name, found.event), (&expected.name, expected.event));
        assert!((found.state.t - expected.state.t).abs() < 1e-8, "{found:?} {expected:?}");
        let values = found.state.entries().chain(found.state.outputs().map(|(name, x)| (name.to_owned(), x.unwrap())));
        for (name, value) in values {
            let other = expected.state.get(&name).unwrap();
            // Dense output is within a thousand tolerances of the ranges.
            assert!((value - other).abs() < 1e-5, "{name} {found:?} {expected:?}");
        }
    }
    // Without the landing all go to the end.
    let short = Shot::default().simulate().scene("short").run().unwrap();
    assert_eq!((short.last().t, short.ended_by()), (3.0, None));
}

#[test]
fn what_ties_parts_together_is_run_together() {
    let parts = |run: Run| run.parts.len();
    assert_eq!(parts(ThreeParts::default().simulate().until(0.1).run().unwrap()), 3);
    let simulation = || ThreeParts::default().simulate().until(1e-3);
    assert_eq!(parts(simulation().method(Method::Dop853).run().unwrap()), 0);
    assert_eq!(parts(simulation().step(1e-6).run().unwrap()), 0);
    assert_eq!(parts(simulation().input("base", std::sync::Arc::new(|_| [0.0; 3])).run().unwrap()), 0);
    assert_eq!(parts(Watched::default().simulate().run().unwrap()), 0);
    assert_eq!(parts(Rubbed::default().simulate().run().unwrap()), 0);
}

#[test]
fn no_run_takes_more_steps_than_it_may() {
    let Err(Error::Run(failure)) = ThreeParts::default().simulate().max_steps(100).run() else { panic!("it goes on") };
    assert_eq!(failure.cause, Cause::TooManySteps { limit: 100 });
    assert_eq!(failure.run.work.steps, 100);
}

#[test]
fn without_dense_output_the_end_is_the_same() {
    let run = ThreeParts::default().simulate().run().unwrap();
    let bare = ThreeParts::default().simulate().with(|settings| settings.dense = false).run().unwrap();
    assert!(bare.at(1.0).is_none() && run.at(1.0).is_some());
    assert_eq!(bare.last(), run.last());
    let still = ThreeParts::default().simulate().until(0.0).run().unwrap();
    assert_eq!((still.len(), still.last().q), (1, vec![0.01, 1.0, 1.0]));
}

/// y'' = −y³/L²: a motion of size L takes the same time.
#[test]
fn parts_have_scales_of_their_own() {
    let alike = |scale: f64| {
        let sized = Sized { scale };
        let run = sized.simulate().starting("y", scale).run().unwrap();
        assert_eq!(run.parts.len(), 2);
        (of(&run, "x"), of(&run, "y") / scale)
    };
    for scale in [1e-24, 1.0, 1e24] {
        let (x, y) = alike(scale);
        assert!((x - y).abs() < 1e-8, "{x} {y}");
    }
    // What rests stays.
    let rests = Sized::default().simulate().starting("y", 0.0).run().unwrap();
    assert_eq!((of(&rests, "y"), of(&rests, "y'")), (0.0, 0.0));
}

#[test]
fn events_that_stop_two_parts_at_one_instant_are_both_recorded_in_the_files_order() {
    let names = |run: &Run| run.events.iter().map(|event| event.name.clone()).collect::<Vec<_>>();
    let apart = TwoFalls::default().simulate().run().expect("a run");
    let together = TwoFalls::default().simulate().together().run().expect("a run");
    assert!(apart.parts.len() == 2 && together.parts.is_empty());
    for run in [&apart, &together] {
        assert_eq!(names(run), ["middle", "low", "high"]);
        assert_eq!(run.ended_by().map(|event| event.name.as_str()), Some("high"));
        assert!((run.last().t - 0.6_f64.sqrt()).abs() < 1e-9, "{}", run.last().t);
    }
    // A micrometre higher it is later by d/v, and has not happened.
    let later = TwoFalls { d: 1e-6, ..TwoFalls::default() };
    for run in [later.simulate(), later.simulate().together()] {
        assert_eq!(names(&run.run().expect("a run")), ["middle", "high"]);
    }
}
