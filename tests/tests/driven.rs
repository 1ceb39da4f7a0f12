//! Linear mechanisms that time drives, propagated exactly.

use dalembert::{Error, Method, Nonlinear, Run};
use dalembert_tests::case::Case;

/// m x'' + c x' + k x = f(t), m = 2 kg, from rest.
fn driven(stiffness: &str, damping: &str, force: &str, more: &str) -> String {
    format!(
        "name: Driven\n{more}parameters: {{m: 2, k: 8, c: 0, w: 1e-4}}\ncoordinates: {{x: }}\n\
         kinetic_energy: m*x'^2/2\npotential_energy: ({stiffness})*x^2/2\ndissipation: ({damping})*x'^2/2\n\
         generalized_forces: {{x: \"{force}\"}}\nscene: {{until: 20, tolerance: 1e-9}}\n"
    )
}

fn exact(text: &str, tolerance: f64) -> Run {
    let mut case = Case::written(text).tolerance(tolerance);
    case.settings.method = Method::Exact;
    case.run()
}

/// The largest error of x in parts of the largest of it.
fn error(run: &Run, x: impl Fn(f64) -> f64) -> f64 {
    let states: Vec<_> = run.states().map(|state| (x(state.t), state["x"])).collect();
    let largest = states.iter().fold(0.0_f64, |most, (x, _)| most.max(x.abs()));
    states.iter().fold(0.0_f64, |most, (x, found)| most.max((x - found).abs())) / largest
}

#[test]
fn a_pulse_in_the_middle_of_a_long_step_is_met() {
    // Of 0.1 ms, where steps are as long as a second: an impulse of I = w √π e^{−(ωw)²/4} sets off I/(mω) sin ω(t − t₀).
    let text = driven("k", "c", "exp(-((t - 7.3)/w)^2)", "");
    for tolerance in [1e-6, 1e-9] {
        let run = exact(&text, tolerance);
        let impulse = 1e-4 * std::f64::consts::PI.sqrt() * (-(2e-4_f64).powi(2) / 4.0).exp();
        let found = error(&run, |t| if t < 7.3 { 0.0 } else { impulse / 4.0 * (2.0 * (t - 7.3)).sin() });
        assert!(found < 10.0 * tolerance, "{tolerance:e}: {found:e}");
        assert!(run.work.steps < 1000 && run.work.factorizations < 100, "{:?}", run.work);
    }
}

#[test]
fn jumps_and_kinks_of_what_drives_are_ends_of_steps() {
    let after = |t: f64| (t - 1.7).max(0.0);
    let jump = |t: f64| (1.0 - (2.0 * after(t)).cos()) / 8.0;
    let kink = |t: f64| (after(t) - (2.0 * after(t)).sin() / 2.0) / 8.0;
    let input = |formula: &str| format!("inputs: {{u: \"{formula}\"}}\n");
    for (force, more, x) in [
        ("step(t - 1.7)", String::new(), &jump as &dyn Fn(f64) -> f64),
        ("u", input("step(t - 1.7)"), &jump),
        ("max(t - 1.7, 0)", String::new(), &kink),
        ("u", input("max(t - 1.7, 0)"), &kink),
    ] {
        for tolerance in [1e-6, 1e-12] {
            let found = error(&exact(&driven("k", "c", force, &more), tolerance), x);
            assert!(found < tolerance, "{force} {more}: {found:e} at {tolerance:e}");
        }
    }
}

#[test]
fn a_base_that_jumps_kicks_through_its_damper() {
    let text = "name: Kicked\ninputs: {u: step(t - 1)}\nparameters: {m: 2, k: 8, c: 2}\ncoordinates: {x: }\n\
        kinetic_energy: m*x'^2/2\npotential_energy: k*(x - u)^2/2\ndissipation: c*(x' - u')^2/2\n\
        scene: {until: 10, tolerance: 1e-12}\n";
    let run = exact(text, 1e-12);
    // x'' + x' + 4 x = 4 from x' = 1, δ = 1/2: e^{−δτ}(−cos ντ + (1 − δ)/ν sin ντ) + 1.
    let nu = 3.75_f64.sqrt();
    let found = error(&run, |t| {
        let tau = (t - 1.0).max(0.0);
        if t <= 1.0 { 0.0 } else { 1.0 + (-0.5 * tau).exp() * ((0.5 / nu) * (nu * tau).sin() - (nu * tau).cos()) }
    });
    assert!(found < 1e-12 && run.impulses.len() == 1, "{found:e}");
}

#[test]
fn coefficients_that_change_with_time_are_refused() {
    let refused = |stiffness: &str, damping: &str| {
        let mut case = Case::written(&driven(stiffness, damping, "sin(t)", ""));
        case.settings.method = Method::Exact;
        let error = case.try_run().expect_err("no linear system with constant coefficients");
        assert!(matches!(error, Error::NotLinear { reason: Nonlinear::Coefficients }), "{error}");
    };
    refused("k*(1 + cos(4*t)/10)", "c");
    refused("k*(1 + step(t - 1))", "c");
    refused("k", "c*(1 + sin(t))");
    let mass = driven("k", "c", "sin(t)", "").replace("m*x'^2/2", "m*(1 + t)*x'^2/2");
    let mut case = Case::written(&mass);
    case.settings.method = Method::Exact;
    assert!(matches!(case.try_run(), Err(Error::NotLinear { .. })));
    // Its neighbour is not.
    exact(&driven("k", "c", "sin(t)", ""), 1e-9);
}

