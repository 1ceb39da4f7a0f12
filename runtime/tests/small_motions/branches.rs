//! The command `modes --vary` of mechanisms with constraints: thresholds against closed forms, at any scale, each beside a
//! neighbour that must be left alone.

use dalembert::linear::{Guess, linearise_constrained};
use dalembert::mechanism::Interpreted;
use dalembert_symbolic::lower::compile;
use serde_json::Value;

use super::{limits, run, scratch, words};

/// `--set NAME=VALUE` of all parameters, and `--vary` of one.
fn with(set: &[(&str, f64)], (name, from, to): (&str, f64, f64)) -> Vec<String> {
    let set = set.iter().flat_map(|(name, value)| ["--set".to_owned(), format!("{name}={value:e}")]);
    set.chain(["--vary".to_owned(), format!("{name}={from:e}..{to:e}")]).collect()
}

fn vary(text: &str, set: &[(&str, f64)], range: (&str, f64, f64)) -> Value {
    let options = with(set, range);
    run(text, &options.iter().map(String::as_str).collect::<Vec<&str>>())
}

fn expect(found: &Value, expected: &[(f64, &str)]) {
    let limits = limits(found);
    let same = |(a, b): (&(f64, &str), &(f64, &str))| (a.0 - b.0).abs() <= 1e-8 * b.0.abs() && a.1 == b.1;
    let all = limits.len() == expected.len() && limits.iter().zip(expected).all(same);
    assert!(all, "{limits:?} is not {expected:?}");
    assert!(found["locus"]["changes"].as_array().unwrap().is_empty(), "{found}");
}

const SCALES: [f64; 3] = [1e-12, 1.0, 1e12];

const INVERTED: &str = "name: Inverted\nparameters: {m: 2 kg, L: 0.5 m, g: 9.81 m/s^2, k: 60 N/m}\ncoordinates: {x: m, y: m}\n\
    bodies: {bob: {mass: m, position: \"[x, y]\"}}\ngravity: [0, -g]\n\
    springs: {s: {stretch: x, stiffness: k, along: \"[1, 0]\", on: bob}}\nconstraints: {rod: x^2 + y^2 - L^2}\n\
    equilibrium: {x: 0, y: L}\nscene: {start: {x: 0, y: L}, until: 1}\n";

/// A spring holds an inverted pendulum upright from k = m g/L on; hanging it needs none.
#[test]
fn an_inverted_pendulum_on_a_rod_falls_below_its_stiffness() {
    for length in SCALES {
        for mass in SCALES {
            let set = [("m", mass), ("L", length)];
            let critical = mass * 9.81 / length;
            let range = ("k", 0.03 * critical, 2.7 * critical);
            expect(&vary(INVERTED, &[&set[..], &[("k", 0.7 * critical)]].concat(), range), &[(critical, "divergence")]);
            let hanging = INVERTED.replace("y: L}", "y: -L}");
            expect(&vary(&hanging, &set, range), &[]);
        }
    }
}

/// At the threshold itself nothing but terms of fourth order is left of the potential, which is said; a hair beside it, and
/// where a direction is free, nothing is.
#[test]
fn a_constrained_equilibrium_without_stiffness_is_degenerate_or_free() {
    let at = |text: &str, place: &[f64]| {
        let program = compile(text, &[]).unwrap_or_else(|problems| panic!("{text}: {problems:?}"));
        let found = linearise_constrained(&Interpreted::new(program, text), &Guess::at(place), false).unwrap();
        found.linear.equilibrium
    };
    let inverted = |k: &str, x: f64| at(&INVERTED.replace("60 N/m", k), &[x, 0.5]);
    for (k, degenerate) in [("39.24 N/m", true), ("39.2401 N/m", false), ("39.2399 N/m", false), ("0 N/m", false)] {
        assert_eq!(inverted(k, 0.0).is_degenerate(), degenerate, "{k}");
    }
    // From aside the search comes ever more slowly nearer; a hair beside the threshold it ends as any other.
    assert!(inverted("39.24 N/m", 0.1).is_degenerate());
    assert!(!inverted("40 N/m", 0.1).is_degenerate());
    let dumbbell = "name: Dumbbell\nparameters: {m: 1 kg, L: 1 m}\ncoordinates: {x1: m, y1: m, x2: m, y2: m}\n\
        bodies: {a: {mass: m, position: \"[x1, y1]\"}, b: {mass: m, position: \"[x2, y2]\"}}\n\
        constraints: {rod: (x2 - x1)^2 + (y2 - y1)^2 - L^2}\nscene: {start: {x1: 0, y1: 0, x2: L, y2: 0}, until: 1}\n";
    let freedom = at(dumbbell, &[0.0, 0.0, 1.0, 0.0]).freedom;
    assert_eq!((freedom.rank, freedom.family, freedom.degenerate.len()), (0, 3, 0));
}

