//! References in double-double against closed forms and against numbers of more digits.

use std::ops::ControlFlow;

use dalembert_symbolic::expr::DoubleDouble;
use dalembert_symbolic::lower::compile;

use super::extended::{SCHEMES, extended_motion};
use super::{Arithmetic, Candidate, DoubleOnly, Plan, Reference, WorkPrecision};
use crate::Settings;
use crate::mechanism::{Interpreted, Method, System};
use crate::simulate::Interruption;

/// A model file, interpreted.
fn interpreted(text: &str) -> Interpreted {
    let program = compile(text, &[]).unwrap_or_else(|problems| panic!("{:?}", problems[0].message));
    Interpreted::new(program, text)
}

/// A model of the library, interpreted.
fn library(name: &str) -> Interpreted {
    let path = format!("{}/../models/{name}.yaml", env!("CARGO_MANIFEST_DIR"));
    interpreted(&std::fs::read_to_string(path).unwrap())
}

fn candidate(model: &Interpreted) -> Candidate {
    Candidate::new("reference", model, Settings::new(&model.scene(0)))
}

/// The reference of a model's first scene.
fn found(model: &Interpreted, columns: &[&str]) -> Reference {
    let candidate = candidate(model);
    let columns: Vec<String> = columns.iter().map(|name| (*name).to_owned()).collect();
    Reference::find(&candidate, &columns).unwrap().extended(&candidate, Ok(model))
}

/// The largest difference of a column from a function of time.
fn error(found: &Reference, column: usize, law: impl Fn(DoubleDouble) -> DoubleDouble) -> f64 {
    let values = found.values[column].iter().zip(&found.rests[column]).zip(&found.times);
    let errors = values.map(|((value, rest), t)| (DoubleDouble::sum(*value, *rest) - law((*t).into())).to_f64().abs());
    errors.fold(0.0, f64::max)
}

/// How far the states of a model's first scene, started at these decimals, are from those of a file in `tests/reference` at
/// the times that are whole numbers, `at` being the names of [q; q'] there.
fn distance(model: &Interpreted, start: &[DoubleDouble], file: &str, at: &[&str]) -> f64 {
    let path = format!("{}/../tests/reference/{file}.json", env!("CARGO_MANIFEST_DIR"));
    let known: serde_json::Value = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
    let number =
        |state: &serde_json::Value, name: &str| DoubleDouble::from_decimal(state[name].as_str().unwrap()).unwrap();
    let states = known["reference"].as_array().unwrap().iter();
    let states: Vec<_> = states.filter(|state| number(state, "t").to_f64().fract() == 0.0).collect();
    let times = std::iter::once(0.0).chain(states.iter().map(|state| number(state, "t").to_f64()));
    let times: Vec<DoubleDouble> = times.map(DoubleDouble::from).collect();
    let computed =
        extended_motion(model, start.to_vec(), (&times, &vec![1.0; start.len()]), SCHEMES[0], &Interruption::default())
            .unwrap();
    let pairs = states.iter().zip(&computed[1..]);
    let errors =
        pairs.flat_map(|(known, y)| at.iter().zip(y).map(|(name, y)| (*y - number(known, name)).to_f64().abs()));
    errors.fold(0.0, f64::max)
}

const OSCILLATOR: &str = "
name: Oscillator
coordinates: {x: 1}
kinetic_energy: x'^2/2
potential_energy: x^2/2
outputs: {force: -x, pull: x''}
scene: {start: {x: 1}, until: 100}
";

