//! Motions that repeat, against references of twenty digits and more and closed forms.

use dalembert::prelude::*;
use dalembert_models::MODELS;
use dalembert_tests::told::{near, number, reference, written};
use serde_json::Value;

/// What `orbit` prints as JSON, or what it says is wrong.
fn told(arguments: &[&str]) -> Result<Value, String> {
    dalembert_tests::told::told(&[&["orbit"], arguments].concat())
}

/// A value is as near to the reference as its error says, and as this.
fn holds(found: &Value, expected: f64, error: f64) {
    near(number(&found["value"]), expected, error);
    near(number(&found["value"]), expected, number(&found["error"]) + 1e-15 * expected.abs());
}

/// Every expected multiplier (re, im) is among those found.
fn multiplied(found: &Value, expected: &Value, error: f64) {
    let found: Vec<[f64; 2]> =
        found.as_array().expect("multipliers").iter().map(|m| [number(&m["re"]), number(&m["im"])]).collect();
    for pair in expected.as_array().expect("multipliers") {
        let [re, im] = [number(&pair[0]), number(&pair[1])];
        let nearest = found.iter().map(|m| (m[0] - re).hypot(m[1] - im)).fold(f64::INFINITY, f64::min);
        assert!(nearest <= error, "{re} {im}: {found:?}");
    }
}

fn van_der_pol() -> String {
    written(
        "name: VanDerPol\nparameters: {mu: 1}\ncoordinates: {x: 1}\nkinetic_energy: x'^2/2\npotential_energy: x^2/2\n\
         generalized_forces: {x: mu*(1 - x^2)*x'}\nscene: {start: {x: 2, x': 0}, until: 40, tolerance: 1e-12}\n",
    )
}

/// The multiplier of mu = 5 is 8·10⁻³⁸, which no monodromy matrix holds.
#[test]
fn van_der_pols_oscillator_has_its_period_and_a_multiplier_far_below_rounding() {
    let (file, known) = (van_der_pol(), reference("van_der_pol"));
    for mu in ["1", "5"] {
        let found = told(&[&file, "--set", &format!("mu={mu}")]).unwrap();
        holds(&found["period"], number(&known["mu"][mu]["period"]), 1e-12);
        let (log, error) = (number(&found["whole"][0]["log_abs"]), number(&found["whole"][0]["error"]));
        near(log, number(&known["mu"][mu]["multiplier"]).ln(), error.min(1e-8));
        assert_eq!(found["map"]["part"], 2);
        assert_eq!(found["known"], serde_json::json!(["time"]));
        assert!(number(&found["returns"]) < 1e-11);
    }
    // Six starts, far off in place and period: found or refused, never another motion.
    let mut count = 0;
    for (x, period) in [("0.5", "4.6"), ("1", "13"), ("1.5", "6"), ("2.5", "9"), ("3", "11"), ("4", "7")] {
        match told(&[&file, "--set", "mu=2", "--start", &format!("x={x}"), "--period", period]) {
            Ok(found) => {
                near(number(&found["period"]["value"]), 7.629_874_48, 1e-8);
                count += 1;
            }
            Err(why) => assert!(why.contains("search") || why.contains("equilibrium"), "{why}"),
        }
    }
    assert!(count >= 4, "{count} of 6");
}

/// Along a family pieces are cut as its motions ask for.  By Liouville's formula the multiplier is the exponential of ∮ μ (1 − x²) dt, which a
/// Runge-Kutta method with 10⁶ steps finds as −204.1209 for μ = 8 and −442.4935 for μ = 12.
#[test]
fn families_of_relaxation_oscillations_keep_the_digits_of_their_multipliers() {
    let found = told(&[&van_der_pol(), "--vary", "mu=3,8,12"]).unwrap();
    for (mu, log) in [(8.0, -204.1209), (12.0, -442.4935)] {
        let members = found["members"].as_array().unwrap();
        let member = members.iter().find(|m| m["asked"] == true && (number(&m["value"]) - mu).abs() < 1e-9).unwrap();
        let multiplier = &member["multipliers"][0];
        near(2.0 * number(&multiplier["log_abs"]), log, 1e-4);
        assert!(number(&multiplier["error"]) < 1e-4, "{multiplier}");
    }
}

/// What is known beforehand is so at a loose tolerance, too.
#[test]
fn a_loose_tolerance_leaves_the_multiplier_of_time_known() {
    let found = told(&[&van_der_pol(), "--set", "mu=5", "--until", "20", "--tolerance", "1e-4"]).unwrap();
    assert_eq!(found["known"], serde_json::json!(["time"]), "{found}");
    let expected = number(&reference("van_der_pol")["mu"]["5"]["multiplier"]).ln();
    near(number(&found["whole"][0]["log_abs"]), expected, number(&found["whole"][0]["error"]));
}

/// T = 4 K(m)/√(1 + k A²) with m = k A²/(2 (1 + k A²)) of x'' = −x − k x³ with the energy A²/2 + k A⁴/4, K by the arithmetic-geometric mean.
#[test]
fn a_loose_tolerance_finds_the_shortest_period() {
    let file = written(
        "name: Free\nparameters: {k3: 1}\ncoordinates: {x: 1}\nkinetic_energy: x'^2/2\npotential_energy: x^2/2 + k3*x^4/4\n\
         scene: {start: {x: 1}, until: 100, tolerance: 1e-12}\n",
    );
    for (k, tolerance, least) in [(1.0, "1e-8", 1e-7), (5.0, "1e-6", 1e-5), (1.0, "1e-4", 1e-3)] {
        let (set, energy) = (format!("k3={k}"), 5.0_f64);
        let arguments = ["--from", "mode 1", "--energy", "5", "--set", &set, "--tolerance", tolerance];
        let found = told(&[&[file.as_str()], &arguments[..]].concat()).unwrap();
        let square = ((1.0 + 4.0 * k * energy).sqrt() - 1.0) / k;
        let stiffness = 1.0 + k * square;
        let (mut a, mut b) = (1.0, (1.0 - 0.5 * k * square / stiffness).sqrt());
        for _ in 0..8 {
            (a, b) = (0.5 * (a + b), (a * b).sqrt());
        }
        near(number(&found["period"]["value"]), std::f64::consts::TAU / (a * stiffness.sqrt()), least);
    }
}