const HOOP: &str = "name: Hoop\nparameters: {m: 1 kg, R: 1 m, g: 9.81 m/s^2, W: 1 rad/s}\ncoordinates: {r: m, z: m}\n\
    points: {p: \"[r*cos(W*t), r*sin(W*t), z]\"}\nbodies: {bead: {mass: m, position: p}}\ngravity: [0, 0, -g]\n\
    constraints: {hoop: r^2 + z^2 - R^2}\nequilibrium: {r: 0, z: -R}\nscene: {start: {r: 0, z: -R}, until: 1}\n";

/// A bead on a turning hoop leaves the bottom at ω² = g/R; the branch aside ends there, at the right places, and that is said.
/// The same row written twice changes nothing.
#[test]
fn a_bead_leaves_the_bottom_of_a_turning_hoop() {
    let twice = HOOP.replace("{hoop", "{again: 2*(r^2 + z^2 - R^2), hoop");
    for radius in SCALES {
        let critical = (9.81 / radius).sqrt();
        for text in [HOOP, &twice] {
            let found = vary(text, &[("R", radius)], ("W", 0.3 * critical, 2.0 * critical));
            expect(&found, &[(critical, "divergence")]);
        }
    }
    let aside = run(HOOP, &["--set", "W=6", "--at", "r=0.96", "--at", "z=-0.28", "--vary", "W=1..6"]);
    let critical = 9.81_f64.sqrt();
    let (value, kind) = limits(&aside)[0];
    assert!((value - critical).abs() < 1e-8 && kind == "bifurcation", "{value} {kind}");
    assert_eq!(aside["locus"]["changes"].as_array().unwrap().len(), 1);
    for step in aside["locus"]["steps"].as_array().unwrap() {
        let [w, z] = [&step["value"], &step["equilibrium"]["z"]].map(|x| x.as_f64().unwrap());
        let expected = if w > critical { -9.81 / (w * w) } else { -1.0 };
        assert!((z - expected).abs() < 1e-6, "{w}: {z} is not {expected}");
    }
}

/// A mass on a guide between two inclined springs in one (von Mises truss) snaps through at
/// k (L₀^(2/3) − b^(2/3))^(3/2).
#[test]
fn a_toggle_folds() {
    let text = "name: Toggle\nparameters: {m: 1 kg, b: 1 m, h: 0.2 m, k: 100 N/m, P: 0 N}\ncoordinates: {x: m, y: m}\n\
        points: {foot: [0, 0]}\nbodies: {p: {mass: m, position: \"[x, y]\"}}\n\
        springs: {s: {between: [foot, p], stiffness: k, rest: \"sqrt(b^2 + h^2)\"}}\n\
        forces: {load: {on: p, force: \"[0, -P]\"}}\nconstraints: {guide: x - b}\nequilibrium: {x: b, y: h}\n\
        scene: {start: {x: b, y: h}, until: 1}\n";
    for length in SCALES {
        for stiffness in SCALES {
            let set = [("b", length), ("h", 0.2 * length), ("k", stiffness), ("m", stiffness)];
            let rest = 1.04_f64.sqrt();
            let critical = stiffness * length * (rest.powf(2.0 / 3.0) - 1.0).powf(1.5);
            let found = vary(text, &set, ("P", 0.0, 20.0 * critical));
            let (value, kind) = limits(&found)[0];
            assert!((value - critical).abs() < 1e-8 * critical && kind == "fold", "{value} {kind}, not {critical}");
            assert!(found["locus"]["limits"][0]["constraint"].is_null());
            // Beyond, it has snapped through.
            let last = found["locus"]["steps"].as_array().unwrap().last().unwrap();
            assert!(last["equilibrium"]["y"].as_f64().unwrap() < -0.2 * length && last["growing"] == 0);
        }
    }
}

