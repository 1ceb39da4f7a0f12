//! Operation counts of the n-link chain and of the library are held by `docs/counts.md`.

mod table;

use dalembert_symbolic::interpret::{At, Interpreter};
use dalembert_symbolic::print::Reading;

#[test]
fn counts_are_those_of_the_table() {
    let now = table::table();
    let held = include_str!("../../../docs/counts.md");
    assert_eq!(now, held, "counts have changed; if that is meant, regenerate docs/counts.md");
}

#[test]
fn growth_stays_below_the_bounds() {
    let text = table::table();
    let exponents: Vec<f64> = text
        .lines()
        .filter_map(|line| line.strip_prefix("Growth exponents from n = 20 to 40: M and h "))
        .flat_map(|line| line.trim_end_matches('.').split(", h ").map(|x| x.parse().unwrap()).collect::<Vec<f64>>())
        .collect();
    for pair in exponents.chunks_exact(2) {
        assert!(pair[0] < 2.0 && (0.9..1.1).contains(&pair[1]), "{exponents:?}");
    }
    assert_eq!(exponents.len(), 4);
}

/// Two bars, M and h by hand: 22 operations.
const ARM: &str = r#"
name: Arm
parameters: {m1: 2 kg, m2: 1 kg, L1: 1 m, L2: 0.8 m, g: 9.81 m/s^2}
coordinates: {q1: rad, q2: rad}
points:
  elbow: "L1*[cos(q1), sin(q1)]"
  hand: "elbow + L2*[cos(q1 + q2), sin(q1 + q2)]"
bodies:
  upper: {mass: m1, inertia: m1*L1^2/12, angle: q1, position: elbow/2}
  fore: {mass: m2, inertia: m2*L2^2/12, angle: q1 + q2, position: (elbow + hand)/2}
gravity: [0, -g]
"#;

#[test]
fn bodies_of_an_arm_cost_what_its_energies_by_hand_do() {
    let by_hand = r#"
name: Arm
parameters: {m1: 2 kg, m2: 1 kg, L1: 1 m, L2: 0.8 m, g: 9.81 m/s^2}
coordinates: {q1: rad, q2: rad}
kinetic_energy: m1*L1^2*q1'^2/6 + m2*(L1^2*q1'^2 + L2^2*(q1' + q2')^2/3 + L1*L2*cos(q2)*q1'*(q1' + q2'))/2
potential_energy: g*((m1/2 + m2)*L1*sin(q1) + m2*L2/2*sin(q1 + q2))
"#;
    for text in [ARM, by_hand] {
        assert_eq!(table::counts(text, &[]).mass_and_bias, 22, "{text}");
    }
}

/// A pendulum whose string winds up on a cylinder.
const WOUND: &str = r#"
name: Wound
parameters: {m: 1 kg, L: 2 m, R: 0.2 m, g: 9.81 m/s^2}
coordinates: {phi: rad}
kinetic_energy: m*(L + R*phi)^2*phi'^2/2
potential_energy: m*g*(R*sin(phi) - (L + R*phi)*cos(phi))
"#;

#[test]
fn what_stays_a_length_is_a_factor_of_all_that_it_multiplies() {
    let (_, head) = WOUND.split_once("name").unwrap();
    let (head, _) = head.split_once("kinetic").unwrap();
    let bodies = format!(
        "name{head}bodies: {{bob: {{mass: m, position: [R*cos(phi) + (L + R*phi)*sin(phi), R*sin(phi) - (L + R*phi)*cos(phi)]}}}}\n\
         gravity: [0, -g]\n"
    );
    for text in [WOUND, &bodies] {
        let program = dalembert_symbolic::lower::compile(text, &[]).unwrap();
        let equations = Reading::of(&program).text(&program.model);
        let has = |line: &str| equations.contains(line);
        assert!(has("M[phi, phi] = m*(L + R*phi)^2"), "{equations}");
        // Rates stand first.
        assert!(has("h[phi] = (L + R*phi)*(m*R*phi'^2 + m*g*sin(phi))"), "{equations}");
        // L + R φ, its square times m; φ'² m R, m g sin φ, their sum, the product.
        assert_eq!(table::counts(text, &[]).mass_and_bias, 2 + 2 + 2 + 2 + 1 + 1, "{text}");
    }
}

#[test]
fn a_pair_of_stars_takes_one_root_and_one_division() {
    let text = include_str!("../../../models/figure_eight.yaml");
    let program = dalembert_symbolic::lower::compile(text, &[]).unwrap();
    let code = dalembert_symbolic::print::rust(&program, text, "FigureEight");
    let bias = code.split("fn bias").nth(1).unwrap().split("\n    }").next().unwrap();
    assert_eq!([bias.matches(" / ").count(), bias.matches("sqrt").count(), bias.matches("ratio").count()], [3, 3, 0]);
}

/// A mass on a spring, in a plane.
const SPRING: &str = r#"
name: Spring
parameters: {m: 3 kg, k: 7 N/m, l: 0.3 m, g: 9.81 m/s^2}
coordinates: {x: m, y: m}
kinetic_energy: m*(x'^2 + y'^2)/2
potential_energy: k*(sqrt(x^2 + y^2) - l)^2/2 + m*g*y
"#;

#[test]
fn constant_masses_cost_nothing_in_accelerations() {
    let counts = table::counts(SPRING, &[]);
    assert_eq!((counts.bias, counts.accelerations), (10, 10));
    // What the coordinates share of M is no constant of one of them.
    let coupled = SPRING.replace("m*(x'^2 + y'^2)/2", "m*(x'^2 + y'^2 + x'*y')/2");
    let counts = table::counts(&coupled, &[]);
    assert!(counts.accelerations > counts.bias + 2, "{counts:?}");
}

#[test]
fn a_spring_of_its_own_length_pulls_nothing() {
    let text = SPRING.replace(" + m*g*y", "");
    for length in [0.3, 0.7, 1.9] {
        let text = text.replace("l: 0.3", &format!("l: {length}"));
        let spring = Interpreter::new(dalembert_symbolic::lower::compile(&text, &[]).unwrap());
        let mut a = [1.0; 2];
        spring.accelerations(At { q: &[length, 0.0], v: &[0.0; 2], ..At::default() }, &mut a).unwrap();
        assert_eq!(a, [0.0; 2], "{length}");
    }
}

#[test]
fn a_constant_mass_matrix_is_factored_once() {
    let model = |kinetic: &str| {
        format!(
            "name: Coupled\nparameters: {{m: 1 kg, L: 1 m, c: 3 N/m^3}}\nsizes: {{n: 40}}\ncoordinates: {{\"x[i in 1..n]\": m}}\n\
             kinetic_energy: \"{kinetic}\"\npotential_energy: \"sum(c*x[i]^4/4, i in 1..n)\"\n"
        )
    };
    let constant = table::counts(&model("m*(sum(x[i]', i in 1..n)^2 + sum(x[i]'^2, i in 1..n))/2"), &[]);
    // A fraction of a factorization, n³/3: substituting forth and back takes 2 n (n - 1).
    assert!(constant.accelerations < 3500, "{constant:?}");
    let varying = table::counts(&model("m*(sum(cos(i*x[i]/L)*x[i]', i in 1..n)^2 + sum(x[i]'^2, i in 1..n))/2"), &[]);
    assert!(varying.accelerations > 20_000, "{varying:?}");
}
