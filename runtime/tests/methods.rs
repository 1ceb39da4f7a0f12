//! Methods of integration on generated mechanisms: orders where derivatives are generated, with inputs and constraints.

use std::f64::consts::PI;

use dalembert::mechanism::{Equations, System};
use dalembert::{Enforcement, Error, Inseparable, Method, Settings, Simulate, Stabilisation, simulate};

dalembert::model!(
    yaml = r#"
name: Shaken
parameters: {m: 1 kg, l: 1 m, g: 10 m/s^2, A: 0.1 m, w: 7 rad/s}
coordinates: {theta: rad}
inputs: {base: A*cos(w*t)}
points: {pivot: "[0, base]"}
bodies: {bob: {mass: m, position: "pivot + l*[sin(theta), -cos(theta)]"}}
gravity: [0, -g]
scene: {start: {theta: 1}, until: 2, tolerance: 1e-9}
"#
);

dalembert::model!(
    yaml = r#"
name: Damped
parameters: {m: 1 kg, l: 1 m, g: 10 m/s^2, c: 0.3 kg/s}
coordinates: {a: rad, b: rad}
bodies:
  upper: {mass: m, position: "l*[sin(a), -cos(a)]"}
  lower: {mass: m, position: "l*[sin(a) + sin(b), -cos(a) - cos(b)]"}
forces: {drag: {on: lower, force: "-c*velocity(lower)"}}
gravity: [0, -g]
scene: {start: {a: 1, b: 2}, until: 2, tolerance: 1e-9}
"#
);

dalembert::model!(
    yaml = r#"
name: Hung
parameters: {m: 1 kg, l: 1 m, g: 10 m/s^2, A: 0.1 m, w: 5 rad/s}
coordinates: {x: m, y: m}
inputs: {hook: A*sin(w*t)}
bodies: {bob: {mass: m, position: "[x, y]"}}
gravity: [0, -g]
constraints: {rod: (x - hook)^2 + y^2 - l^2}
scene: {start: {x: 0.6, y: -0.8}, until: 1.5, tolerance: 1e-9}
"#
);

