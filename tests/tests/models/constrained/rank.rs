//! How many constraints are independent, and where.

use dalembert::{Cause, Error};
use dalembert_symbolic::lower::compile;
use dalembert_tests::case::Case;

use crate::near;

/// n windows in a row (IFToMM, multibody benchmark A02): cranks and bars of one length.
fn windows(n: usize) -> String {
    format!(
        "name: Windows
sizes: {{n: {n}}}
parameters: {{m: 1 kg, l: 1 m, g: 9.81 m/s^2}}
coordinates: {{\"x[i in 0..n]\": m, \"y[i in 0..n]\": m}}
bodies: {{\"tip[i in 0..n]\": {{mass: m, position: \"[x[i], y[i]]\"}}}}
gravity: [0, -g]
constraints:
  \"crank[i in 0..n]\": \"(x[i] - i*l)^2 + y[i]^2 = l^2\"
  \"bar[i in 1..n]\": \"(x[i] - x[i-1])^2 + (y[i] - y[i-1])^2 = l^2\"
scene: {{start: {{\"x[0]\": 0, \"x[0]'\": 1}}, guess: {{\"x[i in 0..n]\": \"i*l\", \"y[i in 0..n]\": l}}, until: 0.5, tolerance: 1e-11}}
scenes: {{flat: {{start: {{\"x[0]\": l}}, guess: {{\"x[i in 0..n]\": \"i*l + l\"}}}}}}
"
    )
}

/// C6: one freedom, whatever the number of windows, and all of them move alike; the flat position, where there are n + 1, is
/// no start.
#[test]
fn c6_windows_have_one_freedom_and_more_where_they_are_flat() {
    for n in [1, 2, 5] {
        let text = windows(n);
        let program = compile(&text, &[]).unwrap_or_else(|problems| panic!("{problems:?}"));
        assert_eq!(program.report.ranks, [2 * n + 1]);
        let last = Case::written(&text).run().last();
        let alone = Case::written(&windows(1)).run().last();
        near(last[format!("x[{n}]").as_str()] - n as f64, alone["x[0]"], 1e-9);
        let Err(Error::Run(failure)) = Case::written(&text).scene("flat").try_run() else { panic!("a motion") };
        assert!(matches!(failure.cause, Cause::SingularConfiguration { sigma } if sigma < 1e-6), "{}", failure.cause);
    }
}

/// C10: a constraint that is redundant for the file's numbers is so told; with others it contradicts, and nothing is averaged.
#[test]
fn c10_redundant_constraints_that_do_not_agree_are_an_error() {
    let bob = "
name: Bob
parameters: {m: 1 kg, l: 1 m, k: 1 1, g: 10 m/s^2}
coordinates: {x: m, y: m}
bodies: {bob: {mass: m, position: \"[x, y]\"}}
gravity: [0, -g]
constraints: {rod: x^2 + y^2 - l^2, again: x^2 + y^2 - k*l^2}
scene: {start: {x': 1}, guess: {x: 0.3, y: -1}, until: 1, tolerance: 1e-12}
";
    let program = compile(bob, &[]).unwrap_or_else(|problems| panic!("{problems:?}"));
    assert_eq!(program.model.warnings.iter().map(|warning| warning.code).collect::<Vec<_>>(), ["W515"]);
    near(Case::written(bob).run().last()["x"].hypot(Case::written(bob).run().last()["y"]), 1.0, 1e-12);
    let Err(Error::Run(failure)) = Case::written(bob).set("k", 1.001).try_run() else { panic!("a motion") };
    let Cause::Unreachable { residual, .. } = failure.cause else { panic!("{}", failure.cause) };
    near(residual.abs(), 5e-4, 1e-9);
    let problems = compile(&bob.replace("k: 1 1", "k: 1.001 1"), &[]).expect_err("no state");
    assert_eq!(problems[0].code, "E514");
}

/// C12: three cranks and a bar are counted as a structure (six coordinates, six rows), and move: one row is redundant.
#[test]
fn c12_an_overconstrained_linkage_moves() {
    let text = "
name: ThreeCranks
parameters: {m: 1 kg, a: 1 m, b: 2 m}
coordinates: {p: rad, q: rad, r: rad, x: m, y: m, psi: rad}
points: {B: \"[b/2, 0]\", C: \"[b, 0]\"}
bodies:
  one: {mass: m, inertia: m*a^2/12, angle: p, position: a/2*one.x}
  two: {mass: m, inertia: m*a^2/12, angle: q, position: B + a/2*two.x}
  three: {mass: m, inertia: m*a^2/12, angle: r, position: C + a/2*three.x}
  bar: {mass: m, inertia: m*b^2/12, angle: psi, position: \"[x, y]\"}
constraints:
  pin_1: a*one.x = position(bar) - b/2*bar.x
  pin_2: B + a*two.x = position(bar)
  pin_3: C + a*three.x = position(bar) + b/2*bar.x
scene: {start: {p: 1, p': 0.5}, guess: {q: 1, r: 1, x: 1.5, y: 0.8}, until: 3, tolerance: 1e-11}
";
    let program = compile(text, &[]).unwrap_or_else(|problems| panic!("{problems:?}"));
    assert_eq!(program.report.ranks, [5]);
    assert_eq!(program.model.warnings.iter().map(|warning| warning.code).collect::<Vec<_>>(), ["W515"]);
    // Without gravity all cranks turn at a constant rate, and the bar stays level.
    let last = Case::written(text).run().last();
    for name in ["p", "q", "r"] {
        near(last[name], 2.5, 1e-9);
    }
    near(last["psi"], 0.0, 1e-10);
    near(last["y"], 2.5_f64.sin(), 1e-9);
}

/// A bead of 10⁻⁸ kg between two rods: stretched, its constraints look alike to the inertia of the bob, and are two all the same.
#[test]
fn light_bodies_between_heavy_ones_are_held() {
    let text = |m: &str| {
        format!(
            "
name: Bead
parameters: {{m1: {m} kg, m2: 1 kg, l: 1 m, g: 9.81 m/s^2}}
coordinates: {{x: m, y: m, u: m, w: m}}
points: {{A: \"[x, y]\", B: \"[u, w]\"}}
bodies: {{bead: {{mass: m1, position: A}}, bob: {{mass: m2, position: B}}}}
gravity: [0, -g]
constraints: {{rod1: x^2 + y^2 - l^2, rod2: (u - x)^2 + (w - y)^2 - l^2}}
scene: {{start: {{x: 0, y: -1, u: 0, w: -2, x': 0.5, u': 1}}, until: 0.05, tolerance: 1e-11}}
"
        )
    };
    let angles = |m: &str| {
        format!(
            "
name: Bead
parameters: {{m1: {m} kg, m2: 1 kg, l: 1 m, g: 9.81 m/s^2}}
coordinates: {{a: rad, b: rad}}
points: {{A: \"l*[sin(a), -cos(a)]\", B: \"A + l*[sin(b), -cos(b)]\"}}
bodies: {{bead: {{mass: m1, position: A}}, bob: {{mass: m2, position: B}}}}
gravity: [0, -g]
outputs: {{x: A.x, u: B.x, w: B.y}}
scene: {{start: {{a: 0, b: 0, a': 0.5, b': 0.5}}, until: 0.05, tolerance: 1e-11}}
"
        )
    };
    for m in ["1e-3", "1e-5", "1e-8"] {
        let (run, other) = (Case::written(&text(m)).run(), Case::written(&angles(m)).run());
        assert!(run.warnings.is_empty(), "{m}: {:?}", run.warnings);
        let last = |run: &dalembert::Run, name: &str| *run.column(name).expect("a column").last().expect("a row");
        for name in ["x", "u", "w"] {
            near(last(&run, name), last(&other, name), 1e-9);
        }
    }
}