/// The figure eight from its eight digits: T |E|^1.5 does not depend on which member of its family is found.
#[test]
fn the_figure_eight_is_found_with_its_eight_multipliers_of_one() {
    let known = reference("figure_eight");
    let found = told(&["figure_eight", "--tolerance", "1e-13", "--period", "6.3"]).unwrap();
    let energy = number(&found["energy"]);
    let invariant = number(&found["period"]["value"]) * energy.abs().powf(1.5);
    near(invariant, number(&known["invariant_T_absE_3_2"]), 1e-13);
    assert!(found["steps"].as_u64().unwrap() <= 6, "{}", found["steps"]);
    let mut rates: Vec<f64> =
        found["whole"].as_array().unwrap().iter().map(|m| number(&m["angle"]).abs() / std::f64::consts::TAU).collect();
    rates.sort_by(f64::total_cmp);
    assert_eq!(rates.len(), 4);
    near(rates[0], number(&known["nu"][0]), 1e-10);
    near(rates[2], number(&known["nu"][1]), 1e-10);
    assert_eq!(found["known"].as_array().unwrap().len(), 8, "{}", found["known"]);
    let free: Vec<&str> = found["free"].as_array().unwrap().iter().filter_map(Value::as_str).collect();
    let shifts = ["shift of x[1], x[2], x[3]", "shift of y[1], y[2], y[3]"];
    assert_eq!(free, ["time", shifts[0], shifts[1], "the motion of `spin`", "scale"]);
}

/// Two families of the double pendulum at six energies each; the one out of phase has a full map that touches −1 at 1.8863 J, where nothing
/// happens, and loses its stability at 8.17 J.
#[test]
fn the_double_pendulum_swings_in_two_families() {
    let known = reference("double_pendulum");
    for mode in [1, 2] {
        let found =
            told(&["double_pendulum", "--from", &format!("mode {mode}"), "--vary", "energy=0.1,2,6,8.3"]).unwrap();
        for point in known["points"].as_array().unwrap().iter().filter(|point| point["mode"] == mode) {
            let energy = number(&point["energy_above_rest"]);
            let members = found["members"].as_array().unwrap();
            let member = members.iter().find(|m| m["asked"] == true && (number(&m["value"]) - energy).abs() < 1e-9);
            let member = member.unwrap_or_else(|| panic!("no member at {energy} J"));
            near(number(&member["period"]), number(&point["period"]), 1e-10);
            // The half map's multipliers squared are those of the whole period.
            let whole = (2.0 * number(&member["multipliers"][0]["angle"])).cos();
            near(whole, number(&point["half_trace"]), 1e-8);
        }
        let thresholds = found["thresholds"].as_array().unwrap();
        if mode == 2 {
            assert_eq!(thresholds.len(), 1, "{thresholds:?}");
            let expected = number(&known["loss_of_stability"]["point"]["energy_above_rest"]);
            holds(&thresholds[0], expected, 1e-8);
        } else {
            assert!(thresholds.is_empty(), "{thresholds:?}");
        }
    }
}

/// A spring that hardens, with a force and a damper.
fn hardening() -> String {
    written(
        "name: Hardening\nparameters: {d: 0.1, f: 0.3, k3: 1, w: 1.5}\ncoordinates: {x: 1}\ninputs: {shake: f*cos(w*t)}\n\
         kinetic_energy: x'^2/2\npotential_energy: x^2/2 + k3*x^4/4\ndissipation: d*x'^2/2\n\
         generalized_forces: {x: shake}\nscene: {start: {x: 0, x': 0}, until: 100, tolerance: 1e-12}\n",
    )
}

/// The answer of a linear oscillator is greatest at w² = 1 − d²/2, where its amplitude is f/(d √(1 − d²/4)).
#[test]
fn the_peak_of_a_forced_response_is_told() {
    let found = told(&[&hardening(), "--set", "k3=0", "--set", "d=0.4", "--vary", "w=0.6..2.6"]).unwrap();
    let peaks = found["peaks"].as_array().unwrap();
    assert_eq!(peaks.len(), 1, "{peaks:?}");
    assert_eq!(peaks[0]["of"], "x");
    holds(&peaks[0], (1.0_f64 - 0.08).sqrt(), 1e-9);
    near(number(&peaks[0]["amplitude"]), 0.3 / (0.4 * 0.96_f64.sqrt()), 1e-10);
}

/// A force of amplitude 0 gives no period, and a damper of coefficient 0 takes no energy: x'' + x + x³ = 0 from x = 1 has the period
/// 2π/agm(√2, √(3/2)), and the energy 3/4.
#[test]
fn what_is_multiplied_by_a_parameter_that_is_zero_does_not_act() {
    let file = hardening();
    let (mut a, mut b) = (2.0_f64.sqrt(), 1.5_f64.sqrt());
    while (a - b).abs() > 1e-15 {
        (a, b) = (0.5 * (a + b), (a * b).sqrt());
    }
    let free = [file.as_str(), "--set", "d=0", "--set", "f=0", "--start", "x=1"];
    let found = told(&[&free[..], &["--energy", "0.75"]].concat()).unwrap();
    holds(&found["period"], std::f64::consts::TAU / a, 1e-11);
    near(number(&told(&free).unwrap()["energy"]), 0.75, 1e-2);
    // One of both acts.
    let refused = told(&[&file, "--set", "f=0", "--start", "x=1", "--energy", "0.75"]).unwrap_err();
    assert!(refused.contains("does not keep its energy"), "{refused}");
    let refused = told(&[&file, "--set", "f=0"]).unwrap_err();
    assert!(refused.contains("equilibrium"), "{refused}");
    // A family may begin where what drives it is 0.
    let found = told(&[&file, "--vary", "f=0,0.3"]).unwrap();
    near(number(&found["members"].as_array().unwrap().last().unwrap()["value"]), 0.3, 1e-12);
}

/// A range is the family from its first value to its last, wherever the search begins; a single motion is found where its family leads.
#[test]
fn energies_of_a_range_are_kept_and_reached() {
    let known = reference("double_pendulum");
    for range in ["energy=3..0.1", "energy=0.1..3"] {
        let found = told(&["double_pendulum", "--from", "mode 1", "--vary", range]).unwrap();
        let members = found["members"].as_array().unwrap();
        let values: Vec<f64> = members.iter().map(|member| number(&member["value"])).collect();
        let way = if range.ends_with('3') { 1.0 } else { -1.0 };
        assert!(values.len() > 10 && values.windows(2).all(|pair| way * (pair[1] - pair[0]) > 0.0), "{values:?}");
        let (low, high) = if way > 0.0 { (0, values.len() - 1) } else { (values.len() - 1, 0) };
        near(values[low], 0.1, 1e-12);
        near(values[high], 3.0, 1e-12);
        let first = known["points"].as_array().unwrap().iter().find(|point| point["energy_above_rest"] == "0.1");
        near(number(&members[low]["period"]), number(&first.unwrap()["period"]), 1e-10);
    }
    let point = &known["loss_of_stability"]["point"];
    let energy = point["energy_above_rest"].as_str().unwrap();
    let found = told(&["double_pendulum", "--from", "mode 2", "--energy", energy]).unwrap();
    near(number(&found["period"]["value"]), number(&point["period"]), 1e-8);
}

