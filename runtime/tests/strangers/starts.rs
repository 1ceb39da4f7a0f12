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

/// A particle whose start is also to meet this, with outputs for it.
fn also(coordinates: &str, rest: &str) -> dalembert::Run {
    let position = if coordinates.contains('z') { "[x, y, z]" } else { "[x, y]" };
    case(&format!(
        "name: Also\nparameters: {{m: 2 kg, l: 1 m}}\ncoordinates: {{{coordinates}}}\n\
         bodies: {{c: {{mass: m, position: '{position}'}}}}\n{rest}\n"
    ))
    .run()
}

/// With `also` the place is the nearest to the guess, and speeds that nobody names are those of least kinetic energy.
#[test]
fn what_a_start_is_also_to_meet_moves_no_more_than_it_must() {
    let near = |run: &dalembert::Run, expected: &[(&str, f64)]| {
        for (name, value) in expected {
            assert!((run.last()[name] - value).abs() < 1e-14, "{name}: {} for {value}", run.last()[name]);
        }
    };
    let distance = 0.2_f64.hypot(1.1);
    let nearest = [("x", 0.2 / distance), ("y", 1.1 / distance), ("x'", 0.0), ("y'", 0.0)];
    let on = "outputs: {d: x^2 + y^2 - l^2}\nscene: {guess: {x: 0.2, y: 1.1}, also: {d: 0}, until: 0}";
    near(&also("x: m, y: m", on), &nearest);
    near(&also("x: m, y: m, z: m", &format!("constraints: {{floor: z}}\n{on}")), &nearest);
    let still =
        "outputs: {e: x*x' + y*y', d: x^2 + y^2 - l^2}\nscene: {guess: {x: 0.2, y: 1.1}, also: {d: 0, e: 0}, until: 0}";
    near(&also("x: m, y: m", still), &nearest);
    let held =
        "outputs: {d: x^2 + y^2 - l^2}\nscene: {start: {x: 0.3, x': 0}, guess: {y: 1.1}, also: {d: 0}, until: 0}";
    near(&also("x: m, y: m", held), &[("x", 0.3), ("y", 0.91_f64.sqrt()), ("x'", 0.0), ("y'", 0.0)]);
    let above = "outputs: {d: x^2 + y^2 - l^2}\nscene: {guess: {x: 0, y: 1.1}, also: {d: 0}, until: 0}";
    near(&also("x: m, y: m", above), &[("x", 0.0), ("y", 1.0)]);
    // What speeds can meet leaves the place where it is: 3 x' + y' = 2 by the shortest (x', y').
    let moving = "outputs: {e: 3*l*x' + l*y'}\nscene: {guess: {x: 0.2, y: 1.1}, also: {e: 2}, until: 0}";
    near(&also("x: m, y: m", moving), &[("x", 0.2), ("y", 1.1), ("x'", 0.6), ("y'", 0.2)]);
    // So does an energy, whatever way it moves.
    let energy = "gravity: [0, -10]\nconserved: {e: energy}\nscene: {guess: {x: 0.2, y: 1.1}, also: {e: 30}, until: 0}";
    let run = also("x: m, y: m", energy);
    near(&run, &[("x", 0.2), ("y", 1.1)]);
    let moves = run.last()["x'"].powi(2) + run.last()["y'"].powi(2);
    assert!((moves - 8.0).abs() < 1e-13, "{moves}");
    // Where no speed can meet it the place gives way: m g y is no more than the energy.
    let low = energy.replace("e: 30", "e: 10");
    let run = also("x: m, y: m", &low);
    assert!(run.last()["y"] <= 0.5 + 1e-9, "{}", run.last()["y"]);
}

/// The same of angles and of a rotation, which turns by no more than it must and rests.
#[test]
fn what_angles_are_also_to_meet_leaves_them_at_rest() {
    let body = |coordinates: &str, turns: &str, guess: &str| {
        case(&format!(
            "name: Also\nparameters: {{m: 2 kg}}\ncoordinates: {{{coordinates}}}\nframes: {{F: {{rotate: {turns}}}}}\n\
             bodies: {{c: {{mass: m, inertia: [1, 1, 2], frame: F, position: [0, 0, 0]}}}}\n\
             outputs: {{tx: F.x.x, w: angular_velocity(c)}}\nscene: {{guess: {{{guess}}}, also: {{tx: 0}}, until: 0}}\n"
        ))
        .run()
    };
    let angles = body("a: rad, b: rad", "[[z, a], [y, b]]", "a: 1.5");
    for (name, value) in [("a", std::f64::consts::FRAC_PI_2), ("b", 0.0), ("a'", 0.0), ("b'", 0.0)] {
        assert!((angles.last()[name] - value).abs() < 1e-14, "{name}: {}", angles.last()[name]);
    }
    let rotation = body("q: rotation", "q", "q: {vector: [0, 0, 1.5]}");
    let half = std::f64::consts::FRAC_1_SQRT_2;
    for (name, value) in [("q.w", half), ("q.z", half), ("w.x", 0.0), ("w.y", 0.0), ("w.z", 0.0), ("q.w'", 0.0)] {
        assert!((rotation.last()[name] - value).abs() < 1e-13, "{name}: {}", rotation.last()[name]);
    }
}