/// Two bars in all coordinates of their ends and angles.
fn ziegler(damping: f64) -> String {
    format!(
        "name: Ziegler\nparameters: {{r: 2 kg, m: 1 kg, l: 1 m, k: 1 N*m/rad, P: 0 N, c: {damping} N*m*s/rad}}\n\
         coordinates: {{x1: m, y1: m, x2: m, y2: m, a: rad, b: rad}}\n\
         bodies:\n  p: {{mass: r, position: \"[x1, y1]\"}}\n  q: {{mass: m, position: \"[x2, y2]\"}}\n\
         potential_energy: k*a^2/2 + k*(b - a)^2/2\ndissipation: c*a'^2/2 + c*(b' - a')^2/2\n\
         generalized_forces: {{x2: -P*cos(b), y2: -P*sin(b)}}\nconstraints:\n  one: \"[x1, y1] - l*[cos(a), sin(a)]\"\n  \
         two: \"[x2 - x1, y2 - y1] - l*[cos(b), sin(b)]\"\nequilibrium: {{x1: l, x2: 2*l}}\n\
         scene: {{start: {{x1: l, y1: 0, x2: 2*l, y2: 0, a: 0, b: 0}}, until: 1}}\n"
    )
}

/// Ziegler's column, its bars held by constraints: flutter at (5 + r)/2 − √r k/l, divergence at (5 + r)/2 + √r; damped, with
/// r = 2, flutter at 41/28 + c²/2 (Ziegler 1952).
#[test]
fn a_follower_force_on_constrained_bars() {
    let undamped = ziegler(0.0);
    for r in [0.5, 2.0, 4.0_f64] {
        let [first, second] = [0.5 * (5.0 + r) - r.sqrt(), 0.5 * (5.0 + r) + r.sqrt()];
        let found = vary(&undamped, &[("r", r)], ("P", 0.0, 6.6));
        expect(&found, &[(first, "flutter"), (second, "divergence")]);
    }
    for c in [0.1, 1.0] {
        // From inside of the range to both of its ends.
        let found = vary(&ziegler(c), &[("P", 1.0)], ("P", 0.0, 2.0));
        expect(&found, &[(41.0 / 28.0 + 0.5 * c * c, "flutter")]);
    }
    for scale in [1e-12, 1e12] {
        let found = vary(&undamped, &[("l", scale), ("r", 2.0), ("k", scale * scale)], ("P", 0.0, 5.5 * scale));
        let root = 2.0_f64.sqrt();
        expect(&found, &[((3.5 - root) * scale, "flutter"), ((3.5 + root) * scale, "divergence")]);
    }
}

/// Three rods hang between supports that part until they are straight: there the rods can be met no further, which is said
/// with the name of one of them, and the rest of the range has nothing.
#[test]
fn rods_that_are_stretched_straight_end_a_branch() {
    let text = "name: Hanging\nparameters: {m: 1 kg, l: 1 m, d: 2 m, g: 9.81 m/s^2}\n\
        coordinates: {x1: m, y1: m, x2: m, y2: m}\n\
        bodies: {a: {mass: m, position: \"[x1, y1]\"}, b: {mass: m, position: \"[x2, y2]\"}}\ngravity: [0, -g]\nconstraints:\n  \
        left: x1^2 + y1^2 - l^2\n  middle: (x2 - x1)^2 + (y2 - y1)^2 - l^2\n  right: (x2 - d)^2 + y2^2 - l^2\n\
        equilibrium: {x1: l/2, y1: -0.86*l, x2: 3*l/2, y2: -0.86*l}\n\
        scene: {start: {x1: l/2, x2: 3*l/2}, guess: {y1: -l, y2: -l}, until: 1}\n";
    for length in SCALES {
        let found = vary(text, &[("l", length), ("d", 2.0 * length)], ("d", length, 3.2 * length));
        let (value, kind) = limits(&found)[0];
        assert!((value - 3.0 * length).abs() < 1e-8 * length && kind == "fold", "{value} {kind}");
        let name = found["locus"]["limits"][0]["constraint"].as_str();
        assert!(["left", "middle", "right"].map(Some).contains(&name), "{name:?}");
        let short = vary(text, &[("l", length), ("d", 2.0 * length)], ("d", length, 2.9 * length));
        expect(&short, &[]);
    }
}