/// Duffing's oscillator: the forced response turns back twice.
#[test]
fn a_forced_response_turns_back_where_the_reference_says() {
    let file = written(
        "name: Duffing\nparameters: {d: 0.1, f: 0.3, w: 1.5}\ncoordinates: {x: 1}\ninputs: {shake: f*cos(w*t)}\n\
         kinetic_energy: x'^2/2\npotential_energy: x^2/2 + x^4/4\ndissipation: d*x'^2/2\n\
         generalized_forces: {x: shake}\nscene: {start: {x: 0, x': 0}, until: 100, tolerance: 1e-12}\n",
    );
    // The way back meets the same folds in the other order.
    let back = told(&[&file, "--vary", "w=2.6..0.6"]).unwrap();
    let values = |found: &Value| -> Vec<f64> {
        found["thresholds"].as_array().unwrap().iter().map(|threshold| number(&threshold["value"])).collect()
    };
    let found = told(&[&file, "--vary", "w=0.6..2.6"]).unwrap();
    for (a, b) in values(&found).iter().zip(values(&back).iter().rev()) {
        near(*a, *b, 1e-10);
    }
    let folds: Vec<&Value> =
        found["thresholds"].as_array().unwrap().iter().filter(|threshold| threshold["kind"] == "fold").collect();
    let known = reference("duffing");
    assert_eq!(folds.len(), 2, "{}", found["thresholds"]);
    for (fold, expected) in folds.iter().zip(known["folds"].as_array().unwrap()) {
        near(number(&fold["value"]), number(&expected["omega"]), 1e-11);
    }
    // Beside the first one the motion goes as far as the free oscillator of that frequency, to first order w² = 1 + 3/4 x².
    let (w, amplitude) = (number(&folds[0]["value"]), number(&folds[0]["member"]["amplitudes"]["x"]));
    near(amplitude, ((w * w - 1.0) / 0.75).sqrt(), 0.05);
    assert!(found["members"].as_array().unwrap().len() <= 120);
    let unstable = found["members"].as_array().unwrap().iter().filter(|member| {
        let first = &member["multipliers"][0];
        number(&first["log_abs"]) > 1e-6
    });
    assert!(unstable.count() > 3);
}

/// A pendulum under a torque f cos w t swings as far to one side as to the other, until this breaks: the branch has the period of the torque, and is
/// where a Runge-Kutta method of fixed steps settles.
#[test]
fn a_driven_pendulum_loses_its_symmetry_and_keeps_its_period() {
    let file = written(
        "name: Driven\nparameters: {c: 0.5, f: 0.8, w: 0.6667}\ncoordinates: {x: 1}\ninputs: {a: f*cos(w*t)}\n\
         kinetic_energy: x'^2/2\npotential_energy: -cos(x)\ndissipation: c*x'^2/2\ngeneralized_forces: {x: a}\n\
         scene: {start: {x: 0}, until: 200, tolerance: 1e-12}\n",
    );
    let symmetric = told(&[&file, "--vary", "f=0.8..1.05"]).unwrap();
    assert_eq!(symmetric["map"]["part"], 2);
    assert_eq!(symmetric["thresholds"][0]["kind"], "symmetry", "{}", symmetric["thresholds"]);
    let threshold = number(&symmetric["thresholds"][0]["value"]);
    let found = told(&[&file, "--vary", "f=0.8,1.03,1.05", "--branch", "1"]).unwrap();
    assert_eq!(found["map"], serde_json::json!({"part": 1, "does": ""}));
    let members = found["members"].as_array().unwrap();
    // It begins at the threshold.
    near(number(&members[0]["value"]), threshold, 1e-4);
    let member = members.iter().find(|m| (number(&m["value"]) - 1.03).abs() < 1e-9).unwrap();
    let period = std::f64::consts::TAU / 0.6667;
    near(number(&member["period"]), period, 1e-12);
    let settled = settled_pendulum(1.03, 0.6667, 0.0);
    // Of the two that are mirror images of each other half a period later either is found.
    let image = settled_pendulum(1.03, 0.6667, 0.5).map(|x| -x);
    let start = [number(&member["start"]["x"]), number(&member["start"]["x'"])];
    let apart = |other: [f64; 2]| (start[0] - other[0]).hypot(start[1] - other[1]);
    assert!(apart(settled).min(apart(image)) < 1e-8, "{start:?} {settled:?} {image:?}");
}

/// The state of x'' = f cos w t − x'/2 − sin x after 100 periods and a part of one from rest, by the Runge-Kutta method of the fourth order.
fn settled_pendulum(f: f64, w: f64, part: f64) -> [f64; 2] {
    let steps = 1000;
    let h = std::f64::consts::TAU / w / f64::from(steps);
    let rate = |t: f64, [x, v]: [f64; 2]| [v, f * (w * t).cos() - 0.5 * v - x.sin()];
    let moved = |[x, v]: [f64; 2], [dx, dv]: [f64; 2], h: f64| [x + h * dx, v + h * dv];
    let mut y = [0.0; 2];
    for k in 0..100 * steps + (part * f64::from(steps)) as i32 {
        let t = f64::from(k) * h;
        let a = rate(t, y);
        let b = rate(t + 0.5 * h, moved(y, a, 0.5 * h));
        let c = rate(t + 0.5 * h, moved(y, b, 0.5 * h));
        let d = rate(t + h, moved(y, c, h));
        for (y, slopes) in y.iter_mut().zip([0, 1].map(|i| a[i] + 2.0 * (b[i] + c[i]) + d[i])) {
            *y += h / 6.0 * slopes;
        }
    }
    y
}

