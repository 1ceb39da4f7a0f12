//! Functions that a model gives by points.

use dalembert::ensemble::{Ensemble, f64x4};
use dalembert::mechanism::{At, Dynamic, Interpreted, System};
use dalembert::prelude::*;
use dalembert::{Settings, simulate};
use dalembert_symbolic::lower::compile_in;
use dalembert_symbolic::model::load;
use std::path::Path;

dalembert::model!("roads/quarter_car.yaml", name = QuarterCar);
dalembert::model!(
    yaml = r#"
name: Bead
tables: {wire: {points: [[-2, 1], [-1, 0.2], [0, 0], [1, 0.5], [2, 1.5]], units: [m, m]}}
parameters: {m: 0.1 kg, g: 9.81 m/s^2}
coordinates: {x: m}
define: {along: "[1, diff(wire(x), x)]"}
bodies: {bead: {mass: m, position: "[x, wire(x)]"}}
gravity: [0, -g]
balances:
  along_the_wire: {equations: [{force: {of: [bead], along: along}}]}
conserved: {E: energy}
checks: {energy_by_hand: "energy = m*x'^2*(1 + diff(wire(x), x)^2)/2 + m*g*wire(x)"}
scene: {start: {x: 1.7}, until: 10, tolerance: 1e-10}
"#
);

/// A mass on a spring whose foot a table moves, and the spring's force where the foot is at u.
fn pulled(table: &str, foot: &str, until: &str) -> String {
    format!(
        "name: Pulled\ntables: {{foot: {table}}}\nparameters: {{m: 2, k: 800, w: 5}}\ncoordinates: {{y: }}\n\
         bodies: {{mass: {{mass: m, position: \"[0, y]\"}}}}\npotential_energy: k*(y - ({foot}))^2/2\n\
         scene: {{until: {until}, tolerance: 1e-11}}\n"
    )
}

fn end(text: &str) -> State {
    let program = compile_in(None, text, &[]).unwrap_or_else(|problems| panic!("{text}: {problems:?}"));
    let mut system = Interpreted::new(program, text);
    let mut settings = Settings::new(&system.scene(0));
    settings.tolerance = 1e-11;
    simulate(&mut system, &settings).expect("a run").last().clone()
}

fn codes(text: &str) -> Vec<&'static str> {
    load(text, &[]).err().unwrap_or_default().iter().map(|problem| problem.code).collect()
}

/// A step that passes a narrow wall sees nothing of it, and what its end leaves of the step is no better.
#[test]
fn a_wall_that_a_table_makes_is_not_stepped_over() {
    let file = |smooth: u32| {
        format!(
            "name: Wall\ntables: {{wall: {{points: [[0, 0], [7, 0], [7.01, 3], [7.02, 0], [20, 0]], smooth: {smooth}}}}}\n\
             coordinates: {{x: }}\nkinetic_energy: x'^2/2\npotential_energy: wall(x)\n\
             scene: {{start: {{x: 6, x': 1}}, until: 3}}\n"
        )
    };
    // In with v = 1 as far as 3 (3 s² − 2 s³) = 1/2, s = (x − 7)/0.01, and out again: 2 ∫ dx/√(1 − 2V) = 0.00838875502.
    let state = end(&file(1));
    assert!((state["x"] - 5.008_388_755_02).abs() < 1e-9 && (state["x'"] + 1.0).abs() < 1e-9, "{state}");
}

#[test]
fn a_straight_table_is_the_line() {
    let line = "{points: [[0, 0], [1, 2], [5, 10]]}";
    let (table, formula) = (end(&pulled(line, "foot(t)", "3")), end(&pulled(line, "2*t + 0*foot(0)", "3")));
    assert!((table["y"] - formula["y"]).abs() < 1e-9 && (table["y'"] - formula["y'"]).abs() < 2e-8);
    // Beyond its ends it goes on.
    let (table, formula) = (end(&pulled(line, "foot(2*t - 1)", "7")), end(&pulled(line, "4*t - 2 + 0*foot(0)", "7")));
    assert!((table["y"] - formula["y"]).abs() < 2e-8, "{} {}", table["y"], formula["y"]);
}

