//! Starts that a guess completes, and slopes at a start.

use dalembert::{Error, NoSlopes};

use super::{case, program, simulation, text_of};

/// The place nearest to a guess is known to rounding, not to the root of it; the point of an ellipsoid by Lagrange's multiplier with 25 digits.
#[test]
fn a_guess_leads_to_the_nearest_place_to_rounding() {
    let run = case(
        "name: Bead\nparameters: {m: 1 kg, l: 1 m}\ncoordinates: {x: m, y: m, z: m}\n\
         bodies: {b: {mass: m, position: \"[x, y, z]\"}}\nconstraints: {on: x^2/4 + y^2 + z^2 - l^2}\n\
         scene: {start: {z: 0}, guess: {x: 2, y: 1.5}, until: 0}\n",
    )
    .run();
    let last = run.last();
    assert!((last["x"] - 1.511_896_795_090_536_1).abs() < 1e-14, "{}", last["x"]);
    assert!((last["y"] - 0.654_631_209_345_19).abs() < 1e-13, "{}", last["y"]);
    // A guess that meets the constraint is left as it is.
    let there = case(
        "name: Bead\ncoordinates: {x: m, y: m}\nparameters: {m: 1 kg, l: 5 m}\nbodies: {b: {mass: m, position: \"[x, y]\"}}\n\
         constraints: {on: x^2 + y^2 - l^2}\nscene: {guess: {x: 3, y: 4}, until: 0}\n",
    );
    let mut there = there;
    let last = there.run().last().q.to_vec();
    assert_eq!(last, [3.0, 4.0]);
}

/// The slopes of a start that a guess with a `rotation` completes are those of runs with other parameters.
#[test]
fn a_guess_with_a_rotation_has_the_slopes_of_its_runs() {
    let text = text_of("universal_joint_by_guess");
    let slopes = simulation(&text).until(0.0).slopes(&["l"]).unwrap();
    let at = |l: f64| {
        let mut case = case(&text.replace("l: 1 m", &format!("l: {l:?} m")));
        case.settings.until = 0.0;
        case.run()
    };
    let (more, less) = (at(1.0 + 1e-4), at(1.0 - 1e-4));
    for name in ["x2", "y2", "z2", "r2.w", "r2.x", "r2.y", "r2.z", "x2'", "r2.x'"] {
        let (found, expected) = (slopes.get(name, "l").unwrap().value, (more.last()[name] - less.last()[name]) / 2e-4);
        assert!((found - expected).abs() < 1e-6, "{name}: {found}, {expected}");
    }
}

/// What moves a start off a surface where forces jump has no slope there; what does not has.
#[test]
fn a_start_on_a_surface_has_no_slopes_across_it() {
    let text = "name: Rub\nparameters: {F: 1, mu: 0.5}\ncoordinates: {x: }\nkinetic_energy: x'^2/2\n\
                generalized_forces: {x: \"-F - mu*sign(x')\"}\nscene: {start: {x: 0, x': 0}, until: 1}\n";
    let refused = simulation(text).slopes(&["x'"]);
    let touches = |error: &Error| matches!(error, Error::NoSlopes(why) if matches!(**why, NoSlopes::Touches { .. }));
    assert!(refused.as_ref().is_err_and(touches), "{refused:?}");
    // x = -(F - mu) t^2/2.
    let found = simulation(text).slopes(&["F", "mu", "x"]).unwrap();
    for (unknown, slope) in [("F", -0.5), ("mu", 0.5), ("x", 1.0)] {
        assert!((found.get("x", unknown).unwrap().value - slope).abs() < 1e-9, "{unknown}");
    }
}

/// Eigenvalues of a sampled loop that are 0 but for rounding are told as such: two values are forgotten here.
#[test]
fn sums_of_values_that_a_loop_forgets_are_zeros() {
    let path = super::folder("forgets").join("model.yaml");
    let text = "name: Forgets\ncoordinates: {x: }\nmemory: {u: 0, w: 0}\nbodies: {a: {mass: 1, position: \"[x, 0]\"}}\n\
                forces: {f: {on: a, force: \"[u + w - x, 0]\"}}\nevents:\n  t1: {every: 0.02, then: {set: {u: -x'}}}\n  \
                t2: {every: 0.04, from: 0.02, then: {set: {w: -x - u/4}}}\nscene: {start: {x: 0}, until: 1}\n";
    std::fs::write(&path, text).expect("a file");
    let said = program(&["modes", path.to_str().expect("a path"), "--sampled"]).unwrap();
    assert!(said.contains("and 2 that are 0") && !said.contains("warning"), "{said}");
}