dalembert::model!(
    yaml = r#"
name: Sliding
parameters: {m: 1 kg, R: 1 m, g: 10 m/s^2, mu: 0.3 1}
coordinates: {x: m, y: m}
bodies: {bead: {mass: m, position: "[x, y]"}}
gravity: [0, -g]
constraints: {bowl: y - x^2/(2*R)}
forces: {rub: {on: bead, force: "-mu*reaction(bowl)*[1, x/R]"}}
scene: {start: {x: -1, y: 0.5, x': 0.5}, until: 0.5, tolerance: 1e-9}
"#
);

dalembert::model!(
    yaml = r#"
name: Sleigh
parameters: {m: 1 kg, I: 0.25 kg*m^2, d: 0.5 m}
coordinates: {x: m, y: m, theta: rad}
points: {skate: "[x, y]"}
bodies: {sled: {mass: m, inertia: I, angle: theta, position: skate + d*sled.x}}
constraints: {edge: "dot(velocity(skate), sled.y)"}
scene: {start: {x: 0, y: 0, theta: 0, x': -0.5, y': 0, theta': 1}, until: 2, tolerance: 1e-9}
"#
);

dalembert::model!(
    yaml = r#"
name: OneSided
parameters: {m: 1 kg, k: 1 N/m, x0: 0.5 m}
coordinates: {x: m}
kinetic_energy: m*x'^2/2
potential_energy: k*x^2/2 + 4*k*x^2*step(x)
events: {half: {when: x - x0, then: record}}
scene: {start: {x: 1}, until: 42, tolerance: 1e-10}
"#
);

/// The last state by a method.
fn last<M: Simulate<N, C> + Default, const N: usize, const C: usize>(change: &dyn Fn(&mut Settings)) -> Vec<f64> {
    let mut system = M::default().system();
    let mut settings = Settings::new(&system.scene(0));
    (settings.dense, settings.watch) = (false, false);
    change(&mut settings);
    let run = simulate(&mut system, &settings).unwrap();
    let last = run.last();
    M::description().coordinates.iter().flat_map(|c| [last[&*c.name], last[&*format!("{}'", c.name)]]).collect()
}

/// How fast errors at the end fall as the step is halved.
fn observed<M: Simulate<N, C> + Default, const N: usize, const C: usize>(
    method: Method,
    coarse: f64,
    start_conditions: &dyn Fn(&mut Settings),
) -> (f64, [f64; 2]) {
    let exact = last::<M, N, C>(&|settings| {
        settings.tolerance = 1e-14;
        start_conditions(settings);
    });
    let errors = [coarse, coarse / 2.0].map(|step| {
        let found = last::<M, N, C>(&|settings| {
            (settings.method, settings.step) = (method, Some(step));
            start_conditions(settings);
        });
        found.iter().zip(&exact).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
    });
    ((errors[0] / errors[1]).log2(), errors)
}

/// Orders of all implicit methods on a mechanism.
fn implicit<M: Simulate<N, C> + Default, const N: usize, const C: usize>(
    name: &str,
    steps: [f64; 4],
    start_conditions: &dyn Fn(&mut Settings),
) {
    let methods = [(Method::Gauss4, 4.0), (Method::Gauss6, 6.0), (Method::Radau5, 5.0), (Method::Rodas5P, 5.0)];
    let mut wrong = Vec::new();
    for ((method, order), step) in methods.into_iter().zip(steps) {
        let (found, errors) = observed::<M, N, C>(method, step, start_conditions);
        if (found - order).abs() > 0.35 {
            wrong.push(format!("{name} by {method}: {found}, {errors:?}"));
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn what_is_separable_is_known() {
    let separable = |description: &dalembert::mechanism::Description| description.structure.separable;
    assert!(separable(Shaken::description()));
    assert!(!separable(Damped::description()) && !Damped::description().structure.constant_mass);
    let refusal = |system: &mut dyn System| {
        let mut settings = Settings::new(&system.scene(0));
        (settings.method, settings.step) = (Method::Verlet, Some(0.01));
        match simulate(system, &settings) {
            Err(Error::NotSeparable { reason, .. }) => Some(reason),
            _ => None,
        }
    };
    assert_eq!(refusal(&mut Shaken::default().system()), None);
    assert_eq!(refusal(&mut Damped::default().system()), Some(Inseparable::MassMatrix));
    assert_eq!(refusal(&mut Hung::default().system()), None);
}

#[test]
fn separable_methods_keep_their_order_with_inputs() {
    for (method, order, step) in [
        (Method::Verlet, 2.0, 0.01),
        (Method::Srkn4, 4.0, 0.05),
        (Method::Suzuki4, 4.0, 0.05),
        (Method::KahanLi8, 8.0, 0.12),
    ] {
        let (found, errors) = observed::<Shaken, 1, 0>(method, step, &|_| ());
        assert!((found - order).abs() < 0.35, "{method}: {found}, {errors:?}");
    }
}

#[test]
fn nystroms_method_keeps_its_order_with_inputs() {
    let (found, errors) = observed::<Shaken, 1, 0>(Method::Rkn8, 0.12, &|_| ());
    // At this end errors of order 8 nearly cancel.
    assert!(found > 7.8, "{found}, {errors:?}");
}

#[test]
fn nystroms_method_meets_switches_and_events() {
    // x'' = −9x where x > 0 and −x else: half periods of π/3 and π, from rest at 1; cos 3t = 1/2 beside each return.
    let mut system = OneSided::default().system();
    let mut settings = Settings::new(&system.scene(0));
    settings.method = Method::Rkn8;
    let run = simulate(&mut system, &settings).unwrap();
    let (period, beside) = (4.0 / 3.0 * PI, PI / 9.0);
    let last = run.last();
    let after = last.t - 10.0 * period;
    assert!((last["x"] - (3.0 * after).cos()).abs() < 2e-9 && (last["x'"] + 3.0 * (3.0 * after).sin()).abs() < 5e-9);
    assert_eq!(run.events.len(), 20);
    for (k, found) in run.events.iter().enumerate() {
        let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
        let error = found.state.t - (k.div_ceil(2) as f64 * period + sign * beside);
        assert!(error.abs() < 2e-9, "{k}: {error:e}");
    }
}

#[test]
fn implicit_methods_keep_their_order_with_inputs() {
    implicit::<Shaken, 1, 0>("shaken", [0.05, 0.1, 0.05, 0.025], &|_| ());
}

#[test]
fn implicit_methods_keep_their_order_where_m_varies() {
    implicit::<Damped, 2, 0>("damped", [0.02, 0.04, 0.02, 0.02], &|_| ());
}

#[test]
fn implicit_methods_keep_their_order_with_a_constraint_that_moves() {
    implicit::<Hung, 2, 1>("hung", [0.05, 0.1, 0.05, 0.0125], &|_| ());
}

#[test]
fn implicit_methods_keep_their_order_with_friction_of_reactions() {
    implicit::<Sliding, 2, 1>("sliding", [0.05, 0.1, 0.05, 0.05], &|_| ());
}

#[test]
fn implicit_methods_keep_their_order_with_constraints_of_speeds() {
    implicit::<Sleigh, 3, 1>("sleigh", [0.1, 0.2, 0.1, 0.1], &|_| ());
}

#[test]
fn implicit_methods_keep_their_order_with_baumgartes_gain() {
    implicit::<Hung, 2, 1>("baumgarte", [0.05, 0.1, 0.05, 0.05], &|settings| {
        settings.stabilisation = Stabilisation::Baumgarte { alpha: Some(3.0) };
    });
}

#[test]
fn implicit_methods_keep_their_order_with_springs_for_constraints() {
    implicit::<Hung, 2, 1>("springs", [0.02, 0.05, 0.02, 0.02], &|settings| {
        settings.enforcement = Enforcement::Springs { stiffness: 200.0, damping: 3.0 };
    });
}

#[test]
fn work_is_counted() {
    let work = |method: Method, step: Option<f64>| {
        let mut system = Damped::default().system();
        let mut settings = Settings::new(&system.scene(0));
        (settings.method, settings.step, settings.tolerance) = (method, step, 1e-6);
        (settings.dense, settings.every) = (false, Some(2.0));
        let work = simulate(&mut system, &settings).unwrap().work;
        (work.steps, work.rejected, work.evaluations, work.jacobians, work.factorizations)
    };
    for (method, step, expected) in [
        (Method::Gauss2, Some(0.01), (200, 0, 1250, 91, 91)),
        (Method::Gauss4, Some(0.01), (200, 0, 2771, 10, 11)),
        (Method::Gauss6, Some(0.01), (200, 0, 3687, 7, 8)),
        (Method::Radau5, None, (100, 8, 764, 25, 108)),
        (Method::Rodas5P, None, (78, 5, 660, 78, 83)),
    ] {
        assert_eq!(work(method, step), expected, "{method}");
    }
}

dalembert::model!(
    yaml = r#"
name: Relaxing
about: Van der Pol's oscillator, which creeps for long and jumps.
parameters: {mu: 1000}
coordinates: {x: 1}
kinetic_energy: x'^2/2
potential_energy: x^2/2
generalized_forces: {x: "mu*(1 - x^2)*x'"}
scene: {start: {x: 0.5}, until: 1000, tolerance: 1e-8}
"#
);

/// Stability would hold an explicit method to some 300,000 steps; where few are left it goes on.  Reference: `radau5`.
#[test]
fn auto_begins_again_where_stability_would_take_very_many_steps() {
    let run = |until: f64, method: Method| {
        Relaxing::default().simulate().until(until).method(method).tolerance(1e-8).run().expect("a run")
    };
    let (stiff, exact) = (run(500.0, Method::Auto), run(500.0, Method::Radau5));
    assert_eq!(stiff.method, Method::Rodas5P);
    assert!(stiff.work.evaluations < 10_000 && stiff.warnings.is_empty(), "{:?}", stiff.work);
    assert!((stiff.last()["x"] - exact.last()["x"]).abs() < 1e-6);
    let short = run(1.0, Method::Auto);
    assert_eq!(short.method, Method::Dop853);
}
