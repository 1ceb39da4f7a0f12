//! Branches of equilibria, thresholds, root loci.

use serde_json::Value;

use super::{folder, printed, program};

fn json(name: &str, arguments: &[&str]) -> Value {
    let text = printed("modes", name, &[arguments, &["--json"]].concat());
    serde_json::from_str(&text).unwrap_or_else(|error| panic!("{text}: {error}"))
}

/// Of x'' + ∂V/∂x = 0 with one parameter p, from a guess.
fn potential(name: &str, (start, guess): (f64, f64), energy: &str, range: &str) -> Value {
    let text = format!(
        "name: T\nparameters: {{p: {start}}}\ncoordinates: {{x: 1}}\nkinetic_energy: x'^2/2\n\
         potential_energy: \"{energy}\"\nequilibrium: {{x: {guess}}}\nscene: {{start: {{x: 1}}, until: 1}}\n"
    );
    let file = folder("branches").join(format!("{name}.yaml"));
    std::fs::write(&file, text).expect("a file");
    let range = format!("p={range}");
    let out = program(&["modes", file.to_str().expect("a path"), "--vary", &range, "--json"]);
    serde_json::from_str(&out.unwrap_or_else(|error| panic!("{name}: {error}"))).expect("JSON")
}

fn limits(found: &Value) -> Vec<(f64, String)> {
    let list = found["locus"]["limits"].as_array().expect("limits").iter();
    list.map(|limit| (limit["value"].as_f64().unwrap(), limit["kind"].as_str().unwrap().to_owned())).collect()
}

fn expect(found: &Value, expected: &[(f64, &str)]) {
    let limits = limits(found);
    let same = |(a, b): (&(f64, String), &(f64, &str))| (a.0 - b.0).abs() <= 1e-9 && a.1 == b.1;
    let all = limits.len() == expected.len() && limits.iter().zip(expected).all(same);
    assert!(all, "{limits:?} is not {expected:?}");
}

fn last_state(found: &Value) -> [f64; 2] {
    let step = found["locus"]["steps"].as_array().expect("steps").last().expect("a state").clone();
    [&step["value"], &step["equilibrium"]["x"]].map(|x| x.as_f64().expect("a number"))
}

#[test]
fn an_s_curve_was_left_behind_its_first_fold() {
    let found = json("s_curve", &["--vary", "p=-1..1"]);
    let fold = 2.0 / 27.0_f64.sqrt();
    expect(&found, &[(-fold, "fold"), (fold, "fold")]);
    let [p, x] = last_state(&found);
    assert!(p == 1.0 && (x.powi(3) - x - 1.0).abs() < 1e-12, "{p} {x}");
    assert_eq!(found["locus"]["missing"].as_array().unwrap().len(), 0);
    // x³ + x = p has no fold; x² = p ends at one, and that is said.
    expect(&potential("monotone", (-1.0, -0.7), "x^4/4 + x^2/2 - p*x", "-1..1"), &[]);
    let ends = potential("fold", (1.0, 1.0), "x^3/3 - p*x", "-1..1");
    expect(&ends, &[(0.0, "fold")]);
    assert_eq!(ends["locus"]["missing"].as_array().unwrap().len(), 1);
}

/// x/10 + sin x = p folds where cos x = −1/10, twelve times between −3 and 3.
#[test]
fn a_curve_of_twelve_folds_is_followed_to_both_ends() {
    let found = potential("many", (0.0, 0.0), "x^2/20 - cos(x) - p*x", "-3..3");
    let at = (-0.1_f64).acos();
    let folds = (0..3).flat_map(|k| {
        let turn = f64::from(k) * std::f64::consts::TAU;
        [0.1 * (at + turn) + at.sin(), 0.1 * (std::f64::consts::TAU - at + turn) - at.sin()]
    });
    let mut expected: Vec<(f64, &str)> = folds.flat_map(|p| [(p, "fold"), (-p, "fold")]).collect();
    expected.sort_by(|a, b| a.0.total_cmp(&b.0));
    expect(&found, &expected);
    assert_eq!(last_state(&found)[0], 3.0);
}