/// A mass between a floor and a wall, off which it bounces without loss: two motions of one freedom, each with its own energy, whose four multipliers
/// are 1.  Two of them come apart by the root of rounding.
#[test]
fn a_double_multiplier_of_one_grows_by_rounding_alone() {
    let file = written(
        "name: Parts\nparameters: {m: 1 kg, g: 10 m/s^2, e: 1, d: 1 m, k: 4 N/m}\ncoordinates: {x: m, y: m}\n\
         points: {P: \"[x, y]\"}\nbodies: {b: {mass: m, position: P}}\n\
         springs: {s: {stretch: x, stiffness: k, along: ground.x, on: b}}\ngravity: [0, -g]\n\
         constraints: {floor: y, wall: x - d}\nphases: {free: [], f: [floor], w: [wall]}\nevents:\n\
         \x20 bounce: {phase: free, when: y, direction: falling, then: {impact: e, along: floor}}\n\
         \x20 hit: {phase: free, when: x - d, direction: rising, then: {impact: e, along: wall}}\n\
         scene: {start: {x: 0, y: 0.8, x': 2.5, y': 0}, until: 20, tolerance: 1e-12}\n",
    );
    for more in [&["--period", "1.6"][..], &[]] {
        let found = told(&[&[file.as_str()], more].concat()).unwrap();
        assert_eq!(found["stable"], true, "{found}");
        for multiplier in found["multipliers"].as_array().unwrap() {
            let off = (number(&multiplier["re"]) - 1.0).hypot(number(&multiplier["im"]));
            assert!(off <= number(&multiplier["error"]) && off < 1e-5, "{multiplier}");
        }
    }
}

/// An oscillator beside a wall at 1 m.  Off a wall without loss it bounces with any energy beyond 0.5 J: with one freedom all multipliers are known,
/// also where it all but touches.  With loss it has no motion that repeats beyond 0.5 J.
#[test]
fn families_end_where_a_wall_is_touched() {
    let file = written(
        "name: Graze\nparameters: {m: 1 kg, k: 1 N/m, w: 1 m, e: 0.5}\ncoordinates: {x: m}\npoints: {P: \"[x, 0]\"}\n\
         bodies: {b: {mass: m, position: P}}\nsprings: {s: {stretch: x, stiffness: k}}\nconstraints: {wall: x - w}\n\
         phases: {free: [], at: [wall]}\n\
         events: {hit: {phase: free, when: x - w, direction: rising, then: {impact: e, along: wall}}}\n\
         scene: {start: {x: -1}, until: 40, tolerance: 1e-11}\n",
    );
    let arguments = ["--set", "e=1", "--start", "x=-1.2", "--vary", "energy=0.72..0.45"];
    let found = told(&[&[file.as_str()], &arguments[..]].concat()).unwrap();
    assert_eq!(found["thresholds"], serde_json::json!([]));
    assert!(found["ended"].as_str().unwrap().contains("touched"), "{}", found["ended"]);
    for member in found["members"].as_array().unwrap() {
        assert_eq!(member["multipliers"], serde_json::json!([]), "{member}");
        // From the wall at w = A cos φ to the wall again: T = 2 (π − φ), which grows like a root where the wall is all but touched.
        let energy = number(&member["value"]);
        if energy > 0.501 {
            let phi = (1.0 / (2.0 * energy).sqrt()).acos();
            near(number(&member["period"]), 2.0 * (std::f64::consts::PI - phi), 1e-11);
        }
    }
    let found = told(&[&file, "--from", "mode 1", "--vary", "energy=0.1..0.8"]).unwrap();
    let members = found["members"].as_array().unwrap();
    assert!(members.len() > 5 && members.iter().all(|member| number(&member["value"]) < 0.5 + 1e-6), "{found}");
    assert!(found["ended"].is_string());
}

fn compass(masses: &str) -> String {
    written(&format!(
        "name: Compass\nparameters: {{m1: 5 kg, m2: {masses}, mh: 10 kg, a: 0.5 m, b: 0.5 m, g: 9.81 m/s^2, slope: 3 deg}}\n\
         coordinates: {{x: m, y: m, p: rad, s: rad}}\ndefine: {{l: a + b}}\n\
         points:\n  hip: \"[x, y]\"\n  foot1: \"hip + l*[sin(p), -cos(p)]\"\n  foot2: \"hip + l*[sin(s), -cos(s)]\"\n\
         \x20 g1: \"hip + b*[sin(p), -cos(p)]\"\n  g2: \"hip + b*[sin(s), -cos(s)]\"\n\
         bodies:\n  pelvis: {{mass: mh, position: hip}}\n  leg1: {{mass: m1, inertia: 0, angle: p, position: g1}}\n\
         \x20 leg2: {{mass: m2, inertia: 0, angle: s, position: g2}}\ngravity: g*[sin(slope), -cos(slope)]\n\
         constraints: {{hold1: velocity(foot1), hold2: velocity(foot2)}}\nphases: {{on1: [hold1], on2: [hold2]}}\n\
         events:\n  strike2: {{phase: on1, when: foot2.y - foot1.y, direction: falling, if: foot2.x - foot1.x - 0.1*l, then: on2}}\n\
         \x20 strike1: {{phase: on2, when: foot1.y - foot2.y, direction: falling, if: foot1.x - foot2.x - 0.1*l, then: on1}}\n\
         scene: {{start: {{x: -0.2677, y: 0.9635, p: 0.27, s: -0.27, \"p'\": -1.1, \"s'\": -0.4}}, until: 3, tolerance: 1e-12}}\n"
    ))
}

const STEP: [&str; 6] = ["--at", "strike2", "--exchange", "p=s,on1=on2", "--shift", "x"];

/// A walker with masses, from a plain model file.
#[test]
fn a_compass_walks_down_a_slope() {
    let file = compass("5 kg");
    let found = told(&[&[file.as_str()][..], &STEP].concat()).unwrap();
    let known = &reference("compass_walker")["points"][0];
    holds(&found["start"]["p"], number(&known["alpha"]), 1e-10);
    holds(&found["start"]["p'"], number(&known["stance_rate"]), 1e-10);
    holds(&found["start"]["s'"], number(&known["swing_rate"]), 1e-10);
    holds(&found["period"], 2.0 * number(&known["step_time"]), 1e-10);
    multiplied(&found["multipliers"], &known["multipliers"], 1e-9);
    assert_eq!(found["multipliers"].as_array().unwrap().len(), 3);
    // Legs of other masses are no mirror images of each other.
    let refused = told(&[&[compass("6 kg").as_str()][..], &STEP].concat()).unwrap_err();
    assert!(refused.contains("acceleration of"), "{refused}");
    // Without the exchange a step ends on the other foot.
    let refused = told(&[&file, "--at", "strike2", "--shift", "x"]).unwrap_err();
    assert!(refused.contains("on2"), "{refused}");
    let refused = told(&[&file, "--at", "strike2", "--exchange", "p=s,on1=on2", "--shift", "p"]).unwrap_err();
    assert!(refused.contains("`p` cannot differ"), "{refused}");
}

