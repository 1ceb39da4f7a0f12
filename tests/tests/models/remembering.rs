//! Mechanisms with states of first order, with frictions that stick by themselves and with forces of teeth: numbers from `reference/states`, from closed
//! forms between events, and from computations of the same mechanism in one coordinate by extrapolation in 40 digits.

use dalembert_models::MODELS;
use dalembert_tests::told::{near, number, told, written};
use serde_json::Value;

/// A value of a run: of a coordinate, a rate, a state or an output.
fn value(run: &Value, name: &str) -> f64 {
    let of = match name.strip_suffix('\'') {
        Some(coordinate) => run["v"].get(coordinate),
        None => ["q", "states", "outputs"].into_iter().find_map(|part| run[part].get(name)),
    };
    let of = of.or_else(|| {
        let (vector, axis) = name.split_once('.')?;
        run["outputs"].get(vector)?.get(["x", "y", "z"].iter().position(|known| *known == axis)?)
    });
    number(of.unwrap_or_else(|| panic!("no {name}")))
}

/// The time of an event of a run, the first being 0.
fn event(run: &Value, name: &str, place: usize) -> f64 {
    let events = run["events"].as_array().expect("events").iter().filter(|event| event["name"] == name);
    number(&events.map(|event| &event["t"]).nth(place).unwrap_or_else(|| panic!("no {name}")).clone())
}

/// What is said of a model of the library in which a text is another one.
fn refused(model: &str, from: &str, to: &str) -> String {
    let file = MODELS.iter().find(|known| known.name == model).expect("a model");
    assert!(file.source.contains(from), "{model}: {from}");
    told(&["check", &written(&file.source.replacen(from, to, 1))]).expect_err(to)
}

/// A place that a PID law holds: matrix exponential in 40 digits; at rest the integral carries the spring, e = k x/Ki.
#[test]
fn a_pid_law_brings_a_mass_to_its_place() {
    let run = told(&["simulate", "pid"]).unwrap();
    near(value(&run, "x"), 1.002_519_027_032_12, 1e-11);
    near(value(&run, "e"), 0.154_892_701_463_501, 1e-11);
    near(value(&run, "f"), 1.002_545_235_530_3, 1e-11);
    let rest = told(&["modes", "pid", "--input", "ref=1"]).unwrap();
    near(number(&rest["equilibrium"]["e"]), 0.15, 1e-14);
    let found = refused("pid", "rate: ref - x}", "rate: x - ref}");
    assert!(found.contains("E506") && found.contains("e'"), "{found}");
}

/// Bristles: the block creeps, jumps and stops again.
#[test]
fn bristles_hold_and_let_go() {
    let run = told(&["simulate", "lugre", "--tolerance", "1e-11"]).unwrap();
    near(value(&run, "x"), 1.908_839_199_225, 1e-9);
    near(value(&run, "rubbing"), 1.182_315_680_45, 1e-8);
    near(value(&run, "z"), 1.181_679_545_589e-5, 1e-12);
    let found = refused("lugre", "x' - abs(x')*z/bend", "x' + abs(x')*z/bend");
    assert!(found.contains("E506"), "{found}");
}

/// Two blocks on a belt: the first one slips when its spring carries all that friction holds, then each by itself.
#[test]
fn two_blocks_stick_to_one_belt() {
    let run = told(&["simulate", "belt"]).unwrap();
    near(event(&run, "rub1 slips", 0), 0.4 * 9.81 / (100.0 * 0.2), 1e-13);
    near(event(&run, "rub2 slips", 0), 0.380_560_010_942_705, 1e-12);
    near(event(&run, "rub1 stops", 0), 1.054_629_970_595_483, 1e-11);
    near(value(&run, "x"), 0.046_213_429_283_880_8, 1e-11);
    near(value(&run, "y"), 0.073_735_742_162_969_2, 1e-11);
    assert_eq!(run["events"].as_array().unwrap().len(), 9);
    let found = refused("belt", "rate: x' - belt", "rate: belt - x'");
    assert!(found.contains("E506"), "{found}");
}

/// A clutch: it holds after 67/194 s, gives way when the load knocks, and holds again.
#[test]
fn a_clutch_slips_and_holds() {
    let run = told(&["simulate", "gear_box"]).unwrap();
    near(event(&run, "clutch stops", 0), 67.0 / 194.0, 1e-13);
    near(event(&run, "clutch stops", 1), 1.231_958_762_886_598, 1e-12);
    near(value(&run, "a"), 52.277_832_171_859_7, 1e-11);
    near(value(&run, "a'"), 8.379_888_268_156_42, 1e-11);
    near(value(&run, "tooth"), -75.977_653_631_284_9, 1e-10);
    near(value(&run, "clutch"), -7.664_804_469_273_74, 1e-11);
    let found = refused("gear_box", "teeth: r2*p + r3*w", "teeth: r2*p - r3*w");
    assert!(found.contains("E506") && found.contains("w''"), "{found}");
}

/// A motor on the crank of a four-bar, in one coordinate by extrapolation.
#[test]
fn a_motor_drives_a_four_bar() {
    let run = told(&["simulate", "motor_four_bar"]).unwrap();
    near(value(&run, "alpha"), -41.542_554_382_5, 1e-9);
    near(value(&run, "alpha'"), -39.703_585_126_9, 1e-9);
    near(value(&run, "i"), 1.573_780_904_3, 1e-9);
    near(value(&run, "C.x"), 0.267_387_078_343, 1e-10);
    near(value(&run, "C.y"), 0.269_098_147_540, 1e-10);
    let found = refused("motor_four_bar", "torque: K*i}", "torque: -K*i}");
    assert!(found.contains("E502") && found.contains("power"), "{found}");
}
