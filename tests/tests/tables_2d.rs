//! Functions of two arguments that a model gives by values on a grid.

use dalembert::ensemble::{Ensemble, f64x4};
use dalembert::mechanism::{At, Dynamic, Interpreted, System};
use dalembert::prelude::*;
use dalembert::{Settings, simulate};
use dalembert_symbolic::lower::compile_in;
use dalembert_symbolic::model::load;
use std::path::Path;

dalembert::model!("roads/terrain.yaml", name = Terrain);
dalembert::model!("../models/engine_map.yaml", name = EngineMap);

fn interpreted(text: &str) -> Interpreted {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("roads");
    let program = compile_in(Some(&folder), text, &[]).unwrap_or_else(|problems| panic!("{text}: {problems:?}"));
    Interpreted::new(program, text)
}

fn end(text: &str) -> State {
    let mut system = interpreted(text);
    let mut settings = Settings::new(&system.scene(0));
    settings.tolerance = 1e-11;
    simulate(&mut system, &settings).expect("a run").last().clone()
}

fn codes(text: &str) -> Vec<&'static str> {
    load(text, &[]).err().unwrap_or_default().iter().map(|problem| problem.code).collect()
}

/// A particle of 1 kg in the plane, in a potential.
fn particle(table: &str, potential: &str, scene: &str) -> String {
    format!(
        "name: Particle\ntables: {{f: {table}}}\ncoordinates: {{x: , y: }}\nkinetic_energy: (x'^2 + y'^2)/2\n\
         potential_energy: {potential}\nscene: {scene}\n"
    )
}

#[test]
fn generated_and_interpreted_code_agree_in_every_piece() {
    let text = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("roads/terrain.yaml")).expect("text");
    let (compiled, interpreted) = (Dynamic::new(Terrain::default()), interpreted(&text));
    let (mut dq, mut dv) = ([0.0; 4], [0.0; 4]);
    for (i, j) in (0..25).flat_map(|i| (0..25).map(move |j| (f64::from(i), f64::from(j)))) {
        let (q, v) = ([0.21 * i - 2.5, 0.19 * j - 2.4], [0.3, -0.7]);
        let (mut a, mut b) = ([0.0; 2], [0.0; 2]);
        compiled.accelerations(At::new(0.0, &q, &v), &mut a).expect("accelerations");
        interpreted.accelerations(At::new(0.0, &q, &v), &mut b).expect("accelerations");
        assert!(a.iter().zip(&b).all(|(a, b)| (a - b).abs() <= 1e-12 * a.abs().max(1.0)), "{q:?}: {a:?} {b:?}");
        // Exact slopes of F against quotients of it, where no point lies between.
        compiled.jacobians(At::new(0.0, &q, &v).accelerated(&a), &mut dq, &mut dv);
        let along = |d: f64| {
            let (mut f, q) = ([0.0; 2], [q[0] + d, q[1]]);
            compiled.residual(At::new(0.0, &q, &v).accelerated(&a), &mut f);
            f
        };
        let (before, after) = (along(-1e-6), along(1e-6));
        for (k, row) in [0, 2].into_iter().enumerate() {
            let slope = (after[k] - before[k]) / 2e-6;
            assert!((slope - dq[row]).abs() < 1e-6 * (1.0 + slope.abs()), "{q:?}: {slope} {}", dq[row]);
        }
    }
}

#[test]
fn a_terrain_keeps_the_energy_and_both_derivations() {
    let run = Terrain::default().simulate().run().expect("a run");
    assert!(run.drift[0].value.expect("a number") < 1e-9, "{:?}", run.drift);
    let balances = Terrain::default().simulate().derivation("along").run().expect("a run by the balance");
    assert!((run.last()["x"] - balances.last()["x"]).abs() < 1e-5);
}

/// A natural spline through a product of straight lines is that product, and goes on as it does.
#[test]
fn a_table_of_a_product_is_the_product() {
    let table = "{points: {x: [-1, 0.5, 2], y: [0, 1, 3], values: [[0, -2, -6], [0, 1, 3], [0, 4, 12]]}";
    let scene = "{start: {x: 0.1, y: 0.2, x': 0.5, y': 1}, until: 6}";
    for smooth in ["}", ", smooth: 1}"] {
        let potential = "x^2 + 2*y^2 + 0.5*f(x, y)";
        let by_table = end(&particle(&format!("{table}{smooth}"), potential, scene));
        let formula = end(&particle(&format!("{table}}}"), "x^2 + 2*y^2 + x*y + 0*f(0, 0)", scene));
        for name in ["x", "y", "x'", "y'"] {
            assert!((by_table[name] - formula[name]).abs() < 1e-8, "{name}: {} {}", by_table[name], formula[name]);
        }
    }
}