/// The simplest walker (Garcia and others, 1998), of which only the hip has a mass: here with feet of 10⁻¹².
fn simplest_walker() -> String {
    written(
        "name: Walker\nparameters: {m: 1, beta: 1e-12, l: 1, g: 1, slope: 0.009}\n\
         coordinates: {x: 1, y: 1, p: rad, s: rad}\n\
         points: {hip: \"[x, y]\", foot1: \"hip + l*[sin(p), -cos(p)]\", foot2: \"hip + l*[sin(s), -cos(s)]\"}\n\
         bodies: {pelvis: {mass: m, position: hip}, toe1: {mass: beta, position: foot1}, toe2: {mass: beta, position: foot2}}\n\
         gravity: g*[sin(slope), -cos(slope)]\nconstraints: {hold1: velocity(foot1), hold2: velocity(foot2)}\n\
         phases: {on1: [hold1], on2: [hold2]}\nevents:\n\
         \x20 strike2: {phase: on1, when: foot2.y - foot1.y, direction: falling, if: foot2.x - foot1.x - 0.1*l, then: on2}\n\
         \x20 strike1: {phase: on2, when: foot1.y - foot2.y, direction: falling, if: foot1.x - foot2.x - 0.1*l, then: on1}\n\
         scene: {start: {x: -0.199, y: 0.98, p: 0.2003, s: -0.2003, \"p'\": -0.19983, \"s'\": -0.184}, until: 10, tolerance: 1e-12}\n",
    )
}

#[test]
fn the_simplest_walker_walks_on_feet_of_next_to_no_mass() {
    let (file, known) = (simplest_walker(), reference("simplest_walker"));
    let short = ["--start", "p=0.194", "--start", "s=-0.194", "--start", "p'=-0.2039", "--start", "s'=-0.188"];
    for (place, slope, more) in [(0, "0.009", &[][..]), (1, "0.012", &[]), (2, "0.009", &short)] {
        let (found, known) = (
            told(&[&[file.as_str(), "--set", &format!("slope={slope}")][..], &STEP, more].concat()).unwrap(),
            &known["points"][place],
        );
        // The reference has no feet: its numbers are the model's but for some 10⁻¹³.
        for (name, expected) in [("p", "theta"), ("p'", "thetadot")] {
            near(number(&found["start"][name]["value"]), number(&known[expected]), 1e-11);
        }
        near(number(&found["period"]["value"]), 2.0 * number(&known["step_time"]), 1e-11);
        multiplied(&found["multipliers"], &known["multipliers"], 1e-9);
        // At a strike the swinging leg's angle and rate are those of the other: a multiplier is 0.
        assert_eq!(found["multipliers"].as_array().unwrap().len(), 3, "{found}");
        assert_eq!(number(&found["multipliers"][2]["re"]), 0.0);
    }
    // Three steps of a gait are three steps, and not one of another.
    let again = told(&[&[file.as_str(), "--count", "2"][..], &STEP].concat()).unwrap();
    assert_eq!(again["repeats"], 3);
    near(number(&again["period"]["value"]), 2.0 * number(&known["points"][0]["step_time"]), 1e-11);
}

#[test]
fn steps_of_the_simplest_walker_double() {
    let (file, known) = (simplest_walker(), reference("simplest_walker"));
    let found = told(&[&[file.as_str()][..], &STEP, &["--vary", "slope=0.0145,0.0152"]].concat()).unwrap();
    let threshold = &found["thresholds"][0];
    assert_eq!(threshold["kind"], "doubling");
    near(number(&threshold["value"]), number(&known["period_doubling"]["slope"]), 1e-10);
}

/// Where steps double a gait of two unequal steps leaves, which doubles again.
#[test]
fn two_unequal_steps_of_the_simplest_walker_double_again() {
    let (file, known) = (simplest_walker(), reference("simplest_walker"));
    let values = ["--vary", "slope=0.015,0.0155,0.016,0.0178", "--branch", "1"];
    let doubled = told(&[&[file.as_str()][..], &STEP, &values].concat()).unwrap();
    for expected in known["doubled"].as_array().unwrap() {
        let member = doubled["members"].as_array().unwrap().iter();
        let slope = number(&expected["slope"]);
        let mut member = member.filter(|member| (number(&member["value"]) - slope).abs() < 1e-14);
        let member = member.next().unwrap_or_else(|| panic!("{doubled}"));
        // It may begin with either step.
        let steps = expected["states"].as_array().unwrap();
        let apart = |step: &&Value| (number(&member["start"]["p"]) - number(&step["theta"])).abs();
        let step = steps.iter().min_by(|a, b| apart(a).total_cmp(&apart(b))).unwrap();
        near(number(&member["start"]["p"]), number(&step["theta"]), 1e-11);
        near(number(&member["start"]["p'"]), number(&step["thetadot"]), 1e-11);
        let whole: f64 = steps.iter().map(|step| number(&step["step_time"])).sum();
        near(number(&member["period"]), whole, 1e-10);
        multiplied(&member["multipliers"], &expected["multipliers"], 1e-9);
    }
    let threshold = &doubled["thresholds"][0];
    assert_eq!(threshold["kind"], "doubling", "{}", doubled["thresholds"]);
    near(number(&threshold["value"]), number(&known["second_doubling"]["slope"]), 1e-12);
}

/// Problems of the course, each by a command: 5, a rosette by the half of it, where it reverses itself; 7 c, the eight after a push; 39 b, a
/// motion of the triple pendulum that repeats, far from small ones.
#[test]
fn problems_that_ask_for_periodic_motions_are_commands() {
    let solve = ["solve", "central_force", "--unknown", "y'=0.36,until=11.6", "--such-that", "y=0,x'=0"];
    let found = dalembert_tests::told::told(&solve).unwrap();
    let known = &reference("central_force")["point"];
    let value = |name: &str| number(&found["values"][name]["value"]);
    near(value("y'"), number(&known["speed"]), 1e-13);
    near(2.0 * value("until"), number(&known["period"]), 1e-11);
    let pushed = ["figure_eight", "--start", "x[1]=-0.96", "--start", "y[3]=0.01", "--period", "6.3"];
    let found = told(&pushed).unwrap();
    // An eight of another size: T |E|^1.5 is the same for all of them.
    let (period, energy) = (number(&found["period"]["value"]), number(&found["energy"]));
    near(period * energy.abs().powf(1.5), 9.237_681_250_724_55, 1e-10);
    let found = told(&["triple_pendulum", "--from", "mode 1", "--energy", "1"]).unwrap();
    near(number(&found["energy"]), 1.0, 1e-10);
    assert!(number(&found["returns"]) < 1e-9, "{found}");
}