/// A quarter of a car: a body on a wheel on a tyre, over a road of this height at 20 m/s.
fn quarter_car(road: &str, tables: &str, until: f64) -> String {
    format!(
        "name: QuarterCar\n{tables}inputs: {{y: \"{road}\"}}\n\
         parameters: {{m1: 300 kg, m2: 40 kg, k1: 2e4 N/m, c1: 1.5e3 N*s/m, k2: 2e5 N/m, v: 20 m/s, A: 0.02 m, L: 5 m}}\n\
         coordinates: {{x: m, z: m}}\n\
         bodies: {{body: {{mass: m1, position: \"[0, x]\"}}, wheel: {{mass: m2, position: \"[0, z]\"}}}}\n\
         potential_energy: k1*(x - z)^2/2 + k2*(z - y)^2/2\ndissipation: c1*(x' - z')^2/2\n\
         scene: {{until: {until}, tolerance: 1e-9}}\n"
    )
}

/// A road of this many points, whose distances differ by about so much.
fn measured_road(points: u32, differ: f64) -> String {
    let place = |k: u32| f64::from(k) + differ * (f64::from(k) * 1.7).sin();
    let points: Vec<String> =
        (0..points).map(|k| format!("[{}, {}]", place(k), 0.01 * (f64::from(k) * 2.3).sin())).collect();
    format!("tables: {{road: {{points: [{}], units: [m, m]}}}}\n", points.join(", "))
}

#[test]
fn quarter_cars_ride_over_waves_and_tables() {
    let table = "tables: {road: {points: [[0, 0], [10, 0.02], [20, -0.01], [30, 0.03], [40, 0]], periodic: true, units: [m, m]}}\n";
    for (road, tables) in [("A*sin(2*pi*v*t/L)", ""), ("road(v*t)", table)] {
        let text = quarter_car(road, tables, 20.0);
        let by = |method: Method, tolerance: f64| {
            let mut case = Case::written(&text).tolerance(tolerance);
            case.settings.method = method;
            case.run()
        };
        let (run, other, reference) = (by(Method::Auto, 1e-9), by(Method::Dop853, 1e-9), by(Method::Dop853, 1e-13));
        let deviation = run.states().zip(reference.states()).fold(0.0_f64, |most, (one, other)| {
            most.max((one["x"] - other["x"]).abs()).max((one["z"] - other["z"]).abs())
        });
        assert!(deviation < 1e-9 * 0.02, "{road}: {deviation:e}");
        assert!(
            run.method == Method::Exact && run.why.is_some_and(|why| why.contains("driven")),
            "{road}: {}",
            run.method
        );
        // Matrices depend on lengths alone, of which a road of equal pieces has few.
        assert!(run.work.factorizations < 10 && 3 * run.work.evaluations < other.work.evaluations, "{:?}", run.work);
    }
}

#[test]
fn many_different_lengths_are_left_to_others() {
    let by = |road: &str, until: f64| Case::written(&quarter_car("road(v*t)", road, until)).run().method;
    assert_eq!(by(&measured_road(200, 0.3), 10.0), Method::Dop853);
    assert_eq!(by(&measured_road(200, 0.0), 10.0), Method::Exact);
    // Long behind the road's end nothing moves.
    assert_eq!(by(&measured_road(3, 0.0), 40.0), Method::Dop853);
}

#[test]
fn digits_of_driven_motions_hold() {
    type Motion = fn(f64) -> f64;
    let cases: [(&str, f64, Motion); 3] = [
        ("sin(2*t)", 60.0, |t| ((2.0 * t).sin() - 2.0 * t * (2.0 * t).cos()) / 16.0),
        ("t^3", 10.0, |t| (t.powi(3) - 1.5 * t + 0.75 * (2.0 * t).sin()) / 8.0),
        // Where the phase itself has lost digits.
        ("sin(3*(t + 1e7))", 10.0, |t| {
            let (s, c) = 3e7_f64.sin_cos();
            ((3.0 * t).sin() * c + (3.0 * t).cos() * s - s * (2.0 * t).cos() - 1.5 * c * (2.0 * t).sin()) / -10.0
        }),
    ];
    for (force, until, x) in cases {
        for tolerance in [1e-6, 1e-9] {
            let mut case = Case::written(&driven("k", "c", force, "")).tolerance(tolerance).until(until);
            (case.settings.method, case.settings.digits) = (Method::Exact, true);
            let run = case.run();
            let promised = run.errors("x").expect("digits");
            let largest = run.states().fold(0.0_f64, |most, state| most.max(state["x"].abs()));
            for (state, promised) in run.states().zip(promised) {
                let error = (state["x"] - x(state.t)).abs();
                // Half a digit may be missing.
                assert!(error <= 3.2 * promised, "{force}: {error:e} {promised:e}");
                assert!(promised < 100.0 * tolerance * largest, "{force}: {promised:e}");
            }
        }
    }
}