/// The wall of `tables.rs`, which stands across one argument and is the same along the other.
#[test]
fn a_wall_that_a_table_makes_is_not_stepped_over() {
    for across in ["x", "y"] {
        let (wall, flat) = ("[0, 7, 7.01, 7.02, 20]", "[-3, 50]");
        let (points, start) = match across {
            "x" => (
                format!("x: {wall}, y: {flat}, values: [[0, 0], [0, 0], [3, 3], [0, 0], [0, 0]]"),
                "x: 6, x': 1, y': 0.4",
            ),
            _ => (format!("x: {flat}, y: {wall}, values: [[0, 0, 3, 0, 0], [0, 0, 3, 0, 0]]"), "y: 6, y': 1, x': 0.4"),
        };
        let table = format!("{{points: {{{points}}}, smooth: 1}}");
        let state = end(&particle(&table, "f(x, y)", &format!("{{start: {{{start}}}, until: 3}}")));
        let along = if across == "x" { "y" } else { "x" };
        assert!((state[across] - 5.008_388_755_02).abs() < 1e-9 && (state[along] - 1.2).abs() < 1e-9, "{state}");
    }
}

/// A force that is straight between points is met at those of both arguments: within each piece the motion is a polynomial.
#[test]
fn points_of_both_arguments_are_stops() {
    let text = r#"
name: Pushed
tables: {f: {points: {x: [0, 2, 4], y: [0, 1, 2], values: [[0, 3, 6], [0, 0, -1], [0, -0.5, -0.5]]}, smooth: 0}}
coordinates: {x: , y: , z: }
bodies: {pointer: {mass: 1, position: "[x, y]"}, pushed: {mass: 1, position: "[z, 0]"}}
forces: {push: {on: pushed, force: "[f(x, y), 0]"}}
scene: {start: {x': 2, y': 1}, until: 2}
"#;
    let state = end(text);
    // At the speeds 2 and 1 the force is 3 t (1 - t), and from t = 1 on, with s = t - 1, s² - 3/2 s.
    assert!((state["z'"] - 1.0 / 12.0).abs() < 1e-12 && (state["z"] - 7.0 / 12.0).abs() < 1e-12, "{state}");
}

/// The top speed: torque and drag are equal where Hermite's cubic between the values of full throttle, with slopes by hand, says so:
/// 4.5 T(4.5 v/0.3)/0.3 = 1.3 v² at 41.02187537768593 m/s, by bisection in Python.
#[test]
fn a_car_comes_to_the_speed_of_its_engine() {
    let run = EngineMap::default().simulate().until(400.0).run().expect("a run");
    assert!((run.last()["x'"] - 41.02187537768593).abs() < 1e-8, "{}", run.last());
    assert!(run.energy_balance.expect("watched") < 1e-9, "{:?}", run.energy_balance);
}

#[test]
fn lanes_read_tables_of_two_arguments_too() {
    let bead = |k: u32| Terrain { m: 0.1 + 0.01 * f64::from(k), g: 9.0 + 0.1 * f64::from(k) }.simulate().until(0.5);
    let ensemble: Ensemble<_> = (0..6).map(bead).collect();
    for (k, ending) in ensemble.ends::<f64x4>().into_iter().enumerate() {
        let (ending, single) = (ending.expect("an end"), bead(k as u32).run().expect("a run"));
        assert!((ending.state["x"] - single.last()["x"]).abs() < 1e-7);
    }
}