/// A wheel of eight spokes: the multiplier of a step is cos²(2π/8).
#[test]
fn a_rimless_wheel_rolls_down() {
    let file = written(
        "name: RimlessWheel\nsizes: {n: 8}\nparameters: {m: 1 kg, l: 1 m, g: 10 m/s^2, slope: 0.08 rad}\n\
         coordinates: {x: m, y: m, phi: rad}\n\
         points: {hub: \"[x, y]\", even: \"hub + l*[sin(phi), -cos(phi)]\", odd: \"hub + l*[sin(phi + 2*pi/n), -cos(phi + 2*pi/n)]\"}\n\
         bodies: {wheel: {mass: m, inertia: 0, angle: phi, position: hub}}\ngravity: g*[sin(slope), -cos(slope)]\n\
         constraints: {on_even: velocity(even), on_odd: velocity(odd)}\nphases: {even: [on_even], odd: [on_odd]}\n\
         events:\n  strike: {phase: even, when: odd.y - even.y, direction: falling, then: odd}\n\
         scene: {start: {x: -0.3826834323650898, y: 0.9238795325112867, phi: pi/8, \"phi'\": -1.2}, until: 3, tolerance: 1e-12}\n",
    );
    let found =
        told(&[&file, "--at", "strike", "--exchange", "even=odd", "--turn", "phi=-0.125", "--shift", "x"]).unwrap();
    let known = &reference("rimless_wheel")["cases"][0];
    holds(&found["start"]["phi'"], -number(&known["omega_after"]), 1e-11);
    holds(&found["period"], 2.0 * number(&known["step_time"]), 1e-11);
    assert_eq!(found["multipliers"].as_array().unwrap().len(), 1);
    near(number(&found["multipliers"][0]["re"]), number(&known["multiplier"]), 1e-11);
    assert_eq!(found["map"]["does"], "exchanged: even for odd, odd for even; shifted: x; turned: phi by -0.125");
}

/// A ball that bounces once each time its table goes down and up: determinant e², trace 1 + e² + …, here by the reference's multipliers.
#[test]
fn a_ball_bounces_on_a_table() {
    let known = &reference("ball_on_table")["cases"][0]["points"][0];
    let file = written(&format!(
        "name: BallOnTable\nparameters: {{m: 1 kg, g: 9.81 m/s^2, e: 0.5, H: 0.0136 m, A: {} m, w: 20*pi rad/s, ph: {} rad}}\n\
         coordinates: {{y: m}}\ninputs: {{table: A*cos(w*t + ph)}}\npoints: {{P: \"[0, y]\"}}\n\
         bodies: {{ball: {{mass: m, position: P}}}}\ngravity: [0, -g]\nconstraints: {{rest: y - table}}\n\
         phases: {{flight: [], carried: [rest]}}\n\
         events:\n  bounce: {{phase: flight, when: y - table, direction: falling, then: {{impact: e, along: rest}}}}\n\
         \x20 lift: {{phase: carried, when: reaction(rest), direction: falling, then: flight}}\n\
         scene: {{start: {{y: A*cos(ph + pi) + H, \"y'\": 0.05}}, until: 5, tolerance: 1e-12}}\n",
        known["A"].as_str().unwrap(),
        number(&known["impact_phase"]) + std::f64::consts::PI,
    ));
    let found = told(&[&file]).unwrap();
    near(number(&found["period"]["value"]), 0.1, 1e-14);
    multiplied(&found["multipliers"], &known["multipliers"], 1e-9);
    assert_eq!(found["events"], serde_json::json!(["bounce"]));
    // With a period that is stated the unstable motion is found from beside it: between two bounces, g T²/8 above where it bounces.
    let known = &reference("ball_on_table")["cases"][0]["points"][1];
    let phase = format!("ph={:?}", number(&known["impact_phase"]) + std::f64::consts::PI);
    let beside = ["--set", &phase, "--set", "H=0.0122625", "--start", "y'=1e-3", "--period", "0.1"];
    let found = told(&[&[file.as_str()], &beside[..]].concat()).unwrap();
    multiplied(&found["multipliers"], &known["multipliers"], 1e-9);
}

/// A ball whose impacts on a shaken table die out each period: slopes go through no such series.  On a table that never falls as fast as the ball would
/// it is carried, y = A cos w t, from a place at which the speed of both is 0.
#[test]
fn a_ball_that_comes_to_rest_on_its_table_is_said_to_do_so() {
    let file = written(
        "name: Zeno\nparameters: {m: 1 kg, g: 9.81 m/s^2, e: 0.3, A: 2.6 mm, w: 20*pi rad/s}\ncoordinates: {y: m}\n\
         inputs: {table: A*cos(w*t)}\npoints: {P: \"[0, y]\"}\nbodies: {ball: {mass: m, position: P}}\ngravity: [0, -g]\n\
         constraints: {rest: y - table}\nphases: {flight: [], carried: [rest]}\n\
         events:\n  bounce: {phase: flight, when: y - table, direction: falling, then: {impact: e, along: rest}}\n\
         \x20 lift: {phase: carried, when: reaction(rest), direction: falling, then: flight}\n\
         scene: {start: {y: 5 mm, \"y'\": 0}, until: 3, tolerance: 1e-12}\n",
    );
    let refused = told(&[&file]).unwrap_err();
    assert!(refused.contains("impacts accumulate"), "{refused}");
    let found = told(&[&file, "--set", "A=1 mm"]).expect("a motion");
    near(number(&found["start"]["y"]["value"]), 1e-3, 1e-14);
    assert!(found["events"].as_array().unwrap().is_empty(), "{found}");
}

/// A pendulum on a shaken pivot stands upright from 44.8186 rad/s on: rest is the motion, and its multipliers are those of one period.
#[test]
fn a_shaken_pendulum_stands_upright_from_the_frequency_of_the_reference() {
    let found = told(&["shaken_pendulum", "--start", "theta=0", "--set", "A=0.1", "--vary", "Omega=43,47"]).unwrap();
    let thresholds = found["thresholds"].as_array().unwrap();
    assert_eq!(thresholds.len(), 1, "{thresholds:?}");
    let known = &reference("mathieu")["shaken"]["points"][1]["Omega_upright"];
    near(number(&thresholds[0]["value"]), number(known), 1e-10 * number(known));
    // By the amplitude of the pivot it flutters again; hanging it is unstable in a window of frequencies.
    let points = &reference("mathieu")["shaken"]["points"];
    let (by_amplitude, tongue) = (&points[2], &points[3]["hanging_tongue"]);
    let up = [number(&by_amplitude["A_upright"]), number(&by_amplitude["A_flutter"])];
    let hanging = [number(&tongue[0]), number(&tongue[1])];
    for (start, map, expected) in
        [("theta=0", "A=0.05..0.5:10,Omega=60", up), ("theta=pi", "Omega=5..8:7,A=0.05", hanging)]
    {
        let found = told(&["shaken_pendulum", "--here", "--start", start, "--map", map]).unwrap();
        let points = found["boundaries"].as_array().unwrap().iter().flat_map(|b| b["points"].as_array().unwrap());
        let mut values: Vec<f64> = points.map(|point| number(&point["x"])).collect();
        values.sort_by(f64::total_cmp);
        assert_eq!(values.len(), 2, "{found}");
        values.iter().zip(expected).for_each(|(value, expected)| near(*value, expected, 1e-10 * expected));
    }
}

