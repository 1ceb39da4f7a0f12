//! What is found when a file is judged: each attack that once succeeded, beside a neighbour that must pass.
//!
//! An attack is a file with one piece in it; the neighbour is the same file with another piece.

use dalembert_symbolic::expr::{Symbol, Tape};
use dalembert_symbolic::lower::compile;

/// The codes and messages of a file.
fn told(text: &str) -> Vec<String> {
    let problems = compile(text, &[]).err().unwrap_or_default();
    problems.iter().map(|problem| format!("{} {}", problem.code, problem.message)).collect()
}

/// The file with `{}` filled by the attack is refused with such a message; filled by the neighbour it passes.
#[track_caller]
fn refused(file: &str, attack: &str, message: &str, neighbour: &str) {
    let found = told(&file.replace("{}", attack));
    assert!(found.iter().any(|line| line.contains(message)), "{attack}: {found:?}");
    let found = told(&file.replace("{}", neighbour));
    assert!(found.is_empty(), "{neighbour}: {found:?}");
}

#[test]
fn the_name_of_a_system_is_a_key() {
    let file = "name: Inject\nparameters: {m: 1 kg}\ncoordinates: {x: m}\nbodies: {a: {mass: m, position: \"[x, 0]\"}}\n\
                balances:\n  \"{}\":\n    equations:\n      - force: {of: [a], along: \"[1, 0]\"}\n";
    refused(file, "a\\nconst _: () = panic!(); //", "E101", "a");
}

#[test]
fn a_wrong_sign_beside_a_stiff_spring() {
    let file = "name: Blind\nparameters: {m: 1 kg, k: 1e13 N/m, l: 1 m, g: 10 m/s^2}\ncoordinates: {x: m, theta: rad}\n\
                bodies:\n  a: {mass: m, position: \"[x, 0]\"}\n  b: {mass: m, position: \"l*[sin(theta), -cos(theta)]\"}\n\
                gravity: [0, -g]\nsprings: {s: {stretch: x, stiffness: k, on: a, along: \"[1, 0]\"}}\n\
                balances:\n  equations:\n    - force: {of: [a], along: \"[1, 0]\"}\n    - equation: \"{}\"\n";
    refused(file, "m*l*theta'' = m*g*sin(theta)", "theta''", "m*l*theta'' = -m*g*sin(theta)");
}

#[test]
fn both_signs_of_a_balance_beside_a_fast_rotor() {
    let file = "name: Spindle\nparameters: {m: 10 kg, F: 0.1 N, c: 0.05 N*s/m, J: 1e-9 kg*m^2, T: 0.01 N*m}\n\
                coordinates: {x: m, phi: rad}\npoints: {o: \"[x, 0]\"}\n\
                bodies:\n  slide: {mass: m, position: o}\n  rotor: {mass: 0, inertia: J, angle: phi, position: o}\n\
                forces: {feed: {on: slide, force: \"[F - c*x', 0]\"}}\ntorques: {drive: {on: rotor, torque: T}}\n\
                balances:\n  by_hand:\n    equations:\n      - equation: \"{}\"\n      - equation: \"J*phi'' = T\"\n\
                scene: {start: {x: 0}, until: 10}\n";
    refused(file, "m*x'' = -F + c*x'", "x''", "m*x'' = F - c*x'");
}

#[test]
fn a_damper_beside_something_a_trillion_times_heavier() {
    let file = "name: Sensor\nparameters: {M: 1000 kg, K: 1e5 N/m, m: 1e-9 kg, k: 1e-3 N/m, c: 1e-6 N*s/m}\n\
                coordinates: {x: m, u: m}\nbodies: {car: {mass: M, position: \"[x, 0]\"}, tip: {mass: m, position: \"[0, u]\"}}\n\
                springs:\n  s: {stretch: x, stiffness: K, along: \"[1, 0]\", on: car}\n  t: {stretch: u, stiffness: k, along: \"[0, 1]\", on: tip}\n\
                {}\nconserved: {energy: energy}\nscene: {start: {x: 0.1, u: 1}, until: 1}\n";
    refused(file, "dampers: {d: {rate: u', damping: c, along: \"[0, 1]\", on: tip}}", "`d` does work", "");
}

