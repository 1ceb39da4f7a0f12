//! Energies that are counted twice, ranges of no width, and what is doubtful beside what is wrong.

use dalembert_symbolic::gate::judged;
use dalembert_symbolic::model::load;

use super::{accepted, refused};

/// The codes of what is doubtful in a file that is accepted.
pub fn warned(text: &str) -> Vec<&'static str> {
    let judged = load(text, &[]).and_then(judged).unwrap();
    judged.derivation.model.warnings.iter().map(|warning| warning.code).collect()
}

/// A body with an energy that is written out.
fn energy(written: &str) -> String {
    format!(
        "name: T
parameters: {{m: 1 kg, M: 3 kg, k: 10 N/m, g: 10 m/s^2}}
coordinates: {{x: m, y: m}}
bodies: {{b: {{mass: m, position: \"[x, y]\"}}}}
gravity: [0, -g]
{written}
"
    )
}

#[test]
fn energies_that_bodies_and_gravity_give_are_warned_of() {
    for twice in [
        "kinetic_energy: m*(x'^2 + y'^2)/2",
        "kinetic_energy: m*(x'^2 + y'^2)/2 + M*x'^2/2",
        "potential_energy: m*g*y",
        "potential_energy: m*g*y + k*x^2/2",
    ] {
        assert_eq!(warned(&energy(twice)), ["W419"], "{twice}");
    }
    for once in ["kinetic_energy: M*(x'^2 + y'^2)/2", "potential_energy: k*(x^2 + y^2)/2", "potential_energy: M*g*y"] {
        assert!(warned(&energy(once)).is_empty(), "{once}");
    }
}

/// A body with ranges, and a claim that is false.
fn ranges(of_x: &str) -> String {
    format!(
        "name: T
parameters: {{m: 1 kg, l: 2 m}}
coordinates: {{x: m}}
bodies: {{b: {{mass: m, position: \"[x, 0]\"}}}}
sample: {{x: {of_x}}}
"
    )
}

#[test]
fn ranges_without_width_are_refused_and_others_are_said() {
    for (range, shown) in [("[0, 0]", "[0, 0]"), ("[1, -1]", "[1, -1]"), ("[l, l]", "[2, 2]")] {
        refused(
            &ranges(range),
            &format!("the range of `x` in `sample` must be from a lower value to a higher one, this is {shown}"),
        );
    }
    accepted(&ranges("[-l, l]"));
    let report = load(&ranges("[-l, l]"), &[]).and_then(judged).unwrap().report;
    assert_eq!(report.unreached, ["`sample` leaves out all states but those with x from -2 to 2"]);
}

#[test]
fn an_inertia_that_was_forgotten_is_named_beside_the_balance_that_disagrees() {
    let text = |inertia: &str| {
        format!(
            "name: T
parameters: {{m: 1 kg, l: 1 m, g: 10 m/s^2}}
coordinates: {{th: rad}}
bodies: {{bar: {{mass: m, {inertia}angle: th, position: l/2*bar.x}}}}
gravity: [0, -g]
balances: {{equations: [{{equation: \"m*l^2/3*th'' = -m*g*l/2*cos(th)\"}}]}}
"
        )
    };
    accepted(&text("inertia: m*l^2/12, "));
    refused(&text(""), "has mass and turns, and has no `inertia`");
}

/// Nothing moves the body on: what solving leaves of x'' is a rounding of a rounding, which no terms are beside.
#[test]
fn a_free_body_is_in_balance_about_a_point_that_it_carries() {
    let file = |force: &str| {
        format!(
            "name: Free\nparameters: {{m: 2 kg, l: 1.5 m, I: m*l^2/3.7}}\ncoordinates: {{a: rad, c: rad, d: rad, x: m, y: m, z: m}}\n\
             frames: {{F: {{rotate: [[x, a], [y, c], [z, d]]}}}}\npoints: {{p: b + 0.5*l*F.z}}\n\
             bodies: {{b: {{mass: m, inertia: [I, I, 0.6*I], frame: F, position: '[x, y, z]'}}}}\n\
             balances: {{equations: [{force}, moment: {{about: p, of: [b]}}]}}\nscene: {{start: {{c: 0.466}}, until: 0.5}}\n"
        )
    };
    let across = "force: {of: [b], along: ground.y}, force: {of: [b], along: ground.z}";
    accepted(&file("force: {of: [b]}"));
    accepted(&file(&format!("equation: \"m*x'' = 0\", {across}")));
    refused(&file(&format!("equation: \"m*x'' = 1e-6*m*l*a'^2\", {across}")), "E506");
}

/// Where nothing presses the ball its accelerations are roundings, which another length of the quaternion makes anew.
#[test]
fn no_force_on_a_ball_is_no_dependence_on_a_length() {
    for until in ["1", "1.2", "1.3", "1.5", "2", "5"] {
        accepted(&format!(
            "name: Ball\nparameters: {{m: 2 kg, R: 0.1 m, mu: 0.9 1, e: 0.5 1}}\ncoordinates: {{x: m, y: m, z: m, q: rotation}}\n\
             frames: {{B: {{rotate: q}}}}\nbodies: {{d: {{mass: m, inertia: [m*R^2/2, m*R^2/2, m*R^2/2], frame: B, position: '[x, y, z]'}}}}\n\
             contacts: {{f: {{gap: z - R, on: d, at: '[x, y, z - R]', normal: '[0, 0, 1]', friction: mu, restitution: e}}}}\n\
             scene: {{start: {{z: 0.3, z': -1, q': {{ground: [40, 0, 0]}}}}, until: {until}}}\n"
        ));
    }
}