/// A parallelogram that is driven through the line in which all its bars lie: two of its rows depend on each other there.
/// With bars that differ by a hundredth they do not.
#[test]
fn a_parallelogram_loses_a_row_where_it_is_flat() {
    let text = |bar: &str| {
        format!(
            "name: Parallelogram\nparameters: {{m: 1 kg, l: 1 m, d: 2 m, g: 9.81 m/s^2, p: 0.5 rad}}\n\
             coordinates: {{a: rad, b: rad, c: rad, w: rad}}\npoints:\n  B: l*[cos(a), sin(a)]\n  \
             C: B + d*[cos(b), sin(b)]\n  D: \"[d, 0] + {bar}*[cos(c), sin(c)]\"\n\
             bodies: {{left: {{mass: m, position: B}}, right: {{mass: m, position: D}}, hung: {{mass: m, position: \"B + l*[sin(w), -cos(w)]\"}}}}\n\
             gravity: [0, -g]\nconstraints: {{drive: a - p, pin: C - D}}\nequilibrium: {{a: 0.5, c: 0.5}}\n\
             scene: {{start: {{a: p, w: 0}}, guess: {{a: 0.5, c: 0.5}}, until: 1}}\n"
        )
    };
    let found = run(&text("l"), &["--vary", "p=-0.3..1"]);
    let list = limits(&found);
    assert!(list.len() == 1 && list[0].0.abs() < 1e-6 && list[0].1 == "dependence", "{list:?}");
    assert_eq!(found["locus"]["limits"][0]["constraint"], "pin.x");
    let told = words(&text("l"), &["--vary", "p=-0.3..1"]).unwrap();
    assert!(told.contains("the constraint `pin.x` depends on others here"), "{told}");
    expect(&run(&text("1.01*l"), &["--vary", "p=-0.3..1"]), &[]);
}