const KEPLER: &str = "
name: Kepler
coordinates: {x: 1, y: 1}
kinetic_energy: (x'^2 + y'^2)/2
potential_energy: -1/sqrt(x^2 + y^2)
scene: {start: {x: 0.4, y': 2}, until: 20*pi}
";

#[test]
fn an_oscillator_keeps_its_phase_to_25_digits_over_16_periods() {
    let found = found(&interpreted(OSCILLATOR), &["x", "x'", "force", "pull"]);
    assert!(matches!(found.arithmetic, Arithmetic::DoubleDouble { .. }), "{:?}", found.arithmetic);
    let laws: [fn(DoubleDouble) -> DoubleDouble; 4] = [|t| t.cos(), |t| -t.sin(), |t| -t.cos(), |t| -t.cos()];
    for (column, law) in laws.into_iter().enumerate() {
        let error = error(&found, column, law);
        assert!(error < 1e-25 && error < 2.0 * found.uncertainty(), "{column}: {error:e} {:e}", found.uncertainty());
    }
    assert!(found.digits() >= 24, "{}", found.digits());
}

#[test]
fn keplers_equation_holds_to_22_digits_over_ten_periods() {
    let found = found(&interpreted(KEPLER), &["x", "y"]);
    // The orbit of the start that is written in `f64`.
    let (r, v) = (DoubleDouble::from(0.4), DoubleDouble::from(2.0));
    let a = DoubleDouble::ONE / (DoubleDouble::from(2.0) / r - v * v);
    let e = DoubleDouble::ONE - r / a;
    let motion = DoubleDouble::ONE / (a * a * a).sqrt();
    let anomaly = |t: DoubleDouble| {
        let mut anomaly = motion * t + (motion * t).sin() * e;
        for _ in 0..60 {
            let rest = anomaly - e * anomaly.sin() - motion * t;
            anomaly = anomaly - rest / (DoubleDouble::ONE - e * anomaly.cos());
        }
        anomaly
    };
    let errors = [
        error(&found, 0, |t| a * (anomaly(t).cos() - e)),
        error(&found, 1, |t| a * (DoubleDouble::ONE - e * e).sqrt() * anomaly(t).sin()),
    ];
    let worst = errors[0].max(errors[1]);
    assert!(worst < 1e-22 && worst < 4.0 * found.uncertainty(), "{errors:?} {:e}", found.uncertainty());
    assert!(found.digits() >= 22, "{}", found.digits());
}

#[test]
fn a_pendulum_of_large_amplitude_has_the_21_digits_of_its_elliptic_functions() {
    let start = [2.5.into(), DoubleDouble::ZERO];
    let error = distance(&library("simple_pendulum"), &start, "B01-simple-pendulum", &["theta", "theta_dot"]);
    assert!(error < 2e-21, "{error:e}");
}

#[test]
fn a_double_pendulum_has_the_digits_of_two_other_methods() {
    let start = [DoubleDouble::FRAC_PI_2, DoubleDouble::PI, DoubleDouble::ZERO, DoubleDouble::ZERO];
    let names = ["theta1", "theta2", "theta1_dot", "theta2_dot"];
    let error = distance(&library("double_pendulum"), &start, "B02-double-pendulum", &names);
    assert!(error < 1e-20, "{error:e}");
}

#[test]
fn the_figure_eight_has_the_digits_of_two_other_methods() {
    let start = [
        "-0.97000436",
        "0.97000436",
        "0",
        "0.24308753",
        "-0.24308753",
        "0",
        "-0.466203685",
        "-0.466203685",
        "0.93240737",
        "-0.43236573",
        "-0.43236573",
        "0.86473146",
    ];
    let start = start.map(|text| DoubleDouble::from_decimal(text).unwrap());
    let names = ["x1", "x2", "x3", "y1", "y2", "y3", "vx1", "vx2", "vx3", "vy1", "vy2", "vy3"];
    let error = distance(&library("figure_eight"), &start, "B05-figure-eight", &names);
    assert!(error < 1e-20, "{error:e}");
}

/// Stability catalogue N8: the plane of Foucault's pendulum turns against the table that it swings over.
#[test]
fn n8_foucaults_plane_turns_by_the_angle_of_the_table_and_no_digit_more() {
    let model = interpreted(
        "
name: Foucault
parameters: {omega: 2, turn: 0.0625}
coordinates: {x: 1, y: 1}
kinetic_energy: ((x' - turn*y)^2 + (y' + turn*x)^2)/2
potential_energy: omega^2*(x^2 + y^2)/2
scene: {start: {x: 1}, until: 150}
",
    );
    let found = found(&model, &["x", "y"]);
    // At rest on the table the bob moves with it: x + i y = e^(-i turn t) (cos(omega t) + i turn/omega sin(omega t)).
    let (omega, turn) = (DoubleDouble::from(2.0), DoubleDouble::from(0.0625));
    let swing = |t: DoubleDouble| [(omega * t).cos(), turn / omega * (omega * t).sin()];
    let errors = [
        error(&found, 0, |t| swing(t)[0] * (turn * t).cos() + swing(t)[1] * (turn * t).sin()),
        error(&found, 1, |t| swing(t)[1] * (turn * t).cos() - swing(t)[0] * (turn * t).sin()),
    ];
    assert!(errors.iter().all(|error| *error < 1e-24 && *error < 2.0 * found.uncertainty()), "{errors:?}");
    assert!(found.digits() >= 23, "{}", found.digits());
}

#[test]
fn scales_make_no_difference() {
    for (size, rate) in [(1e-12, 1.0), (1e12, 1.0), (1.0, 1e6), (1e-9, 1e-6)] {
        let text = format!(
            "
name: Duffing
parameters: {{a: {size}, w: {rate}}}
coordinates: {{x: 1, y: 1}}
kinetic_energy: (x'^2 + y'^2)/2
potential_energy: w^2*(x^2/2 + x^4/(4*a^2) + (y - x/3)^2)
scene: {{start: {{x: 2*a, y: -a}}, until: 20/w}}
"
        );
        let found = found(&interpreted(&text), &[]);
        assert!(found.digits() >= 22, "{size} {rate}: {:?}", found.arithmetic);
    }
}

#[test]
fn what_double_double_does_not_reach_stays_in_double_precision_with_the_reason() {
    let why = |model: &Interpreted| match found(model, &[]).arithmetic {
        Arithmetic::Double { why } => why,
        arithmetic => panic!("{arithmetic:?}"),
    };
    assert_eq!(why(&library("pendulum_cartesian")), DoubleOnly::Constraints);
    assert_eq!(why(&library("cannon_ball")), DoubleOnly::Events);
    assert_eq!(why(&library("two_masses_spring")), DoubleOnly::Switches);
    let mut shaken = library("shaken_pendulum");
    shaken.set_input(0, std::sync::Arc::new(|t| [t.cos(), -t.sin(), -t.cos()]));
    assert_eq!(why(&shaken), DoubleOnly::Inputs);
    let stiff = OSCILLATOR
        .replace("x^2/2", "x^2/2 + 5e11*(x - 1)^2")
        .replace("coordinates", "dissipation: 1e9*x'^2\ncoordinates");
    assert!(matches!(why(&interpreted(&stiff)), DoubleOnly::TooLong { .. }));
    // A pulse between all evaluations but those that follow narrow features.
    let pulse = "
name: Pushed
coordinates: {x: 1}
kinetic_energy: x'^2/2
generalized_forces: {x: 1e4*exp(-((t - 4.9871)/1e-4)^2)}
scene: {until: 10}
";
    assert!(matches!(why(&interpreted(pulse)), DoubleOnly::Differs { from: Method::Dop853, .. }));
}

/// Both methods in `f64` agree to 7e-9 where they are 4e-8 off: they round the same constants alike.
#[test]
fn chaos_is_followed_further_than_methods_in_double_precision_agree() {
    let model = library("double_pendulum");
    let candidate = candidate(&model);
    let candidate = Candidate { settings: Settings { until: 40.0, ..candidate.settings.clone() }, ..candidate };
    let found = Reference::find(&candidate, &[]).unwrap();
    let (cut, floor) = (found.is_cut, found.floor());
    let found = found.extended(&candidate, Ok(&model));
    let Arithmetic::DoubleDouble { from_double, .. } = found.arithmetic else { panic!("{:?}", found.arithmetic) };
    assert!(cut && from_double > 0.1 * floor && found.uncertainty() < 1e-6 * floor, "{}", found.sentence());
}

#[test]
fn another_model_is_not_taken_for_the_candidates() {
    let candidate = candidate(&interpreted(OSCILLATOR));
    let found = Reference::find(&candidate, &[]).unwrap();
    let other = interpreted(&OSCILLATOR.replace("x^2/2\noutputs", "x^4/2\noutputs"));
    let found = found.extended(&candidate, Ok(&other));
    assert_eq!(found.arithmetic, Arithmetic::Double { why: DoubleOnly::OtherModel });
}

#[test]
fn parameters_of_the_candidate_are_those_of_the_reference() {
    let text = OSCILLATOR.replace("coordinates", "parameters: {k: 1}\ncoordinates").replace("x^2/2\n", "k*x^2/2\n");
    let (model, mut changed) = (interpreted(&text), interpreted(&text));
    changed.set_parameter(0, 4.0);
    let candidate = candidate(&changed);
    let found = Reference::find(&candidate, &[]).unwrap().extended(&candidate, Ok(&model));
    let error = error(&found, 0, |t| (t * 2.0).cos());
    assert!(error < 1e-24, "{error:e} {:?}", found.arithmetic);
}

#[test]
fn curves_reach_down_to_the_methods_own_rounding() {
    let model = interpreted(KEPLER);
    let settings = Settings::new(&model.scene(0));
    let of = |method: Method| Candidate::new(method.name(), &model, Settings { method, ..settings.clone() });
    let candidates = [Method::Rk4, Method::KahanLi8, Method::Gauss6].map(of);
    let plan = Plan { repetitions: 1, ..Plan::default() };
    let found =
        WorkPrecision::measure_extended(&candidates, &plan, &model, &mut |_| ControlFlow::Continue(())).unwrap();
    let in_double = Reference::find(&candidates[0], &[]).unwrap();
    let least = |name: &str| found.curve(name).unwrap().measured().map(|m| m.error).fold(f64::INFINITY, f64::min);
    for name in ["kahanli8", "gauss6"] {
        assert!(
            least(name) > 1e-15 && least(name) < 0.3 * in_double.floor(),
            "{name}: {:e} {:e}",
            least(name),
            in_double.floor()
        );
    }
    // What rounding hides is not paid for: the curve ends soon after its least error.
    let errors: Vec<f64> = found.curve("kahanli8").unwrap().measured().map(|point| point.error).collect();
    let lowest = errors.iter().position(|error| *error <= 2.0 * least("kahanli8")).unwrap();
    assert!(errors.len() - lowest <= 8, "{errors:?}");
    let rows = found.to_csv();
    assert!(rows.lines().next().unwrap().ends_with("failure,reference,reference_digits"));
    let digits = found.reference.digits();
    assert!(rows.lines().skip(1).all(|row| row.ends_with(&format!(",double-double,{digits}"))), "{rows}");
    assert!(found.figure().to_svg().contains(&format!("measured from double-double ({digits} digits)")));
}

/// In its second mode the mass in the middle of three rests: what rounding does to it is measured by what the others do.
#[test]
fn what_rests_is_not_measured_by_its_rounding() {
    let model = library("three_masses");
    let scene = model.description().scenes.iter().position(|name| name == "second_mode").unwrap();
    let settings = Settings { method: Method::Exact, ..Settings::new(&model.scene(scene)) };
    let candidates = [Candidate::new("exact", &model, settings)];
    let plan = Plan { repetitions: 1, ..Plan::default() };
    let found =
        WorkPrecision::measure_extended(&candidates, &plan, &model, &mut |_| ControlFlow::Continue(())).unwrap();
    let least = found.curves[0].measured().map(|point| point.error).fold(f64::INFINITY, f64::min);
    assert!(least < 1e-13, "{least:e}");
}