#[test]
fn folds_were_told_at_a_pole() {
    let found = json("pole_of_a_branch", &["--vary", "s=0..2"]);
    expect(&found, &[(1.0, "pole")]);
    assert!(printed("modes", "pole_of_a_branch", &["--vary", "s=0..2"]).contains("s = 1: x grows beyond all bounds"));
    expect(&potential("double_pole", (0.0, 1.0), "(1-p)^2*x^2/2 - x", "0..2"), &[(1.0, "pole")]);
    expect(&potential("root_pole", (0.0, 1.0), "(1-p)*x^4/4 - x^2/2", "0..2"), &[(1.0, "pole")]);
    expect(&potential("log_pole", (0.0, 0.0), "exp(-x) + (1-p)*x", "0..2"), &[(1.0, "pole")]);
    // Before the pole there is nothing, and what is merely steep has none.
    expect(&json("pole_of_a_branch", &["--vary", "s=0..0.9"]), &[]);
    expect(&potential("steep", (0.0, 0.0), "x^2/2 - 1e6*p*x", "-1..1"), &[]);
}

/// Three oscillators (k − p) y = F turned against each other, so that at each of p = 3, 5, 8 all three coordinates go to infinity.
#[test]
fn poles_behind_a_pole_were_told_as_divergence_beside_them() {
    let of = |name: &str, springs: &str, ranges: &[&str]| {
        let text = format!(
            "name: T\nparameters: {{p: 0}}\ncoordinates: {{u: 1, v: 1, w: 1}}\n\
             define: {{a: (u + v + w)/sqrt(3), b: (u - v)/sqrt(2), c: (u + v - 2*w)/sqrt(6)}}\n\
             kinetic_energy: (u'^2 + v'^2 + w'^2)/2\npotential_energy: {springs} - (a + b + c)\nscene: {{start: {{}}, until: 1}}\n"
        );
        let file = folder("branches").join(format!("{name}.yaml"));
        std::fs::write(&file, text).expect("a file");
        let out = program(&[&["modes", file.to_str().expect("a path"), "--json"], ranges].concat());
        serde_json::from_str::<Value>(&out.unwrap_or_else(|error| panic!("{name}: {error}"))).expect("JSON")
    };
    let springs = "(3 - p)*a^2/2 + (5 - p)*b^2/2 + (8 - p)*c^2/2";
    for from in ["p=0", "p=9", "p=3.00001", "p=4.9999"] {
        let found = of("poles", springs, &["--set", from, "--vary", "p=0..10"]);
        expect(&found, &[(3.0, "pole"), (5.0, "pole"), (8.0, "pole")]);
    }
    // Without a load along it nothing goes to infinity where a stiffness vanishes.
    let found = of("unloaded", "(3 - p)*a^2/2 + (5 - p)*b^2/2 + (8 - p)*c^2/2 + b", &["--vary", "p=0..10"]);
    expect(&found, &[(3.0, "pole"), (5.0, "divergence"), (8.0, "pole")]);
    // Seen from turning axes: sqrt(3000/2) and sqrt(3700/2), of which the second ends a growth.
    for from in ["W=30", "W=44.6"] {
        let found = json("shaft_of_two_stiffnesses", &["--set", from, "--vary", "W=10..80"]);
        expect(&found, &[(1500_f64.sqrt(), "pole"), (1850_f64.sqrt(), "pole")]);
    }
}

/// A coordinate that touches 0 is measured by what it has been, too.
#[test]
fn a_coordinate_that_touches_nought_is_followed() {
    let found = potential("touches", (0.0, 0.09), "(x - (p-0.3)^2)^2/2", "0..1");
    expect(&found, &[]);
    assert_eq!(found["locus"]["changes"].as_array().map_or(0, Vec::len), 0);
    let [p, x] = last_state(&found);
    assert!(p == 1.0 && (x - 0.49).abs() < 1e-12, "{x}");
}

