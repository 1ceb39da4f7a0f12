//! Motions that something drives: responses, their peaks and folds, symmetries that are lost, maps of stability.

use dalembert_tests::told::{near, number, reference, written};
use serde_json::Value;

use super::{holds, told};

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

#[test]
fn axes_of_pictures_have_units() {
    let picture = std::env::temp_dir().join(format!("dalembert-orbits-{}.svg", std::process::id()));
    let plot = picture.to_str().expect("a path");
    let family = ["--set", "A=0.1", "--vary", "Omega=43,47", "--plot", plot];
    told(&[&["shaken_pendulum", "--start", "theta=0"], &family[..]].concat()).expect("a family");
    let text = std::fs::read_to_string(&picture).expect("a picture");
    std::fs::remove_file(&picture).expect("the picture");
    for axis in ["Omega (rad/s)", "amplitude of theta (rad)", "period (s)"] {
        assert!(text.contains(axis), "{axis}: {text}");
    }
}
