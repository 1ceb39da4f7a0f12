//! Motions that repeat, to some 25 digits.

use dalembert::mechanism::Interpreted;
use dalembert::orbit::ExtendedValue;
use dalembert::prelude::*;
use dalembert_symbolic::expr::DoubleDouble;
use dalembert_symbolic::lower::compile;
use dalembert_tests::told::{number, reference, written};
use serde_json::Value;

use super::told;

dalembert::model!("orbits/cubic.yaml", name = Cubic);

const CUBIC: &str = include_str!("../../orbits/cubic.yaml");

/// What is printed, and the digits of a reference.
fn printed(found: &Value) -> DoubleDouble {
    DoubleDouble::from_decimal(found["digits"].as_str().expect("digits")).expect("a number")
}

/// A number is as near to the digits of a reference as its own error says, and as this.
#[track_caller]
fn holds(found: &Value, expected: &Value, error: f64) {
    let expected = DoubleDouble::from_decimal(expected.as_str().expect("digits")).expect("a number");
    let off = (printed(found) - expected).abs().to_f64();
    assert!(
        off <= error && off <= number(&found["error"]) + DoubleDouble::UNIT,
        "{found} is not {expected:?}: {off:e}"
    );
}

/// T |E|^1.5 of the figure eight, which has one value for all of its sizes.
#[test]
fn the_figure_eight_has_more_than_twenty_digits() {
    let found = told(&["figure_eight", "--double-double"]).unwrap();
    let found = &found["double_double"];
    let (period, energy) = (printed(&found["period"]), printed(&found["energy"]).abs());
    let known = reference("figure_eight")["invariant_T_absE_3_2"].clone();
    let known = DoubleDouble::from_decimal(known.as_str().unwrap()).unwrap();
    let off = (period * energy * energy.sqrt() - known).abs().to_f64();
    assert!(off < 1e-25, "{off:e}");
}

/// A family is told apart by its energy, counted from the equilibrium in double-double, too.
#[test]
fn the_double_pendulum_swings_as_long_as_its_reference() {
    for point in reference("double_pendulum")["points"].as_array().unwrap() {
        let (mode, energy) = (format!("mode {}", point["mode"]), point["energy_above_rest"].as_str().unwrap());
        if number(&point["energy_above_rest"]).fract() != 0.0 {
            continue;
        }
        let found = told(&["double_pendulum", "--from", &mode, "--energy", energy, "--double-double"]).unwrap();
        holds(&found["double_double"]["period"], &point["period"], 1e-24);
        holds(&found["double_double"]["energy"], &point["energy_above_rest"], 1e-24);
    }
}

/// T = 4 K(m)/√(1 + k A²) with m = k A²/(2 (1 + k A²)), by the arithmetic-geometric mean in double-double; the API tells what the program does.
#[test]
fn a_program_goes_on_in_double_double_too() {
    let cubic = Cubic::default();
    let model = Interpreted::new(compile(CUBIC, &[]).expect("a model"), CUBIC);
    let found = cubic.simulate().orbit().in_double_double(&model).find().expect("an orbit");
    let found = found.extended.expect("digits");
    let value = |value: &ExtendedValue| DoubleDouble::from(value.value) + value.rest;
    let speed = value(&found.start[1]);
    let energy = value(found.energy.as_ref().expect("an energy"));
    let place = value(&found.start[0]);
    let own = speed * speed * 0.5 + place * place * 0.5 + place * place * place * place * 0.75;
    assert!((own - energy).abs().to_f64() < 1e-28, "{own:?} {energy:?}");
    let square = ((DoubleDouble::ONE + energy * 12.0).sqrt() - DoubleDouble::ONE) / 3.0.into();
    let stiffness = DoubleDouble::ONE + square * 3.0;
    let (mut a, mut b) = (DoubleDouble::ONE, (DoubleDouble::ONE - square * 1.5 / stiffness).sqrt());
    for _ in 0..8 {
        (a, b) = ((a + b) * 0.5, (a * b).sqrt());
    }
    let known = DoubleDouble::PI * 2.0 / (a * stiffness.sqrt());
    let off = (value(&found.period) - known).abs().to_f64();
    assert!(off <= found.period.error + 1e-30 && off < 1e-26, "{off:e} {found:?}");
}

/// Numbers are written with the digits that hold, of any size and sign.
#[test]
fn digits_are_those_that_hold() {
    let text = |value: &Value| value["digits"].as_str().expect("digits").len();
    let found = told(&["figure_eight", "--double-double"]).unwrap();
    for (name, value) in found["double_double"]["start"].as_object().unwrap() {
        let (size, error) = (number(&value["value"]).abs(), number(&value["error"]));
        let decimals = value["digits"].as_str().unwrap().split_once('.').expect("decimals").1.len() as i32;
        assert_eq!(-decimals, error.log10().ceil() as i32, "{name}: {value}");
        assert!(text(value) > 20 && size > error, "{name}: {value}");
        assert!((printed(value) - number(&value["value"]).into()).to_f64().abs() <= 1e-15 * size, "{name}: {value}");
    }
}

#[test]
fn what_is_no_smooth_motion_by_itself_is_refused_with_the_reason() {
    let driven = written(
        "name: Driven\ncoordinates: {x: 1}\nkinetic_energy: x'^2/2\npotential_energy: x^2/2\ngeneralized_forces: {x: cos(2*t)}\n\
         scene: {start: {x: 1}, until: 20}\n",
    );
    for (arguments, why) in [(&["four_bar"][..], "there are constraints"), (&[&driven, "--here"], "depend on time")] {
        let refused = told(&[arguments, &["--double-double"]].concat()).unwrap_err();
        assert!(refused.contains("not known in double-double") && refused.contains(why), "{refused}");
        assert!(told(arguments).is_ok());
    }
}
