//! What is refused: the code, and the words under the caret.

use dalembert_symbolic::diagnose::Problem;
use dalembert_symbolic::file::locate;
use dalembert_symbolic::model::load;

/// The problems of a file: code and the words that are marked.
fn marked(text: &str) -> Vec<(&'static str, String)> {
    let problems = load(text, &[]).err().unwrap_or_default();
    marks(text, &problems)
}

fn marks(text: &str, problems: &[Problem]) -> Vec<(&'static str, String)> {
    let places: Vec<_> = problems.iter().map(|problem| &problem.place).collect();
    let ranges = locate(text, &places);
    problems.iter().zip(ranges).map(|(problem, range)| (problem.code, text[range].to_owned())).collect()
}

const BASE: &str = "name: Test
sizes: {n: 3}
parameters: {m: 1 kg, l: 1 m, w: 1 rad/s, k: 2*m, \"c[i in 1..n]\": 1}
coordinates: {x: m, y: m, phi: rad, \"q[i in 1..n]\": m}
inputs: {u: sin(w*t)}
points: {P: \"[x, y]\", O: \"[0, 0]\"}
bodies:
  bead: {mass: m, position: P}
  rod: {mass: m, inertia: 1, angle: phi, position: P}
";

/// One problem with this code at these words.
#[track_caller]
fn refused(more: &str, code: &str, words: &str) {
    let text = format!("{BASE}{more}\n");
    assert_eq!(marked(&text), [(code, words.to_owned())], "{more}");
}

#[test]
fn names() {
    refused("define: {a: x + thta}", "E201", "thta");
    refused("define: {a: 2*X}", "E201", "X");
    refused("define: {x: 1}", "E202", "x");
    refused("define: {rod: 1}", "E202", "rod");
    refused("define: {t: 1}", "E203", "t");
    refused("define: {energy: 1}", "E203", "energy");
    refused("define: {sin: 1}", "E203", "sin");
    refused("define: {a: \"sum(m, m in 1..2)\"}", "E204", "m");
    refused("define: {\"a[m in 1..2]\": 1}", "E204", "m");
    refused("define: {a: \"integral(x^2, x in 0..1)\"}", "E204", "x");
    refused("define: {\"a[1]\": 1, \"a[i in 1..2]\": 2}", "E205", "\"a[i in 1..2]\"");
    refused("define: {a: foo(x)}", "E206", "foo");
    refused("define: {a: sinus(x)}", "E206", "sinus");
    refused("define: {a: \"sin(x, y)\"}", "E207", "sin(x, y)");
    refused("define: {a: min(x)}", "E207", "min(x)");
    refused("define: {a: b, b: c_, c_: a}", "E217", "b");
    refused("define: {a: 1 + a}", "E217", "1 + a");
    refused("define: {\"a[i in 1..3]\": \"a[mod(i, 3) + 1]\"}", "E217", "\"a[mod(i, 3) + 1]\"");
    refused("define: {a: \"q[4]\"}", "E218", "4");
    refused("define: {a: \"sum(q[i], i in 0..n)\"}", "E218", "i");
    refused("define: {a: q}", "E219", "q");
    refused("define: {a: \"q[1, 2]\"}", "E219", "q[1, 2]");
    refused("define: {a: \"x[1]\"}", "E220", "x[1]");
    refused("define: {a: \"q[x]\"}", "E221", "x");
    refused("define: {a: \"q[1/2]\"}", "E221", "1/2");
    refused("define: {a: \"q[1.5]\"}", "E221", "1.5");
    refused("define: {a: P'}", "E226", "P'");
    refused("define: {a: m'}", "E226", "m'");
    refused("define: {a: rod.z}", "E227", "rod.z");
    refused("define: {a: length}", "E228", "length");
    refused("define: {a: 2*energy}", "E228", "energy");
    refused("define: {a: x^65}", "E230", "x^65");
    refused("define: {a: 1/(n - 3)}", "E231", "(n - 3)");
    refused("define: {a: sqrt(-1)}", "E231", "sqrt(-1)");
    refused("define: {a: \"diff(x, x + y)\"}", "E232", "x + y");
    refused("define: {a: \"diff(x, k)\"}", "E232", "k");
    refused("define: {a: bead.x}", "E225", "bead");
}

#[test]
fn kinds() {
    refused("define: {a: \"[1, 2, 3]\"}", "E209", "[1, 2, 3]");
    refused("define: {a: \"P + 1\"}", "E212", "P + 1");
    refused("define: {a: P*P}", "E212", "P*P");
    refused("define: {a: 1/P}", "E212", "1/P");
    refused("define: {a: P^2}", "E212", "P^2");
    refused("define: {a: sin(P)}", "E208", "P");
    refused("define: {a: \"dot(P, 1)\"}", "E208", "1");
    refused("define: {a: velocity(x)}", "E208", "x");
    refused("define: {a: \"velocity(bead, P)\"}", "E406", "bead");
    refused("define: {a: angular_velocity(bead)}", "E406", "bead");
    refused("define: {a: angular_velocity(P)}", "E224", "P");
    refused("gravity: 9.81", "E211", "9.81");
    refused("kinetic_energy: velocity(P)", "E210", "velocity(P)");
    refused("define: {a: \"[P, 1]\"}", "E210", "P");
    refused("define: {a: x.y}", "E211", "x");
}

#[test]
fn another_name_that_is_offered_is_free() {
    for (more, offered) in [
        ("define: {length: 1}", "`l_`"),
        ("define: {energy: 1}", "`E`"),
        ("outputs: {E: x}\ndefine: {energy: 1}", "`E_`"),
    ] {
        let problems = load(&format!("{BASE}{more}\n"), &[]).err().unwrap_or_default();
        assert!(
            matches!(problems.as_slice(), [one] if one.code == "E203" && one.help.ends_with(offered)),
            "{problems:?}"
        );
    }
}

#[test]
fn a_gap_opens_along_its_normal_without_friction_too() {
    let wall = |normal: &str| format!("{{gap: x, on: bead, at: bead, normal: \"{normal}\"}}");
    assert_eq!(marked(&format!("{BASE}contacts: {{wall: {}}}\n", wall("[1, 0]"))), []);
    for normal in ["[-1, 0]", "[0, 1]"] {
        let wall = wall(normal);
        refused(&format!("contacts: {{wall: {wall}}}"), "E462", &wall);
        // Where nobody says at which point it acts, the gap tells what it does.
        let nowhere = wall.replace("at: bead, ", "");
        assert_eq!(marked(&format!("{BASE}contacts: {{wall: {nowhere}}}\n")), []);
    }
}

#[test]
fn what_may_depend_on_what() {
    refused("potential_energy: x'", "E213", "x'");
    refused("contacts: {wall: {gap: x', on: bead, normal: \"[1, 0]\"}}", "E213", "x'");
    refused("potential_energy: norm(velocity(P))", "E213", "velocity(P)");
    refused("kinetic_energy: x''", "E214", "x''");
    refused("generalized_forces: {x: rate(x')}", "E214", "rate(x')");
    refused("dissipation: norm(acceleration(P))", "E214", "acceleration(P)");
    refused("conserved: {a: x''}", "E214", "x''");
    refused("outputs: {a: rate(x'')}", "E214", "rate(x'')");
    refused("frames: {f: {angle: phi'}}", "E213", "phi'");
    refused("define: {v: x'}\npotential_energy: v^2", "E213", "v");
    refused("springs: {s: {between: [P, O], stiffness: x}}", "E215", "x");
    refused("scene: {start: {x: y}}", "E215", "y");
    refused("scene: {until: t}", "E216", "t");
    refused("gravity: [0, x]", "E215", "x");
    refused("gravity: [0, u']", "E215", "u'");
}

#[test]
fn sections() {
    refused("cordinates: {}", "E301", "cordinates");
    refused("springs: {s: {betwen: [P, O], stiffness: 1}}", "E301", "betwen");
    refused("balances: {equations: []}", "E414", "balances");
    refused("balances: {a: {equations: [], reactions: {h: {on: rod, at: P}}}}\noutputs: {h: h}", "E414", "a");
    refused("define: {a: }", "E303", "a");
    refused("define: {a: {b: 1}}", "E304", "{b: 1}");
    refused("define: [1, 2]", "E304", "[1, 2]");
    refused("events: {e: {when: x, direction: up, then: stop}}", "E307", "up");
    refused("events: {e: {when: x, then: stopp}}", "E307", "stopp");
    refused("events: {e: {then: stop}}", "E302", "e");
    refused("scene: {start: {z: 1}}", "E410", "z");
    refused("scene: {start: {xx: 1}}", "E410", "xx");
    refused("scene: {start: {m: 1}}", "E224", "m");
    refused("scene: {start: {x'': 1}}", "E410", "x''");
    refused("scene: {start: {\"q[i in 1..3]\": [1, 2]}}", "E308", "[1, 2]");
    refused("scene: {start: {\"q[4]\": 1}}", "E218", "\"q[4]\"");
    refused("scene: {set: {k: 1}}", "E409", "k");
    refused("scene: {set: {mm: 1}}", "E201", "mm");
    refused("scene: {tolerance: 0}", "E411", "0");
    refused("scene: {until: -1/w}", "E411", "-1/w");
    refused("scenes: {a: {strat: {x: 1}}}", "E301", "strat");
    refused("equilibrium: {z: 1}", "E410", "z");
    refused("sample: {x: 1}", "E304", "1");
    refused("draw: [{lin: [P, O]}]", "E301", "lin");
    refused("draw: [{circle: {at: P}}]", "E302", "circle");
    refused("draw: [{line: [P, O], each: i in 1..x}]", "E221", "x");
    refused("draw: [{line: [P, \"[i, kk]\"], each: i in 1..3}]", "E201", "kk");
    refused("draw: [{line: [P, O], each: m in 1..3}]", "E204", "m in 1..3");
    refused("draw: [{curve: \"[s, s^2]\"}]", "E302", "curve");
    refused("checks: {a: \"x = P\"}", "E212", "x = P");
    refused("define: {a: x = y}", "E115", "=");
}

#[test]
fn loads() {
    refused("forces: {f: {on: P, force: [1]}}", "E113", "[1]");
    refused("forces: {f: {on: P, force: 1}}", "E211", "1");
    refused("forces: {f: {on: rod}}", "E302", "f");
    refused("forces: {f: {on: \"[2*x, y]\", force: [1, 0]}}", "E404", "\"[2*x, y]\"");
    refused("forces: {f: {on: bead, at: \"P + [l, 0]\", force: [1, 0]}}", "E405", "\"P + [l, 0]\"");
    refused("forces: {f: {on: P, at: O, force: [1, 0]}}", "E224", "P");
    refused("torques: {f: {on: bead, torque: 1}}", "E406", "bead");
    refused("torques: {f: {on: rod, torque: P}}", "E210", "P");
    refused("springs: {s: {between: [P], stiffness: 1}}", "E308", "[P]");
    refused("springs: {s: {between: [P, P], stiffness: 1}}", "E413", "[P, P]");
    refused("springs: {s: {between: [P, O]}}", "E306", "s");
    refused("springs: {s: {stiffness: 1}}", "E306", "s");
    refused("springs: {s: {between: [P, O], stiffness: 1, energy: 1}}", "E305", "energy");
    refused("springs: {s: {stretch: phi, stiffness: 1, on: bead}}", "E406", "bead");
    refused("springs: {s: {stretch: phi, stiffness: 1, from: rod}}", "E311", "from");
    refused("dampers: {s: {between: [P, O]}}", "E302", "s");
    refused("dampers: {s: {between: [P, \"[2*x, y]\"], damping: 1}}", "E404", "\"[2*x, y]\"");
    refused("generalized_forces: {z: 1}", "E201", "z");
    refused("generalized_forces: {m: 1}", "E224", "m");
}

#[test]
fn constraints() {
    let c = "constraints: {floor: y - l, roll: x' - l*phi', \"h[i in 1..n]\": \"q[i] - x\"}";
    let refused_beside = |more: &str, code: &str, words: &str| refused(&format!("{c}\n{more}"), code, words);
    refused("outputs: {force: reaction(c)}", "E235", "c");
    refused_beside("outputs: {force: reaction(flor)}", "E235", "flor");
    refused_beside("outputs: {force: reaction(x + y)}", "E224", "x + y");
    refused_beside("outputs: {force: \"reaction(h[4])\"}", "E218", "4");
    refused_beside("outputs: {force: reaction(h)}", "E219", "h");
    refused_beside("outputs: {force: reaction(floor).x}", "E211", "reaction(floor)");
    refused_beside("outputs: {force: rate(reaction(floor))}", "E237", "rate(reaction(floor))");
    for (more, words) in [
        ("springs: {s: {between: [P, O], tension: reaction(floor)}}", "reaction(floor)"),
        ("dampers: {s: {rate: x', damping: reaction(floor)}}", "reaction(floor)"),
        ("generalized_forces: {x: reaction(floor)}", "reaction(floor)"),
        ("potential_energy: l*reaction(floor)", "reaction(floor)"),
        ("conserved: {a: reaction(floor)}", "reaction(floor)"),
        ("define: {n_: reaction(floor)}\nkinetic_energy: n_*l", "n_"),
        ("scene: {until: reaction(floor)}", "reaction(floor)"),
        ("gravity: \"[0, reaction(floor)/m]\"", "reaction(floor)"),
    ] {
        refused_beside(more, "E237", words);
    }
    refused("constraints: {a: x - reaction(a)*l}", "E237", "reaction(a)");
    for force in
        ["abs(reaction(floor))", "max(0, reaction(floor))", "sign(reaction(floor))", "reaction(floor)*reaction(roll)"]
    {
        let more = format!("torques: {{t: {{on: rod, torque: \"l*{force}\"}}}}");
        let words = if force.contains(")*") { format!("l*{force}") } else { force.to_owned() };
        let found = marked(&format!("{BASE}{c}\n{more}\n"));
        assert_eq!(found, [("E238", words)], "{force}");
    }
    refused_beside("forces: {f: {on: rod, force: P/reaction(floor)}}", "E238", "P/reaction(floor)");
    refused("constraints: {a: x - abs(y)}", "E239", "abs(y)");
    refused("constraints: {a: \"x' - max(0, t*l*w^2 - l*w)\"}", "E239", "max(0, t*l*w^2 - l*w)");
    refused("define: {s: step(x)}\nconstraints: {a: y - l*s}", "E239", "s");
    refused("constraints: {a: x''}", "E214", "x''");
    refused("constraints: {a: x + phi}", "E241", "phi");
    refused("constraints: {a: P = 1}", "E212", "P = 1");
    refused("constraints: {a: x, \"a[1]\": y}", "E310", "\"a[1]\"");
    refused("constraints: {\"a[1]\": x, \"a[i in 1..2]\": y}", "E310", "\"a[i in 1..2]\"");
    refused("constraints: {a: }", "E303", "a");
    refused("constraints: {a: {b: x}}", "E304", "{b: x}");
    refused("constraints: {sin: x}\noutputs: {f: l}", "E203", "sin");
    refused("constraints: {a: l}", "E423", "l");
    refused("constraints: {a: l - t*l*w}", "E423", "l - t*l*w");
    refused("constraints: {a: [x, l]}", "E423", "[x, l]");
    refused(
        "constraints: {a: \"(x + y)^2 - x^2 - 2*x*y - y^2 + l^2\"}",
        "E423",
        "\"(x + y)^2 - x^2 - 2*x*y - y^2 + l^2\"",
    );
    // What is 0 whatever the motion follows from the others: that is a warning of the gate.
    for zero in ["0", "[x, 0]", "\"(x + y)^2 - x^2 - 2*x*y - y^2\"", "\"sum(q[i], i in 1..0)\"", "\"x'^2 - x'*x'\""] {
        assert_eq!(marked(&format!("{BASE}constraints: {{a: {zero}}}\n")), []);
    }
    refused("constraints: {a: x'*y' - l^2*w^2}", "E424", "x'*y' - l^2*w^2");
    refused("constraints: {a: norm(velocity(P)) - l*w}", "E424", "norm(velocity(P)) - l*w");
    refused("constraints: {a: x*w - l*u'}", "E425", "x*w - l*u'");
}

#[test]
fn phases_and_starts() {
    let c = "constraints: {floor: y - l, roll: x' - l*phi', wall: x}
phases: {slide: [floor], \"roll[i in 1..2]\": [floor, roll], flight: []}";
    let refused_beside = |more: &str, code: &str, words: &str| refused(&format!("{c}\n{more}"), code, words);
    let idle = "constraints: {floor: y - l}\n";
    refused(&format!("{idle}phases: {{}}"), "E317", "phases");
    refused(&format!("{idle}phases: {{a: }}"), "E303", "a");
    refused(&format!("{idle}phases: {{a: floor}}"), "E304", "floor");
    refused(&format!("{idle}phases: {{a: [flor]}}"), "E235", "flor");
    refused(&format!("{idle}phases: {{a: [floor, floor]}}"), "E316", "floor");
    refused(&format!("{idle}phases: {{stop: [floor]}}"), "E203", "stop");
    refused(&format!("{idle}phases: {{\"a[1]\": [floor], \"a[i in 1..2]\": []}}"), "E310", "\"a[i in 1..2]\"");
    refused("phases: {a: [x]}", "E235", "x");
    let ticks = "noise: {gust: {every: 1 s, sigma: 1 N}}\nevents: {gust: {every: 1 s, then: record}}";
    refused(ticks, "E310", "gust");
    for entry in [
        "springs: {s: {between: [P, O], stiffness: 1, PHASE}}",
        "dampers: {s: {between: [P, O], damping: 1, PHASE}}",
        "forces: {s: {on: rod, force: \"[1, 0]\", PHASE}}",
        "torques: {s: {on: rod, torque: 1, PHASE}}",
        "events: {s: {when: x, then: stop, PHASE}}",
        "conserved: {s: {value: x, PHASE}}",
        "checks: {s: {holds: x = y, PHASE}}",
        "scene: {PHASE}",
        "scenes: {late: {PHASE}}",
    ] {
        let with = |phase: &str| entry.replace("PHASE", phase);
        refused(&with("phase: slide"), "E315", "phase");
        refused_beside(&with("phase: slid"), "E236", "slid");
        refused_beside(&with("phase: \"roll[3]\""), "E218", "3");
        if !entry.starts_with("scene") {
            refused_beside(&with("phase: []"), "E317", "phase");
            refused_beside(&with("phase: [slide, slide]"), "E316", "slide");
        }
    }
    refused("balances: {phase: a, equations: []}", "E315", "phase");
    refused_beside("balances: {phase: flght, equations: []}", "E236", "flght");
    refused_beside("events: {e: {when: x, then: slid}}", "E307", "slid");
    refused_beside("events: {e: {when: x, then: []}}", "E317", "then");
    refused_beside("events: {e: {when: x, then: [slide, flight]}}", "E318", "flight");
    refused_beside("events: {e: {when: x, then: \"roll[7]\"}}", "E218", "7");
    let impact = |impact: &str| format!("events: {{e: {{phase: flight, when: x, then: {{{impact}}}}}}}");
    refused_beside(&impact("impact: 0.5"), "E302", "then");
    refused_beside(&impact("along: floor"), "E302", "then");
    refused_beside(&impact("impact: 1.5, along: floor"), "E411", "1.5");
    refused_beside(&impact("impact: x, along: floor"), "E215", "x");
    refused_beside(&impact("impact: l, along: floor"), "E242", "l");
    refused_beside(&impact("impact: 0.5, along: flor"), "E235", "flor");
    refused_beside(&impact("impact: 0.5, along: roll"), "E429", "roll");
    refused_beside(&impact("impact: 0.5, along: floor, at: 1"), "E301", "at");
    refused_beside("events: {e: {phase: slide, when: x, then: {impact: 1, along: floor}}}", "E430", "floor");
    refused(&format!("{idle}events: {{e: {{when: x, then: {{impact: 1, along: floor}}}}}}"), "E430", "floor");
    refused_beside("scene: {guess: {z: 1}}", "E410", "z");
    refused_beside("scene: {guess: {x': 1}}", "E410", "x'");
    refused_beside("scene: {guess: {x: 1 s}}", "E242", "1");
    refused_beside("scene: {guess: {x: 1}, phase: flight}", "E426", "guess");
    refused("scene: {guess: {x: 1}}", "E426", "guess");
    refused("scene: {also: {e: 1}}", "E427", "e");
    refused("outputs: {e: P}\nscene: {also: {e: 1}}", "E308", "1");
    refused("outputs: {e: x}\nscene: {also: {e: y}}", "E215", "y");
    refused("outputs: {e: x}\nscene: {also: {e: 1 s}}", "E242", "1");
    refused("outputs: {e: x}\nscene: {also: {e': 1}}", "E428", "e'");
    refused("outputs: {e: x''}\nscene: {also: {e: 1}}", "E428", "e");
    refused("outputs: {e: l}\nscene: {also: {e: 1}}", "E428", "e");
    refused("outputs: {e: x}\nconserved: {e: y}\nscene: {also: {e: 1}}", "E428", "e");
    refused("outputs: {e: X}\nscene: {also: {e: 1}}", "E201", "X");
}

#[test]
fn balances_count_active_constraints_as_equations_and_reactions_in_forces_as_unknowns() {
    let file = |more: &str| {
        format!(
            "name: A\nparameters: {{m: 1 kg, mu: 1 1}}\ncoordinates: {{x: m, y: m}}
bodies: {{b: {{mass: m, position: \"[x, y]\"}}}}\nconstraints: {{floor: y}}\nphases: {{on: [floor], off: []}}
forces: {{rub: {{on: b, force: \"[-mu*reaction(floor), 0]\", phase: on}}}}\n{more}\n"
        )
    };
    let message = |more: &str| load(&file(more), &[]).err().map_or(String::new(), |found| found[0].message.clone());
    let up = "reactions: {n: {on: b, along: \"[0, 1]\"}}";
    let both = "{force: {of: [b]}}";
    assert_eq!(message(&format!("balances: {{equations: [{both}, {{equation: n = reaction(floor)}}], {up}}}")), "");
    assert_eq!(
        message(&format!("balances: {{equations: [{both}], {up}}}")),
        "`balances` has 2 equations and 1 row of constraints in the phase `on` for 2 accelerations and 1 reaction \
         component and 1 multiplier (`reaction(floor)`)"
    );
    assert_eq!(message(&format!("balances: {{phase: off, equations: [{both}]}}")), "");
    assert_eq!(
        message(&format!("balances: {{phase: off, equations: [{both}], {up}}}")),
        "`balances` has 2 equations in the phase `off` for 2 accelerations and 1 reaction component"
    );
}

#[test]
fn heads_and_sizes() {
    let file = |head: &str| format!("{head}\ncoordinates: {{x: m}}\nkinetic_energy: 0*x'\n");
    let one = |head: &str| marked(&file(head));
    assert_eq!(one("name: pendulum"), [("E309", "pendulum".to_owned())]);
    assert_eq!(one("name: A\nsizes: {n: 1.5}"), [("E222", "1.5".to_owned())]);
    assert_eq!(one("name: A\nsizes: {n: many}"), [("E222", "many".to_owned())]);
    assert_eq!(one("name: A\nparameters: {m: }"), [("E303", "m".to_owned())]);
    assert_eq!(one("name: A\nparameters: {m: 1 kgg}"), [("E119", "kgg".to_owned())]);
    assert_eq!(one("name: A\nparameters: {m: 2*x}"), [("E215", "x".to_owned())]);
    assert_eq!(one("name: A\nparameters: {m: 1/0}"), [("E231", "0".to_owned())]);
    assert_eq!(one("name: A\nparameters: {m: [1, 2]}"), [("E304", "[1, 2]".to_owned())]);
    assert_eq!(one("name: A\nparameters: {\"m[i in 1..3]\": [1, 2]}"), [("E308", "[1, 2]".to_owned())]);
    assert_eq!(one("name: A\nparameters: {a: b, b: a}"), [("E217", "b".to_owned())]);
    assert_eq!(one("name: A\nbodies: {b: {mass: -1, position: '[x, 0]'}}"), [("E411", "-1".to_owned())]);
    assert_eq!(
        one("name: A\nbodies: {b: {mass: 1, inertia: 1, position: '[x, 0]'}}"),
        [("E407", "inertia".to_owned())]
    );
    assert_eq!(
        one("name: A\nbodies: {b: {mass: x, position: '[x, 0]'}}"),
        [("E242", "x".to_owned()), ("E459", "x".to_owned())]
    );
    assert_eq!(one("name: A\nbodies: {b: {position: '[x, 0]'}}"), [("E302", "b".to_owned())]);
    assert_eq!(marked("name: A\ncoordinates: {a: deg}"), [("E314", "deg".to_owned())]);
    assert_eq!(marked("name: A\n")[0].0, "E401");
    assert_eq!(marked("coordinates: {a: m}\n")[0].0, "E302");
    assert_eq!(load(&file("name: A"), &[("n".to_owned(), 3)]).unwrap_err()[0].code, "E201");
}

#[test]
fn one_mistake_one_message() {
    // What depends on a name that failed is silent, and members of a family speak once.
    refused("define: {a: thta, b: 2*a, c_: a + b, d: \"[a, b]\"}", "E201", "thta");
    refused("define: {\"a[i in 1..5]\": thta + i}", "E201", "thta");
    refused("outputs: {\"a[i in 1..5]\": thta + i}", "E201", "thta");
    refused("outputs: {a: \"sum(thta*i, i in 1..1000)\"}", "E201", "thta");
    refused("define: {\"a[i in 1..two]\": 1, b: \"a[1]\"}\noutputs: {c_: b, d: \"2*a[2]\"}", "E201", "two");
}

/// Sections that are misspelt, or of another shape than a mapping, declare their names all the same, and a name that is declared nowhere
/// is told once.
#[test]
fn a_section_that_is_not_read_makes_no_other_wrong() {
    let balanced = format!("{BASE}balances: {{equations: [{{moment: {{about: O, of: [rod]}}}}]}}\n");
    let outputs = "outputs: {a: m*x', b: l*phi'}\nscene: {start: {x: 1}}\n";
    for (section, slip) in
        [("parameters:", "parameter:"), ("coordinates:", "coordinate:"), ("bodies:", "bodys:"), ("sizes:", "size:")]
    {
        let text = format!("{balanced}{outputs}").replace(section, slip);
        let found = marked(&text);
        assert_eq!(found[0], ("E301", slip.trim_end_matches(':').to_owned()));
        assert!(found[1..].iter().all(|(code, _)| *code == "E414"), "{found:?}");
    }
    let free = "name: Test\nparameters: {m: 1 kg}\ncoordinates: {x: m}\nbodies: {bead: {mass: m, position: \"[x, 0]\"}}\n\
                balances: {equations: [{force: {of: [bead], along: ground.x}}]}\nscene: {start: {x: 1}}\n";
    assert_eq!(marked(free), []);
    for shape in ["x", "[x]", "[x: m]"] {
        let text = free.replace("{x: m}", shape);
        let codes: Vec<&str> = marked(&text).iter().map(|(code, _)| *code).collect();
        assert_eq!(codes, ["E304"], "{shape}");
    }
    let problems = load(&free.replace("{x: m}", "{y: m}"), &[]).unwrap_err();
    let codes: Vec<&str> = problems.iter().map(|problem| problem.code).collect();
    assert_eq!(codes, ["E201", "E410"]);
    let twice = load(&format!("{BASE}define: {{a: thta + 1, b: thta}}\noutputs: {{c_: 2*thta}}\n"), &[]).unwrap_err();
    assert_eq!((twice.len(), &*twice[0].label), (1, "not declared; it stands in 2 other places too"));
    // A name like one that was refused is this one.
    let numbered = BASE.replace("  rod:", "  1rod:");
    assert_eq!(marked(&format!("{numbered}outputs: {{a: position(rod)}}\n")), [("E118", "1rod".to_owned())]);
    // One scene in the place of several.
    let one = "scenes: {start: {x: 0, phi: 1}, until: 3}";
    assert_eq!(marked(&format!("{BASE}{one}\n")), [("E304", "scenes".to_owned())]);
}

#[test]
fn helps_name_what_is_meant() {
    let help = |more: &str| load(&format!("{BASE}{more}\n"), &[]).unwrap_err()[0].help.clone();
    for (more, part) in [
        ("define: {a: \"max(0 x)\"}", "`0, x` or `0*x`"),
        ("define: {a: \"[x y]\"}", "`x, y` or `x*y`"),
        ("define: {a: (x y)}", "did you mean `x*y`?"),
        ("outputs: {a: energi}", "did you mean `energy`?"),
        ("forces: {f: {on: bead, force: y}}", "`ground.y`"),
        ("springs: {s: {stretch: x, stiffness: 1 N/m, on: bead}}", "add `along: e`"),
        ("dampers: {d: {rate: x', damping: 1 N*s/m, on: bead}}", "add `along: e`"),
        ("constraints: {c_: x}\nevents: {e: {when: x, then: bounce}}", "`{impact: e, along: c}`"),
    ] {
        assert!(help(more).contains(part), "{more}: {}", help(more));
    }
    let parameters =
        |value: &str| load(&BASE.replace("k: 2*m", &format!("k: {value}")), &[]).unwrap_err()[0].help.clone();
    assert_eq!(parameters("25 kgs"), "did you mean `kg`?");
    assert_eq!(parameters("25 kgg"), "did you mean `kg`?");
    assert!(parameters("[1, 2]").contains("`define: {k: …}`") && parameters("\"[1, 2]\"").contains("`define: {k: …}`"));
    let solid = "name: Top\ncoordinates: {a: rad}\nframes: {F: {rotate: [z, a]}}\n\
                 bodies: {b: {mass: 1, inertia: \"[1, 1, 1]\", frame: F, position: [0, 0, 0]}}\n";
    let turned = solid.replace("[z, a]", "[a, z]").replace('"', "");
    assert_eq!(load(&turned, &[]).unwrap_err()[0].help, "the axis comes first");
    assert_eq!(load(solid, &[]).unwrap_err()[0].help, "leave out the quotes: `[1, 1, 1]`");
}

#[test]
fn all_problems_at_once() {
    let text = format!("{BASE}define: {{a: thta}}\nsprings: {{s: {{between: [P, O]}}}}\nscene: {{start: {{zz: 1}}}}\n");
    let codes: Vec<&str> = marked(&text).iter().map(|(code, _)| *code).collect();
    assert_eq!(codes, ["E201", "E410", "E306"]);
}

/// What follows from a mistake that was told is none of its own: here a frame that cannot be made, and with it the only balance.
#[test]
fn balances_that_need_something_mistaken_are_not_counted() {
    let text = "name: Test
parameters: {m: 1 kg, l: 1 m, g: 9.81 m/s^2}
coordinates: {theta: rad}
frames: {F: {rotate: [[H.z, theta]]}}
bodies: {bob: {mass: m, position: l*F.x, frame: F, inertia: [1, 1, 1]}}
points: {pivot: [0, 0, 0]}
gravity: [0, -g, 0]
balances: {by_hand: {equations: [{moment: {about: pivot, of: [bob], along: F.z}}]}}
";
    assert_eq!(marked(text), [("E201", "H".to_owned())]);
    assert_eq!(marked(&text.replace("H.z", "z")), []);
}