#[test]
fn a_spline_through_a_sine_is_nearly_the_sine() {
    let points: Vec<String> = (0..=80)
        .map(|k| std::f64::consts::TAU * f64::from(k) / 80.0)
        .map(|x| {
            let y = if (x - std::f64::consts::TAU).abs() < 1e-9 { 0.0 } else { x.sin() };
            format!("[{x:?}, {y:?}]")
        })
        .collect();
    let table = format!("{{points: [{}], periodic: true}}", points.join(", "));
    // Five turns of a cam, against the formula; h^4/384 of a sine is 1e-7.
    let (cam, sine) = (end(&pulled(&table, "foot(w*t)", "6")), end(&pulled(&table, "sin(w*t)", "6")));
    assert!((cam["y"] - sine["y"]).abs() < 1e-6, "{} {}", cam["y"], sine["y"]);
    assert!((cam["y"] - sine["y"]).abs() > 1e-12);
}

#[test]
fn points_of_time_are_stops_and_the_energy_balance_holds() {
    let run = QuarterCar::default().simulate().tolerance(1e-10).run().expect("a run");
    assert!(run.energy_balance.expect("watched") < 1e-9, "{:?}", run.energy_balance);
    let finer = QuarterCar::default().simulate().tolerance(1e-12).run().expect("a run");
    for name in ["z", "u"] {
        assert!((run.last()[name] - finer.last()[name]).abs() < 1e-9 * 0.03);
    }
    // No step is rejected for a kink: the first is too long, and the last before some of the 61 points.
    assert!(run.work.rejected < 20, "{}", run.work.rejected);
}

#[test]
fn a_bump_between_distant_points_is_met() {
    let road = "{points: [[0, 0], [49.99, 0], [50, 0.01], [50.01, 0], [100, 0]], smooth: 1}";
    for foot in ["foot(20*t)", "foot(20*t + 0*y)"] {
        let hit = end(&pulled(road, foot, "4"));
        let size = hit["y"].hypot(hit["y'"] / 20.0);
        // An impulse of k times the area 1e-4 m² over 20 m/s and the mass: 2e-3 m/s, or 1e-4 m.
        assert!((0.8e-4..1.2e-4).contains(&size), "{foot}: {size:e}");
    }
}

#[test]
fn a_wire_through_points_keeps_the_energy_and_both_derivations() {
    let run = Bead::default().simulate().run().expect("a run");
    assert!(run.drift[0].value.expect("a number") < 1e-7, "{:?}", run.drift);
    let balances = Bead::default().simulate().derivation("along_the_wire").run().expect("a run by the balance");
    assert!((run.last()["x"] - balances.last()["x"]).abs() < 1e-6);
}

#[test]
fn a_wire_as_a_constraint_is_the_wire_as_a_coordinate() {
    let text = r#"
name: Slot
tables: {wire: {points: [[-2, 1], [-1, 0.2], [0, 0], [1, 0.5], [2, 1.5]], units: [m, m]}}
parameters: {m: 0.1 kg, g: 9.81 m/s^2}
coordinates: {x: m, y: m}
bodies: {bead: {mass: m, position: "[x, y]"}}
gravity: [0, -g]
constraints: {on: y = wire(x)}
scene: {start: {x: 1.7}, guess: {y: 1}, until: 10}
"#;
    let run = Bead::default().simulate().tolerance(1e-12).run().expect("a run");
    let slot = end(text);
    assert!((run.last()["x"] - slot["x"]).abs() < 1e-6, "{} {}", run.last()["x"], slot["x"]);
}

#[test]
fn generated_and_interpreted_code_agree_in_every_piece() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("roads");
    let text = std::fs::read_to_string(folder.join("quarter_car.yaml")).expect("a file");
    let program = compile_in(Some(&folder), &text, &[]).expect("a good file");
    assert!(program.model.files[0].ends_with("road.csv"));
    let (compiled, interpreted) = (Dynamic::new(QuarterCar::default()), Interpreted::new(program, &text));
    for k in 0..200 {
        let t = -0.5 + 0.02 * f64::from(k);
        let at = At::new(t, &[0.01, -0.02], &[0.3, 0.1]);
        let (mut a, mut b) = ([0.0; 2], [0.0; 2]);
        compiled.accelerations(at, &mut a).expect("accelerations");
        interpreted.accelerations(at, &mut b).expect("accelerations");
        assert!(a.iter().zip(&b).all(|(a, b)| (a - b).abs() <= 1e-12 * a.abs().max(1.0)), "{t}: {a:?} {b:?}");
    }
}

