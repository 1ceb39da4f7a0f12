//! Hostile and very large files end with an answer or an error, without a panic.

use std::fmt::Write;

use dalembert_symbolic::model::load;

fn codes(text: &str) -> Vec<&'static str> {
    load(text, &[]).err().unwrap_or_default().iter().map(|problem| problem.code).collect()
}

fn family(n: i64, more: &str) -> String {
    format!(
        "name: Large\nsizes: {{n: {n}}}\nparameters: {{m: 1}}\ncoordinates: {{\"x[i in 1..n]\": m}}\n\
         bodies: {{\"bead[i in 1..n]\": {{mass: m, position: \"[x[i], 0]\"}}}}\n{more}\n"
    )
}

#[test]
fn long_chains_of_definitions_need_no_stack() {
    let chain = |key: &str| {
        family(20_000, &format!("define: {{\"a[i in 1..n]\": \"{key} + x[i]\", \"a[0]\": 0, \"a[n+1]\": 0}}"))
    };
    assert!(codes(&chain("a[i-1]")).is_empty());
    assert!(codes(&chain("a[i+1]")).is_empty());
    // One cycle of 20 000 members is one message.
    let cycle = family(20_000, "define: {\"a[i in 1..n]\": \"a[mod(i, n) + 1] + 1\"}");
    assert_eq!(codes(&cycle), ["E217"]);
}

#[test]
fn too_many_names() {
    assert_eq!(codes(&family(200_000, "outputs: {a: \"x[1]\"}")), ["E223"]);
    assert_eq!(codes(&family(60_000, "")), ["E223"]);
    assert_eq!(codes(&family(i64::MAX, "")), ["E223"]);
    assert_eq!(codes(&family(1000, "define: {\"a[i in 1..n, j in 1..n, k in 1..n]\": 1}")), ["E223"]);
    assert!(codes(&family(-5, "kinetic_energy: 1")).contains(&"E401"));
}

#[test]
fn too_much_to_expand() {
    assert_eq!(codes(&family(9, "define: {a: \"sum(1, i in 1..10^15)\"}")), ["E229"]);
    assert_eq!(codes(&family(1000, "define: {a: \"sum(1, i in 1..n, j in 1..n, k in 1..n)\"}")), ["E229"]);
    let nested = "sum(sum(sum(sum(sum(i*j*k, k in 1..n), j in 1..n), i in 1..n), p in 1..n), q in 1..n)";
    assert_eq!(codes(&family(300, &format!("define: {{a: \"{nested}\"}}"))), ["E229"]);
    assert_eq!(
        codes(&family(400, "define: {a: \"sum(sin(x[i]*x[j] + i*j)^3, i in 1..n, j in 1..n, k in 1..6)\"}")),
        ["E229"]
    );
    let mut integral = "sin(a*b*c_*d*e*x[1])".to_owned();
    for name in ["a", "b", "c_", "d", "e"] {
        integral = format!("integral({integral}, {name} in 0..1)");
    }
    assert_eq!(codes(&family(2, &format!("define: {{z: \"{integral}\"}}"))), ["E233"]);
}

#[test]
fn doubling_definitions_stay_small() {
    let mut text = family(2, "define:\n  d0: x[1]");
    for k in 1..200 {
        let _ = writeln!(text, "  d{k}: d{}*d{}", k - 1, k - 1);
    }
    assert!(codes(&text).is_empty());
}

