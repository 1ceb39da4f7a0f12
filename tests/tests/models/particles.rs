//! Particles, alone and in company.

use std::f64::consts::{E, PI};

use dalembert::Method;
use dalembert_tests::case::Case;
use dalembert_tests::reference::Reference;

use super::near;

/// x = eᵗ, and so is its rate.
#[test]
fn exponential_growth_reaches_e() {
    let last = Case::new("exponential_growth").run().last();
    near(last["x"], E, 1e-11);
    near(last["x'"], E, 1e-11);
    near(last["growth"], 1.0, 1e-11);
}

#[test]
fn cannon_ball_flies_lands_and_turns_as_the_closed_form() {
    let reference = Reference::load("B08");
    Case::new("cannon_ball").tolerance(1e-13).compare(&reference, &[], |_| 1e-11);
    let run = Case::new("cannon_ball").tolerance(1e-13).run();
    let land = run.ended_by().expect("a landing");
    assert_eq!(land.name, "land");
    near(land.state.t, reference.scalar("landing_time"), 1e-11);
    near(land.state["x"], reference.scalar("range"), 1e-10);
    let apex = &run.events[0];
    assert_eq!(apex.name, "apex");
    near(apex.state.t, reference.scalar("apex_time"), 1e-11);
    near(apex.state["y"], reference.scalar("apex_height"), 1e-10);
    let run = Case::new("cannon_ball").scene("no_drag").run();
    near(run.last().t, reference.scalar("landing_time_no_drag"), 1e-11);
    near(run.last()["x"], reference.scalar("range_no_drag"), 1e-10);
}

/// Fired fast, the ball goes m v₀/b, a little more than 0.999 of it straight out, and comes down steeply.
#[test]
fn a_fast_cannon_ball_flies_a_triangle() {
    let run = Case::new("cannon_ball").scene("fast").run();
    let (reach, apex) = (2.0 * 3000.0 / 0.5, &run.events[0].state);
    near(run.last()["x"], reach, 1e-6 * reach);
    assert!(apex["x"] > 0.98 * reach && apex["x"] < reach);
    near(run.last()["x'"], 0.0, 1e-6);
    near(run.last()["y'"], -40.0, 1e-6);
}

/// Bernoulli's hodograph: with s the slope, m g/(c x'²) + s √(1 + s²) + asinh s keeps its value; at the apex s = 0.
/// Falling for long, the speed tends to √(m g/c).
#[test]
fn cannon_ball_with_quadratic_drag_keeps_to_the_hodograph() {
    let run = Case::new("cannon_ball_quadratic").tolerance(1e-13).run();
    let (m, c, g, s) = (2.0, 0.01, 10.0, 4.0_f64 / 3.0);
    let start = m * g / (c * 30.0 * 30.0) + s * (1.0 + s * s).sqrt() + s.asinh();
    near(run.events[0].state["x'"], (m * g / (c * start)).sqrt(), 1e-10);
    let mut fall = Case::new("cannon_ball_quadratic").start("y", 1e5).until(100.0);
    let last = fall.run().last();
    near(last["speed"], last["terminal_speed"], 1e-9);
}

#[test]
fn hanging_spring_moves_on_an_ellipse() {
    let reference = Reference::load("B07");
    Case::new("hanging_spring").tolerance(1e-13).compare(&reference, &[], |_| 1e-12);
    let back = Case::new("hanging_spring").state_at(reference.scalar("period"));
    for (name, start) in [("x", 1.0), ("y", 0.0), ("z", 0.0), ("x'", 0.0), ("y'", 2.0), ("z'", 1.0)] {
        near(back[name], start, 1e-10);
    }
}

/// Seven petals and three turns: after that the planet is back, at the same speed.
#[test]
fn the_rosette_of_the_cubic_spring_closes() {
    let run = Case::new("central_force").tolerance(1e-13).run();
    near(run.last()["x"], 1.0, 1e-10);
    near(run.last()["y"], 0.0, 1e-10);
    near(run.last()["y'"], 0.36432639161357316, 1e-10);
    let far = run.column("distance").expect("an output");
    let petals = far.windows(3).filter(|d| d[1] > d[0] && d[1] >= d[2]).count();
    assert_eq!(petals, 6, "and the seventh at both ends");
}

/// n = 1: x = cos t, y = 0.5 sin t.  n = −2: Kepler's equation t = (u − e sin u)/n with x' = 0 at perigee.
#[test]
fn central_force_gives_both_ellipses() {
    let last = Case::new("central_force").scene("ellipse").state_at(2.5);
    near(last["x"], 2.5_f64.cos(), 1e-10);
    near(last["y"], 0.5 * 2.5_f64.sin(), 1e-10);
    // Perigee at distance 1 with speed 1.2: a = 1/(2 − 1.44), e = 1 − 1/a.
    let a = 1.0 / (2.0 - 1.44_f64);
    let e = 1.0 - 1.0 / a;
    let mean = 20.0 / (a * a * a).sqrt();
    let mut u = mean;
    for _ in 0..50 {
        u -= (u - e * u.sin() - mean) / (1.0 - e * u.cos());
    }
    let last = Case::new("central_force").scene("kepler").tolerance(1e-13).run().last();
    near(last["x"], a * (u.cos() - e), 1e-9);
    near(last["y"], a * (1.0 - e * e).sqrt() * u.sin(), 1e-9);
}

