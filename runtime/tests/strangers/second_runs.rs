//! Second runs that began otherwise than the first went on: digits that were lost, and advice that did not fit.

use dalembert::Run;

use super::case;

/// The run with its digits.
fn judged(text: &str) -> Run {
    let mut case = case(text);
    case.settings.digits = true;
    case.run()
}

/// A dose that a tick adds to what decays.
const DOSE: &str = r#"
name: Dose
states: {z: {unit: 1, rate: -r*z}}
parameters: {r: 1 1/s}
memory: {n: 0}
events: {dose: {every: 1 s, then: {set: {z: z + 1, n: n + 1}}}}
scene: {start: {z: 0}, until: 0.5, tolerance: 1e-11}
"#;

#[test]
fn a_tick_at_the_start_happened_twice_in_a_second_run() {
    // One dose at t = 0: e^−t; with the ticks of 1 s and 2 s as well at t = 2.5.
    for (until, doses, z) in
        [("0.5", 1.0, (-0.5_f64).exp()), ("2.5", 3.0, [-2.5_f64, -1.5, -0.5].map(f64::exp).iter().sum())]
    {
        let run = judged(&DOSE.replace("until: 0.5", &format!("until: {until}")));
        assert!((run.last()["z"] - z).abs() < 1e-10 && run.memory("n") == Some(doses), "{}", run.last()["z"]);
        assert!(run.digits("z").is_some_and(|digits| digits >= 9), "until {until}: {:?}", run.digits("z"));
        assert!(run.warnings.is_empty(), "{:?}", run.warnings);
    }
    // A first tick after the start was right before.
    let later = judged(&DOSE.replace("every: 1 s", "every: 1 s, from: 0.1 s"));
    assert!(
        (later.last()["z"] - (-0.4_f64).exp()).abs() < 1e-10 && later.digits("z").is_some_and(|digits| digits >= 9)
    );
}
