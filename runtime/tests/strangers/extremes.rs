//! Extremes and samples of a run: `sweep`, `needs`, tables.

use dalembert::mechanism::System;

use crate::{case, folder, printed, text_of};

/// The rows of numbers that a sweep prints.
fn swept(name: &str, vary: &str, show: &str) -> Vec<Vec<f64>> {
    let csv = folder("extremes").join(format!("{name}.csv"));
    let arguments = ["--vary", vary, "--show", show, "--csv", csv.to_str().expect("a path")];
    let text = printed("sweep", name, &arguments);
    let rows = text.lines().skip(1).map(|line| line.split_whitespace().map_while(|cell| cell.parse().ok()).collect());
    rows.filter(|row: &Vec<f64>| !row.is_empty()).collect()
}

#[test]
fn a_sweep_finds_the_amplitude_of_a_vibration_in_step_with_reports() {
    // x = 2 pi / w sin(w t): the first in step with the reports, the second not.
    for row in swept("vibration_in_step_with_reports", "w=6.283185307179586,6", "max x,min x") {
        let amplitude = std::f64::consts::TAU / row[1];
        assert!((row[2] - amplitude).abs() < 1e-4 && (row[3] + amplitude).abs() < 1e-4, "{row:?}");
    }
}

#[test]
fn a_sweep_finds_the_force_of_a_kerb_between_reports() {
    let row = &swept("kerb_of_two_millimetres", "m=400", "max tyre")[0];
    // The kerb of 20 mm lifts the tyre by kt h above its load of (m + mw) g = 4316 N, less what the wheel gives way.
    assert!(row[2] > 8300.0 && row[2] < 8317.0, "{row:?}");
}

#[test]
fn a_sweep_finds_the_height_of_a_flight_that_ends_early() {
    let row = &swept("cannon_lands_early", "th=0.7853981633974483", "max y")[0];
    // y at y' = 0 with drag c = m = g = 1: v - ln(1 + v).
    let v = 0.5_f64.sqrt();
    assert!((row[2] - (v - v.ln_1p())).abs() < 1e-6, "{row:?}");
}

#[test]
fn both_sides_of_an_impact_are_extremes_and_coarse_reports_hide_nothing() {
    let text = "
name: Ball
parameters: {m: 1 kg, g: 9.81 m/s^2}
coordinates: {y: m}
bodies: {ball: {mass: m, position: '[0, y]'}}
gravity: [0, -g]
constraints: {floor: y}
phases: {flight: [], rest: [floor]}
events: {bounce: {phase: flight, when: y, direction: falling, then: {impact: 0.5, along: floor}}}
scene: {start: {y: 1}, until: 0.6, tolerance: 1e-10}
";
    let mut case = case(text);
    case.settings.every = Some(0.6);
    let run = case.run();
    let speed = (2.0 * 9.81_f64).sqrt();
    let (low, high) = run.extremes("y'").expect("a range");
    assert!((low + speed).abs() < 1e-8 && (high - 0.5 * speed).abs() < 1e-8, "{low} {high}");
}

#[test]
fn a_run_that_ends_early_is_reported_over_its_own_time() {
    let mut case = case(&text_of("cannon_lands_early"));
    let run = case.run();
    assert!(run.len() >= 250 && run.len() <= 502, "{}", run.len());
    let y = run.column("y").expect("y");
    // y(t) = (v + 1)(1 - exp(-t)) - t.
    let v = 0.5_f64.sqrt();
    for (t, y) in run.times().iter().zip(&y) {
        assert!((y - ((v + 1.0) * (1.0 - (-t).exp()) - t)).abs() < 1e-8, "{t} {y}");
    }
    let text = printed("simulate", "cannon_lands_early", &[]);
    assert!(!text.contains('?'), "{text}");
}

#[test]
fn reports_that_were_asked_for_stay() {
    let mut case = case(&text_of("cannon_lands_early"));
    case.settings.every = Some(0.5);
    let run = case.run();
    assert_eq!(&run.times()[..3], &[0.0, 0.5, 1.0]);
    assert_eq!(run.len(), 4, "{:?}", run.times());
}