/// The circular motion of two bodies has the period 2π √(d³/(G (m₁ + m₂))); an ellipse, that of its half axis.
#[test]
fn two_bodies_return() {
    let mut circle = Case::new("two_body").tolerance(1e-13);
    let (start, last) = (circle.run().first(), circle.state_at(2.0 * PI / 3.0_f64.sqrt()));
    near(last["distance"], 1.0, 1e-11);
    for (name, value) in start.entries() {
        near(last[name.as_str()], value, 1e-10);
    }
    let a = 1.0 / (2.0 - 1.44_f64);
    let mut ellipse = Case::new("two_body").scene("ellipse").tolerance(1e-13);
    let last = ellipse.state_at(2.0 * PI * (a * a * a / 3.0).sqrt());
    for (name, value) in ellipse.run().first().entries() {
        near(last[name.as_str()], value, 1e-9);
    }
}

/// Problem 6 c: on a circle of diameter 1 the rate is √(8/√3); after a third of a turn each body is where the
/// next one was.
#[test]
fn three_bodies_turn_as_a_rigid_triangle() {
    let mut case = Case::new("three_body_circle").tolerance(1e-13);
    let start = case.run().first();
    near(start["x[3]"].hypot(start["y[3]"]), 0.5, 1e-15);
    let third = case.state_at(2.0 * PI / 3.0 / (8.0 / 3.0_f64.sqrt()).sqrt());
    for (from, to) in [(1, 2), (2, 3), (3, 1)] {
        for axis in ["x", "y"] {
            near(third[format!("{axis}[{from}]").as_str()], start[format!("{axis}[{to}]").as_str()], 1e-11);
        }
    }
    let unequal = Case::new("three_body_circle").scene("unequal").tolerance(1e-13);
    { unequal }.compare(&Reference::load("B22"), &[], |_| 1e-11);
}

#[test]
fn figure_eight_follows_the_reference() {
    Case::new("figure_eight").tolerance(1e-13).compare(&Reference::load("B05"), &[], |_| 1e-10);
}

/// A corner of a hexagon moves along x, a drum stays as high as it is: what the other coordinate does is rounding, to which no
/// step is short enough.
#[test]
fn what_stays_at_rounding_does_not_shorten_the_steps_that_are_found() {
    for (name, methods) in [
        ("hexagon_springs", &[Method::Gauss4, Method::Gauss6, Method::Verlet, Method::KahanLi8][..]),
        ("eccentric_cylinder", &[Method::Gauss2, Method::Gauss4, Method::Gauss6]),
    ] {
        let exact = Case::new(name).run().last();
        for &method in methods {
            let mut case = Case::new(name).tolerance(1e-5);
            case.settings.method = method;
            let run = case.run();
            let last = run.last();
            assert!(run.work.steps < 200_000, "{name}, {method}: {:?}", run.work);
            for (found, expected) in last.q.iter().zip(&exact.q) {
                near(*found, *expected, 2e-3 * expected.abs().max(1.0));
            }
        }
    }
}

/// With s = x₂ − x₁ − l₀: s = (F₀ m₁/((m₁ + m₂) k))(1 − cos ωt), ω² = k (m₁ + m₂)/(m₁ m₂), while the centre of
/// mass gains F₀ t²/(2 (m₁ + m₂)), t counted from t₀ on.
#[test]
fn two_masses_follow_the_closed_form() {
    for (scene, k, from) in [("scene", 10.0, 0.0), ("later", 10.0, 0.7), ("stiff", 1000.0, 0.0)] {
        let last = Case::new("two_masses_spring").scene(scene).tolerance(1e-13).run().last();
        let (m1, m2, l0, force, t) = (1.0, 2.0, 1.5, 3.0, 3.0 - from);
        let omega = f64::sqrt(k * (m1 + m2) / (m1 * m2));
        let stretch = force * m1 / ((m1 + m2) * k) * (1.0 - (omega * t).cos());
        let centre = m2 * l0 / (m1 + m2) + force * t * t / (2.0 * (m1 + m2));
        near(last["stretch"], stretch, 1e-11);
        near(last["x1"], centre - m2 / (m1 + m2) * (l0 + stretch), 1e-10);
        near(last["x2"], centre + m1 / (m1 + m2) * (l0 + stretch), 1e-10);
    }
}

/// Whatever the springs do, the centre of mass flies a parabola.
#[test]
fn the_cluster_of_koenig_flies_a_parabola() {
    let run = Case::new("koenig").run();
    let (start, last) = (run.first(), run.last());
    // Masses 1, 2, 3 with velocities (1, 3), (1, 7), (3, 5), for 1 s.
    near(last["centre.x"] - start["centre.x"], (1.0 + 2.0 + 9.0) / 6.0, 1e-10);
    near(last["centre.y"] - start["centre.y"], (3.0 + 14.0 + 15.0) / 6.0 - 5.0, 1e-10);
    let spread = (start["energy_about_centre"] - last["energy_about_centre"]).abs();
    assert!(spread > 0.1, "the springs should have changed the energy about the centre");
}
