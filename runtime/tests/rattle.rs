//! RATTLE and its compositions: orders, constraints and energy kept, steps that are too long, and what they are not for.

use dalembert::mechanism::System;
use dalembert::precision::{Candidate, Plan, WorkPrecision};
use dalembert::{
    Cause, Enforcement, Error, Inseparable, Method, Run, Settings, Simulate, Stabilisation, Warning, simulate,
};

dalembert::model!(
    yaml = r#"
name: Swing
parameters: {m: 1 kg, l: 1 m, g: 9.81 m/s^2}
coordinates: {x: m, y: m}
bodies: {bob: {mass: m, position: "[x, y]"}}
gravity: [0, -g]
constraints: {rod: x^2 + y^2 - l^2}
balances:
  equations: [{force: {of: [bob]}}]
  reactions: {pull: {on: bob, along: -position(bob)}}
outputs:
  theta: atan2(x, -y)
  tension: -2*l*reaction(rod)
  energy: m*(x'^2 + y'^2)/2 + m*g*y
  missed: x^2 + y^2 - l^2
scene: {start: {x: l*sin(2), y: -l*cos(2), x': 0}, until: 4, tolerance: 1e-9}
scenes:
  rotor: {start: {x: 0, y: -l, x': 1}, set: {g: 0}, until: 4}
"#
);

dalembert::model!(
    yaml = r#"
name: Watched
parameters: {m: 1 kg, l: 1 m, g: 9.81 m/s^2}
coordinates: {x: m, y: m}
bodies: {bob: {mass: m, position: "[x, y]"}}
gravity: [0, -g]
constraints: {rod: x^2 + y^2 - l^2}
events: {lowest: {when: x, then: record}}
scene: {start: {x: l*sin(2), y: -l*cos(2), x': 0}, until: 4, tolerance: 1e-9}
"#
);

dalembert::model!(
    yaml = r#"
name: Angle
parameters: {m: 1 kg, l: 1 m, g: 9.81 m/s^2}
coordinates: {theta: rad}
bodies: {bob: {mass: m, position: "l*[sin(theta), -cos(theta)]"}}
gravity: [0, -g]
scene: {start: {theta: 2}, until: 4, tolerance: 1e-14}
"#
);

/// The rod of a hook that moves, a force that follows time, a third rod that says nothing new, and a ring without mass.
#[expect(deprecated, reason = "it warns of the rod that says nothing new")]
mod moved {
    dalembert::model!(
        yaml = r#"
name: Moved
parameters: {m: 1 kg, l: 1 m, g: 10 m/s^2, A: 0.1 m, w: 5 rad/s, F: 2 N, W: 3 rad/s}
coordinates: {x: m, y: m, u: m, v: m, s: m}
inputs: {hook: A*sin(w*t)}
bodies: {near: {mass: m, position: "[x, y]"}, far: {mass: 2*m, position: "[u, v]"}}
gravity: [0, -g]
forces: {wind: {on: far, force: "[F*cos(W*t), 0]"}}
constraints:
  upper: (x - hook)^2 + y^2 - l^2
  lower: (u - x)^2 + (v - y)^2 - l^2
  again: (x - hook)^2 + y^2 + (u - x)^2 + (v - y)^2 - 2*l^2
  ring: s - u - v/2
scene: {start: {x: 0.6, y: -0.8, u: 1.4, v: -1.4}, until: 1.5, tolerance: 1e-9}
"#
    );
}

use moved::Moved;

dalembert::model!(
    yaml = r#"
name: Released
parameters: {m: 1 kg, l: 1 m, g: 10 m/s^2}
coordinates: {x: m, y: m}
bodies: {bob: {mass: m, position: "[x, y]"}}
gravity: [0, -g]
constraints: {rod: x^2 + y^2 - l^2}
phases: {held: [rod], free: []}
events: {lets_go: {phase: held, when: y + 0.6*l, direction: rising, then: free}}
scene: {start: {x: 0, y: -l, x': 4}, phase: held, until: 0.6, tolerance: 1e-9}
"#
);

dalembert::model!(
    yaml = r#"
name: Parallelogram
parameters: {m: 1 kg, l: 1 m, d: 1.5 m, g: 10 m/s^2}
coordinates: {x: m, y: m, u: m, v: m}
bodies: {a: {mass: m, position: "[x, y]"}, b: {mass: 2*m, position: "[u, v]"}}
gravity: [0, -g]
constraints: {crank: x^2 + y^2 - l^2, rocker: (u - d)^2 + v^2 - l^2, rod: (u - x)^2 + (v - y)^2 - d^2}
outputs: {energy: m*(x'^2 + y'^2)/2 + m*(u'^2 + v'^2) + m*g*(y + 2*v)}
scene: {start: {x: l*cos(1), y: l*sin(1), u: d + l*cos(1), v: l*sin(1), x': -8*sin(1)}, until: 100, tolerance: 1e-9}
"#
);

dalembert::model!(
    yaml = r#"
name: Curved
parameters: {m: 1 kg, l: 1 m, g: 10 m/s^2}
coordinates: {r: m, theta: rad}
bodies: {bob: {mass: m, position: "r*[sin(theta), -cos(theta)]"}}
gravity: [0, -g]
constraints: {rod: r - l}
scene: {start: {r: l, theta: 1, r': 0}, until: 1}
"#
);

dalembert::model!(
    yaml = r#"
name: Dragged
parameters: {m: 1 kg, l: 1 m, c: 0.1 kg/s}
coordinates: {x: m, y: m}
bodies: {bob: {mass: m, position: "[x, y]"}}
forces: {drag: {on: bob, force: -c*velocity(bob)}}
constraints: {rod: x^2 + y^2 - l^2}
scene: {start: {x: 0, y: -l, x': 1}, until: 1}
"#
);

dalembert::model!(
    yaml = r#"
name: Skate
parameters: {m: 1 kg, I: 0.25 kg*m^2}
coordinates: {x: m, y: m, theta: rad}
bodies: {sled: {mass: m, inertia: I, angle: theta, position: "[x, y]"}}
constraints: {edge: "dot(velocity(sled), sled.y)"}
scene: {start: {x: 0, y: 0, theta: 0, x': 1, y': 0, theta': 1}, until: 1}
"#
);

dalembert::model!(
    yaml = r#"
name: Rubbed
parameters: {m: 1 kg, R: 1 m, g: 10 m/s^2, mu: 0.3 1}
coordinates: {x: m, y: m}
bodies: {bead: {mass: m, position: "[x, y]"}}
gravity: [0, -g]
constraints: {bowl: y - x^2/(2*R)}
forces: {rub: {on: bead, force: "-mu*reaction(bowl)*[1, x/R]"}}
scene: {start: {x: -1, y: 0.5, x': 0.5}, until: 0.5}
"#
);

const ALL: [(Method, f64); 3] = [(Method::Verlet, 2.0), (Method::Suzuki4, 4.0), (Method::KahanLi8, 8.0)];

fn swing(change: &dyn Fn(&mut Settings)) -> Run {
    run(&mut Swing::default().system(), change).unwrap()
}

fn run(system: &mut dyn System, change: &dyn Fn(&mut Settings)) -> Result<Run, Error> {
    let mut settings = Settings::new(&system.scene(0));
    (settings.dense, settings.watch) = (false, false);
    change(&mut settings);
    simulate(system, &settings)
}

/// Steps of this length by this method, reported at the end.
fn fixed(method: Method, step: f64) -> impl Fn(&mut Settings) {
    move |settings| (settings.method, settings.step, settings.every) = (method, Some(step), Some(settings.until))
}

#[test]
fn a_pendulum_in_x_and_y_follows_its_angle_with_the_order_of_the_method() {
    let exact = run(&mut Angle::default().system(), &|_| ()).unwrap().last()["theta"];
    for ((method, order), coarse) in ALL.into_iter().zip([0.005, 0.04, 0.1]) {
        let errors = [coarse, coarse / 2.0].map(|h| (swing(&fixed(method, h)).last()["theta"] - exact).abs());
        let observed = (errors[0] / errors[1]).log2();
        assert!((observed - order).abs() < 0.2, "{method}: {observed}, {errors:?}");
    }
}

/// Places, speeds and dense output, with constraints that move and that depend on each other, and a coordinate without inertia.
#[test]
fn orders_stay_where_constraints_move_depend_on_each_other_and_hold_what_has_no_mass() {
    let names = ["x", "y", "u", "v", "s", "x'", "y'", "u'", "v'", "s'"];
    let found = |change: &dyn Fn(&mut Settings)| {
        let run = run(&mut Moved::default().system(), &|settings| {
            settings.dense = true;
            change(settings);
        });
        run.unwrap()
    };
    let exact = found(&|settings| settings.tolerance = 1e-14);
    for ((method, order), coarse) in ALL.into_iter().zip([0.01, 0.025, 0.12]) {
        let errors = [coarse, coarse / 2.0].map(|h| {
            let run = found(&fixed(method, h));
            let off = |t: f64, name: &str| run.at(t).unwrap()[name] - exact.at(t).unwrap()[name];
            let error = |t: f64| names.iter().map(|name| off(t, name).powi(2)).sum::<f64>().sqrt();
            let residuals = run.residuals.unwrap();
            assert!(residuals.position < 1e-13 && residuals.velocity < 1e-13, "{method}: {residuals:?}");
            (error(1.5), (1..50).map(|k| error(0.03 * f64::from(k) - 0.007)).fold(0.0, f64::max))
        });
        let (observed, between) = ((errors[0].0 / errors[1].0).log2(), (errors[0].1 / errors[1].1).log2());
        assert!((observed - order).abs() < 0.2, "{method}: {observed}, {errors:?}");
        assert!((between - order).abs() < 0.5, "{method}: dense {between}, {errors:?}");
    }
}

#[test]
fn the_work_of_what_moves_a_constraint_has_the_order_of_the_method() {
    for ((method, order), coarse) in ALL.into_iter().zip([0.01, 0.05, 0.1]) {
        let drifts = [coarse, coarse / 2.0].map(|h| {
            let run = run(&mut Moved::default().system(), &|settings| {
                fixed(method, h)(settings);
                settings.watch = true;
            });
            run.unwrap().energy_balance.unwrap().abs()
        });
        let observed = (drifts[0] / drifts[1]).log2();
        assert!((observed - order).abs() < 0.5, "{method}: {observed}, {drifts:?}");
    }
}

/// The slope of the least squares' line through y over t, and r².
fn line(t: &[f64], y: &[f64]) -> (f64, f64) {
    let mean = |list: &[f64]| list.iter().sum::<f64>() / list.len() as f64;
    let (t_mean, y_mean) = (mean(t), mean(y));
    let sum = |f: &dyn Fn(f64, f64) -> f64| t.iter().zip(y).map(|(t, y)| f(t - t_mean, y - y_mean)).sum::<f64>();
    let (tt, ty, yy) = (sum(&|t, _| t * t), sum(&|t, y| t * y), sum(&|_, y| y * y));
    (ty / tt, ty * ty / (tt * yy))
}

#[test]
fn energy_stays_in_its_band_where_rk4_with_projection_loses_it_d6() {
    let along = |method: Method, step: f64| {
        let run = swing(&|settings| {
            (settings.method, settings.step) = (method, Some(step));
            (settings.until, settings.every) = (1000.0, Some(0.5));
        });
        let energy = run.column("energy").unwrap();
        let (slope, share) = line(run.times(), &energy);
        let most = energy.iter().fold(0.0_f64, |most, e| most.max((e - energy[0]).abs()));
        (slope, share, most)
    };
    let (slope, share, _) = along(Method::Rk4, 0.02);
    assert!((slope + 1.22e-5).abs() < 0.02e-5 && share > 0.99, "{slope:e} {share}");
    for (method, step, band) in
        [(Method::Verlet, 0.02, 2.5e-2), (Method::Suzuki4, 0.05, 5e-4), (Method::KahanLi8, 0.05, 5e-9)]
    {
        let (slope, share, most) = along(method, step);
        assert!(
            most < band && 1000.0 * slope.abs() < 0.01 * band && share < 0.1,
            "{method} {slope:e} {share} {most:e}"
        );
    }
}

#[test]
fn constraints_are_kept_to_rounding_over_a_hundred_thousand_steps() {
    let residuals = |method: Method, stabilisation: Stabilisation, until: f64| {
        let run = swing(&|settings| {
            settings.until = until;
            fixed(method, 0.01)(settings);
            settings.stabilisation = stabilisation;
        });
        assert!(run.work.steps >= 100 * until as u64 && run.warnings.is_empty(), "{method}: {:?}", run.warnings);
        run.residuals.unwrap()
    };
    for (method, until) in [(Method::Verlet, 1000.0), (Method::Suzuki4, 200.0), (Method::KahanLi8, 60.0)] {
        // Nothing is projected, and nothing needs to be.
        for stabilisation in [Stabilisation::Project, Stabilisation::None] {
            let found = residuals(method, stabilisation, until);
            assert!(found.position < 1e-14 && found.velocity < 1e-14, "{method}: {found:?}");
        }
    }
    assert!(residuals(Method::Rk4, Stabilisation::None, 100.0).position > 1e-3);
}

#[test]
fn a_rotor_turns_by_asin_of_the_step_and_a_longer_step_is_an_error_d7() {
    let rotor = |method: Method, step: f64, steps: f64| {
        let simulation = Swing::default().simulate().scene("rotor").method(method).until(step * steps).step(step);
        simulation.run()
    };
    let angle = rotor(Method::Verlet, 0.99, 1.0).unwrap().last()["theta"];
    assert!((angle - 0.99_f64.asin()).abs() < 1e-13 && (angle - 1.42926).abs() < 1e-5, "{angle}");
    let turned = rotor(Method::Verlet, 0.5, 4.0).unwrap().last()["theta"];
    assert!((turned - 4.0 * 0.5_f64.asin()).abs() < 1e-13, "{turned}");
    // No multiplier is real: nothing is a number where there is none, and the step is named.
    for (method, step) in
        [(Method::Verlet, 1.01), (Method::Suzuki4, 1.6), (Method::KahanLi8, 1.8), (Method::Verlet, 1e6)]
    {
        let error = rotor(method, step, 3.0).unwrap_err();
        assert_eq!(error.cause(), Some(&Cause::IterationStalled { h: step }), "{method}");
        let state = error.partial().unwrap().last();
        assert_eq!((state.t, state["x"], state["y"]), (0.0, 0.0, -1.0), "{method}");
    }
    let text = rotor(Method::Verlet, 1.01, 3.0).unwrap_err().to_string();
    assert!(text.contains("a step of 1.01e0 s could not be solved: it is too long"), "{text}");
}

#[test]
fn the_motion_runs_back_to_its_start() {
    let there_and_back = |method: Method| {
        let back = |settings: &mut Settings| {
            settings.until = 100.0;
            fixed(method, 0.1)(settings);
        };
        let there = swing(&back).last();
        let home = swing(&|settings| {
            back(settings);
            (settings.q, settings.v) = (vec![there["x"], there["y"]], vec![-there["x'"], -there["y'"]]);
        });
        (home.last()["theta"] - 2.0).hypot(home.last()["x'"]).hypot(home.last()["y'"])
    };
    for (method, _) in ALL {
        assert!(there_and_back(method) < 1e-11, "{method}: {:e}", there_and_back(method));
    }
    assert!(there_and_back(Method::Rk4) > 1e-6);
}

#[test]
fn reports_and_recorded_events_change_no_bit_and_an_end_cuts_its_own_step_only() {
    for (method, _) in ALL {
        let end = |every: f64, dense: bool| {
            let run = run(&mut Watched::default().system(), &|settings| {
                (settings.method, settings.step, settings.every) = (method, Some(0.03), Some(every));
                settings.dense = dense;
            });
            let run = run.unwrap();
            (["x", "y", "x'", "y'"].map(|name| run.last()[name].to_bits()), run.events.len(), run.work.steps)
        };
        let alone = end(4.0, false);
        assert_eq!(alone, end(0.007, true), "{method}");
        assert!(alone.1 > 2 && alone.2 == 134, "{method}: {alone:?}");
    }
}

#[test]
fn reactions_are_those_of_the_accelerations() {
    for (method, _) in ALL {
        let run = swing(&|settings| (settings.method, settings.step) = (method, Some(0.02)));
        for state in run.states() {
            let speed = state["x'"].hypot(state["y'"]);
            let expected = speed * speed - 9.81 * state["y"];
            assert!((state["tension"] - expected).abs() < 1e-12, "{method}: {} {expected}", state["tension"]);
            assert!(state["missed"].abs() < 1e-14);
        }
    }
}

#[test]
fn a_step_that_is_found_makes_errors_proportional_to_the_tolerance() {
    let exact = run(&mut Angle::default().system(), &|_| ()).unwrap().last()["theta"];
    for (method, tolerances) in
        [(Method::Verlet, [1e-3, 1e-5]), (Method::Suzuki4, [1e-4, 1e-8]), (Method::KahanLi8, [1e-7, 1e-11])]
    {
        for tolerance in tolerances {
            let run = swing(&|settings| (settings.method, settings.tolerance) = (method, tolerance));
            let error = (run.last()["theta"] - exact).abs();
            assert!(error < 100.0 * tolerance && error > 1e-3 * tolerance, "{method} {tolerance:e}: {error:e}");
        }
    }
}

#[test]
fn balances_of_momentum_may_give_the_accelerations() {
    for (method, _) in ALL {
        let lagrange = swing(&fixed(method, 0.02)).last();
        let by_balances = Swing::default().simulate().derivation("balances").method(method).step(0.02).every(4.0);
        let balances = by_balances.run().unwrap().last();
        assert!((lagrange["theta"] - balances["theta"]).abs() < 1e-11, "{method}");
    }
}

#[test]
fn a_phase_without_constraints_is_left_to_kicks_and_drifts() {
    let end = |change: &dyn Fn(&mut Settings)| {
        let run = run(&mut Released::default().system(), change).unwrap();
        assert_eq!(run.phases.len(), 2);
        ["x", "y", "x'", "y'"].map(|name| run.last()[name])
    };
    let exact = end(&|settings| settings.tolerance = 1e-13);
    for ((method, _), within) in ALL.into_iter().zip([1e-3, 1e-6, 1e-10]) {
        let found = end(&fixed(method, 0.01));
        assert!(found.iter().zip(&exact).all(|(a, b)| (a - b).abs() < within), "{method}: {found:?} {exact:?}");
    }
}

fn refusal(system: &mut dyn System, change: &dyn Fn(&mut Settings)) -> Option<Inseparable> {
    let outcome = run(system, &|settings| {
        (settings.method, settings.step) = (Method::Verlet, Some(0.01));
        change(settings);
    });
    match outcome {
        Err(Error::NotSeparable { reason, .. }) => Some(reason),
        Err(other) => panic!("{other}"),
        Ok(_) => None,
    }
}

#[test]
fn what_rattle_is_not_for_is_refused_with_the_reason() {
    let plain = |_: &mut Settings| ();
    assert_eq!(refusal(&mut Swing::default().system(), &plain), None);
    assert_eq!(refusal(&mut Curved::default().system(), &plain), Some(Inseparable::MassMatrix));
    assert_eq!(refusal(&mut Dragged::default().system(), &plain), Some(Inseparable::Speeds));
    let edge = Inseparable::Rates { constraint: "edge".into() };
    assert_eq!(refusal(&mut Skate::default().system(), &plain), Some(edge));
    assert_eq!(refusal(&mut Rubbed::default().system(), &plain), Some(Inseparable::Friction));
    let by = |method| refusal(&mut Swing::default().system(), &move |settings| settings.method = method);
    assert_eq!(by(Method::Srkn4), Some(Inseparable::Constraints));
    assert_eq!((by(Method::Suzuki4), by(Method::KahanLi8)), (None, None));
}

#[test]
fn other_ways_to_enforce_constraints_are_refused_but_springs_without_dampers() {
    let by = |enforcement, stabilisation| {
        refusal(&mut Swing::default().system(), &move |settings| {
            (settings.enforcement, settings.stabilisation) = (enforcement, stabilisation);
        })
    };
    let (multipliers, project) = (Enforcement::Multipliers, Stabilisation::Project);
    assert_eq!(by(multipliers, Stabilisation::None), None);
    let baumgarte = Stabilisation::Baumgarte { alpha: Some(3.0) };
    assert_eq!(by(multipliers, baumgarte), Some(Inseparable::Enforcement));
    assert_eq!(by(Enforcement::NullSpace, project), Some(Inseparable::Enforcement));
    let springs = |damping| Enforcement::Springs { stiffness: 100.0, damping };
    assert_eq!(by(springs(0.0), project), None);
    assert_eq!(by(springs(1.0), project), Some(Inseparable::Speeds));
}

/// Released half a radian from hanging, springs of stiffness k in the place of the rod lengthen it by what the catalogue says.
#[test]
fn springs_in_the_place_of_a_rod_are_kicks_and_drifts_d12() {
    let bias = |stiffness: f64| {
        let run = swing(&|settings| {
            (settings.q, settings.v) = (vec![1f64.sin(), -1f64.cos()], vec![0.0; 2]);
            (settings.method, settings.step, settings.until) = (Method::Verlet, Some(1e-4), 10.0);
            settings.enforcement = Enforcement::Springs { stiffness, damping: 0.0 };
        });
        run.states().map(|state| (state["x"].hypot(state["y"]) - 1.0).abs()).fold(0.0, f64::max)
    };
    // λ = −k c with c = r² − l², so that the spring along the rod has 4 k.
    let ratio = bias(2.5e3) / bias(2.5e4);
    assert!((ratio - 10.0).abs() < 0.5, "{ratio}");
}

#[test]
fn refusals_say_why() {
    let told = |system: &mut dyn System, method: Method| {
        run(system, &|settings| (settings.method, settings.step) = (method, Some(0.01))).unwrap_err().to_string()
    };
    for (system, method, words) in [
        (&mut Skate::default().system() as &mut dyn System, Method::Verlet, "its constraint `edge` contains speeds"),
        (&mut Rubbed::default().system(), Method::Suzuki4, "its forces are made of reactions"),
        (&mut Curved::default().system(), Method::KahanLi8, "its mass matrix changes along the motion"),
        (&mut Swing::default().system(), Method::Srkn4, "`verlet` (RATTLE), `suzuki4` and `kahanli8` keep them"),
    ] {
        let text = told(system, method);
        assert!(text.starts_with(&format!("`{method}` is for separable systems")) && text.contains(words), "{text}");
    }
}

#[test]
fn rattle_is_another_name_of_verlet() {
    assert_eq!("rattle".parse(), Ok(Method::Verlet));
    assert!("rattle8".parse::<Method>().is_err());
}

#[test]
fn work_is_counted() {
    for (method, expected) in
        [(Method::Verlet, (75, 76, 75)), (Method::Suzuki4, (75, 376, 375)), (Method::KahanLi8, (75, 1276, 1275))]
    {
        let work = run(&mut Moved::default().system(), &fixed(method, 0.02)).unwrap().work;
        assert_eq!((work.steps, work.evaluations, work.factorizations), expected, "{method}");
        assert_eq!((work.rejected, work.jacobians), (0, 0), "{method}");
    }
}

#[test]
fn charts_have_a_curve_for_each_of_them() {
    let system = Swing::default().system();
    let mut settings = Settings::new(&system.scene(0));
    settings.until = 1.0;
    let methods = ["verlet", "srkn4", "suzuki4", "kahanli8", "dop853"];
    let candidates: Vec<Candidate> = Candidate::methods(&system, &settings)
        .into_iter()
        .filter(|candidate| methods.contains(&&*candidate.name) || candidate.name == "auto")
        .collect();
    let plan = Plan { repetitions: 1, ..Plan::default() };
    let found = WorkPrecision::measure(&candidates, &plan, &mut |_| std::ops::ControlFlow::Continue(())).unwrap();
    let refused: Vec<&str> = found.refused.iter().map(|(name, _)| &**name).collect();
    assert_eq!(refused, ["srkn4"]);
    for (method, order) in [("verlet", 2.0), ("suzuki4", 4.0), ("kahanli8", 8.0)] {
        let curve = found.curves.iter().find(|curve| curve.name == method).expect("a curve");
        let observed = curve.order().unwrap();
        assert!((observed - order).abs() < 0.1 * order, "{method}: {observed}");
    }
}

#[test]
fn change_points_are_passed_on_the_branch_and_on_the_constraints() {
    for (method, step, within) in [
        (Method::Verlet, 0.03, 5e-3),
        (Method::Verlet, 0.01, 2e-3),
        (Method::Suzuki4, 0.02, 1e-5),
        (Method::KahanLi8, 0.1, 1e-5),
        (Method::KahanLi8, 0.023, 1e-8),
    ] {
        let change = |settings: &mut Settings| {
            (settings.method, settings.step, settings.every) = (method, Some(step), Some(1.0));
        };
        let run = run(&mut Parallelogram::default().system(), &change).unwrap();
        let off = run.states().map(|state| (state["u"] - state["x"] - 1.5).abs()).fold(0.0, f64::max);
        let (energy, residuals) = (run.column("energy").unwrap(), run.residuals.unwrap());
        let lost = (energy.last().unwrap() / energy[0] - 1.0).abs();
        assert!(off < 1e-12 && lost < within, "{method} {step}: {off:e} {lost:e}");
        assert!(residuals.position < 1e-10 && residuals.velocity < 1e-6, "{method} {step}: {residuals:?}");
        assert!(run.warnings.iter().any(|warning| matches!(warning, Warning::SingularPassed { .. })));
    }
}

#[test]
fn a_tolerance_below_rounding_finds_the_step_below_which_errors_do_not_fall() {
    let exact = run(&mut Angle::default().system(), &|_| ()).unwrap().last()["theta"];
    let found = swing(&|settings| {
        (settings.method, settings.tolerance, settings.every) = (Method::Suzuki4, 1e-14, Some(settings.until));
    });
    let (error, step) = ((found.last()["theta"] - exact).abs(), found.step.unwrap());
    assert!(error < 1e-11 && (1e-4..1e-2).contains(&step), "{error:e} {step:e}");
}