/// Along a branch of the library's four-bar every state's eigenvalues are those of `modes` at that value, and the picture of
/// their paths is drawn.
/// Free turns and shifts leave a family of rests at every length: the branch keeps where it can, and loses nothing of the range.
#[test]
fn rests_that_are_families_are_followed_through_the_whole_range() {
    for size in [1e-6, 1.0, 1e6] {
        let dumbbell = "name: Dumbbell
parameters: {m: 1 kg, k: 100 N/m, l: 1 m}
coordinates: {x: m, y: m, u: m, v: m}
bodies: {a: {mass: m, position: \"[x, y]\"}, b: {mass: 2*m, position: \"[u, v]\"}}
springs: {s: {between: [a, b], stiffness: k, rest: l}}
equilibrium: {u: 0.8*l, v: 0.6*l}
";
        let found = vary(dumbbell, &[("l", size)], ("l", 0.5 * size, 2.0 * size));
        expect(&found, &[]);
        let steps = found["locus"]["steps"].as_array().unwrap();
        let ends = [&steps[0], &steps[steps.len() - 1]].map(|step| step["value"].as_f64().unwrap());
        assert!(
            (ends[0] / (0.5 * size) - 1.0).abs() < 1e-12 && (ends[1] / (2.0 * size) - 1.0).abs() < 1e-12,
            "{ends:?}"
        );
        // ω² = k/μ whatever the length.
        for step in steps {
            let largest =
                step["eigenvalues"].as_array().unwrap().iter().map(|x| x[1].as_f64().unwrap()).fold(0.0, f64::max);
            assert!((largest / 150.0_f64.sqrt() - 1.0).abs() < 1e-9, "{step}");
        }
    }
}

#[test]
fn eigenvalues_along_a_branch_are_those_of_its_states() {
    let model = format!("{}/../models/four_bar.yaml", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(model).unwrap();
    let picture = scratch("locus.svg");
    let found = run(&text, &["--vary", "crank=0.5..1.5", "--locus", picture.to_str().unwrap()]);
    let drawn = std::fs::read_to_string(&picture).unwrap();
    std::fs::remove_file(&picture).unwrap();
    assert!(drawn.contains("<svg") && drawn.contains("crank"));
    let steps = found["locus"]["steps"].as_array().unwrap();
    assert!(steps.len() > 20);
    for step in [&steps[0], &steps[steps.len() / 2], &steps[steps.len() - 1]] {
        let value = format!("crank={:e}", step["value"].as_f64().unwrap());
        let at = ["crank_angle", "coupler_angle", "rocker_angle"]
            .map(|name| format!("{name}={:e}", step["equilibrium"][name].as_f64().unwrap()));
        let there = run(&text, &["--set", &value, "--at", &at[0], "--at", &at[1], "--at", &at[2]]);
        let pair = |x: &Value| [0, 1].map(|part| x[part].as_f64().unwrap());
        let largest = |list: &Value| list.as_array().unwrap().iter().map(pair).fold(0.0_f64, |most, x| most.max(x[0]));
        let (along, direct) = (largest(&step["eigenvalues"]), there["modes"][0]["omega"].as_f64().unwrap());
        assert!((along - direct).abs() < 1e-9 * direct, "{along} is not {direct}");
    }
}

/// A sled on an edge, its centre of mass a before the edge, and Chaplygin's: forwards it keeps straight by −m a v/(J + m a²),
/// backwards it turns round; at rest nothing moves it.
#[test]
fn constraints_with_speeds_leave_a_branch_of_departures() {
    let sled = "name: Sled\nparameters: {m: 1 kg, I: 0.2 kg*m^2, d: 0.3 m}\ncoordinates: {x: m, y: m, a: rad}\n\
        points: {edge: \"[x, y]\", centre: \"[x + d*cos(a), y + d*sin(a)]\"}\n\
        bodies: {sled: {mass: m, inertia: I, angle: a, position: centre}}\n\
        constraints: {edge: \"y'*cos(a) - x'*sin(a)\"}\nscene: {start: {x: 0, y: 0, a: 0, x': 2}, until: 1}\n";
    let found = run(sled, &["--steady", "--vary", "x'=-3..3"]);
    let [(value, kind)] = limits(&found)[..] else { panic!("{}", found["locus"]["limits"]) };
    assert!(kind == "divergence" && value.abs() < 1e-12, "{kind} at {value}");
    for step in found["locus"]["steps"].as_array().unwrap() {
        let speed = step["value"].as_f64().unwrap();
        let last = step["eigenvalues"].as_array().unwrap().last().unwrap()[0].as_f64().unwrap();
        let expected = -0.3 * speed / (0.2 + 0.3 * 0.3);
        assert!((last - expected).abs() < 1e-13 * 3.0, "{speed}: {last} is not {expected}");
        assert_eq!(step["growing"], u64::from(speed < 0.0), "{step}");
    }
    let resting = run(sled, &["--vary", "m=1..2"]);
    assert!(limits(&resting).is_empty() && resting["locus"]["steps"][0]["growing"] == 0, "{resting}");
}

/// A threshold is told with the digits that rounding leaves: damping from below 0 to above it meets 0 and nothing near it.
#[test]
fn a_threshold_that_rounding_hides_has_no_false_digits() {
    let truss = "name: Arch\nparameters: {m: 1 kg, k: 1000 N/m, b: 1 m, h: 0.3 m, c: 1 N*s/m}\ncoordinates: {y: m}\n\
        define: {l0: sqrt(b^2 + h^2)}\nbodies: {p: {mass: m, position: \"[0, y]\"}}\npoints: {A: \"[-b, 0]\", B: \"[b, 0]\"}\n\
        springs: {s1: {between: [A, p], stiffness: k, rest: l0}, s2: {between: [B, p], stiffness: k, rest: l0}}\n\
        dampers: {d1: {between: [A, p], damping: c}}\nequilibrium: {y: h}\nscene: {start: {y: h}, until: 1}\n";
    let told = words(truss, &["--vary", "c=-1..1"]).unwrap();
    assert!(told.contains("c = 0 N*s/m: growth ends"), "{told}");
    let found = run(truss, &["--vary", "c=-1..1"]);
    let limit = &found["locus"]["limits"][0];
    let [value, hidden] = ["value", "hidden"].map(|key| limit[key].as_f64().unwrap());
    assert!(value.abs() <= hidden && hidden < 1e-10, "{limit}");
    // One that is well apart keeps its ten digits.
    let told = words(INVERTED, &["--set", "k=30", "--vary", "k=1..100"]).unwrap();
    assert!(told.contains("k = 39.24 N/m: growth ends"), "{told}");
}