/// A mass on a spring whose scene reaches x = 10, with these claims and forces.
fn oscillator(lines: &str) -> String {
    format!(
        "name: Oscillator\nparameters: {{m: 1, k: 1, c: 1, d: 1e-6, e: 0, a: 4}}\ncoordinates: {{x: 1, y: 1}}\n\
         bodies: {{b: {{mass: m, position: \"[x, y]\"}}}}\nsprings: {{s: {{between: [b, ground], stiffness: k}}}}\n{lines}\n\
         scene: {{start: {{x: 0, x': 10, y: 1}}, until: 20}}\n"
    )
}

#[test]
fn a_damper_beyond_a_place_that_the_motion_reaches() {
    let file = oscillator("generalized_forces: {x: \"{}\"}\nconserved: {energy: energy}");
    let (attack, neighbour) = ("-c*x'*step(x - a)", "-c*x*step(x^2 + y^2 + a^2)*0");
    refused(&file, attack, "does work", neighbour);
    refused(&file, "-c*x'*step(x^2 + y^2 - a)*step(a - y^2)", "does work", neighbour);
    refused(&file, "-c*x'*max(0, 1e-3 - abs(x - a))", "does work", neighbour);
    // Right in x and in y at once.
    refused(&file, "-c*x'*max(0, 1e-3 - abs(x - a) - abs(y - 0.3))", "does work", neighbour);
}

#[test]
fn a_damper_in_a_band_of_time() {
    let file = oscillator("generalized_forces: {x: \"{}\"}\nconserved: {energy: energy}");
    refused(&file, "-c*x'*step(t - 2)*step(2.001 - t)", "does work", "0*x'*step(t - 2)");
    refused(&file, "-c*x'*exp(-1e6*(t - 7)^2)", "does work", "0*c");
}

#[test]
fn a_sign_is_not_conserved() {
    refused(&oscillator("conserved: {side: \"{}\"}"), "sign(x)", "not conserved", "sign(x^2 + 1)");
}

#[test]
fn claims_that_hold_near_the_start_only() {
    for (attack, neighbour) in [
        ("energy + exp(-1000*(x - 0.5)^2)", "energy + exp(-1000*(0.5)^2)"),
        ("energy + 1e-9*exp(-1e6*(x - a)^2)", "energy + 1e-9*a"),
        ("energy + max(0, 1e-3 - abs(x - a))", "energy + max(0, 1e-3 - abs(a))"),
        ("energy*(1 + 1e-12*sin(1e6*x))", "energy*(1 + 1e-12*sin(1e6*k))"),
        ("energy + step(t - 14.9)", "energy + step(m)"),
        ("x*y' - (1 + 1e-12)*y*x'", "x*y' - y*x'"),
    ] {
        refused(&oscillator("conserved: {claim: \"{}\"}"), attack, "not conserved", neighbour);
    }
}

#[test]
fn identities_that_hold_on_one_side_only() {
    for (attack, neighbour) in [
        ("min(x, 3.5) = x", "min(x, 3.5) = 3.5 + min(x - 3.5, 0)"),
        ("abs(e) = e", "abs(e) = sqrt(e^2)"),
        ("sqrt(x^2 + d^2) = abs(x)", "sqrt(x^2) = abs(x)"),
        ("atan2(sin(x), cos(x)) = x", "tan(atan2(sin(x), cos(x))) = tan(x)"),
        ("((x+1)^2 - x^2 - 2*x - (1 + 1e-15))*5 = 0", "((x+1)^2 - x^2 - 2*x - 1)*5 = 0"),
        ("step(x*y - 0.3)*step(0.3001 - x*y) = 0", "step(x*y - 0.3)*step(0.3 - x*y - 1) = 0"),
        ("1e12*x - (1e12 - 1e-6)*x = 0", "1e12*x - (1e12 - 1e-6)*x = 1e-6*x"),
    ] {
        refused(&oscillator("checks: {claim: \"{}\"}"), attack, "does not hold", neighbour);
    }
}

