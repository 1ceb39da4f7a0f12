//! What the error says of a wrong balance: the term of a written-out equation, a forgotten inertia, or where to look.

use dalembert_symbolic::diagnose::{Problem, Step};
use dalembert_symbolic::gate::judged;
use dalembert_symbolic::model::load;

/// A bar on the axle of a rolling wheel with a spring; these two balances.
fn help(first: &str, second: &str) -> String {
    let text = format!(
        "name: WheelAndBar
parameters: {{M: 2 kg, R: 0.5 m, m: 1 kg, l: 1 m, k: 8 N/m, g: 9.81 m/s^2}}
coordinates: {{x: m, th: rad}}
define: {{J: M*R^2/2, I: m*l^2/12}}
points: {{touch: \"[x, 0]\", axle: \"[x, R]\", peg: \"[0, R]\", foot: \"axle + l*[sin(th), -cos(th)]\"}}
bodies:
  wheel: {{mass: M, inertia: J, angle: -x/R, position: axle}}
  bar: {{mass: m, inertia: I, angle: th, position: (axle + foot)/2}}
gravity: [0, -g]
springs: {{s: {{between: [peg, {{on: wheel, at: axle}}], stiffness: k}}}}
balances:
  equations:
    - {first}
    - {second}
"
    );
    match judged(load(&text, &[]).unwrap()) {
        Ok(_) => String::new(),
        Err(problems) => {
            assert_eq!(problems.iter().map(|p| p.code).collect::<Vec<_>>(), ["E506"]);
            problems[0].help.clone()
        }
    }
}

const ALL: &str = "moment: {about: touch, of: all}";
const BAR: &str = "moment: {about: axle, of: [bar]}";

fn equation(text: &str) -> String {
    format!("equation: \"{text}\"")
}

#[test]
fn the_wrong_term_of_a_written_out_equation_is_named() {
    assert_eq!(help(ALL, BAR), "");
    let right = "m*l/2*(l/2*th'' + x''*cos(th)) + I*th'' = -m*g*l/2*sin(th)";
    assert_eq!(help(ALL, &equation(right)), "");
    for (old, new, said) in [
        ("= -m", "= m", "with the opposite sign of `m*g*l/2*sin(th)`"),
        ("x''*cos", "2*x''*cos", "with half of `m*l/2*2*x''*cos(th)`"),
        ("+ I*th''", "- I*th''", "with the opposite sign of `I*th''`"),
        (" + I*th''", "", "with I alpha of bar added to the left of balance 2 (equation)"),
        ("+ I*th''", "+ I*th'' + k*x*l", "without `k*x*l`"),
    ] {
        let found = help(ALL, &equation(&right.replace(old, new)));
        assert!(found.starts_with(said), "{new}: {found}");
    }
    let found = help(ALL, &equation("rate(m*l^2/4*th' + 2*I*th') + m*l/2*x''*cos(th) = -m*g*l/2*sin(th)"));
    assert!(found.starts_with("with half of `rate(2*I*th')`"), "{found}");
}

#[test]
fn otherwise_the_help_says_where_to_look() {
    assert!(help("moment: {about: touch, of: [wheel]}", BAR).contains("balance 1 (moment) for a constraint's force"));
    assert!(help("force: {of: all, along: ground.x}", BAR).contains("balance 1 (force) for a constraint's force"));
    let found = help(ALL, &equation("I*th'' = 0"));
    assert!(found.contains("balance 2 (equation) for a term that is missing"), "{found}");
}

/// The codes of the errors of a file, with the lines at which they stand (of the balances, the first is 1) and their helps.
fn told(text: &str) -> Vec<(&'static str, usize, String)> {
    let problems = judged(load(text, &[]).unwrap()).err().unwrap_or_default();
    let line = |problem: &Problem| match problem.place.path.last() {
        Some(Step::Index(k)) => k + 1,
        _ => 0,
    };
    problems.iter().map(|problem| (problem.code, line(problem), problem.help.clone())).collect()
}

/// Newton's double pendulum: four equations, and two reactions that stand in all of them.
const DOUBLE: &str = r#"
name: Double
parameters: {m: 1 kg, M: 2 kg, a: 0.5 m, b: 0.7 m, g: 9.81 m/s^2}
coordinates: {p: rad, q: rad}
bodies:
  u: {mass: M, position: "a*[sin(p), -cos(p)]"}
  v: {mass: m, position: "a*[sin(p), -cos(p)] + b*[sin(q), -cos(q)]"}
gravity: [0, -g]
balances:
  equations:
    - equation: "M*a*p''*cos(p) - M*a*p'^2*sin(p) = -T*sin(p) + S*sin(q)"
    - equation: "M*a*p''*sin(p) + M*a*p'^2*cos(p) = T*cos(p) - S*cos(q) - M*g"
    - equation: "m*(a*p''*cos(p) - a*p'^2*sin(p) + b*q''*cos(q) - b*q'^2*sin(q)) = -S*sin(q)"
    - equation: "m*(a*p''*sin(p) + a*p'^2*cos(p) + b*q''*sin(q) + b*q'^2*cos(q)) = S*cos(q) - m*g"
  reactions:
    T: {on: u, along: "[-sin(p), cos(p)]"}
    S: {on: v, along: "[-sin(q), cos(q)]", from: u}
"#;

#[test]
fn of_equations_that_share_reactions_the_wrong_one_is_named() {
    assert_eq!(told(DOUBLE), []);
    for (old, new, line, help) in [
        ("- M*a*p'^2*sin(p)", "+ M*a*p'^2*sin(p)", 1, "with the opposite sign of `M*a*p'^2*sin(p)` in balance 1"),
        ("+ S*sin(q)", "- S*sin(q)", 1, "with the opposite sign of `S*sin(q)` in balance 1"),
        ("- M*g", "+ M*g", 2, "with the opposite sign of `M*g` in balance 2"),
        ("b*q''*cos(q) - b", "1.1*b*q''*cos(q) - b", 3, "no single term explains it; look in balance 3"),
        ("m*(a*p''*sin", "2*m*(a*p''*sin", 4, "with half of `2*m*(a*p''*sin(p) + a*p'^2*cos(p) + "),
        ("S*cos(q) - m*g", "-S*cos(q) - m*g", 4, "with the opposite sign of `-S*cos(q)` in balance 4"),
    ] {
        let found = told(&DOUBLE.replace(old, new));
        let [("E506" | "E512", place, said)] = found.as_slice() else { panic!("{new}: {found:?}") };
        assert_eq!(*place, line, "{new}: {found:?}");
        assert!(said.starts_with(help), "{new}: {found:?}");
    }
}

#[test]
fn several_wrong_equations_of_a_system_are_all_named() {
    let found = told(&DOUBLE.replace("- M*g", "+ M*g").replace("+ S*sin(q)", "- S*sin(q)"));
    let places: Vec<usize> = found.iter().map(|problem| problem.1).collect();
    assert_eq!(places, [1, 2], "{found:?}");
    assert!(found.iter().all(|(_, line, help)| help.contains(&format!("in balance {line} "))), "{found:?}");
}

/// A weight on a string over a pulley whose bearing nobody named; the string is a constraint, too.
#[test]
fn supports_that_nobody_named_do_not_hide_the_wrong_equation() {
    let text = r#"
name: Pulley
parameters: {m1: 1 kg, m2: 1.6 kg, J: 0.02 kg*m^2, R: 0.1 m, g: 9.81 m/s^2}
coordinates: {y1: m, y2: m, ph: rad}
bodies:
  a: {mass: m1, position: "[-R, y1]"}
  b: {mass: m2, position: "[R, y2]"}
  w: {mass: 1 kg, inertia: J, angle: ph, position: [0, 0]}
gravity: [0, -g]
constraints: {left: "y1 + R*ph", right: "y2 - R*ph"}
balances:
  equations:
    - equation: "m1*y1'' = S1 - m1*g"
    - equation: "m2*y2'' = S2 - m2*g"
    - equation: "J*ph'' = R*(S1 - S2)"
  reactions: {S1: {on: a, along: "[0, 1]", from: w, at: a}, S2: {on: b, along: "[0, 1]", from: w, at: b}}
"#;
    assert_eq!(told(text), []);
    for (old, new, line, help) in [
        ("S1 - m1*g", "S1 + m1*g", 1, "with the opposite sign of `m1*g` in balance 1"),
        ("= S2", "= 2*S2", 2, "with half of `2*S2` in balance 2"),
        ("R*(S1 - S2)", "-R*(S1 - S2)", 3, "with the opposite sign of `J*ph''` in balance 3"),
        ("R*(S1 - S2)", "R*(S1 + S2)", 3, "with the opposite sign of `R*S2` in balance 3"),
    ] {
        let found = told(&text.replace(old, new));
        let [("E506" | "E512", place, said)] = found.as_slice() else { panic!("{new}: {found:?}") };
        assert_eq!(*place, line, "{new}: {found:?}");
        assert!(said.starts_with(help), "{new}: {found:?}");
    }
}

/// A damper on the wheel of a gear whose rate has the wrong sign: only the balance of the wheel can be mended so; a spring between two
/// carts stands in both balances.
#[test]
fn a_load_with_the_wrong_sign_is_named_where_it_stands() {
    let gears = |rate: &str| {
        format!(
            "name: Gears\nparameters: {{J1: 0.01 kg*m^2, J2: 0.2 kg*m^2, r: 20 mm, R: 100 mm, c: 0.1 N*m*s}}\n\
             coordinates: {{u: rad, w: rad}}\npoints: {{A: [0, 0], B: \"[r + R, 0]\", mesh: \"[r, 0]\"}}\n\
             bodies:\n  pinion: {{mass: 0, inertia: J1, angle: u, position: A}}\n  \
             wheel: {{mass: 0, inertia: J2, angle: -w, position: B}}\n\
             dampers: {{load: {{rate: {rate}, damping: c, on: wheel}}}}\n\
             constraints: {{teeth: \"velocity(pinion, mesh).y - velocity(wheel, mesh).y\"}}\n\
             balances:\n  equations:\n    - moment: {{about: A, of: [pinion]}}\n    - moment: {{about: B, of: [wheel]}}\n  \
             reactions: {{push: {{on: pinion, at: mesh, along: ground.y, from: wheel}}}}\n"
        )
    };
    assert_eq!(told(&gears("-w'")), []);
    let found = told(&gears("w'"));
    assert!(
        matches!(found.as_slice(), [("E506", 2, help)] if help.contains("load in balance 2 (moment)")),
        "{found:?}"
    );
    let carts = |on: &str, from: &str| {
        format!(
            "name: Carts\nparameters: {{m: 1 kg, k: 5 N/m}}\ncoordinates: {{x: m, z: m}}\n\
             bodies: {{a: {{mass: m, position: \"[x, 0]\"}}, b: {{mass: 2*m, position: \"[z, 0]\"}}}}\n\
             springs: {{s: {{stretch: z - x, stiffness: k, on: {on}, from: {from}, along: ground.x}}}}\n\
             balances: {{equations: [{{force: {{of: a, along: ground.x}}}}, {{force: {{of: b, along: ground.x}}}}]}}\n"
        )
    };
    assert_eq!(told(&carts("b", "a")), []);
    let found = told(&carts("a", "b"));
    let both = "with the opposite sign of s in balance 1 (force) and balance 2 (force) they agree";
    assert!(matches!(found.as_slice(), [("E506", 1, help)] if help == both), "{found:?}");
}

#[test]
fn what_is_offered_for_a_balance_that_says_nothing_says_something() {
    let bob = |balance: &str| {
        format!(
            "name: Bob\nparameters: {{m: 1 kg, l: 1 m, g: 10 m/s^2}}\ncoordinates: {{theta: rad}}\n\
             points: {{o: [0, 0], tip: \"l*[sin(theta), -cos(theta)]\"}}\nbodies: {{bob: {{mass: m, position: tip}}}}\n\
             gravity: [0, -g]\nbalances: {{equations: [{balance}]}}\n"
        )
    };
    assert_eq!(told(&bob("{moment: {about: o, of: bob}}")), []);
    let found = told(&bob("{moment: {about: bob, of: bob}}"));
    let [("E508", 1, help)] = found.as_slice() else { panic!("{found:?}") };
    assert!(help.contains("another point with `about`"), "{help}");
}

/// A wrong sign in a constraint is in Lagrange's equations, not in the balances.
#[test]
fn constraints_are_suspects_too() {
    let press = "name: CrankPress
parameters: {r: 80 mm, l: 300 mm, mr: 25 kg, J: 0.6 kg*m^2, T: 40 N*m, g: 9.81 m/s^2}
coordinates: {phi: rad, y: m}
points: {O: [0, 0], P: \"r*[cos(phi), sin(phi)]\", S: \"[0, y]\"}
bodies:
  crank: {mass: 0, inertia: J, angle: phi, position: O}
  ram: {mass: mr, position: S}
gravity: [0, -g]
torques: {motor: {on: crank, torque: T}}
constraints: {rod: r^2*cos(phi)^2 + (y + r*sin(phi))^2 - l^2}
balances:
  equations:
    - moment: {about: O, of: [crank]}
    - force: {of: [ram], along: ground.y}
  reactions:
    push: {on: ram, along: unit(S - P), from: crank}
scene: {start: {phi: 0, phi': 5 rad/s}, guess: {y: 0.29}}
";
    let help = |text: &str| judged(load(text, &[]).unwrap()).err().map(|problems| problems[0].help.clone());
    let found = help(press).expect("a wrong constraint");
    assert!(found.contains("or in the constraint `rod`"), "{found}");
    assert_eq!(help(&press.replace("y + r", "y - r")), None);
    // A motor is no spring: where it has a potential its claim may leave it out.
    let claim = "conserved: {energy: energy}\n";
    let found = help(&format!("{}{claim}", press.replace("y + r", "y - r"))).expect("a motor");
    assert!(found.contains("`when: {T: 0}`"), "{found}");
}
