//! Velocity constraints in disguise: what `check` says of them, and their integrals along a motion.

use dalembert::Run;
use dalembert_models::MODELS;
use dalembert_tests::case::Case;

fn check(model: &str) -> String {
    let mut out = Vec::new();
    let told = dalembert::cli::run(MODELS, ["dalembert", "check", model], &mut out);
    told.unwrap_or_else(|problem| panic!("{problem}"));
    String::from_utf8(out).expect("text")
}

/// What `check` says of freedoms.
fn freedoms(model: &str) -> Vec<String> {
    let told = check(model);
    told.lines().filter(|line| line.contains("of freedom")).map(|line| line.trim().to_owned()).collect()
}

#[test]
fn check_counts_the_freedoms_of_the_sleigh() {
    let words = "3 degrees of freedom in configuration, 2 in velocity; edge is nonholonomic";
    assert_eq!(freedoms("chaplygin_sleigh"), [words]);
}

#[test]
fn check_counts_the_freedoms_of_the_eccentric_cylinder_in_every_phase() {
    let rolls = "1 degree of freedom in configuration, 1 in velocity; no_slip is integrable: its integral is held";
    let slides = "2 degrees of freedom in configuration, 2 in velocity";
    assert_eq!(
        freedoms("eccentric_cylinder"),
        [
            format!("phase ideal: {rolls}"),
            format!("phase rolling: {rolls}"),
            format!("phase slide_down: {slides}"),
            format!("phase slide_up: {slides}"),
            "phase flight: 3 degrees of freedom in configuration, 3 in velocity".to_owned(),
        ]
    );
}

#[test]
fn check_counts_the_freedoms_of_linkages_and_of_none() {
    assert_eq!(freedoms("four_bar"), ["1 degree of freedom in configuration, 1 in velocity"]);
    assert_eq!(freedoms("five_bar"), ["2 degrees of freedom in configuration, 2 in velocity"]);
    assert_eq!(freedoms("rolling_cylinder"), Vec::<String>::new());
}

/// A pendulum whose rod is written with velocities.
const ROD: &str = "
name: Rod
parameters: {m: 1 kg, l: 1 m, g: 10 m/s^2}
coordinates: {x: m, y: m}
bodies: {bob: {mass: m, position: \"[x, y]\"}}
gravity: [0, -g]
constraints: {rod: x*x' + y*y'}
scene: {start: {x: l, y: 0, x': 0}, until: 100, tolerance: 1e-5}
";

/// The length of the rod, in every row from a time on.
fn lengths(run: &Run, from: f64) -> Vec<f64> {
    let rows = (0..run.len()).map(|k| run.state(k)).filter(|state| state.t > from);
    rows.map(|state| state["x"].hypot(state["y"])).collect()
}

/// The neighbour, times what makes it not closed, drifts by the error of the integration.
#[test]
fn the_integral_of_a_closed_row_is_held() {
    let off = |text: &str| {
        let lengths = lengths(&Case::written(text).run(), 0.0);
        assert!(lengths.len() > 400, "{}", lengths.len());
        lengths.iter().fold(0.0_f64, |most, length| most.max((length - 1.0).abs()))
    };
    let held = off(ROD);
    assert!(held < 1e-14, "{held:e}");
    let drifts = off(&ROD.replace("x*x' + y*y'", "(x*x' + y*y')*(2*l + y)"));
    assert!(drifts > 1e-9, "{drifts:e}");
}

/// A mass that is thrown, caught on a rod of whatever length that is then, let go and caught again.
const CAUGHT: &str = "
name: Caught
parameters: {m: 1 kg, l: 1 m, g: 10 m/s^2, a: 0.3 s, b: 2 s, c: 2.5 s}
coordinates: {x: m, y: m}
bodies: {bob: {mass: m, position: \"[x, y]\"}}
gravity: [0, -g]
constraints: {rod: x*x' + y*y'}
phases: {free: [], held: [rod], free_again: [], held_again: [rod]}
events:
  catch: {phase: free, when: t - a, then: held}
  let_go: {phase: held, when: t - b, then: free_again}
  again: {phase: free_again, when: t - c, then: held_again}
scene: {start: {x: l, y: 0, x': 1, y': 2}, until: 20, every: 0.03, tolerance: 1e-6}
";

#[test]
fn an_integral_takes_the_value_that_it_has_where_its_phase_is_entered() {
    let run = Case::written(CAUGHT).run();
    let length = |name: &str| {
        let event = run.events.iter().find(|event| event.name == name).expect("an event");
        event.state["x"].hypot(event.state["y"])
    };
    let (first, second) = (length("catch"), length("again"));
    assert!((first - second).abs() > 0.1, "{first} {second}");
    let mut seen = [0, 0];
    for state in (0..run.len()).map(|k| run.state(k)) {
        let now = state["x"].hypot(state["y"]);
        for (k, (from, to, of)) in [(0.3, 2.0, first), (2.5, 30.0, second)].into_iter().enumerate() {
            if state.t > from && state.t < to {
                assert!((now - of).abs() < 1e-13, "{now} {of} at {}", state.t);
                seen[k] += 1;
            }
        }
    }
    assert!(seen[0] > 50 && seen[1] > 500, "{seen:?}");
}

/// Two rows neither of which is the rate of anything, and their sum, which is that of x − z.
const PAIR: &str = "
name: Pair
parameters: {k: 3 1}
coordinates: {x: 1, y: 1, z: 1, w: 1}
kinetic_energy: (x'^2 + 2*y'^2 + z'^2 + w'^2)/2
potential_energy: k*(x^2 + y^2 + (w - 1)^2)/2
constraints: {one: x' - y*w', two: y*w' - z'}
scene: {start: {x: 0.3, y: 1, z: 0.1, w: 0, y': 0.4, w': 1}, until: 100, tolerance: 1e-5}
";

/// The neighbour, where a row is multiplied by what moves, has the integral too, but nobody writes it down.
fn pair_without_words() -> String {
    PAIR.replace("two: y*w' - z'", "two: (y*w' - z')*(2 + sin(w))")
}

#[test]
fn the_integral_of_a_combination_is_found_said_and_held() {
    let off = |text: &str| {
        let run = Case::written(text).run();
        let states = (0..run.len()).map(|k| run.state(k));
        states.fold(0.0_f64, |most, state| most.max((state["x"] - state["z"] - 0.2).abs()))
    };
    let (held, drifts) = (off(PAIR), off(&pair_without_words()));
    assert!(held < 1e-13, "{held:e}");
    assert!(drifts > 1e-9, "{drifts:e}");
    let words = |text: &str| {
        let path = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("pair.yaml");
        std::fs::write(&path, text).expect("a file");
        freedoms(path.to_str().expect("a path")).join("\n")
    };
    assert!(
        words(PAIR).ends_with("a combination of one and two is integrable: its integral is held"),
        "{}",
        words(PAIR)
    );
    let other = words(&pair_without_words());
    assert!(
        other.ends_with("none of them by itself, by no integral that was found: their velocities are held"),
        "{other}"
    );
}
