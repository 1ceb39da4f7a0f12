//! Van der Pol's oscillator, whose multipliers are far below rounding.

use dalembert_tests::told::{near, number, reference, written};

use super::{holds, told};

pub fn van_der_pol() -> String {
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
    // Far off in place and period; some of these guesses lead to rest.
    for (x, period) in [("0.5", "4.3"), ("1", "13"), ("1.5", "6"), ("2.5", "9"), ("3", "5.7"), ("4", "7")] {
        let found = told(&[&file, "--set", "mu=2", "--start", &format!("x={x}"), "--period", period]).unwrap();
        near(number(&found["period"]["value"]), 7.629_874_48, 1e-8);
    }
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
