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

/// Guides that cross under a small angle e hold a particle all the same: of the forces along them some 16 + 2 lg e digits are known, and no more are told.
#[test]
fn guides_under_a_small_angle_hold() {
    let text = |e: &str| {
        format!(
            "
name: Guides
parameters: {{m: 1 kg, e: {e} rad, al: 0.3 rad, g: 9.81 m/s^2}}
coordinates: {{x: m, y: m}}
define: {{u: \"[sin(al), -cos(al)]\", v: \"[sin(al + e), -cos(al + e)]\"}}
bodies: {{p: {{mass: m, position: \"[x, y]\"}}}}
gravity: [0, -g]
constraints: {{one: \"dot([x, y], u)\", two: \"dot([x, y], v)\"}}
outputs: {{one: reaction(one), two: reaction(two), ax: x''}}
scene: {{start: {{x: 0, y: 0}}, until: 1, tolerance: 1e-9}}
"
        )
    };
    for (e, angle) in [("1e-1", 1e-1_f64), ("1e-2", 1e-2), ("1e-3", 1e-3), ("1e-4", 1e-4), ("1e-5", 1e-5)] {
        for until in [0.0, 1.0] {
            let mut case = Case::written(&text(e));
            case.settings.until = until;
            let run = case.run();
            assert!(run.warnings.is_empty(), "{e}: {:?}", run.warnings);
            // λ₁ u + λ₂ v carries the weight.
            let known = [-9.81 * (0.3 + angle).sin() / angle.sin(), 9.81 * 0.3_f64.sin() / angle.sin()];
            for (name, force) in ["one", "two"].into_iter().zip(known) {
                let found = run.column(name).expect("a reaction")[run.len() - 1];
                assert!(
                    (found - force).abs() < 1e-14 / angle.powi(2) * force.abs(),
                    "{e}: {name} = {found}, not {force}"
                );
            }
            assert_eq!(run.column("ax").expect("a column")[run.len() - 1], 0.0, "{e}");
        }
    }
}

/// What moves two rows that are alike but for e: y'' = (b − a)/e, and the forces −(b − a)/e² + a and (b − a)/e².
#[test]
fn rows_that_are_alike_but_for_a_small_part_are_two() {
    for (e, small) in [("1e-2", 1e-2_f64), ("1e-3", 1e-3), ("1e-4", 1e-4)] {
        let text = format!(
            "
name: Alike
parameters: {{m: 1 kg, e: {e} 1, A: 1 m/s^2, B: 2 m/s^2}}
coordinates: {{x: m, y: m}}
kinetic_energy: m*(x'^2 + y'^2)/2
constraints: {{c0: x - A*t^2/2, c1: x + e*y - B*t^2/2}}
outputs: {{ay: \"y''\", r0: reaction(c0), r1: reaction(c1)}}
scene: {{start: {{x: 0, y: 0, x': 0, y': 0}}, until: 1}}
"
        );
        let mut case = Case::written(&text);
        case.settings.digits = true;
        let run = case.run();
        assert!(run.warnings.is_empty(), "{e}: {:?}", run.warnings);
        let force = 1.0 / (small * small);
        for (name, known) in [("y", 0.5 / small), ("ay", 1.0 / small), ("r0", 1.0 - force), ("r1", force)] {
            let values = run.column(name).expect("a column");
            let error = run.errors(name).expect("digits")[run.len() - 1];
            let off = (values[run.len() - 1] - known).abs();
            assert!(
                off <= error && error < 1e-12 / small.powi(2) * known.abs(),
                "{e}: {name} is off by {off:e}, told {error:e}"
            );
        }
    }
}

/// Three rods that are almost stretched between two pins: rods of l = 1 m at ±α, cos α = 1 − e/2, and the middle one level, which turns at 10⁻⁴ rad/s.
#[test]
fn places_that_nearly_singular_rows_determine_have_few_digits() {
    for e in ["1e-6", "1e-8", "1e-10"] {
        let text = format!(
            "
name: Taut
parameters: {{l: 1 m, m: 1 kg, g: 9.81 m/s^2, e: {e} 1}}
coordinates: {{a: rad, b: rad, c: rad}}
points: {{P: \"l*[cos(a), sin(a)]\", Q: \"P + l*[cos(b), sin(b)]\", R: \"Q + l*[cos(c), sin(c)]\", E: \"[l*(3 - e), 0]\"}}
bodies: {{one: {{mass: m, position: P}}, two: {{mass: m, position: Q}}}}
gravity: [0, -g]
constraints: {{pin: R - E}}
outputs: {{pin: reaction(pin)}}
scene: {{start: {{b: 0, b': 1e-4}}, guess: {{a: -1e-3, c: 1e-3}}, until: 0, tolerance: 1e-10}}
"
        );
        let mut case = Case::written(&text);
        case.settings.digits = true;
        let run = case.run();
        let small: f64 = e.parse().expect("a number");
        // 1 − cos α = e/2, without cancellation.
        let alpha = 2.0 * (small / 4.0).sqrt().asin();
        let off = (run.last()["a"] + alpha).abs();
        let error = run.errors("a").expect("digits")[0];
        assert!(off <= error && error < 1e-14 / alpha, "{e}: off by {off:e}, told {error:e}");
    }
}

/// A four-bar with a coupler of 10⁶ kg between links of 10⁻⁶ kg (30 digits by its one freedom): elimination in a fixed order keeps none of its digits.
#[test]
fn a_heavy_coupler_between_light_links_keeps_its_digits() {
    let text = "
name: FourBar
parameters: {d: 3 m, a: 1 m, b: 2.6 m, c: 1.9 m, g: 9.81 m/s^2, I: 1e-6 kg*m^2, m: 1e-6 kg, mb: 1e6 kg}
coordinates: {p: rad, q: rad, r: rad}
points:
  D: [d, 0]
  B: a*[cos(p), sin(p)]
  C: B + b*[cos(q), sin(q)]
  C2: D + c*[cos(r), sin(r)]
bodies:
  crank: {mass: m, inertia: I, angle: p, position: B/2}
  coupler: {mass: mb, inertia: I, angle: q, position: (B + C)/2}
  rocker: {mass: m, inertia: I, angle: r, position: (D + C2)/2}
gravity: [0, -g]
constraints: {pin: C - C2}
outputs: {ar: \"r''\"}
scene: {start: {p: 1, p': 2}, guess: {q: 0.4, r: 1.6}, until: 1, tolerance: 1e-9}
";
    let run = Case::written(text).run();
    assert!(run.work.steps < 50, "{} steps", run.work.steps);
    near(run.column("ar").expect("a column")[0], -0.152_649_739_737_234_9, 1e-9);
}

/// Lengths of 10⁵ m beside an angle that is held: the same place in parts of them as of lengths of 1 m.
#[test]
fn a_large_mechanism_is_closed_as_a_small_one() {
    let text = "
name: Scaled
parameters: {s: 1 m}
coordinates: {p: rad, x1: m, y1: m, x2: m, y2: m}
bodies:
  crank: {mass: 1 kg, inertia: 1 kg*m^2, angle: p, position: \"s*[cos(p), sin(p)]/2\"}
  one: {mass: 1 kg, position: \"[x1, y1]\"}
  two: {mass: 1 kg, position: \"[x2, y2]\"}
constraints:
  bc: (x1 - s*cos(p))^2 + (y1 - s*sin(p))^2 - 16*s^2
  cd: (x2 - 4*s)^2 + y2^2 - 9*s^2
  cc: (x2 - x1)^2 + (y2 - y1)^2 - s^2
outputs: {y1_s: y1/s, y2_s: y2/s}
scene: {start: {p: 1.5, x1: 3.9*s}, guess: {y1: 2.8*s, x2: 4.2*s, y2: 2.9*s}, until: 0}
";
    let place = |s: f64| {
        let run = Case::written(text).set("s", s).run();
        ["y1_s", "y2_s"].map(|name| run.column(name).expect("a column")[0])
    };
    let usual = place(1.0);
    for s in [1e-9, 1e5, 1e9] {
        let found = place(s);
        (0..2).for_each(|k| near(found[k], usual[k], 1e-9));
    }
}