#[test]
fn bad_tables_are_refused_each_with_its_reason() {
    let with = |table: &str| codes(&particle(table, "f(x, y)", "{until: 1}"));
    let grid = "x: [0, 1], y: [0, 1, 2], values: [[0, 1, 2], [3, 4, 5]]";
    for (table, code) in [
        ("{points: {GRID}}", ""),
        ("{points: {GRID}, units: [m, m, J]}", ""),
        ("{points: {x: [0, pi], y: [0, 1], values: [[1, 2], [sqrt(2), 0]]}}", ""),
        ("{points: {GRID}, units: [m, N]}", "E308"),
        ("{points: {GRID}, units: [m, N, furlong]}", "E119"),
        ("{points: {GRID}, smooth: 3}", "E307"),
        ("{points: {GRID}, periodic: z}", "E307"),
        ("{points: {GRID}, periodic: x}", "E319"),
        ("{points: {GRID}, periodic: y}", "E319"),
        ("{points: {x: [0, 1], y: [0, 1, 2], values: [[0, 1, 0], [3, 4, 3]]}, periodic: y}", ""),
        ("{points: {x: [0, 1], y: [0, 1], values: [[0, 1], [0, 1], [0, 1]]}}", "E319"),
        ("{points: {x: [0, 1], y: [0, 1], values: [[0, 1], [0, 1, 2]]}}", "E319"),
        ("{points: {x: [0, 1], y: [0, 1], values: [0, 1]}}", "E304"),
        ("{points: {x: [0, 1], y: [0, 1], values: 3}}", "E304"),
        ("{points: {x: [0, 1], y: [0, 0], values: [[0, 1], [0, 1]]}}", "E319"),
        ("{points: {x: [1, 0], y: [0, 1], values: [[0, 1], [0, 1]]}}", "E319"),
        ("{points: {x: [0], y: [0, 1], values: [[0, 1]]}}", "E319"),
        ("{points: {x: [0, 1], y: [0, 1]}}", "E302"),
        ("{points: {x: [0, 1], y: [0, 1], values: [[0, 1], [0, 1]], z: 1}}", "E301"),
        ("{points: {x: [0, 1e-300], y: [0, 1], values: [[0, 1e300], [0, 1]]}}", "E319"),
        ("{points: {x: [0, 1e308], y: [0, 1], values: [[0, 1], [0, 1]]}, units: [Gm, 1, 1]}", "E319"),
        ("{points: {x: [0, m], y: [0, 1], values: [[0, 1], [0, 1]]}}", "E201"),
        ("{points: [[0, 0, 1], [1, 0, 2]]}", "E319"),
        ("{points: {GRID}, file: a.csv}", "E305"),
    ] {
        let found = with(&table.replace("GRID", grid));
        assert!(if code.is_empty() { found.is_empty() } else { found.contains(&code) }, "{table}: {found:?}");
    }
    let uses = |potential: &str| codes(&particle(&format!("{{points: {{{grid}}}}}"), potential, "{until: 1}"));
    assert_eq!((uses("f(x)"), uses("f(x, y, x)"), uses("f(x, y)")), (vec!["E207"], vec!["E207"], vec![]));
    assert!(uses("f").contains(&"E224"));
    // A force may be straight between its points, a potential not.
    let rough = |smooth: u8| {
        let text = particle(&format!("{{points: {{{grid}}}, smooth: {smooth}}}"), "f(x, y)", "{until: 1}");
        compile_in(None, &text, &[]).err().unwrap_or_default().iter().map(|problem| problem.code).collect::<Vec<_>>()
    };
    assert_eq!((rough(0), rough(1)), (vec!["E320"], vec![]));
}

#[test]
fn both_arguments_have_units() {
    let text = "name: U\ntables: {f: {points: {x: [0, 1], y: [0, 1], values: [[0, 1], [2, 3]]}, units: [m, rad/s, N]}}\n\
                parameters: {m: 1 kg, w: 2 rad/s}\ncoordinates: {x: m}\nbodies: {b: {mass: m, position: \"[x, 0]\"}}\n\
                forces: {push: {on: b, force: \"[f(x, w), 0]\"}}\n";
    assert_eq!(codes(text), Vec::<&str>::new());
    assert_eq!(codes(&text.replace("f(x, w)", "f(w, x)")), ["E242", "E242"]);
    assert_eq!(codes(&text.replace("f(x, w)", "f(x, 2*t)")), ["E242"]);
    assert_eq!(codes(&text.replace("rad/s, N", "rad/s, m")), ["E242"]);
}

#[test]
fn files_have_every_place_of_a_grid_once() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("roads");
    let text = std::fs::read_to_string(folder.join("terrain.yaml")).expect("text");
    let told = |text: &str| {
        let problems = compile_in(Some(&folder), text, &[]).err().unwrap_or_default();
        problems.into_iter().map(|problem| problem.message).collect::<Vec<_>>().join("\n")
    };
    assert_eq!(told(&text), "");
    assert!(told(&text.replace("[east, north, height]", "[east, height, north]")).contains("are no grid of 6 x by"));
    assert!(told(&text.replace("north, height]", "north, hight]")).contains("no column is called `hight`"));
    assert!(told(&text.replace("terrain.csv", "terain.csv")).starts_with("`terain.csv` is no function: "));
}
