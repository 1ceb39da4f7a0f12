//! Skates and wheels that cannot slip sideways.

use dalembert::Method;
use dalembert_tests::case::Case;
use dalembert_tests::reference::Reference;

use crate::near;

#[test]
fn chaplygin_sleigh_follows_the_reference() {
    let reference = Reference::load("B14");
    let mut case = Case::new("chaplygin_sleigh").tolerance(1e-13);
    case.compare(&reference, &["v", "omega"], |_| 1e-11);
    for (t, values) in reference.states() {
        let state = case.state_at(t);
        let value = |name: &str| values.iter().find(|(n, _)| n == name).expect("a value").1;
        near(state["speed"], value("v"), 1e-11);
        near(state["theta'"], value("omega"), 1e-11);
    }
    near(case.state_at(reference.scalar("time_of_omega_max"))["theta'"], reference.scalar("omega_max"), 1e-11);
    let late = case.state_at(40.0);
    near(late["speed"], reference.scalar("v_limit"), 1e-11);
    near(late["theta"], reference.scalar("theta_limit"), 1e-10);
}

#[test]
fn a_coarse_method_passes_where_the_watched_speed_turns() {
    // The speed of the locked axle is least at 0.47 s; those of Euler's method are not the rates of its places.
    let car = |method: Method| {
        let mut case = Case::new("braking_car");
        (case.settings.method, case.settings.step) = (method, Some(1e-3));
        case.run().last()
    };
    let (coarse, fine) = (car(Method::Euler), car(Method::Rk4));
    near(coarse["psi"], fine["psi"], 0.05);
}

#[test]
fn braking_car_follows_the_reference_with_either_axle_locked() {
    let reference = Reference::load("B15");
    for scene in ["rear_locked", "front_locked"] {
        let mut case = Case::new("braking_car").scene(scene).tolerance(1e-13);
        let states = reference.variant(scene);
        assert_eq!(states.len(), 3);
        case.compare_states(&states, &["v", "omega"], |_| 1e-9);
        for (t, values) in states {
            let state = case.state_at(t);
            let value = |name: &str| values.iter().find(|(n, _)| n == name).expect("a value").1;
            near(state["speed"], value("v"), 1e-9);
            near(state["psi'"], value("omega"), 1e-9);
        }
    }
}

/// Straight ahead it slows by μ g b/(a + b) or μ g a/(a + b); the run ends at the speed `crawl`.
#[test]
fn a_car_that_brakes_straight_stops_where_its_load_says() {
    let reference = Reference::load("B15");
    let straight = &reference.scalars()["straight_line"];
    for (front, axle) in [(1.0, "front"), (0.0, "rear")] {
        let number = |name: &str| dalembert_tests::reference::number(&straight[format!("{name}_{axle}").as_str()]);
        let slowing = dalembert_tests::reference::number(&straight[format!("decel_{axle}_locked").as_str()]);
        let mut case = Case::new("braking_car").scene("front_stop").set("front", front).start("psi'", 0.0);
        let run = case.run();
        assert_eq!(run.ended_by().map(|event| event.name.as_str()), Some("stopped"));
        near(run.last()["x"], number("stop_distance_from_20") - 1e-6 / (2.0 * slowing), 1e-8);
    }
}

/// Hint 1 of problem 16: without friction energy is kept, and the car is the sleigh of the lecture.
#[test]
fn a_car_without_brakes_is_a_sleigh() {
    let mut sleigh = Case::new("chaplygin_sleigh").set("m", 1000.0).set("I", 1500.0).set("d", -1.2);
    sleigh = sleigh.start("x'", 20.0).start("theta'", 0.05).tolerance(1e-13);
    let mut car = Case::new("braking_car").scene("no_brakes").tolerance(1e-13);
    for t in [1.0, 3.0, 5.0] {
        let (one, other) = (car.state_at(t), sleigh.state_at(t));
        near(one["x"], other["x"], 1e-8);
        near(one["y"], other["y"], 1e-8);
        near(one["psi"], other["theta"], 1e-9);
        near(one["speed"], other["speed"], 1e-8);
    }
}