#[test]
fn deviations_were_those_at_equal_distances() {
    // x = A sin(2 pi t), reported where it is 0.
    let vibration = |speed: f64| {
        let mut case = case(&format!(
            "name: InStep
parameters: {{w: 6.283185307179586}}
coordinates: {{x: 1}}
kinetic_energy: x'^2/2
potential_energy: w^2*x^2/2
scene: {{start: {{x: 0, x': {speed}}}, until: 50, every: 1, tolerance: 1e-10}}
"
        ));
        case.run()
    };
    let (usual, larger) = (vibration(1.0), vibration(1.1));
    let off = usual.deviation(&larger, "x").expect("a column of both");
    // A tenth of the amplitude, of a range of twice that.
    assert!((off - 0.05).abs() < 1e-4, "{off}");
    assert!(usual.deviation(&vibration(1.0), "x") == Some(0.0));
}

/// The energy and the forces of soft walls, wells and humps are numbers however far behind them the motion leads.
#[test]
fn soft_walls_push_where_their_exponentials_are_beyond_all_numbers() {
    let text = |energy: &str| {
        format!(
            "name: Soft\nparameters: {{m: 1 kg, A: 0.1 J, w: 0.01 m, l: 5 m}}\ncoordinates: {{x: m}}\n\
             bodies: {{b: {{mass: m, position: \"[x, 0]\"}}}}\npotential_energy: {energy}\n\
             scene: {{start: {{x: 0, x': 0.5}}, until: 30, tolerance: 1e-9}}\n"
        )
    };
    // The times of ways by quadrature with 20 digits.
    for (energy, x) in [("A*ln(1 + exp((x - l)/w))", -4.939_399_220_1), ("A/cosh((x - l)/w)", 14.975_509_833_8)] {
        let found = case(&text(energy)).run();
        assert!((found.last()["x"] - x).abs() < 1e-7 && found.warnings.is_empty(), "{energy}: {}", found.last()["x"]);
    }
    // Down a slope of 10 N from its edge: 800 widths on, both potentials grow on as a straight line, and none.
    for (energy, a) in [("-A*ln(1 + exp(x/w))", 10.0), ("A/(1 + exp(-x/w))", 0.0)] {
        let mut case = case(&text(energy));
        (case.settings.q[0], case.settings.until) = (8.0, 1.0);
        let found = case.run();
        assert!((found.last()["x"] - 8.5 - 0.5 * a).abs() < 1e-9, "{energy}: {}", found.last()["x"]);
        assert!(found.energy_balance.is_some_and(|balance| balance < 1e-9), "{energy}: {:?}", found.energy_balance);
    }
}

/// `max(0, …)` of a product or a quotient is cut off where it is as a whole.
#[test]
fn one_sided_powers_of_products_are_evaluated_on_their_side() {
    let ball = |force: &str| {
        format!(
            "name: Hertz\nparameters: {{m: 1 kg, k: 100 N/m, R: 1 m, g: 10 m/s^2}}\ncoordinates: {{y: m}}\n\
             bodies: {{ball: {{mass: m, position: \"[0, y]\"}}}}\ngravity: [0, -g]\n{force}\nscene: {{start: {{y: 0.1}}, until: 2}}\n"
        )
    };
    for force in [
        "generalized_forces: {y: \"k*R*max(0, -y/R)^1.5\"}",
        "generalized_forces: {y: \"k*R*max(0, -2*y/(2*R))^1.5\"}",
        "generalized_forces: {y: \"k*max(0, -y)^1.5/R^0.5\"}",
        "potential_energy: k*R^2*0.4*max(0, -y/R)^2.5",
    ] {
        let run = case(&ball(force)).run();
        assert!((run.last()["y"] + 0.284_189_9).abs() < 1e-6, "{force}: {}", run.last()["y"]);
    }
}

/// The speed rises to A s √π in the pulse and never falls: steps before and behind it are longer by far than those in it.
#[test]
fn a_pulse_between_long_steps_has_no_extremes_of_its_own() {
    let text = "
name: Pulse
parameters: {m: 1 kg, A: 1 N, t0: 3.7 s, s: 0.1 s}
coordinates: {x: m}
inputs: {u: 'A*exp(-((t - t0)/s)^2)'}
bodies: {b: {mass: m, position: '[x, 0]'}}
forces: {f: {on: b, force: '[u, 0]'}}
scene: {start: {x: 0}, until: 10, tolerance: 1e-10}
";
    for width in [0.1_f64, 1e-3, 1e-5] {
        let mut case = case(text);
        case.system.set_parameter(3, width);
        let run = case.run();
        let gained = width * std::f64::consts::PI.sqrt();
        for (name, end) in [("x'", gained), ("x", 6.3 * gained)] {
            let (low, high) = run.extremes(name).expect("a range");
            assert!(
                low.abs() < 1e-9 * end && (high - end).abs() < 1e-9 * end,
                "{width} {name}: {low} {high}, not {end}"
            );
        }
    }
}