#[test]
fn a_pitchfork_at_nought_was_printed_as_4e_6() {
    let found = potential("pitchfork", (1.0, 1.0), "x^4/4 - p*x^2/2", "-1..1");
    let [(value, kind)] = &limits(&found)[..] else { panic!("{found}") };
    assert!(value.abs() <= 2e-12 && kind == "bifurcation", "{value} {kind}");
    let shifted = potential("shifted", (3.0, 2.0), "(x-1)^4/4 - (p-2)*(x-1)^2/2", "1..3");
    let [(value, kind)] = &limits(&shifted)[..] else { panic!("{shifted}") };
    assert!((value - 2.0).abs() <= 1e-10 && kind == "bifurcation", "{value} {kind}");
    expect(&potential("trivial", (-1.0, 0.0), "x^4/4 - p*x^2/2", "-1..1"), &[(0.0, "divergence")]);
    expect(&potential("broken", (1.0, 1.0), "x^4/4 - p*x^2/2 - 0.01*x", "-1..1"), &[]);
    expect(&potential("transcritical", (1.0, 1.0), "x^3/3 - p*x^2/2", "-1..1"), &[(0.0, "divergence")]);
}

#[test]
fn a_closed_branch_went_round_eight_times() {
    let found = potential("circle", (0.0, 1.0), "x^3/3 + (p^2-1)*x", "-2..2");
    expect(&found, &[(-1.0, "fold"), (1.0, "fold")]);
    assert_eq!(found["locus"]["closed"], true);
    assert_eq!(found["locus"]["missing"].as_array().unwrap().len(), 2);
    assert!(found["locus"]["steps"].as_array().unwrap().iter().all(|step| step["growing"] == 0));
}

#[test]
fn a_growing_pair_that_splits_on_the_real_axis_was_told_as_one_more() {
    expect(&json("growing_pair_splits", &["--vary", "c=1..3"]), &[]);
    // From damped to growing a pair does cross.
    let (value, kind) = limits(&json("growing_pair_splits", &["--vary", "c=-1..3"]))[0].clone();
    assert!(value.abs() < 1e-12 && kind == "flutter", "{value} {kind}");
}

#[test]
fn a_window_of_divergence_touched_from_one_side_was_missed() {
    for range in ["s=0.5..2.01", "s=0..2", "s=0.3..1.9"] {
        let found = json("narrow_divergence", &["--vary", range]);
        expect(&found, &[(0.9999, "divergence"), (1.0001, "divergence")]);
    }
    expect(
        &potential("narrower", (0.5, 0.0), "((p-1)^2 - 1e-12)*x^2/2", "0.5..2.01"),
        &[(1.0 - 1e-6, "divergence"), (1.0 + 1e-6, "divergence")],
    );
    // What only touches, but for rounding, grows nowhere, and what comes near does not either.
    expect(&potential("touches", (0.5, 0.0), "(p^2 - 2*p + 1)*x^2/2", "0.5..2.01"), &[]);
    expect(&potential("near", (0.5, 0.0), "((p-1)^2 + 1e-12)*x^2/2", "0.5..2.01"), &[]);
}

/// (J + Jp) W² = k, 4 J W² ± 2 Jp W² = k: where whirl has once or twice the speed.
#[test]
fn a_root_locus_was_scaled_to_rounding_and_there_was_no_campbell_diagram() {
    let file = |name: &str| folder("branches").join(name).to_str().expect("a path").to_owned();
    let (locus, campbell) = (file("locus.svg"), file("campbell.svg"));
    let found = json("gyroscopic_disc", &["--vary", "W=0..1000", "--locus", &locus, "--campbell", &campbell]);
    for step in found["locus"]["steps"].as_array().unwrap() {
        assert!(step["eigenvalues"].as_array().unwrap().iter().all(|x| x[0] == 0.0), "{step}");
    }
    let drawn = |path: &str| std::fs::read_to_string(path).expect("a picture");
    assert!(drawn(&locus).contains("\n100\n"), "the axis of real parts ends near ±0.1 of the largest eigenvalue");
    assert!(drawn(&campbell).contains("frequency (rad/s)") && drawn(&campbell).contains("W (rad/s)"));
    let expected = [(1e4 / 0.76_f64, 2.0), (1e4 / 0.28, 1.0), (1e4 / 0.04, 2.0)];
    let critical = found["locus"]["critical_speeds"].as_array().unwrap();
    assert_eq!(critical.len(), expected.len(), "{critical:?}");
    for (met, (square, order)) in critical.iter().zip(expected) {
        let value = met["value"].as_f64().unwrap();
        assert!((value / square.sqrt() - 1.0).abs() < 1e-10 && met["order"] == order, "{met}");
    }
    let path = super::stranger("gyroscopic_disc");
    let refused =
        program(&["modes", path.to_str().unwrap(), "--vary", "k=1..2", "--campbell", &campbell, "--orders", "1"]);
    assert!(refused.unwrap_err().contains("`k` has the unit N*m"));
}

