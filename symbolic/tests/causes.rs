//! What the error says of a wrong balance: the term of a written-out equation, a forgotten inertia, or where to look.

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