#[test]
fn a_molecule_is_tried_at_its_own_size() {
    let file = "name: Molecule\nparameters: {m: 1.6e-27 kg, D: 7e-19 J, a: 2e10 1/m, r0: 1e-10 m}\ncoordinates: {r: m}\n\
                bodies: {p: {mass: m, position: \"[r, 0]\"}}\npotential_energy: D*(1 - exp(-a*(r - r0)))^2\n\
                conserved: {claim: \"{}\"}\nscene: {start: {r: 1.2e-10 m}, until: 1e-13}\n";
    refused(file, "m*r'^2/2", "not conserved", "energy");
    let program = compile(&file.replace("{}", "energy"), &[]).unwrap();
    assert!(program.structure.cyclic.is_empty());
}

#[test]
fn a_motor_that_runs_for_a_while_does_work() {
    let file = "name: Crane\nparameters: {M: 500 kg, m: 2000 kg, L: 8 m, g: 9.81 m/s^2, F0: 3 kN, T: 2 s}\n\
                coordinates: {x: m, theta: rad}\ninputs: {F: F0*(step(t) - step(t - T))}\n\
                points: {trolley_pos: \"[x, 0]\", load_pos: \"trolley_pos + L*[sin(theta), -cos(theta)]\"}\n\
                bodies: {trolley: {mass: M, position: trolley_pos}, load: {mass: m, position: load_pos}}\n\
                gravity: [0, -g]\nforces: {motor: {on: trolley, force: \"[{}, 0]\"}}\n\
                conserved: {energy: energy}\nscene: {start: {x: 0}, until: 20}\n";
    refused(file, "F", "`motor` does work", "0*F");
}

#[test]
fn orbits_are_judged_by_their_own_size() {
    for radius in ["1e-9 m", "7e6 m", "1.496e11 m"] {
        let file = format!(
            "name: Sat\nparameters: {{GM: 3.986e14 m^3/s^2, m: 1000 kg, R: {radius}}}\ncoordinates: {{r: m, phi: rad}}\n\
             bodies: {{p: {{mass: m, position: \"r*[cos(phi), sin(phi)]\"}}}}\npotential_energy: -GM*m/r\n\
             conserved: {{energy: energy, spin: \"{{}}\"}}\nscene: {{start: {{r: R, phi': sqrt(GM/R^3)}}, until: 7*sqrt(R^3/GM)}}\n"
        );
        refused(&file, "m*r^2*phi'*(1 + 1e-12*cos(phi))", "not conserved", "m*r^2*phi'");
        // What stays where it is, but for rounding, is no reason to stop following the motion.
        let program = compile(&file.replace("{}", "m*r^2*phi'"), &[]).unwrap();
        let (_, reached, until) = &program.report.followed[0];
        assert!(reached > &(0.999 * until), "{radius}: {reached} of {until}");
    }
}

#[test]
fn a_redundant_coordinate() {
    let file = "name: Redundant\nparameters: {m: 1 kg, d: 0.3 m}\ncoordinates: {a: rad, b: rad, s: m}\n\
                bodies: {p: {mass: m, position: \"d*[cos(a), sin(a)] + s*[-sin(a + b), cos(a + b)]\"}{}}\n";
    let neighbour = ", q: {mass: m, position: \"d*[cos(b), sin(b)]\"}";
    refused(file, "", "rank 2 of 3", neighbour);
    let far = ", q: {mass: m, position: \"1e-6*d*[cos(a + b), sin(a + b)]\"}";
    assert_eq!(told(&file.replace("{}", far)), Vec::<String>::new());
    refused(file, ", q: {mass: 0*m, position: \"d*[cos(b), sin(b)]\"}", "rank 2 of 3", neighbour);
}