/// p x'' + (p − 1/100) x' + x = 0: nothing moves at p = 0, and the border is within the first step behind it.
#[test]
fn what_begins_beside_a_singular_end_was_missed() {
    let text = "name: T\nparameters: {k: 1, p: 1}\ncoordinates: {x: 1}\nkinetic_energy: p*x'^2/2\npotential_energy: k*x^2/2\n\
        generalized_forces: {x: -(p - 0.01)*x'}\nscene: {start: {x: 0}, until: 1}\n";
    let file = folder("branches").join("singular_end.yaml");
    std::fs::write(&file, text).expect("a file");
    let of = |range: &str| -> Value {
        let told = program(&["modes", file.to_str().expect("a path"), "--vary", range, "--json"]);
        serde_json::from_str(&told.unwrap_or_else(|error| panic!("{range}: {error}"))).expect("JSON")
    };
    // The range begins at the singular value, or beyond it; its neighbour has none.
    for (range, missing) in [("p=0..10", 1), ("p=10..0", 1), ("p=-1..10", 1), ("p=0.001..10", 0)] {
        let found = of(range);
        expect(&found, &[(0.01, "flutter")]);
        let parts = found["locus"]["missing"].as_array().expect("parts");
        assert_eq!(parts.len(), missing, "{range}: {parts:?}");
        let near = |part: &Value| part["to"].as_f64().is_some_and(|to| to < 1e-9);
        assert!(parts.iter().all(near), "{range}: {parts:?}");
    }
}

/// A model file of this text, varied.
fn file_varied(name: &str, text: &str, arguments: &[&str]) -> Value {
    let file = folder("branches").join(format!("{name}.yaml"));
    std::fs::write(&file, text).expect("a file");
    let out = program(&[&["modes", file.to_str().expect("a path"), "--json"], arguments].concat());
    serde_json::from_str(&out.unwrap_or_else(|error| panic!("{name}: {error}"))).expect("JSON")
}

fn count(found: &Value, what: &str) -> usize {
    found["locus"][what].as_array().map_or(0, Vec::len)
}

/// V = (1 − p) x²/2 + x⁴/4 − e x: the branch turns aside at p = 1 within e^(2/3), and grows as √(p − 1) from there on.
#[test]
fn an_imperfection_was_stepped_over_or_ended_a_branch() {
    for (k, e) in [1e-3, 1e-8, 1e-9, 1e-10, 1e-12].into_iter().enumerate() {
        let found = potential(&format!("imperfect{k}"), (0.0, 0.0), &format!("(1-p)*x^2/2 + x^4/4 - {e:e}*x"), "0..3");
        expect(&found, &[]);
        assert_eq!([count(&found, "changes"), count(&found, "missing")], [0, 0], "{e}: {found}");
        let [p, x] = last_state(&found);
        assert!(p == 3.0 && (x * x * x - 2.0 * x - e).abs() < 1e-12 && x > 1.0, "{e}: {x}");
    }
}

/// On x² + y² = 1 with V = (x − e)²/2 + p y: p = cos a − e cot a, which folds at (1 − e^(2/3))^(3/2).
#[test]
fn an_imperfection_on_a_circle_was_stepped_over() {
    for e in [1e-5, 1e-8, 1e-10] {
        let text = format!(
            "name: T\nparameters: {{p: 0}}\ncoordinates: {{x: 1, y: 1}}\nkinetic_energy: x'^2/2 + y'^2/2\n\
             constraints: {{rod: x^2 + y^2 - 1}}\npotential_energy: \"(x - {e:e})^2/2 + p*y\"\n\
             equilibrium: {{x: 0, y: 1}}\nscene: {{start: {{x: 0, y: 1}}, until: 1}}\n"
        );
        let found = file_varied("circle_of_an_imperfection", &text, &["--vary", "p=0..3"]);
        let fold = (1.0 - f64::powf(e, 2.0 / 3.0)).powf(1.5);
        let limits = limits(&found);
        let known = |(value, kind): &(f64, String)| (value - fold).abs() <= 1e-9 && kind == "fold";
        assert!(limits.first().is_some_and(known) && limits.len() == 1, "{e}: {fold} {limits:?}");
    }
}