/// Speeds of least energy have their own digits, however stiff what massless points hang on is: the mass stays at rest.
#[test]
fn massless_points_move_no_mass_at_the_start() {
    for (k, c) in [(1e6, 1e3), (1e9, 2e5), (1e7, 1e4), (1e5, 1e-3), (10.0, 2.0)] {
        let run = case(&format!(
            "name: Knots\nparameters: {{m: 1 kg, k: {k:e} N/m, c: {c:e} N*s/m}}\ncoordinates: {{x: m, a: m, b: m}}\n\
             bodies: {{M: {{mass: m, position: '[x, 0]'}}, P: {{mass: 0, position: '[a, 0]'}}, Q: {{mass: 0, position: '[b, 0]'}}}}\n\
             springs: {{s1: {{stretch: x - a, stiffness: k, on: M, from: P, along: '[1, 0]'}}, s2: {{stretch: b, stiffness: 2*k, on: Q, along: '[1, 0]'}}}}\n\
             dampers: {{d: {{rate: a' - b', damping: c, on: P, from: Q, along: '[1, 0]'}}}}\nscene: {{start: {{x: 1}}, until: 0}}\n"
        ))
        .run();
        assert_eq!(run.last()["x'"], 0.0, "{k} {c}");
    }
}

/// Light and heavy bodies share a speed as their masses say, in all digits, and rows that a light one brings near each other are no singular position.
#[test]
fn speeds_at_the_start_have_their_own_digits() {
    let file = |mass: &str, rows: &str| {
        format!(
            "name: Geared\ncoordinates: {{x: 1, y: 1, z: 1}}\nkinetic_energy: {mass}\nconstraints: {{{rows}}}\nscene: {{until: 0}}\n"
        )
    };
    let light = file("x'^2/2 + 1e-12*(y'^2 + z'^2)/2", "a: x' - y' - 2*z', b: y' - z' - 8");
    // λ of the first row is −x': with ε = 1e-12, x' = −8/(9/ε + 2)·(…): by hand −8 ε/(9 + 2 ε).
    let x = case(&light).run().last()["x'"];
    let known = -8e-12 / (9.0 + 2e-12);
    assert!((x / known - 1.0).abs() < 1e-12, "{x:e} {known:e}");
    let heavy = file("x'^2/2 + 1e-6*y'^2/2 + 1e6*z'^2/2", "a: x' + 1e6*y' - 1, b: y' + z' - 2");
    let last = case(&heavy).run().last();
    // y' = y, x' = 1 − 1e6 y and z' = 2 − y with the least energy: (1e12 + 1e-6 + 1e6) y = 1e6 + 2e6.
    let y = 3e6 / (1e12 + 1e-6 + 1e6);
    assert!((last["y'"] / y - 1.0).abs() < 1e-12, "{:e} {y:e}", last["y'"]);
}

/// What a search leaves of a place or a speed that is 0 is not carried through the run.
#[test]
fn what_a_search_leaves_of_zero_is_zero() {
    let run = case(
        "name: Arm\nparameters: {m: 2 kg, l: 1 m, W: 3 rad/s}\ncoordinates: {x: m, y: m, z: m, q: rotation}\nframes: {F: {rotate: q}}\n\
         bodies: {c: {mass: m, inertia: [0.1, 0.2, 0.25], frame: F, position: '[x, y, z]'}}\nconstraints: {p: position(c) - l*F.x}\n\
         scene: {start: {q': [0, 0, W]}, guess: {x: 0.2, y: 1, q: {vector: [0, 0, 1.5]}}, until: 1}\n",
    )
    .run();
    assert_eq!(["z", "q.x", "q.y", "z'", "q.x'", "q.y'"].map(|name| run.last()[name]), [0.0; 6]);
}