#[test]
fn what_depends_on_speed_or_time_has_no_potential() {
    let file = "name: F\nparameters: {m: 1 kg, N: 3 N, t0: 1 s}\ncoordinates: {x: m}\nkinetic_energy: m*x'^2/2\n\
                generalized_forces: {x: \"{}\"}\nconserved: {energy: energy}\nscene: {start: {x: 1}, until: 3}\n";
    for attack in ["-N*sign(x')", "N*step(t - t0)", "N*step(t0 - t)*step(t - 0.99*t0)"] {
        let problems = compile(&file.replace("{}", attack), &[]).unwrap_err();
        assert!(problems.iter().all(|problem| !problem.help.contains("put it in")), "{attack}: {problems:?}");
    }
    // A constant force has one, and the error says so; without any, energy is conserved.
    let constant = compile(&file.replace("{}", "N"), &[]).unwrap_err();
    assert!(constant.iter().any(|problem| problem.help.contains("potential_energy")), "{constant:?}");
    refused(file, "N", "does work", "0*N");
}

#[test]
fn primes_that_yaml_folds() {
    let file = "name: Y\nparameters: {m: 1, k: 2}\ncoordinates: {x: 1}\nkinetic_energy: m*x'^2/2\n\
                potential_energy: k*x^2/2\noutputs: {acc: {}}\n";
    refused(file, "'x'' + 0'", "E017", "\"x'' + 0\"");
}

#[test]
fn a_partial_derivative_by_time_of_what_moves() {
    let file = "name: D\nparameters: {m: 1 kg, d: 1 m, c: 1 N*s/m}\ncoordinates: {x: m}\nbodies: {a: {mass: m, position: \"[x, 0]\"}}\n\
                dampers: {d: {rate: \"{}\", damping: c, on: a, along: \"[1, 0]\"}}\n";
    refused(file, "diff(x, t)", "E234", "rate(x)");
    refused(file, "2*diff(x, t)", "E234", "x'");
    refused(file, "diff(sqrt(x^2 + d^2), t)", "E234", "x'");
}

/// A wrong unit and a wrong output beside a wrong balance: all are told, in the order of the file.
/// Equations whose units do not fit, and claims that are not as meant, are not judged besides.
#[test]
fn what_follows_from_a_mistake_is_not_told() {
    let file = |more: &str| {
        format!(
            "name: Push\nparameters: {{m: 1 kg, F: 1 N, T: 2 N}}\ncoordinates: {{x: m}}\n\
             bodies: {{a: {{mass: m, position: \"[x, 0]\"}}}}\nforces: {{push: {{on: a, force: \"[F, 0]\"}}}}\n{more}\n"
        )
    };
    let codes = |more: &str| told(&file(more)).into_iter().map(|line| line[..4].to_owned()).collect::<Vec<String>>();
    assert_eq!(codes("conserved: {energy: {value: energy, when: {F: 0}}}"), [""; 0]);
    assert_eq!(codes("conserved: {energy: {value: energy, when: {T: 0}}}"), ["E509"]);
    assert_eq!(codes("conserved: {energy: {value: energy, when: {Fo: 0}}}"), ["E201"]);
    assert_eq!(codes("balances: {equations: [{equation: \"m*x'' = 2*F\"}]}"), ["E506"]);
    assert_eq!(codes("balances: {equations: [{equation: \"m*x'' = F*x\"}]}"), ["E241"]);
    // Another claim is.
    let two = "conserved: {energy: {value: energy, when: {Fo: 0}}, momentum: m*x'}";
    assert_eq!(codes(two), ["E201", "E509"]);
}