const HOOP: &str = "name: T\nparameters: {m: 1 kg, R: 1 m, g: 10 m/s^2, W: 1 rad/s, e: 0 m}\ncoordinates: {r: m, z: m}\nkinetic_energy: m*(r'^2 + z'^2)/2\n\
    potential_energy: m*g*z - m*W^2*(r + e)^2/2\nconstraints: {hoop: r^2 + z^2 - R^2}\n\
    equilibrium: {r: 0, z: -1}\nscene: {start: {r: 0, z: -1}, until: 1}\n";

/// A bead on a hoop that turns about an axis beside its centre leaves the bottom without a threshold.
#[test]
fn a_bead_on_a_hoop_was_told_to_fall_from_its_bottom() {
    for e in ["1e-3", "1e-5", "1e-7", "1e-8", "1e-9"] {
        let set = format!("e={e}");
        let found = file_varied("hoop_beside_its_axis", HOOP, &["--set", &set, "--vary", "W=0..10"]);
        expect(&found, &[]);
        assert_eq!([count(&found, "changes"), count(&found, "missing")], [0, 0], "{e}: {found}");
        let steps = found["locus"]["steps"].as_array().expect("steps");
        let omega = |step: &Value| step["eigenvalues"][0][1].as_f64().expect("a number").abs();
        let e: f64 = e.parse().expect("a number");
        let [first, last] = [omega(&steps[0]), omega(steps.last().expect("a state"))];
        assert!((first - 10_f64.sqrt()).abs() < 1e-9, "{e}: {first}");
        assert!((last - 99_f64.sqrt()).abs() < 1e-9 + 10.0 * e, "{e}: {last}");
    }
}

/// x = 1/(s + 4 s²) with y = 2 x s, and the same without the constraint.
#[test]
fn a_pole_with_a_constraint_was_told_as_folds() {
    let text = |coordinates: &str, energy: &str, rest: &str| {
        format!(
            "name: T\nparameters: {{s: -1}}\ncoordinates: {{{coordinates}}}\nkinetic_energy: x'^2/2\n\
             potential_energy: {energy}\n{rest}equilibrium: {{x: 0.3}}\nscene: {{start: {{}}, until: 1}}\n"
        )
    };
    let held = text("x: 1, y: 1", "s*x^2/2 - x + y^2/2", "constraints: {c: y - 2*x*s}\n")
        .replace("x'^2/2\n", "x'^2/2 + y'^2/2\n");
    for (name, text) in [("pole_held", held), ("pole_free", text("x: 1", "s*x^2/2 - x + 2*x^2*s^2", ""))] {
        let found = file_varied(name, &text, &["--vary", "s=-1..1"]);
        expect(&found, &[(-0.25, "pole"), (0.0, "pole")]);
    }
}

/// What forces has a pole, or jumps, where the stiffness is 1 everywhere.
#[test]
fn a_pole_of_what_forces_was_told_as_the_end_of_a_branch() {
    expect(&potential("pole_of_tan", (0.1, 0.1), "(x - tan(p))^2/2", "0..3"), &[(std::f64::consts::FRAC_PI_2, "pole")]);
    expect(&potential("pole_of_load", (0.0, -1.0), "(x - 1/(p-1.1))^2/2", "0..3"), &[(1.1, "pole")]);
    // What only grows steeply has none, and a jump is where the branch ends.
    expect(&potential("no_pole", (0.1, 0.1), "(x - tan(p))^2/2", "0..1.57"), &[]);
    let jump = potential("jump", (0.0, 0.0), "(x - step(p - 1.234567))^2/2", "0..3");
    expect(&jump, &[]);
    let at = jump["locus"]["changes"][0]["value"].as_f64().expect("a change");
    assert!((at - 1.234567).abs() < 1e-9, "{at}");
}

