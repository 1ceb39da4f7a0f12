//! Motions that set off from rest, by a high power of time or beside the surface of a discontinuity.

use dalembert::Method;

use super::{Case, file};

/// Two bodies at rest on a spring: a force that sets in as `force` says moves one, and a drag v |v|, or v³, acts on the other.
fn pulled(force: &str, drag: &str, start: &str) -> Case {
    file(&format!(
        "name: Pulled
parameters: {{m: 1, F: 1, k: 100, d: 0.1}}
coordinates: {{x: 1, y: 1}}
bodies: {{b: {{mass: m, position: \"[x, 0]\"}}, c: {{mass: m, position: \"[y, 0]\"}}}}
springs: {{s: {{stretch: y - x, stiffness: k, along: \"[1, 0]\", on: c, from: b}}}}
forces: {{f: {{on: b, force: \"[F*({force}), 0]\"}}, d: {{on: c, force: \"[-d*{drag}, 0]\"}}}}
scene: {{start: {{{start}}}, until: 4, tolerance: 1e-8}}"
    ))
}

#[test]
fn a_force_that_sets_in_slowly_takes_no_step_beyond_counting() {
    // y goes like t⁶ at first, so that its error is the same part of it in any step.
    for force in ["1 - exp(-t^2)", "t^2", "t^3"] {
        for drag in ["y'*abs(y')", "y'^3"] {
            let mut case = pulled(force, drag, "");
            let expected = case.run().last()["y"];
            for (method, most) in
                [(Method::Dop853, 300), (Method::Dopri5, 1200), (Method::Radau5, 2500), (Method::Gauss2, 60_000)]
            {
                case.settings.method = method;
                let run = case.run();
                assert!(run.work.steps < most, "{force}, {drag}, {method}: {} steps", run.work.steps);
                assert!((run.last()["y"] / expected - 1.0).abs() < 1e-6, "{force}, {drag}, {method}: {}", run.last());
            }
        }
    }
}

#[test]
fn rounding_beside_a_surface_does_not_choose_the_side() {
    // y' leaves 0 upwards, from whatever side rounding has put it on.
    for force in ["t", "1 - exp(-t^2)"] {
        let expected = pulled(force, "y'*abs(y')", "").tolerance(1e-12).run().last()["y"];
        for start in ["-1e-25", "-1e-20", "-1e-17", "-1e-15", "-1e-13", "-1e-10", "1e-20", "1e-15"] {
            let mut case = pulled(force, "y'*abs(y')", &format!("y': {start}"));
            case.settings.digits = true;
            let run = case.run();
            assert!((run.last()["y"] / expected - 1.0).abs() < 1e-6, "{force} from {start}: {}", run.last());
            let promised = run.errors("y").unwrap()[run.len() - 1] / expected;
            assert!(promised < 1e-4, "{force} from {start}: {promised:e}");
        }
    }
}

#[test]
fn rounding_at_the_onset_is_no_error() {
    // 1 − exp(−t²) is 0 or 2⁻⁵³ at first: nothing but rounding moves anything.
    for k in [1.0, 1e4] {
        let expected = pulled("1 - exp(-t^2)", "y'*abs(y')", "").set("k", k).tolerance(1e-13).run().last()["x"];
        for tolerance in [1e-4, 1e-6, 1e-9, 1e-11] {
            let run = pulled("1 - exp(-t^2)", "y'*abs(y')", "").set("k", k).tolerance(tolerance).run();
            assert!(run.work.rejected < 40 + run.work.steps / 3, "{k}, {tolerance:e}: {} rejected", run.work.rejected);
            let error = (run.last()["x"] / expected - 1.0).abs();
            assert!(error < 100.0 * tolerance, "{k}, {tolerance:e}: {error:e}");
        }
    }
}

#[test]
fn what_a_resonant_force_reaches_by_way_of_others_takes_no_step_beyond_counting() {
    // At rest at first: the second mass goes like t⁴, the third like t⁶, with errors of the size of that in any step.
    let mut case = file(
        "name: Chain
parameters: {m: 1, k: 1, F: 1, w: sqrt(2)}
coordinates: {\"x[i in 1..3]\": 1}
inputs: {push: F*cos(w*t)}
bodies: {\"b[i in 1..3]\": {mass: m, position: \"[x[i], 0]\"}}
springs:
  left: {stretch: \"x[1]\", stiffness: k, along: ground.x, on: \"b[1]\"}
  \"s[i in 1..2]\": {stretch: \"x[i+1] - x[i]\", stiffness: k, along: ground.x, on: \"b[i+1]\", from: \"b[i]\"}
  right: {stretch: \"x[3]\", stiffness: k, along: ground.x, on: \"b[3]\"}
forces: {f: {on: \"b[1]\", force: \"[push, 0]\"}}
scene: {until: 20, tolerance: 1e-9}",
    );
    case.settings.method = Method::Dop853;
    let expected = case.run().last()["x[1]"];
    for (method, tolerance, most) in [
        (Method::Dop853, 1e-2, 20),
        (Method::Dop853, 3.2e-4, 40),
        (Method::Dop853, 3.2e-5, 60),
        (Method::Dopri5, 1e-2, 50),
        (Method::Dopri5, 1e-4, 100),
    ] {
        (case.settings.method, case.settings.tolerance) = (method, tolerance);
        let run = case.run();
        let tried = run.work.steps + run.work.rejected;
        assert!(tried < most, "{method} at {tolerance:e}: {tried} steps");
        let error = (run.last()["x[1]"] - expected).abs();
        assert!(error < 30.0 * tolerance, "{method} at {tolerance:e}: {error:e}");
    }
}