/// What is conserved where one mass is three times another: at every mass that is drawn, and watched where it is so up to rounding.
#[test]
fn a_condition_on_one_parameter_goes_by_the_values_of_others() {
    let file = |when: &str| {
        format!(
            "name: Pair\nparameters: {{m: 1 kg, M: 3 kg, k: 7 N/m}}\ncoordinates: {{x: m, y: m}}\n\
             bodies: {{a: {{mass: m, position: \"[x, 0]\"}}, b: {{mass: M, position: \"[y, 0]\"}}}}\n\
             springs: {{s: {{stretch: x - y, stiffness: k, along: \"[1, 0]\", on: a, from: b}}}}\n\
             conserved: {{drift: {{value: x' + 3*y', when: {{{when}}}}}}}\n"
        )
    };
    for when in ["M: 3*m", "M: 3, m: 1", "m: M/3, k: 2"] {
        assert_eq!(told(&file(when)), [""; 0], "{when}");
    }
    for when in ["M: 2*m", "M: 3"] {
        assert!(told(&file(when))[0].starts_with("E509"), "{when}");
    }
    assert!(told(&file("m: 2, M: 3*m"))[0].starts_with("E465"));
    let program = compile(&file("M: 3*m"), &[]).unwrap();
    let drift = |masses: [f64; 2]| {
        let value = |symbol: Symbol| if let Symbol::Parameter(place) = symbol { masses[place as usize] } else { 1.0 };
        Tape::new(&program.model.graph, &program.invariants[..1]).evaluate(value)[0]
    };
    assert_eq!([drift([1.0, 3.0]), drift([0.1, 0.3])], [4.0, 4.0]);
    assert!(!drift([0.1, 0.300_000_1]).is_finite());
}

#[test]
fn independent_mistakes_are_told_together() {
    let file = "name: Both\nparameters: {m: 1 kg, l: 1 m, g: 10 m/s^2}\ncoordinates: {theta: rad}\n\
                bodies: {b: {mass: m, position: \"l*[sin(theta), -cos(theta)]\"}}\ngravity: [0, -g]\n\
                balances:\n  equations:\n    - equation: \"m*l*theta'' = m*g*sin(theta)\"\n\
                conserved: {energy: energy + l}\noutputs: {tip: l*sin(thta)}\n";
    let codes = |text: &str| told(text).iter().map(|line| line[..4].to_owned()).collect::<Vec<_>>();
    let found = codes(file);
    assert_eq!((found[0].as_str(), found[2].as_str(), found.len()), ("E506", "E201", 3), "{found:?}");
    assert!(found[1].starts_with("E24"), "{found:?}");
    let mended = file.replace("= m*g", "= -m*g").replace("energy + l", "energy").replace("thta", "theta");
    assert_eq!(codes(&mended), Vec::<String>::new());
    // Each mistake alone is told alone.
    assert_eq!(codes(&file.replace("energy + l", "energy").replace("thta", "theta")), ["E506"]);
}

/// The limits of deriving, each at the entry with which it is passed, beside a file within it.
#[test]
fn limits_are_announced_where_they_are_passed() {
    let file = |n: usize, lines: &str| {
        format!(
            "name: Large\nsizes: {{n: {n}}}\nparameters: {{m: 1 kg, d: 1 m, F: 1 N}}\ncoordinates: {{x: m}}\n\
             bodies: {{b: {{mass: m, position: \"[x, 0]\"}}}}\n{lines}\n"
        )
    };
    let two = "forces:\n  near: {on: b, force: \"[-F*sum(step(x - i*d), i in 1..600), 0]\"}\n  \
               far: {on: b, force: \"[-F*sum(step(x + i*d), i in 1..n), 0]\"}";
    let problems = compile(&file(600, two), &[]).unwrap_err();
    let place = dalembert_symbolic::file::locate(&file(600, two), &[&problems[0].place])[0].start;
    assert_eq!(problems[0].code, "E421");
    assert!(file(600, two)[place..].starts_with("{on: b, force: \"[-F*sum(step(x +"), "{problems:?}");
    assert_eq!(told(&file(400, two)), Vec::<String>::new());
    let many = "potential_energy: \"F*sum(abs(x - i*d), i in 1..n)\"";
    assert_eq!(compile(&file(100_000, many), &[]).unwrap_err()[0].code, "E421");
    // Rows of constraints count with the coordinates that they couple.
    let rods = |n: usize| {
        format!(
            "name: Rods\nsizes: {{n: {n}}}\nparameters: {{m: 1 kg, d: 1 m}}\ncoordinates: {{\"x[i in 1..n]\": m}}\n\
             bodies: {{\"b[i in 1..n]\": {{mass: m, position: \"[x[i], 0]\"}}}}\n\
             constraints: {{\"c[i in 2..n]\": \"x[i] - x[i-1] - d\"}}\n"
        )
    };
    assert_eq!(compile(&rods(202), &[]).unwrap_err()[0].code, "E422");
    assert_eq!(told(&rods(20)), Vec::<String>::new());
}