/// A shallow truss: its branch folds, leaves the range on the side where it began, and comes back to it upside down.
#[test]
fn a_branch_that_comes_back_from_outside_was_lost() {
    let text = "name: T\nparameters: {m: 1 kg, k: 100 N/m, L: 1 m, l0: 1.2 m, q: 0 N}\ncoordinates: {y: m}\nbodies: {b: {mass: m, position: \"[0, y]\"}}\n\
        points: {A: \"[-L, 0]\", B: \"[L, 0]\"}\nsprings: {s1: {between: [A, b], stiffness: k, rest: l0}, \
        s2: {between: [B, b], stiffness: k, rest: l0}}\nforces: {f: {on: b, force: \"[0, -q*30]\"}}\n\
        equilibrium: {y: 0.66}\nscene: {start: {y: 0.66}, until: 1}\n";
    let found = file_varied("truss", text, &["--vary", "q=0..1"]);
    assert_eq!(count(&found, "missing"), 0, "{found}");
    let whole = file_varied("truss", text, &["--vary", "q=-1..1"]);
    for found in [&found, &whole] {
        let last = found["locus"]["steps"].as_array().expect("steps").last().expect("a state");
        let y = last["equilibrium"]["y"].as_f64().expect("a number");
        assert!(last["value"] == 1.0 && (y + 0.997_44).abs() < 1e-5, "{last}");
    }
    let folds = |found: &Value| limits(found).iter().map(|(value, _)| (value * 1e8).round() / 1e8).collect::<Vec<_>>();
    assert_eq!((folds(&found), folds(&whole)), (vec![0.30975653], vec![-0.30975653, 0.30975653]));
}

/// Two motions of different frequencies begin to grow at once, and two of one.
#[test]
fn of_two_motions_that_begin_to_grow_at_once_one_was_told() {
    let of = |stiffness: &str| {
        let text = format!(
            "name: T\nparameters: {{c: 1}}\ncoordinates: {{x: 1, y: 1}}\nkinetic_energy: x'^2/2 + y'^2/2\n\
             potential_energy: x^2/2 + {stiffness}*y^2/2\ngeneralized_forces: {{x: c*x', y: c*y'}}\n\
             scene: {{start: {{x: 1}}, until: 1}}\n"
        );
        let found = file_varied("two_at_once", &text, &["--vary", "c=-1..1"]);
        let limits = found["locus"]["limits"].as_array().expect("limits").iter();
        limits.map(|limit| (limit["omega"].as_f64().expect("a number"), limit["growing"].clone())).collect::<Vec<_>>()
    };
    let two = of("4");
    let near = |found: f64, expected: f64| (found - expected).abs() < 1e-9;
    assert!(two.len() == 2 && near(two[0].0, 1.0) && near(two[1].0, 2.0), "{two:?}");
    assert_eq!([&two[0].1, &two[1].1], [&serde_json::json!([0, 1]), &serde_json::json!([1, 2])]);
    let one = of("1");
    assert!(one.len() == 1 && near(one[0].0, 1.0) && one[0].1 == serde_json::json!([0, 2]), "{one:?}");
}

/// The same imperfection where y = x: the multiplier carries what is left of x alone, and has no terms of its own.
#[test]
fn rounding_of_what_a_multiplier_carries_was_told_as_no_equilibrium() {
    let text = "name: T\nparameters: {p: 0}\ncoordinates: {x: 1, y: 1}\nkinetic_energy: x'^2/2 + y'^2/2\n\
        constraints: {rod: y - x}\npotential_energy: \"(1-p)*x^2/2 + x^4/4 - 1e-8*x\"\n\
        equilibrium: {x: 0, y: 0}\nscene: {start: {x: 0, y: 0}, until: 1}\n";
    let found = file_varied("carried", text, &["--vary", "p=0..3"]);
    expect(&found, &[]);
    assert_eq!([count(&found, "changes"), count(&found, "missing")], [0, 0], "{found}");
}
