//! Features that act only in a small part of the states: they are met, several at once, and in motion.

use dalembert_symbolic::gate::judged;
use dalembert_symbolic::model::load;

use super::{accepted, refused};

/// A body in space with a force, and claims.
fn body(force: &str, more: &str) -> String {
    format!(
        "name: T
parameters: {{m: 1 kg, c: 1 N*s/m, F: 1 N, w: 1 mm, x1: 3.1 m, x2: 4 m, y1: 4.9 m, y2: 6 m, z1: 7.1 m, z2: 8.1 m,
  t1: 1.7 s, tw: 1 ms, v1: 0.37 m/s, vw: 1 mm/s, s1: 4 m, s2: 1 m}}
coordinates: {{x: m, y: m, z: m}}
bodies: {{b: {{mass: m, position: \"[x, y, z]\"}}}}
forces: {{f: {{on: b, force: \"{force}\"}}}}
{more}
"
    )
}

const OF_X: &str = "step(x - x1)*step(x2 - x)";
const OF_Y: &str = "step(y - y1)*step(y2 - y)";
const OF_Z: &str = "step(z - z1)*step(z2 - z)";

#[test]
fn a_drag_inside_a_zone_is_met_in_motion_where_the_scene_rests() {
    for (zone, start) in [
        (format!("{OF_X}*{OF_Y}"), ""),
        (format!("{OF_X}*{OF_Y}*{OF_Z}"), ""),
        (format!("{OF_X}*{OF_Y}"), "scene: {start: {x: 3.5, y: 5.5}}\n"),
        (format!("{OF_X}*{OF_Y}"), "scene: {start: {x': 1}}\n"),
    ] {
        for (force, claim) in [
            (format!("-c*{zone}*velocity(b)"), "conserved: {e: energy}"),
            (format!("-c*{zone}*velocity(b)"), "conserved: {p: \"m*velocity(b)\"}"),
            // What turns the motion does no work, and changes the momentum.
            (format!("[-c*{zone}*y', c*{zone}*x', 0]"), "conserved: {p: \"m*velocity(b)\"}"),
        ] {
            let text = body(&force, &format!("{start}{claim}"));
            refused(&text, "is not conserved");
        }
        accepted(&body(&format!("[-c*{zone}*y', c*{zone}*x', 0]"), &format!("{start}conserved: {{e: energy}}")));
        accepted(&body(&format!("[0, 0, -c*{zone}*z']"), &format!("{start}conserved: {{p: \"m*x'\"}}")));
    }
}

#[test]
fn narrow_factors_are_met_all_at_once() {
    let peak = |of: &str| format!("exp(-(({of})/w)^2)");
    let [x, y, z] = ["x - x1", "y - y1", "z - z1"].map(peak);
    let plateau = "(1 - tanh((z - z1)/w)^2)";
    for product in [
        format!("{x}*{y}*{z}"),
        format!("{x}*{y}*{z}*exp(-((t - t1)/tw)^2)"),
        format!("{x}*{y}*{z}*exp(-((x' - v1)/vw)^2)"),
        format!("{x}*{y}*{plateau}"),
        format!("{}*{}*{z}", peak("x + y - s1"), peak("x - y - s2")),
        format!("{x}*{}*{}", peak("x + y - y2"), peak("x + y + z - z2")),
        format!("{OF_X}*{y}*{z}"),
        format!("{x}*({y}*{z} + 0)"),
    ] {
        refused(&body(&format!("[F*{product}, 0, 0]"), "conserved: {e: energy}"), "is not conserved");
        accepted(&body(&format!("[F*{product}, 0, 0]"), "conserved: {p: \"m*y'\"}"));
    }
}

#[test]
fn narrow_factors_that_no_state_meets_at_once_are_named() {
    let text =
        body("[F*exp(-((x - x1)/w)^2)*exp(-((x - x2)/w)^2)*exp(-((y - y1)/w)^2), 0, 0]", "conserved: {e: energy}");
    let report = load(&text, &[]).and_then(judged).unwrap().report;
    let named = |words: &String| words.contains("act at once");
    assert!(report.unreached.iter().any(named), "{:?}", report.unreached);
}

/// A force that acts only where two tables are not 0, or inside two zones, at once is met: a piece of a table that is 0 says nothing.
#[test]
fn products_of_tables_and_of_zones_are_met() {
    for (smooth, force) in [(0, "gate(x)*gate(y)"), (1, "gate(x)*gate(y)"), (1, "gate(x)*max(0, z - 5)")] {
        let file = |claim: &str| {
            format!(
                "name: Gates\nparameters: {{m: 1 kg, J: 1 kg*m^2, F: 3 N}}\n\
                 tables: {{gate: {{points: [[0, 0], [3, 0], [4, 1], [6, 0], [10, 0]], smooth: {smooth}, units: [m, 1]}}}}\n\
                 coordinates: {{x: m, y: m, z: 1}}\nkinetic_energy: m*(x'^2 + y'^2)/2 + J*z'^2/2\n\
                 generalized_forces: {{x: 'F*{force}'}}\n{claim}"
            )
        };
        refused(&file("conserved: {e: energy}\n"), "`e`");
        refused(&file("checks: {c: \"m*x'' = 0\"}\n"), "`c`");
        accepted(&file(&format!("checks: {{c: \"m*x'' = F*{force}\"}}\n")));
    }
    for width in ["1e-1", "1e-2", "1e-3"] {
        let file = |claim: &str| {
            format!(
                "name: Zones\nparameters: {{c: 1, a: 3, b: 2, w: {width}}}\ncoordinates: {{p: 1, q: 1}}\nkinetic_energy: p'^2/2 + q'^2/2\n\
                 generalized_forces: {{p: -c*p'*step(w - abs(p - a))*step(w - abs(q - b))}}\npotential_energy: p^2/2\n\
                 {claim}scene: {{start: {{p: 1}}, until: 1}}\n"
            )
        };
        refused(&file("conserved: {e: energy}\n"), "`e`");
        accepted(&file(""));
    }
}