/// A large diagonal mass matrix is divided by, not factored as a full triangle; a constant one is factored once per run; a large
/// full one is not on the stack.
#[test]
fn large_mass_matrices_need_no_stack() {
    let file = |n: usize, position: &str| {
        format!(
            "name: Large\nsizes: {{n: {n}}}\nparameters: {{m: 1 kg, L: 1 m}}\ncoordinates: {{\"x[i in 1..n]\": m}}\n\
             define: {{\"s[0]\": \"0*x[1]\", \"s[i in 1..n]\": \"s[i-1] + x[i]\"}}\n\
             bodies: {{\"b[i in 1..n]\": {{mass: m, position: \"[{position}, 0]\"}}}}\n"
        )
    };
    let printed = |text: &str| {
        let program = compile(text, &[]).unwrap();
        dalembert_symbolic::print::rust(&program, text, "Large")
    };
    assert!(!printed(&file(1500, "x[i]")).contains("packed"));
    assert!(printed(&file(130, "s[i]")).contains("let mut packed = ::std::vec!["));
    assert!(!printed(&file(40, "s[i]")).contains("packed"));
    assert!(printed(&file(40, "s[i]*cos(s[40]/L)")).contains("let mut packed = ["));
    // Velocities that are shared between neighbours are eliminated one by one.
    assert!(!printed(&file(40, "s[i]*cos(x[1]/L)")).contains("packed"));
}

/// What may be shifted in the motion of three masses on a line with this potential and these forces.
fn shifts(potential: &str, forces: &str) -> Vec<Vec<(usize, i64)>> {
    let file = format!(
        "name: Line\nparameters: {{m: 1 kg, k: 1e6 N/m, e: 1e-6 N/m, c: 0.1 N*s/m, l: 1 m}}\ncoordinates: {{x: m, y: m, z: m}}\n\
         kinetic_energy: m*(x'^2 + 2*y'^2 + 3*z'^2)/2\npotential_energy: {potential}\n\
         generalized_forces: {{{forces}}}\nscene: {{start: {{x: 1, y: 2, z: 4}}, until: 3}}\n"
    );
    let program = compile(&file, &[]).unwrap_or_else(|problems| panic!("{problems:?}"));
    program.structure.directions.iter().map(|direction| direction.shift.clone()).collect()
}

#[test]
fn directions_along_which_nothing_changes_are_found() {
    let all = vec![vec![(0, 1), (1, 1), (2, 1)]];
    assert_eq!(shifts("k*((x - y)^2 + (y - z)^2)/2", ""), all);
    // Dampers between them.
    assert_eq!(shifts("k*((x - y)^2 + (y - z)^2)/2", "x: \"-c*(x' - y')\", y: \"-c*(y' - x')\""), all);
    // Beside a cyclic coordinate, and in other ratios than 1 : 1.
    assert_eq!(shifts("k*(x - y)^2/2", ""), [vec![(0, 1), (1, 1)]]);
    assert_eq!(shifts("k*((2*x - 3*y)^2 + e/k*(2*x - z)^2)/2", ""), [vec![(0, 3), (1, 2), (2, 6)]]);
    assert_eq!(shifts("k*(x - y)^2/2 + e*(x + y - 2*z)^4/l^2", ""), all);
}