#[test]
fn lanes_read_tables_too() {
    let car = |k: u32| QuarterCar { v: 5.0 + f64::from(k), ..QuarterCar::default() }.simulate().until(1.0);
    let ensemble: Ensemble<_> = (0..6).map(car).collect();
    for (k, ending) in ensemble.ends::<f64x4>().into_iter().enumerate() {
        let (ending, single) = (ending.expect("an end"), car(k as u32).run().expect("a run"));
        assert!((ending.state["z"] - single.last()["z"]).abs() < 1e-8);
    }
}

#[test]
fn bad_tables_are_refused_each_with_its_reason() {
    let with = |table: &str| codes(&pulled(table, "foot(t)", "1"));
    assert!(with("{points: [[0, 0], [1, 2*pi]]}").is_empty());
    for (table, code) in [
        ("{points: [[0, 0]]}", "E319"),
        ("{points: [[1, 0], [0, 1]]}", "E319"),
        ("{points: [[0, 0], [1, 1]], periodic: true}", "E319"),
        ("{points: [[0, 0], [1e308, 1], [1e309, 2]]}", "E109"),
        ("{points: [[0, 0], [1, 1]], units: [s, 1]}", ""),
        ("{points: [[0, 0], [1e308, 1]], units: [Gm, 1]}", "E319"),
        ("{points: [[0, 0], [1e-300, 1e300]]}", "E319"),
        ("{points: [[0, 0], [1]]}", "E308"),
        ("{points: [[0, 0], [1, m]]}", "E304"),
        ("{points: 3}", "E304"),
        ("{points: [[0, 0], [1, 1]], smooth: 3}", "E307"),
        ("{points: [[0, 0], [1, 1]], periodic: maybe}", "E307"),
        ("{points: [[0, 0], [1, 1]], units: [m]}", "E308"),
        ("{points: [[0, 0], [1, 1]], units: [m, furlong]}", "E119"),
        ("{points: [[0, 0], [1, 1]], file: road.csv}", "E305"),
        ("{smooth: 2}", "E306"),
        ("{pionts: [[0, 0], [1, 1]]}", "E301"),
    ] {
        let found = with(table);
        assert!(if code.is_empty() { found.is_empty() } else { found.contains(&code) }, "{table}: {found:?}");
    }
    let uses = |foot: &str| codes(&pulled("{points: [[0, 0], [1, 1]]}", foot, "1"));
    assert!(
        uses("foot").contains(&"E224") && uses("foot(t, 1)") == ["E207"] && uses("foot(position(mass))") == ["E208"]
    );
    assert_eq!(uses("fot(t)"), ["E206"]);
    let units = "name: U\ntables: {f: {points: [[0, 0], [1, 1]], units: [m, N]}}\nparameters: {m: 1 kg, v: 2 m/s}\n\
                 coordinates: {x: m}\nbodies: {b: {mass: m, position: \"[x, 0]\"}}\n\
                 forces: {push: {on: b, force: \"[f(v*t), 0]\"}}\n";
    assert_eq!(codes(units), Vec::<&str>::new());
    assert_eq!(codes(&units.replace("f(v*t)", "f(t)")), ["E242"]);
    assert_eq!(codes(&units.replace("[m, N]", "[m, m]")), ["E242"]);
}

#[test]
fn files_of_tables_are_found_beside_the_model() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("roads");
    let text = std::fs::read_to_string(folder.join("quarter_car.yaml")).expect("a file");
    let told = |text: &str| {
        let problems = compile_in(Some(&folder), text, &[]).err().unwrap_or_default();
        problems.into_iter().map(|problem| problem.message).collect::<Vec<_>>().join("\n")
    };
    assert_eq!(told(&text), "");
    assert!(told(&text.replace("road.csv", "rode.csv")).starts_with("`rode.csv` is no function: "));
    assert!(
        told(&text.replace("[s, height]", "[s, hight]")).contains("no column is called `hight`; there are s, height")
    );
    assert!(load(&text, &[]).is_err());
}