/// A row whose terms are all zero where it begins, and a drive that sets off like t²: 1 − cos(w t) is rounded to 1e-16 beside it.
#[test]
fn a_drive_that_sets_off_slowly_keeps_its_constraint() {
    let text = "name: Lost\nparameters: {m: 1 kg, a: 1 m, w: 3 rad/s}\ncoordinates: {x: m, y: m}\n\
                inputs: {raise: a*(1 - cos(w*t))}\n\
                bodies: {b: {mass: m, position: \"[x, 0]\"}, c: {mass: m, position: \"[y, 0]\"}}\n\
                constraints: {arm: y - x - raise}\nscene: {until: 1, tolerance: 1e-12}\n";
    for until in [1e-9, 1e-3, 1.0] {
        let mut drive = case(text);
        drive.settings.until = until;
        let run = drive.run();
        // What is rounding at the start is no defect that shorter steps would mend.
        assert!(run.work.evaluations < 10_000, "{until}: {}", run.work.evaluations);
        let x = run.last()["x"];
        let expected = -f64::sin(1.5 * until).powi(2);
        assert!((x - expected).abs() < 1e-15 + 1e-11 * until, "{until}: {x}, not {expected}");
    }
}

/// 0.3 - 0.1 - 0.2 is -3e-17: what lengths that cancel leave is on the floor, in a contact and in a phase.
#[test]
fn a_start_from_lengths_that_cancel_is_on_the_floor() {
    let block = |rest: &str| {
        format!(
            "name: Block\nparameters: {{m: 1 kg, g: 10 m/s^2, a: 0.1 m, b: 0.2 m, c: 0.3 m}}\ncoordinates: {{x: m, y: m}}\n\
             bodies: {{block: {{mass: m, position: '[x, y]'}}}}\ngravity: [0, -g]\n{rest}\n"
        )
    };
    let contact = "contacts: {k: {gap: y, on: block, normal: '[0, 1]', restitution: 0.5}}";
    let phase = "constraints: {floor: y}\nphases: {rest: [floor]}";
    for law in [contact, phase] {
        for start in ["c - a - b", "a + b - c", "0"] {
            let run = case(&block(&format!("{law}\nscene: {{start: {{y: {start}, x': 1}}, until: 1}}"))).run();
            assert_eq!((run.last()["y"], run.last()["y'"]), (0.0, 0.0), "{law} {start}");
            assert!(run.warnings.is_empty(), "{law} {start}: {:?}", run.warnings);
        }
        let below = case(&block(&format!("{law}\nscene: {{start: {{y: -1e-9, x': 1}}, until: 1}}"))).try_run();
        assert!(below.is_err(), "{law}");
    }
}

/// What rests at the zero of an event that changes the motion, and leaves it in the event's direction later, meets it where it leaves.
#[test]
fn what_rests_at_a_guard_meets_it_where_it_leaves() {
    let pushed = |push: &str| {
        format!(
            "name: Pushed\nparameters: {{m: 1 kg, F: 2 N, r: 2 N/s, c: 1 N*s/m, t1: 1 s}}\ncoordinates: {{x: m}}\n\
             bodies: {{b: {{mass: m, position: '[x, 0]'}}}}\nphases: {{air: [], mud: []}}\n\
             forces: {{push: {{on: b, force: '[{push}, 0]'}}, drag: {{on: b, force: -c*velocity(b), phase: mud}}}}\n\
             events: {{enter: {{phase: air, when: x, direction: rising, then: mud}}}}\n\
             scene: {{start: {{x: 0}}, until: 2, tolerance: 1e-11}}\n"
        )
    };
    // x'' + x' = 2 or 2 (t - 1), from rest at t = 1.
    let e = f64::exp(-1.0);
    for (push, x) in [("F*step(t - t1)", 2.0 * e), ("r*max(t - t1, 0)", 1.0 - 2.0 * e)] {
        let run = case(&pushed(push)).run();
        assert!((run.last()["x"] - x).abs() < 1e-11, "{push}: {}", run.last()["x"]);
        assert!(matches!(&run.events[..], [enter] if enter.state.t == 1.0), "{push}");
        assert!(run.warnings.is_empty(), "{push}: {:?}", run.warnings);
    }
    // It rests on the floor of another phase while a magnet holds its weight, and stays there afterwards.
    let held = "name: Held\nparameters: {m: 1 kg, e: 0.5 1, g: 10 m/s^2, t1: 1 s}\ncoordinates: {y: m}\n\
                bodies: {b: {mass: m, position: '[0, y]'}}\ngravity: [0, -g]\n\
                forces: {magnet: {on: b, force: '[0, m*g*step(t1 - t)]'}}\nconstraints: {floor: y}\n\
                phases: {flight: [], rest: [floor]}\n\
                events: {bounce: {phase: flight, when: y, direction: falling, then: {impact: e, along: floor}}}\n\
                scene: {start: {y: 0}, until: 2}\n";
    let run = case(held).run();
    assert_eq!((run.last()["y"], run.last()["y'"]), (0.0, 0.0));
}