/// Three links turn about a pin: at a state in which only the first one does, what the rows leave is rounding.
#[test]
fn what_turns_as_a_whole_is_found_without_a_scene() {
    let links = |last: &str| {
        let file = format!(
            "name: Links\nparameters: {{m: 1 kg, L: 1 m}}\ncoordinates: {{a: rad, b: rad, c: rad}}\n\
             points: {{q: \"L*[cos(a), sin(a)]\", r: \"q + L*[cos(b), sin(b)]\", s: \"r + L*[cos(c), sin(c)]\"}}\n\
             bodies: {{B: {{mass: m, position: q}}, C: {{mass: m, position: r}}, E: {{mass: {last}, position: s}}}}\n"
        );
        let program = compile(&file, &[]).unwrap_or_else(|problems| panic!("{problems:?}"));
        program.structure.directions.iter().map(|direction| direction.shift.clone()).collect::<Vec<_>>()
    };
    for last in ["m", "2*m", "1e-9*m", "1e9*m"] {
        assert_eq!(links(last), [[(0, 1), (1, 1), (2, 1)]], "{last}");
    }
}

#[test]
fn directions_along_which_little_changes_are_not_ignorable() {
    assert!(shifts("k*((x - y)^2 + (y - z)^2)/2 + 1e-7*e*z^2", "").is_empty());
    assert!(shifts("k*((x - y)^2 + (y - z)^2)/2", "z: \"-1e-12*c*z'\"").is_empty());
    assert!(shifts("k*((x - y)^2 + (y - (1 + 1e-15)*z)^2)/2", "").is_empty());
    assert!(shifts("k*((x - y)^2 + (y - z)^2)/2", "x: \"-c*(x' - y')\", y: \"-(1 + 1e-14)*c*(y' - x')\"").is_empty());
}

