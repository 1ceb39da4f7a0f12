//! Gaps that are no distances: friction and reactions are of the force across all the same.

use super::case;

/// A block on a slope, whose gap is this.
fn on_slope(gap: &str, mu: f64) -> dalembert::Run {
    let text = format!(
        "name: Slope
parameters: {{m: 1 kg, g: 9.81 m/s^2, mu: {mu}, al: pi/6 rad}}
coordinates: {{x: m, y: m}}
define: {{N: reaction(slope)}}
bodies: {{b: {{mass: m, position: '[x, y]'}}}}
gravity: [0, -g]
contacts: {{slope: {{gap: {gap}, on: b, normal: '[-sin(al), cos(al)]', friction: mu}}}}
outputs: {{N: N, path: x/cos(al)}}
scene: {{start: {{x: 0, y: 0}}, until: 1}}
"
    );
    case(&text).run()
}

#[test]
fn a_block_on_a_slope_obeys_the_force_across_it_however_the_gap_is_written() {
    let weight = 9.81 * (std::f64::consts::PI / 6.0).cos();
    for gap in ["y*cos(al) - x*sin(al)", "y - x*tan(al)", "3*(y - x*tan(al))"] {
        let rests = on_slope(gap, 0.6);
        assert!(rests.last()["x"] == 0.0 && (rests.last()["N"] - weight).abs() < 1e-12, "{gap}: {}", rests.last());
        let slides = on_slope(gap, 0.3);
        let path = -0.5 * (9.81 * 0.5 - 0.3 * weight);
        assert!((slides.last()["path"] - path).abs() < 1e-12, "{gap}: {}", slides.last());
    }
}

/// It takes off from a road, strikes it again with friction, and comes to rest: found by hand-written event search at 1e-12.
#[test]
fn a_point_on_a_bumpy_road_lands_with_friction() {
    let text = "name: Road
parameters: {m: 1 kg, g: 9.81 m/s^2, mu: 0.1, e: 0.4, slope: 0.1}
coordinates: {x: m, y: m}
tables: {road: {points: [[0, 0], [1, 0.3], [2, 0], [3, -0.3], [4, 0]], units: [m, m], periodic: true}}
define: {n: 'unit([-diff(road(x), x), 1])'}
bodies: {p: {mass: m, position: '[x, y]'}}
gravity: [0, -g]
contacts: {c: {gap: y - road(x), on: p, normal: n, friction: mu, restitution: e}}
scene: {start: {x: 0, y: 0, x': 3, y': '3*slope'}, until: 3, tolerance: 1e-11}
";
    let mut road = case(text);
    road.settings.digits = false;
    let run = road.run();
    let landings: Vec<f64> = run.events.iter().filter(|e| e.name == "c lands").map(|e| e.state.t).collect();
    assert!((landings[1] - 0.088658).abs() < 1e-6, "{landings:?}");
    assert!((run.last()["x"] - 0.9702).abs() < 1e-4, "{}", run.last());
}
