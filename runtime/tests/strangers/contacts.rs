//! Contacts that come to rest together, and hops that are too low to be seen.

use super::{case, printed, text_of};

/// It rests on the plate until the plate falls faster, A W² sin W t = g, in every period anew: gaps close and open within their rounding.
#[test]
fn a_ball_on_a_shaken_plate_leaves_it_in_every_period() {
    let run = case(&text_of("ball_on_shaken_plate")).run();
    let (frequency, share) = (30.0, 9.81_f64 / (0.02 * 30.0 * 30.0));
    let lifts = run.events.iter().filter(|event| event.name == "c lifts");
    let lifts: Vec<f64> = lifts.map(|event| event.state.t).collect();
    assert_eq!(lifts.len(), 13);
    for (k, found) in lifts.into_iter().enumerate() {
        let expected = (share.asin() + std::f64::consts::TAU * (k + 1) as f64) / frequency;
        assert!((found - expected).abs() < 1e-9, "{found} {expected}");
    }
}

/// Both corners strike at the same instants, and have no more hops from the same one on: the motion of a ball.
#[test]
fn a_brick_that_falls_flat_comes_to_rest() {
    let told = printed("simulate", "brick_falls_flat", &[]);
    assert!(told.contains("y = 0.1000000000 m") && told.contains("th = 0 rad\n"), "{told}");
    assert!(!told.contains("no digit"), "{told}");
    let run = case(&text_of("brick_falls_flat")).run();
    let first = (2.0 * 0.5 / 9.81_f64).sqrt();
    // It rests after the first fall and hops that last 2 e + 2 e² + … times as long.
    let rests = run.events.last().expect("events").state.t;
    assert!((rests - 3.0 * first).abs() < 1e-6, "{rests}");
}

/// Its corners strike one after the other, some hundred times; what closes one moves the others by rounding.
#[test]
fn a_cube_comes_to_rest_on_four_corners() {
    let mut cube = case(&text_of("cube_on_four_corners"));
    cube.settings.digits = false;
    for tolerance in [1e-9, 1e-10] {
        cube.settings.tolerance = tolerance;
        let run = cube.run();
        let end = |name: &str| run.last()[name];
        for (name, expected) in [("x", 1.0), ("z", 0.1), ("q.x", 0.0), ("q.y", 0.0), ("z'", 0.0)] {
            assert!((end(name) - expected).abs() < 1e-9, "{name} = {} at {tolerance:e}", end(name));
        }
    }
}

/// What an input moves by itself has energy of its own, which no step follows: the balance is held without it.
#[test]
fn the_energy_of_a_driven_table_is_no_part_of_the_balance() {
    let told = printed("simulate", "block_on_shaken_table", &["--json"]);
    let json: serde_json::Value = serde_json::from_str(&told).expect("JSON");
    let drift = json["drift"]["energy_balance"].as_f64().expect("a drift");
    assert!(drift < 1e-11, "{drift}");
}