/// Mathieu's equation: every boundary of every row, a window of 2.5·10⁻⁴ beside columns 0.35 apart included; rows that begin without a drive
/// do not take its symmetry to the others.
#[test]
fn a_map_has_mathieus_tongues() {
    let file = written(
        "name: Mathieu\nparameters: {a: 1, q: 1}\ncoordinates: {x: 1}\ninputs: {k: a - 2*q*cos(2*t)}\nkinetic_energy: x'^2/2\n\
         generalized_forces: {x: -k*x}\nscene: {start: {x: 0}, until: 10, tolerance: 1e-12}\n",
    );
    let found = told(&[&file, "--here", "--map", "a=-0.5..10:31,q=0,0.2,1,5"]).unwrap();
    let known = reference("mathieu");
    let boundaries = found["boundaries"].as_array().unwrap();
    for row in known["characteristic"].as_array().unwrap() {
        let q = number(&row["q"]);
        let points: Vec<&Value> = boundaries.iter().flat_map(|b| b["points"].as_array().unwrap()).collect();
        let points: Vec<&Value> = points.into_iter().filter(|point| number(&point["y"]) == q).collect();
        let values = ["a0", "b1", "a1", "b2", "a2", "b3", "a3"].map(|name| number(&row[name]));
        let values: Vec<f64> = values.into_iter().filter(|a| (-0.5..10.0).contains(a)).collect();
        assert_eq!(points.len(), values.len(), "{q}: {points:?}");
        for expected in values {
            let apart = |point: &&&Value| (number(&point["x"]) - expected).abs();
            let nearest = points.iter().min_by(|a, b| apart(a).total_cmp(&apart(b))).unwrap();
            near(number(&nearest["x"]), expected, 1e-11);
            near(number(&nearest["x"]), expected, number(&nearest["error"]));
        }
    }
    // Columns far apart, as few as two, lose none of them.
    let few = told(&[&file, "--here", "--map", "a=-0.5..10:2,q=1"]).unwrap();
    let mut values: Vec<f64> =
        few["boundaries"].as_array().unwrap().iter().map(|b| number(&b["points"][0]["x"])).collect();
    values.sort_by(f64::total_cmp);
    let row = &known["characteristic"].as_array().unwrap().iter().find(|row| number(&row["q"]) == 1.0).unwrap();
    let expected = ["a0", "b1", "a1", "b2", "a2", "b3", "a3"].map(|name| number(&row[name]));
    assert_eq!(values.len(), expected.len(), "{values:?}");
    values.iter().zip(expected).for_each(|(value, expected)| near(*value, expected, 1e-10));
    // At q = 1, unstable from b1 to a1, stable from a1 to b2.
    let row = &found["growth"][2];
    let column = |a: f64| ((a + 0.5) / 0.35).round() as usize;
    assert!(number(&row[column(0.9)]) > 0.1 && number(&row[column(3.0)]).abs() < 1e-9, "{row}");
    let refused = told(&[&file, "--map", "a=0..1:3"]).unwrap_err();
    assert!(refused.contains("two parameters"), "{refused}");
    let refused = told(&[&file, "--map", "a=0..1:3,x=0..1:3"]).unwrap_err();
    assert!(refused.contains("`x`"), "{refused}");
    // A symmetry that is stated must hold for all values.
    let refused = told(&[&file, "--set", "q=0", "--part", "4", "--mirror", "x", "--vary", "q=0..1"]).unwrap_err();
    assert!(refused.contains("does not move alike"), "{refused}");
}

/// Where a held phase is entered a freedom is lost: the multiplier is 0 and nothing else.
#[test]
fn stick_slip_loses_a_dimension() {
    let found = told(&["stick_slip"]).unwrap();
    let known = &reference("stick_slip")["cases"][0];
    holds(&found["period"], number(&known["period"]), 1e-11);
    assert_eq!(found["superstable"], 1);
    assert_eq!(found["multipliers"].as_array().unwrap().len(), 1);
    assert_eq!(found["multipliers"][0]["re"], 0.0);
}

/// A period that is given is a multiple of the inputs' own and moves with them; any other is refused.
#[test]
fn a_period_of_the_inputs_may_be_a_multiple() {
    let file = written(
        "name: Duffing\nparameters: {d: 0.1, f: 0.3, w: 1.5}\ncoordinates: {x: 1}\ninputs: {shake: f*cos(w*t)}\n\
         kinetic_energy: x'^2/2\npotential_energy: x^2/2 + x^4/4\ndissipation: d*x'^2/2\n\
         generalized_forces: {x: shake}\nmotions: {response: {closes: {period: 2*pi/w}}}\n\
         scene: {start: {x: 0, x': 0}, until: 100, tolerance: 1e-12}\n",
    );
    let once = told(&[&file]).unwrap();
    let thrice = told(&[&file, "--period", "6*pi/1.5"]).unwrap();
    assert_eq!(thrice["repeats"], 3, "{thrice}");
    near(number(&thrice["period"]["value"]), number(&once["period"]["value"]), 1e-14);
    let refused = told(&[&file, "--period", "4"]).unwrap_err();
    assert!(refused.contains("does not repeat itself after 4 s"), "{refused}");
    let found = told(&[&file, "--motion", "response", "--vary", "w=2,2.2"]).unwrap();
    let last = found["members"].as_array().unwrap().last().unwrap();
    near(number(&last["value"]), 2.2, 1e-12);
    near(number(&last["period"]), std::f64::consts::TAU / 2.2, 1e-12);
}