#[test]
fn a_large_model_resolves() {
    let text = family(
        10_000,
        "springs: {\"s[i in 1..n-1]\": {between: [\"bead[i]\", \"bead[i+1]\"], stiffness: 1, rest: 1}}
forces: {\"f[i in 1..100]\": {on: \"[x[i], 0]\", force: [1, 0]}}
outputs: {p: \"sum(m*velocity(bead[i]), i in 1..n)\"}
scene: {start: {\"x[i in 1..n]\": i}}",
    );
    let model = load(&text, &[]).unwrap();
    assert_eq!((model.bodies.len(), model.loads.len()), (10_000, 10_099));
}

#[test]
fn values_without_sense() {
    for define in [
        "\"x[9223372036854775807 + 1]\"",
        "\"x[-9223372036854775807 - 5]\"",
        "\"x[2^100]\"",
        "\"x[(-9223372036854775807 - 1)/(0 - 1)]\"",
        "\"x[mod(1, 0)]\"",
        "\"x[1/0]\"",
        "1e400",
        "0^-1",
        "(-8)^0.5",
        "ln(0)",
        "asin(2)",
        "x[1]/0",
        "1/(2 - 2)",
        "\"sum(i, i in 1..x[1])\"",
        "\"integral(1, s in x'..1)\"",
        "\"unit([0, 0])/0\"",
        "diff(1)",
        "rate()",
        "velocity()",
        "\"velocity(1, ground)\"",
        "reaction(1 + 2)",
        "\"cross(1, 2)\"",
        "ground'",
        "all",
        "\"min([1, 2], 3)\"",
        "ground.w",
    ] {
        let text = family(3, &format!("define: {{a: {define}}}"));
        assert_eq!(codes(&text).len(), 1, "{define}: {:?}", codes(&text));
    }
}

#[test]
fn shapes_without_sense() {
    let keys = [
        "about",
        "sizes",
        "parameters",
        "coordinates",
        "inputs",
        "define",
        "frames",
        "points",
        "bodies",
        "gravity",
        "springs",
        "dampers",
        "forces",
        "torques",
        "kinetic_energy",
        "potential_energy",
        "dissipation",
        "generalized_forces",
        "constraints",
        "phases",
        "events",
        "balances",
        "conserved",
        "checks",
        "sample",
        "outputs",
        "draw",
        "scene",
        "scenes",
        "equilibrium",
    ];
    let values = [
        "",
        "1",
        "a",
        "[]",
        "{}",
        "[1]",
        "[1, 2]",
        "[[1, 2], [3]]",
        "{a: }",
        "{a: 1}",
        "{a: []}",
        "{a: {}}",
        "{x: [1]}",
        "{a: {b: {c: 1}}}",
        "{a: {on: {}, between: 1, when: [], then: {}, force: {}, at: []}}",
        "{\"a[\": 1}",
        "{\"a[i in 1..0]\": {}}",
        "{\"a[i in 1..2]\": [1, 2]}",
        "{start: 1, set: [1], until: {}}",
        "{\"x[1]\": 1}",
        "{x: 1}",
        "{x': 1}",
        "{angle: x, mass: 1}",
        "{a: {between: [a, b], stiffness: 1}}",
        "{a: {stretch: x, stiffness: 1, on: a, along: [1], at: 2, from: 3}}",
        "[{line: 1}, {curve: 1, s: 2}, {circle: 3}]",
    ];
    for key in keys {
        for value in values {
            let rest = if key == "coordinates" { "" } else { "coordinates: {x: m}\n" };
            let text = format!("name: Shape\n{rest}{key}: {value}\n");
            // Whatever it is, it ends; what is wrong is told once at each place.
            let _ = codes(&text);
        }
    }
}

/// Whatever is wrong with constraints and phases, what names them ends too, with a problem and without a panic.
#[test]
fn uses_of_what_was_refused() {
    let constraints = [
        "",
        "[]",
        "{c: }",
        "{c: [x]}",
        "{c: \"[x, 1]\"}",
        "{c: x, \"c[1]\": x}",
        "{\"c[\": x}",
        "{\"c[i in 1..0]\": x}",
    ];
    let phases = [
        "",
        "[c]",
        "{}",
        "{a: c}",
        "{a: [c], \"a[1]\": [c]}",
        "{\"a[1]\": [c], \"a[i in 1..2]\": []}",
        "{stop: [c]}",
        "{a: [[c]]}",
        "{\"a[i in 1..0]\": []}",
        "{a: [\"c[i in 1..2]\", \"c[i in 2..1]\", 1, x', \"c['\"]}",
    ];
    let uses = "outputs: {o: reaction(c), p: \"reaction(c[1])\"}
define: {d: reaction(c)*2}
forces: {f: {on: b, force: \"[d, 0]\", phase: [a, \"a[1]\", \"a[2]\"]}}
events: {e: {when: x, phase: \"a[2]\", then: [a, stop, \"a[2]\", {impact: 1, along: c}, {impact: 1, along: \"c[1]\"}, {}, [stop]]}}
conserved: {q: {value: x, phase: {a: 1}}}
balances: {phase: \"a[i in 1..2]\", equations: [{force: {of: [b]}}, {energy: {}}]}
scene: {phase: \"a[2]\", guess: [x], also: [q]}
scenes: {two: {phase: [a], guess: {x: [1]}, also: {q: [], o: [1, 2], \"p[i in 1..2]\": [1], x': 1}}}
";
    for c in constraints {
        for p in phases {
            let text = format!(
                "name: A\ncoordinates: {{x: m, y: m}}\nbodies: {{b: {{mass: 1, position: \"[x, y]\"}}}}\n\
                 constraints: {c}\nphases: {p}\n{uses}"
            );
            assert!(!codes(&text).is_empty(), "{text}");
        }
    }
}

/// Names of constraints are looked up, and their rows counted, in a time that does not grow with the square.
#[test]
fn many_constraints() {
    let n = 1500;
    let text = format!(
        "name: Chain\nsizes: {{n: {n}}}\nparameters: {{m: 1 kg, l: 1 m}}
coordinates: {{\"x[i in 0..n]\": m, \"y[i in 0..n]\": m}}
points: {{\"p[i in 0..n]\": \"[x[i], y[i]]\"}}
bodies: {{\"bead[i in 1..n]\": {{mass: m, position: \"p[i]\"}}}}
constraints: {{pin: \"p[0]\", \"rod[i in 1..n]\": \"dot(p[i] - p[i-1], p[i] - p[i-1]) - l^2\"}}
phases: {{\"held[k in 1..3]\": [pin, \"rod[i in 1..n]\"]}}
define: {{\"tension[i in 1..n]\": \"-2*l*reaction(rod[i])\"}}
outputs: {{\"pull[i in 1..n]\": \"tension[i]\"}}\n"
    );
    let model = dalembert_symbolic::model::load(&text, &[]);
    let told = model.as_ref().err().map(|problems| problems.iter().map(|p| p.message.clone()).collect::<Vec<_>>());
    let model = model.unwrap_or_else(|_| panic!("{told:?}"));
    assert_eq!(model.constraints.last().map(|c| c.first), Some(n + 1));
    assert_eq!(model.phases[2].constraints.len(), n + 1);
}
