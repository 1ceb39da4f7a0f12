//! Fixed steps that are found for a tolerance: what happens only later, and within a part of a step, is not passed over in silence.

use dalembert::Run;
use dalembert::mechanism::Method;

use super::case;

/// A run by a method, to its scene's end or to another one, with digits; of a step that is given, or found.
fn run(text: &str, method: Method, (step, until): (Option<f64>, Option<f64>)) -> Run {
    let mut case = case(text);
    (case.settings.method, case.settings.step, case.settings.digits) = (method, step, true);
    case.settings.until = until.unwrap_or(case.settings.until);
    case.run()
}

const BARRIER: &str = "name: Barrier\nparameters: {m: 1 kg, A: 0.2 J, w: 0.01 m, x1: 50 m}\ncoordinates: {x: m}\n\
    bodies: {b: {mass: m, position: \"[x, 0]\"}}\npotential_energy: A*exp(-((x - x1)/w)^2)\nscene: {start: {x: 0, x': 0.5}, until: 150}\n";

/// An eighth of a joule does not climb a barrier of 0.2 J, a ten-thousandth of the way wide: the particle comes back to 25.00233 m.
#[test]
fn a_narrow_barrier_turns_a_particle_back_or_no_digit_is_promised() {
    for method in [Method::Verlet, Method::Gauss6, Method::KahanLi8, Method::Srkn4] {
        let found = run(BARRIER, method, (None, None));
        let (x, digits) = (found.last()["x"], found.digits("x").expect("a number"));
        let holds = (x - 25.0023315).abs() <= 25.0 * 10.0_f64.powi(1 - digits as i32);
        assert!(digits == 0 || holds, "{method:?}: {x} with {digits} digits");
    }
    // A step that was given is taken, and what it passes over is told.
    let given = run(BARRIER, Method::Verlet, (Some(0.3), None));
    let told = given.warnings.iter().any(|warning| warning.to_string().contains("passes over"));
    assert!(told && given.digits("x") == Some(0), "{:?}", given.warnings);
    let free = run(BARRIER, Method::Gauss6, (None, Some(60.0)));
    assert!(free.warnings.is_empty() && free.digits("x") > Some(10), "{:?}", free.warnings);
}

/// Where a motion begins by standing still, the step that suits it is found when it is pushed.
#[test]
fn a_motion_that_begins_later_has_a_step_of_its_own() {
    let text = "name: Late\nparameters: {m: 1 kg, k: 100 N/m, F: 3 N, t1: 40 s}\ncoordinates: {x: m}\ninputs: {u: F*step(t - t1)}\n\
        bodies: {b: {mass: m, position: \"[x, 0]\"}}\ngeneralized_forces: {x: -k*x + u}\nscene: {start: {x: 0}, until: 60}\n";
    for method in [Method::Gauss4, Method::Gauss6, Method::KahanLi8] {
        let found = run(text, method, (None, None));
        let exact = 0.03 * (1.0 - 200.0_f64.cos());
        let (x, digits) = (found.last()["x"], found.digits("x"));
        assert!((x - exact).abs() < 1e-7 && digits >= Some(5), "{method:?}: {x} with {digits:?}");
        assert!(found.step < Some(0.05), "{:?}", found.step);
    }
}

/// Terms of a series that ends in a well tell nothing of it when they begin in front of it.
#[test]
fn the_series_of_a_step_into_a_well_is_too_long_a_step() {
    let well = BARRIER.replace("A: 0.2 J, w: 0.01 m, x1: 50 m", "A: -0.3 J, w: 0.1 m, x1: 1 m");
    for (tolerance, error) in [(1e-9, 1e-8), (1e-12, 1e-11)] {
        let mut case = case(&well);
        (case.settings.method, case.settings.tolerance, case.settings.digits) = (Method::Taylor, tolerance, true);
        let found = case.run();
        // ∫dx/√(2(E − V)) by quadrature with 20 digits.
        assert!((found.last()["x"] - 75.104_007_784_740_2).abs() < 75.0 * error, "{}", found.last()["x"]);
        assert!(found.warnings.is_empty() && found.digits("x") > Some(7), "{:?}", found.warnings);
    }
}