/// One value is one motion; a value that the family does not reach is said to be so by where it ends.
#[test]
fn a_family_of_one_value_is_one_motion() {
    let file = van_der_pol();
    let found = told(&[&file, "--vary", "mu=2"]).unwrap();
    assert_eq!(found["members"].as_array().unwrap().len(), 1, "{found}");
    let found = told(&["double_pendulum", "--from", "mode 1", "--amplitude", "0.1", "--vary", "energy=0.5"]).unwrap();
    let last = found["members"].as_array().unwrap().last().unwrap();
    near(number(&last["value"]), 0.5, 1e-10);
    assert_eq!(last["asked"], true);
    for option in [["--energy", "2"], ["--vary", "energy=..2"]] {
        let refused = told(&[&[file.as_str()][..], &option].concat()).unwrap_err();
        assert!(refused.contains("does not keep its energy"), "{refused}");
    }
}

/// All motions that files of the library name are found, and run as they say.
#[test]
fn every_motion_of_the_library_is_found() {
    let mut count = 0;
    for entry in MODELS {
        for motion in (entry.compiled.expect("its code"))().motions() {
            let closes = matches!(motion.goal, dalembert::mechanism::Goal::Closes(_));
            let verb = if closes { "orbit" } else { "solve" };
            let found = dalembert_tests::told::told(&[verb, entry.name, "--motion", &motion.name]);
            let found = found.unwrap_or_else(|why| panic!("{} {}: {why}", entry.name, motion.name));
            if closes {
                assert!(number(&found["returns"]) < 1e-8, "{} {}: {found}", entry.name, motion.name);
            }
            count += 1;
        }
    }
    assert!(count >= 5, "{count}");
}

/// In the library a motion of a file is searched for by its name, too.
#[test]
fn a_motion_of_a_file_is_found_by_its_name() {
    let pendulum = dalembert_models::double_pendulum::DoublePendulum::default();
    let orbit = pendulum.simulate().orbit_of("swing").find().expect("an orbit");
    let asked = told(&["double_pendulum", "--motion", "swing"]).expect("an orbit");
    near(orbit.period.value, number(&asked["period"]["value"]), 1e-10);
    let unknown = pendulum.simulate().orbit_of("nothing").find().expect_err("no such motion").to_string();
    assert!(unknown.contains("there are `swing`"), "{unknown}");
    let ball = dalembert_models::cannon_ball::CannonBall::default();
    let name = ball.system().motions()[0].name.to_string();
    let error = ball.simulate().orbit_of(&name).find().expect_err("a flight").to_string();
    assert!(error.contains("does not say how it closes"), "{error}");
}

#[test]
fn what_does_not_close_is_said_to_be_so() {
    // A damped oscillator comes to rest only.
    let file = written(
        "name: Damped\nparameters: {k: 1, c: 0.3}\ncoordinates: {x: 1}\nkinetic_energy: x'^2/2\npotential_energy: k*x^2/2\n\
         dissipation: c*x'^2/2\nscene: {start: {x: 1}, until: 30}\n",
    );
    let refused = told(&[&file, "--period", "6.3"]).unwrap_err();
    assert!(refused.contains("equilibrium"), "{refused}");
    // Two frequencies without a common period.
    let file = written(
        "name: Twice\nparameters: {k: 1, c: 0.3}\ncoordinates: {x: 1}\ninputs: {a: cos(t), b: cos(sqrt(2)*t)}\nkinetic_energy: x'^2/2\n\
         potential_energy: k*x^2/2 - (a + b)*x\ndissipation: c*x'^2/2\nscene: {start: {x: 1}, until: 30}\n",
    );
    let refused = told(&[&file]).unwrap_err();
    assert!(refused.contains("no common period"), "{refused}");
    // An event that does not happen, and one that changes nothing.
    let refused = told(&["bouncing_ball", "--at", "nothing"]).unwrap_err();
    assert!(refused.contains("nothing"), "{refused}");
    // Exchanging what is not alike.
    let refused = told(&["double_pendulum", "--period", "2.3", "--exchange", "theta1=theta2"]).unwrap_err();
    assert!(refused.contains("does not move alike"), "{refused}");
    let refused = told(&["double_pendulum", "--from", "mode 3"]).unwrap_err();
    assert!(refused.contains("no mode 3"), "{refused}");
    // A search that does not end at a motion says where it ended, and what the run does instead.
    let state = written("");
    let refused = told(&["figure_eight", "--period", "3.16", "--save", &state]).unwrap_err();
    assert!(
        refused.contains("comes nearest to its own states again: to that of t = 0.000000 s after 6.32"),
        "{refused}"
    );
    assert!(std::fs::read_to_string(state).expect("a state").contains("\"x[1]'\": "));
}

/// Between two states that reverse time a motion begins at one: at rest, where that is said.  All motions of a linear oscillator have 2π.
#[test]
fn a_motion_that_turns_round_at_rest_begins_there() {
    let file = written(
        "name: Turns\nparameters: {k: 1}\ncoordinates: {x: 1}\nkinetic_energy: x'^2/2\npotential_energy: k*x^2/2\n\
         motions:\n  quarter: {closes: {part: 1/4, from: {}, to: {mirror: [x]}}, start: {x: 0.7}}\n\
         \x20 half: {closes: {part: 1/2, from: {}, to: {}}, start: {x: 0.7}}\n\
         scene: {start: {x: 1}, until: 10, tolerance: 1e-12}\n",
    );
    let found = told(&[&file, "--motion", "quarter"]).unwrap();
    holds(&found["period"], std::f64::consts::TAU, 1e-12);
    near(number(&found["start"]["x"]["value"]), 0.7, 1e-12);
    near(number(&found["start"]["x'"]["value"]), 0.0, 1e-15);
    // Between rest and rest, of which the smallest map is that of half a period.
    let found = told(&[&file, "--motion", "half"]).unwrap();
    near(number(&found["start"]["x"]["value"]), 0.7, 1e-12);
    assert_eq!(found["map"]["part"], 2);
    let found = told(&["double_pendulum", "--motion", "brake"]).unwrap();
    for rate in ["theta1'", "theta2'"] {
        near(number(&found["start"][rate]["value"]), 0.0, 1e-12);
    }
}

/// Motions that shrink to rest under a drive are rest, with its multipliers.
#[test]
fn what_shrinks_to_rest_under_a_drive_rests() {
    let rest = told(&["shaken_pendulum", "--here", "--start", "theta=0"]).unwrap();
    let found = told(&["shaken_pendulum", "--start", "theta=0.1"]).unwrap();
    assert_eq!(number(&found["start"]["theta"]["value"]), 0.0);
    for k in 0..2 {
        near(number(&found["multipliers"][k]["re"]), number(&rest["multipliers"][k]["re"]), 1e-9);
    }
}
