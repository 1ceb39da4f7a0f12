//! Motions that stay on a discontinuity, to which both sides push back: against `friction` and closed forms.
#![cfg(all(feature = "cli", feature = "modal"))]

mod program;

use dalembert::mechanism::{Dynamic, System};
use dalembert::{Cause, Error, NoSlopes, Simulate};
use program::{File, json, near, reference, run};
use serde_json::Value;

dalembert::model!(
    yaml = r#"
name: Coulomb
parameters: {m: 1 kg, k: 1 N/m, F: 1 N, x0: 3.5 m}
coordinates: {x: m}
bodies: {b: {mass: m, position: "[x, 0]"}}
springs: {s: {stretch: x, stiffness: k}}
forces: {rub: {on: b, force: "[-F*sign(x'), 0]"}}
outputs: {rub: -F*sign(x')}
scene: {start: {x: x0}, until: 20}
"#
);

/// The ends of the runs of a file with `sign` and of one with `friction`.
fn both(name: &str, head: &str, sign: &str, friction: &str, tail: &str) -> [Value; 2] {
    [("sign", sign), ("friction", friction)].map(|(kind, law)| {
        let file = File::new(&format!("{name}_{kind}"), &format!("name: M\n{head}\n{law}\n{tail}\n"));
        json(&["simulate", &file.0])
    })
}

#[track_caller]
fn agree(found: &[Value; 2], names: &[&str], within: f64) {
    for name in names {
        for of in ["q", "v"] {
            near(&found[0][of][name], found[1][of][name].as_f64().expect("a number"), within);
        }
    }
    assert_eq!(found[0]["warnings"], serde_json::json!([]));
}

#[test]
fn coulombs_oscillator_rests_off_its_centre() {
    // 2 F/k less every half swing, from 3.5 F/k to -0.5 F/k.
    let ends = Coulomb::default().simulate().every(1.0).run().expect("a motion");
    let last = ends.last();
    assert!((last["x"] + 0.5).abs() < 1e-8 && last["x'"] == 0.0, "{last}");
    // The force is what keeps it, and not what the sign of nothing makes.
    let rub = *ends.column("rub").expect("a column").last().expect("a row");
    assert!((rub + 0.5).abs() < 1e-8, "{rub}");
    let held = Coulomb { x0: 0.5, ..Coulomb::default() }.simulate().run().expect("a motion");
    assert_eq!(held.last()["x"], 0.5);
    let jumps = Coulomb { x0: 0.5, ..Coulomb::default() }.simulate().slopes(&["k"]);
    assert!(
        matches!(jumps, Err(Error::NoSlopes(why)) if matches!(*why, NoSlopes::Rests { .. })),
        "slopes on a discontinuity"
    );
}

#[test]
fn a_block_on_a_belt_sticks_and_slips_as_with_friction() {
    let head = "parameters: {m: 1 kg, k: 4 N/m, F: 1 N, S: 0.5 N, v0: 0.2 m/s, vs: 0.1 m/s}\ncoordinates: {x: m}\n\
                bodies: {b: {mass: m, position: \"[x, 0]\"}}\nsprings: {s: {stretch: x, stiffness: k}}";
    let law = "F + S*exp(-((x' - v0)/vs)^2)";
    let sign = format!("forces: {{rub: {{on: b, force: \"[-({law})*sign(x' - v0), 0]\"}}}}");
    let friction = format!("friction: {{rub: {{rate: x' - v0, on: b, along: \"[1, 0]\", limit: {law}}}}}");
    let found = both("belt", head, &sign, &friction, "scene: {start: {x: 0}, until: 20}");
    agree(&found, &["x"], 1e-12);
    assert_eq!(found[0]["work"]["steps"], found[1]["work"]["steps"]);
}

#[test]
fn two_blocks_stick_and_slip_on_each_other() {
    let blocks = File::new(
        "blocks",
        "name: Blocks\nparameters: {m: 2 kg, M: 1 kg, g: 9.81 m/s^2, mu: 0.3, nu: 0.25, F: 14 N, w: 5 rad/s}\n\
         coordinates: {x: m, y: m}\nbodies: {low: {mass: m, position: \"[x, 0]\"}, high: {mass: M, position: \"[y, 0]\"}}\n\
         forces:\n  pull: {on: low, force: \"[F*sin(w*t), 0]\"}\n  \
         floor: {on: low, force: \"[-mu*(m + M)*g*sign(x'), 0]\"}\n  \
         between: {on: high, from: low, force: \"[-nu*M*g*sign(y' - x'), 0]\"}\n\
         scene: {start: {x: 0}, until: 3, tolerance: 1e-12}\n",
    );
    let (found, expected) = (json(&["simulate", &blocks.0]), reference("two_blocks"));
    for name in ["x", "y"] {
        near(&found["q"][name], expected[name].as_f64().expect("a number"), 1e-11);
        near(&found["v"][name], expected[format!("{name}'")].as_f64().expect("a number"), 1e-11);
    }
    assert_eq!(found["warnings"], serde_json::json!([]));
}

/// How two frictions share what holds a block is not determined; how it moves is.
#[test]
fn two_frictions_on_one_block_are_one() {
    for (x, k, limits) in
        [(-0.428, 45.1, ["2.55*N", "1.9*N*(1.2 + sin(w*t/2))"]), (-0.121, 24.9, ["1.48*N*(1.2 + sin(w*t/2))", "1.8*N"])]
    {
        let head = format!(
            "parameters: {{m: 1.2 kg, w: 7.5 rad/s, F: 3 N, k: {k} N/m, N: 1 N}}\ncoordinates: {{x: m}}\n\
             bodies: {{b: {{mass: m, position: \"[x, 0]\"}}}}\nsprings: {{s: {{stretch: x, stiffness: k}}}}"
        );
        let pull = "pull: {on: b, force: \"[F*sin(w*t), 0]\"}";
        let [one, two] = limits;
        let sign = format!("forces: {{{pull}, rub: {{on: b, force: \"[-({one} + {two})*sign(x'), 0]\"}}}}");
        let friction = format!(
            "forces: {{{pull}}}\nfriction:\n  one: {{on: b, along: \"[1, 0]\", rate: x', limit: \"{one}\"}}\n  \
             two: {{on: b, along: \"[1, 0]\", rate: x', limit: \"{two}\"}}"
        );
        let tail = format!("scene: {{start: {{x: {x}}}, until: 6, tolerance: 1e-10}}");
        let found = both("shared", &head, &sign, &friction, &tail);
        agree(&found, &["x"], 1e-9);
    }
}

/// Of two that hold one rate each carries what the other leaves, by `sign` and by `friction`, in whichever direction rates are written.
#[test]
fn two_brakes_between_two_blocks_share_what_holds_them() {
    let head = "parameters: {m: 2.8 kg, M: 2.2 kg, w: 6.6 rad/s, F: 8 N, k: 4.7 N/m, L: 4.4 N, l: 0.9 N, v0: 0.1 m/s}\n\
                coordinates: {x: m, y: m}\n\
                bodies: {b: {mass: m, position: \"[x, 0]\"}, c: {mass: M, position: \"[y, 0]\"}}\n\
                springs: {s: {stretch: y - x, stiffness: k}}";
    let pull = "pull: {on: c, force: \"[F*sin(w*t), 0]\"}";
    let tail = "scene: {start: {x: 0.17, y: -0.55}, until: 6, tolerance: 1e-10}";
    let limits = [["L", "l"], ["L*(1.2 + sin(w*t/2))", "l"], ["L*(1 + 0.5*exp(-((x' - y')/v0)^2))", "l"]];
    for ([one, two], (on, from, rate)) in
        limits.into_iter().flat_map(|limits| [(limits, ("b", "c", "x' - y'")), (limits, ("c", "b", "y' - x'"))])
    {
        let sign = format!(
            "forces:\n  {pull}\n  one: {{on: b, from: c, force: \"[-({one})*sign(x' - y'), 0]\"}}\n  \
             two: {{on: {on}, from: {from}, force: \"[-({two})*sign({rate}), 0]\"}}"
        );
        let friction = format!(
            "forces: {{{pull}}}\nfriction:\n  one: {{on: b, from: c, along: \"[1, 0]\", rate: x' - y', limit: \"{one}\"}}\n  \
             two: {{on: {on}, from: {from}, along: \"[1, 0]\", rate: {rate}, limit: \"{two}\"}}"
        );
        agree(&both("brakes", head, &sign, &friction, tail), &["x", "y"], 1e-9);
    }
}

/// A floor and a belt cannot both hold a block.
#[test]
fn what_cannot_stick_together_sticks_by_itself() {
    let head = "parameters: {m: 2 kg, w: 6.2 rad/s, F: 8 N, k: 56 N/m, v: 0.3 m/s, L: 3.5 N, l: 3.6 N}\n\
                coordinates: {x: m}\nbodies: {b: {mass: m, position: \"[x, 0]\"}}\nsprings: {s: {stretch: x, stiffness: k}}";
    let pull = "pull: {on: b, force: \"[F*sin(w*t), 0]\"}";
    let sign = format!("forces: {{{pull}, rub: {{on: b, force: \"[-L*sign(x') - l*sign(x' - v), 0]\"}}}}");
    let friction = format!(
        "forces: {{{pull}}}\nfriction:\n  floor: {{on: b, along: \"[1, 0]\", rate: x', limit: L}}\n  \
         belt: {{on: b, along: \"[1, 0]\", rate: x' - v, limit: l}}"
    );
    let tail = "scene: {start: {x: -0.2, x': 1.6}, until: 6, tolerance: 1e-10}";
    agree(&both("floor_and_belt", head, &sign, &friction, tail), &["x"], 1e-9);
}

#[test]
fn ten_signs_at_rest_each_hold_or_slide() {
    let blocks = File::new(
        "many",
        "name: Many\nsizes: {n: 10}\nparameters: {m: 1 kg, F: 1 N, P: 2 N}\ncoordinates: {\"x[i in 1..n]\": m}\n\
         bodies: {\"b[i in 1..n]\": {mass: m, position: \"[x[i], 0]\"}}\n\
         forces: {\"rub[i in 1..n]\": {on: \"b[i]\", force: \"[P*i/n - F*sign(x[i]'), 0]\"}}\n\
         scene: {start: {}, until: 1}\n",
    );
    let found = json(&["simulate", &blocks.0]);
    for i in 1..=10 {
        let pull = 2.0 * f64::from(i) / 10.0 - 1.0;
        near(&found["q"][format!("x[{i}]")], 0.5 * pull.max(0.0), 1e-12);
    }
}

#[test]
fn friction_made_of_a_reaction_sticks() {
    let head = "parameters: {m: 1 kg, g: 9.81 m/s^2, mu: 0.3, F: 6 N, G: 3 N, w: 2 rad/s}\ncoordinates: {x: m, y: m}\n\
                bodies: {b: {mass: m, position: \"[x, y]\"}}\ngravity: [0, -g]\nconstraints: {floor: y}";
    let pull = "pull: {on: b, force: \"[F*sin(w*t), G*sin(w*t)]\"}";
    let sign = format!("forces: {{{pull}, rub: {{on: b, force: \"[-mu*reaction(floor)*sign(x'), 0]\"}}}}");
    let friction = format!(
        "forces: {{{pull}}}\nfriction: {{rub: {{on: b, along: \"[1, 0]\", rate: x', limit: mu*reaction(floor)}}}}"
    );
    let found = both("reaction", head, &sign, &friction, "scene: {start: {x: 0}, until: 10, tolerance: 1e-10}");
    agree(&found, &["x"], 1e-8);
}

#[test]
fn a_relay_and_a_controller_hold_what_they_are_for() {
    // Sliding mode control: on x' = -c x the force is what the disturbance and the way there ask for.
    let control = File::new(
        "control",
        "name: Control\nparameters: {m: 1 kg, c: 2 1/s, K: 5 N, D: 1 N, w: 3 rad/s}\ncoordinates: {x: m}\n\
         bodies: {b: {mass: m, position: \"[x, 0]\"}}\n\
         forces: {u: {on: b, force: \"[-K*sign(x' + c*x) + D*sin(w*t), 0]\"}}\noutputs: {u: -K*sign(x' + c*x)}\n\
         scene: {start: {x: 1}, until: 3}\n",
    );
    let found = json(&["simulate", &control.0]);
    let [x, v] = [&found["q"]["x"], &found["v"]["x"]].map(|number| number.as_f64().expect("a number"));
    assert!((v + 2.0 * x).abs() < 1e-12, "{v} {x}");
    near(&found["outputs"]["u"], -(9.0_f64).sin() - 2.0 * v, 1e-9);
    let relay = File::new(
        "relay",
        "name: Relay\nparameters: {C: 10 J/K, h: 2 W/K, P: 100 W, A: 280 K, S: 300 K}\n\
         states: {T: {unit: K, rate: (P*step(S - T) - h*(T - A))/C}}\noutputs: {heat: P*step(S - T)}\n\
         scene: {start: {T: 290}, until: 20}\n",
    );
    let found = json(&["simulate", &relay.0]);
    near(&found["states"]["T"], 300.0, 1e-11);
    near(&found["outputs"]["heat"], 40.0, 1e-9);
}

#[test]
fn a_run_is_saved_and_continued_while_it_sticks() {
    let belt = File::new(
        "saved",
        "name: Saved\nparameters: {m: 1 kg, k: 4 N/m, F: 1 N, v: 0.2 m/s}\ncoordinates: {x: m}\n\
         bodies: {b: {mass: m, position: \"[x, 0]\"}}\nsprings: {s: {stretch: x, stiffness: k}}\n\
         forces: {rub: {on: b, force: \"[-F*sign(x' - v), 0]\"}}\nscene: {start: {x: 0}, until: 3}\n",
    );
    let state = std::env::temp_dir().join(format!("dalembert-sliding-{}.yaml", std::process::id()));
    let name = state.to_str().expect("a name");
    let whole = json(&["simulate", &belt.0]);
    run(&["simulate", &belt.0, "--until", "1", "--save", name]).expect("a first part");
    let rest = json(&["simulate", &belt.0, "--until", "3", "--state", name]);
    std::fs::remove_file(&state).expect("a file");
    near(&rest["q"]["x"], whole["q"]["x"].as_f64().expect("a number"), 1e-9);
}

#[test]
fn methods_that_use_derivatives_say_that_they_cannot() {
    let held = Coulomb::default().simulate().method("radau5".parse().expect("a method")).run();
    let Err(Error::Run(failure)) = held else { panic!("a motion") };
    assert!(matches!(&failure.cause, Cause::Sliding { switch } if switch == "x'"), "{}", failure.cause);
    assert!((failure.state.t - 2.0 * std::f64::consts::PI).abs() < 1e-6);
}

#[test]
fn modes_that_are_not_numbers_slide() {
    let mut system = Dynamic::new(Coulomb::default());
    assert!(system.sliding().is_empty() && system.can_slide());
    system.set_modes(&[f64::NAN]);
    assert_eq!(system.sliding(), [0]);
    let (mut a, mut values) = ([1.0], [0.0]);
    let at = dalembert::mechanism::At::new(0.0, &[-0.5], &[0.0]);
    system.accelerations(at, &mut a).expect("accelerations");
    system.outputs(at, &mut values);
    assert_eq!((a, values), ([0.0], [-0.5]));
    system.set_modes(&[1.0]);
    assert!(system.sliding().is_empty());
}

#[test]
fn single_evaluations_are_on_the_side_where_the_state_is() {
    let dry = Coulomb::default();
    // −k x − F sign x', with sign 0 = 0.
    for (x, v, a) in [(1.0, -1.0, 0.0), (1.0, 1.0, -2.0), (-0.5, -1.0, 1.5), (0.5, 0.0, -0.5)] {
        let found = dry.accelerations_at(0.0, &[x], &[v]).expect("a mass")[0];
        assert_eq!(found, a, "{x} {v}");
        assert_eq!((dry.bias_at(0.0, &[x], &[v])[0], dry.residual_at(0.0, &[x], &[v], &[a])[0]), (-a, 0.0), "{x} {v}");
    }
}