/// A mass in the plane with this table, which says something on a narrow piece only, and these lines.
fn narrow(smooth: u8, unit: &str, lines: &str) -> String {
    format!(
        "name: Narrow
tables: {{p: {{points: [[0, 0], [7, 0], [7.01, 3], [7.02, 0], [20, 0]], units: [m, {unit}], smooth: {smooth}}}}}
parameters: {{m: 1 kg, k: 1 N/m, L: 1 m}}
coordinates: {{x: m, y: m}}
bodies: {{b: {{mass: m, position: \"[x, y]\"}}}}
{lines}
scene: {{start: {{x: 1, y': 1}}, until: 3}}
"
    )
}

#[test]
fn claims_are_tested_between_the_points_of_tables() {
    let file = narrow(0, "N", "forces: {f: {on: b, force: \"[p(x), 0]\"}}\nconserved: {momentum: m*{}}");
    refused(&file, "x'", "`momentum`", "y'");
    let file = narrow(0, "N*s/m", "forces: {f: {on: b, force: \"[-p(x)*x', 0]\"}}\nconserved: {{}}");
    refused(&file, "energy: energy", "`energy`", "momentum: m*y'");
    let file = narrow(0, "1", "checks: {c: \"{} = 0\"}");
    refused(&file, "p(x)", "`c` does not hold", "p(x)*(x - x)");
    let file = narrow(
        0,
        "N",
        "forces: {f: {on: b, force: \"[p(x), 0]\"}}\nbalances: {equations: [{equation: \"{}\"}, {equation: \"m*y'' = 0\"}]}",
    );
    refused(&file, "m*x'' = -p(x)", "E5", "m*x'' = p(x)");
}

#[test]
fn a_potential_by_a_table_is_not_cyclic() {
    let cyclic = |lines: &str| {
        let program = compile(&narrow(1, "J", lines), &[]).expect("a good file");
        program.structure.cyclic.iter().map(|(i, _)| *i).collect::<Vec<_>>()
    };
    assert_eq!(cyclic("potential_energy: p(x)"), [1]);
    assert_eq!(cyclic("potential_energy: p(y)"), [0]);
}

#[test]
fn two_narrow_functions_at_once() {
    let file = narrow(0, "1", "checks: {c: \"exp(-1e3*(x/L - 50)^2)*{} = 0\"}");
    refused(&file, "exp(-1e3*(y/L - 30)^2)", "`c` does not hold", "(x - x)");
    refused(&file, "p(y)", "`c` does not hold", "(p(y) - p(y))");
    // However narrow they are: what is known of each to 1e-18 is known of their product.
    let file = narrow(0, "1", "checks: {c: \"exp(-{k}*(x/L - 50)^2)*exp(-{k}*(y/L - 30)^2){} = 0\"}");
    for k in ["1e5", "1e6"] {
        refused(&file.replace("{k}", k), "", "`c` does not hold", "*(x - x)");
    }
}

#[test]
fn wedges_between_slanted_discontinuities() {
    let file = narrow(0, "1", "checks: {c: \"step(x/L - 2)*step(y/L - 2)*step(x/L - y/L - 5)*step({}) = 0\"}");
    refused(&file, "3*y/L - x/L", "`c` does not hold", "y/L - x/L");
}

#[test]
fn a_cosine_undone_is_no_absolute_value() {
    let file = narrow(0, "1", "checks: {c: \"{}\"}");
    refused(&file, "acos(cos(x/L)) = abs(x/L)", "`c` does not hold", "cos(acos(cos(x/L))) = cos(x/L)");
    refused(&file, "atan(tan(x/L)) = x/L", "`c` does not hold", "tan(atan(x/L)) = x/L");
}

#[test]
fn what_underflows_does_not_differ_by_nothing() {
    let file = narrow(0, "1", "checks: {c: \"{} = 0\"}");
    let nothing = "((sin(x/L)^64)^64)^64*((cos(3*x/L)^64)^64)^64";
    refused(&file, "sin(x/L)^4*cos(3*x/L)^4", "`c` does not hold", nothing);
    refused(&file, "(sin(x/L)^64)^64*(cos(3*x/L)^64)^64", "`c` does not hold", nothing);
}

#[test]
fn a_reaction_on_a_particle_acts_at_the_particle() {
    let file = narrow(
        0,
        "1",
        "constraints: {floor: y}\n\
         balances: {equations: [{force: {of: [b]}}], reactions: {N: {on: b, at: \"{}\", along: \"[0, 1]\"}}}",
    );
    let file = file.replace("y': 1", "x': 1");
    refused(&file, "[7*L, 0]", "the particle `b` takes forces at its own position only", "[x, y]");
    refused(&file, "[2*x, y]", "the particle `b` takes forces at its own position only", "[2*x - x, y]");
}

/// The last of a row of masses begins as a high power of time, the last body of a chain of rotations likewise: their errors are parts of
/// their own ranges however short the step.
#[test]
fn a_motion_that_reaches_the_last_of_a_chain_late_is_followed() {
    let row = "name: Row\nsizes: {n: 7}\nparameters: {m: 1 kg, k: 100 N/m}\ncoordinates: {\"x[i in 1..n]\": m}
points: {\"P[i in 1..n]\": \"[x[i], 0]\"}\nbodies: {\"b[i in 1..n]\": {mass: m, position: \"P[i]\"}}
springs: {\"s[i in 2..n]\": {stretch: \"x[i] - x[i-1]\", stiffness: k}}\nconserved: {energy: energy}
scene: {start: {\"x[1]\": 0.1}, until: 2}\n";
    let bodies = "name: Bodies\nsizes: {n: 3}\nparameters: {m: 1 kg, l: 0.5 m, g: 9.81 m/s^2}\ncoordinates: {\"r[i in 1..n]\": rotation}
frames: {\"B[i in 1..n]\": {rotate: \"r[i]\"}}\npoints: {\"P[0]\": [0, 0, 0], \"P[i in 1..n]\": \"P[i-1] - l*B[i].z\"}
bodies: {\"b[i in 1..n]\": {mass: m, inertia: [0.02, 0.03, 0.01], frame: \"B[i]\", position: \"(P[i-1] + P[i])/2\"}}
gravity: [0, 0, -g]\nconserved: {energy: energy}
scene: {start: {\"r[1]\": [[x, 1]], \"r[2]'\": [0.1, 2, 0]}, until: 2}\n";
    for text in [row, bodies] {
        let program = compile(text, &[]).unwrap_or_else(|problems| panic!("{problems:?}"));
        let (scene, reached, until) = &program.report.followed[0];
        assert!(reached > &(0.2 * until), "{scene}: {reached} of {until}");
    }
}
