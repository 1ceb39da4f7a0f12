//! Small mechanisms with drawn parameters.

use std::f64::consts::TAU;

use super::draws::{Draws, neat, text};
use super::local::{Local, Of};
use super::shapes::Spot;

/// A mechanism and its motion, to which forces and events are added.
#[derive(Clone, Debug, Default)]
pub struct Mechanism {
    /// What it is.
    pub kind: &'static str,
    /// The coordinates' names, with the sizes of their motion, of their rates, and of the forces on them.
    pub coordinates: Vec<(&'static str, f64, f64, f64)>,
    /// Sections of the file besides those that are put together of several parts.
    pub lines: String,
    /// Generalized forces of its own: coordinate and expression.
    pub forces: Vec<(usize, String)>,
    /// Where these are not smooth.
    pub locals: Vec<Local>,
    /// Start: q, then q'.
    pub start: Vec<f64>,
    /// What happens to lie in the way: a coordinate or rate and the range that it passes through.
    pub ways: Vec<(Of, (f64, f64))>,
    /// How long it is watched, s.
    pub until: f64,
    /// The size of the motion of `base`, if that is an input that moves it.
    pub base: Option<f64>,
}

impl Mechanism {
    /// What a variable is called in the file.
    pub fn name_of(&self, of: Of) -> String {
        match of {
            Of::Time => "t".to_owned(),
            Of::Coordinate(i) => self.coordinates[i].0.to_owned(),
            Of::Rate(i) => format!("{}'", self.coordinates[i].0),
        }
    }
}

/// All kinds.
pub const KINDS: [fn(&mut Draws) -> Mechanism; 10] = [
    oscillator,
    coasting,
    pendulum,
    double_pendulum,
    two_scales,
    bouncing_ball,
    dry_friction,
    on_a_base,
    central_force,
    shaken_pendulum,
];

/// Lengths are of the order of metres, or anything.
fn length(draws: &mut Draws) -> f64 {
    if draws.chance(0.7) { draws.scale(0.3, 3.0) } else { draws.scale(1e-6, 1e6) }
}

pub fn oscillator(draws: &mut Draws) -> Mechanism {
    let (m, k, x) = (draws.scale(0.1, 10.0), draws.scale(0.1, 100.0), length(draws));
    let omega = (k / m).sqrt();
    let damping = if draws.chance(0.5) { 0.0 } else { neat(draws.scale(1e-3, 0.3) * m * omega) };
    Mechanism {
        kind: "oscillator",
        coordinates: vec![("x", x, x * omega, k * x)],
        lines: format!("bodies: {{b: {{mass: {}, position: \"[x, 0]\"}}}}", text(m)),
        forces: vec![(0, format!("-{}*x - {}*x'", text(k), text(damping)))],
        start: vec![neat(x * draws.sign()), 0.0],
        ways: vec![(Of::Coordinate(0), (-x, x)), (Of::Rate(0), (-x * omega, x * omega))],
        until: neat(draws.between(2.0, 60.0) / omega),
        ..Mechanism::default()
    }
}

pub fn coasting(draws: &mut Draws) -> Mechanism {
    let (m, x, until) = (draws.scale(0.1, 10.0), length(draws), draws.scale(0.1, 1000.0));
    let v = neat(x / until);
    Mechanism {
        kind: "coasting particle",
        coordinates: vec![("x", x, v, m * v / until)],
        lines: format!("bodies: {{b: {{mass: {}, position: \"[x, 0]\"}}}}", text(m)),
        start: vec![0.0, v],
        ways: vec![(Of::Coordinate(0), (0.0, x))],
        until,
        ..Mechanism::default()
    }
}

const BOB: &str =
    "gravity: [0, -9.81]\nbodies: {bob: {mass: MASS, position: \"[BASELENGTH*sin(theta), -LENGTH*cos(theta)]\"}}";

fn pendulum(draws: &mut Draws) -> Mechanism {
    let (m, l, theta) = (draws.scale(0.1, 10.0), draws.scale(0.1, 10.0), draws.between(0.2, 2.9));
    let omega = (9.81 / l).sqrt();
    Mechanism {
        kind: "pendulum",
        coordinates: vec![("theta", theta, theta * omega, m * 9.81 * l * theta)],
        lines: BOB.replace("MASS", &text(m)).replace("BASE", "").replace("LENGTH", &text(l)),
        start: vec![theta, neat(0.5 * omega * draws.between(-1.0, 1.0))],
        ways: vec![(Of::Coordinate(0), (-theta, theta)), (Of::Rate(0), (-0.9 * theta * omega, 0.9 * theta * omega))],
        until: neat(draws.between(2.0, 40.0) / omega),
        ..Mechanism::default()
    }
}

fn double_pendulum(draws: &mut Draws) -> Mechanism {
    let (m, l, theta) = (draws.scale(0.1, 10.0), draws.scale(0.3, 3.0), draws.between(0.2, 2.5));
    let (ratio, second) = (draws.scale(0.1, 10.0), draws.between(-2.5, 2.5));
    let omega = (9.81 / l).sqrt();
    let force = m * 9.81 * l * theta * (1.0 + ratio);
    Mechanism {
        kind: "double pendulum",
        coordinates: vec![
            ("theta", theta, theta * omega, force),
            ("phi", second.abs().max(theta), theta * omega, m * ratio * 9.81 * l * theta),
        ],
        lines: format!(
            "gravity: [0, -9.81]
points: {{elbow: \"{l}*[sin(theta), -cos(theta)]\"}}
bodies:
  upper: {{mass: {}, position: elbow}}
  lower: {{mass: {}, position: \"elbow + {l}*[sin(phi), -cos(phi)]\"}}",
            text(m),
            text(m * ratio),
            l = text(l),
        ),
        start: vec![theta, second, 0.0, 0.0],
        ways: vec![(Of::Coordinate(0), (-0.7 * theta, theta)), (Of::Coordinate(1), (-0.7 * theta, 0.7 * theta))],
        until: neat(draws.between(2.0, 15.0) / omega),
        ..Mechanism::default()
    }
}

/// A heavy body on a spring carries a light one, or stands beside one whose motion is smaller by orders of magnitude.
fn two_scales(draws: &mut Draws) -> Mechanism {
    let (m, omega, x) = (draws.scale(0.1, 10.0), draws.scale(0.3, 10.0), length(draws));
    let (light, faster) = (neat(m * draws.scale(1e-9, 1e-2)), draws.scale(3.0, 40.0));
    let carried = draws.chance(0.5);
    // What is carried is shaken by about this.
    let u = neat(x * if carried { 1.0 / (faster * faster) } else { draws.scale(1e-9, 1e-3) });
    let (stiff, soft) = (neat(m * omega * omega), neat(light * (faster * omega).powi(2)));
    Mechanism {
        kind: "two masses of very different size",
        coordinates: vec![("x", x, x * omega, stiff * x), ("u", u, u * faster * omega, soft * u)],
        lines: format!(
            "bodies: {{heavy: {{mass: {}, position: \"[x, 0]\"}}, light: {{mass: {}, position: \"[{}, 0]\"}}}}",
            text(m),
            text(light),
            if carried { "x + u" } else { "u" }
        ),
        forces: vec![(0, format!("-{}*x", text(stiff))), (1, format!("-{}*u", text(soft)))],
        start: vec![x, u, 0.0, 0.0],
        ways: vec![(Of::Coordinate(0), (-x, x)), (Of::Coordinate(1), (-u, u))],
        until: neat(draws.between(2.0, 15.0) / omega),
        ..Mechanism::default()
    }
}

fn bouncing_ball(draws: &mut Draws) -> Mechanism {
    let (m, height, power) = (draws.scale(0.1, 10.0), draws.scale(0.03, 30.0), *draws.pick(&[1.0, 1.5, 2.0, 2.5]));
    let depth = neat(height * draws.scale(1e-4, 0.1));
    // Half m g h is stored at this depth.
    let stiffness = neat(m * 9.81 * height * (power + 1.0) / depth.powf(power + 1.0));
    let damping = if draws.chance(0.5) { 0.0 } else { neat(draws.scale(1e-3, 0.3) / (2.0 * 9.81 * height).sqrt()) };
    let fall = (2.0 * height / 9.81).sqrt();
    Mechanism {
        kind: "bouncing ball",
        coordinates: vec![("y", height, 9.81 * fall, m * 9.81)],
        lines: format!("gravity: [0, -9.81]\nbodies: {{ball: {{mass: {}, position: \"[0, y]\"}}}}", text(m)),
        forces: vec![(0, format!("{}*max(0, -y)^{power:?}*(1 - {}*y')", text(stiffness), text(damping)))],
        locals: vec![Local { of: Of::Coordinate(0), spot: Spot { place: 0.0, every: None, width: 1e-4 * depth } }],
        start: vec![height, 0.0],
        ways: vec![(Of::Coordinate(0), (0.0, height))],
        until: neat(draws.between(1.2, 9.0) * fall),
        ..Mechanism::default()
    }
}

/// A block on a spring, driven, and rubbed by a belt or the ground.
fn dry_friction(draws: &mut Draws) -> Mechanism {
    let (m, k, x) = (draws.scale(0.1, 10.0), draws.scale(0.1, 100.0), length(draws));
    let omega = (k / m).sqrt();
    let belt = if draws.chance(0.5) { 0.0 } else { neat(0.3 * x * omega * draws.between(-1.0, 1.0)) };
    let drive = neat(k * x * draws.between(0.0, 0.6));
    let slip = if belt == 0.0 { "x'".to_owned() } else { format!("x' - {}", text(belt)) };
    let friction = neat(k * x * draws.scale(0.01, 0.4));
    Mechanism {
        kind: "dry friction",
        coordinates: vec![("x", x, x * omega, k * x)],
        lines: format!("bodies: {{b: {{mass: {}, position: \"[x, 0]\"}}}}", text(m)),
        forces: vec![(
            0,
            format!(
                "-{}*x + {}*sin({}*t) - {}*sign({slip})",
                text(k),
                text(drive),
                text(omega * draws.scale(0.2, 3.0)),
                text(friction)
            ),
        )],
        locals: vec![Local { of: Of::Rate(0), spot: Spot { place: belt, every: None, width: 1e-5 * x * omega } }],
        start: vec![neat(x * draws.sign()), 0.0],
        ways: vec![(Of::Coordinate(0), (-0.8 * x, 0.8 * x))],
        until: neat(draws.between(2.0, 30.0) / omega),
        ..Mechanism::default()
    }
}

/// A mass on a spring and a damper, carried by what an input moves.
pub fn on_a_base(draws: &mut Draws) -> Mechanism {
    let (m, k, x) = (draws.scale(0.1, 10.0), draws.scale(0.1, 100.0), length(draws));
    let omega = (k / m).sqrt();
    let damping = neat(draws.scale(1e-3, 0.3) * m * omega);
    Mechanism {
        kind: "mass on a base",
        coordinates: vec![("x", x, x * omega, k * x)],
        lines: format!("bodies: {{b: {{mass: {}, position: \"[base + x, 0]\"}}}}", text(m)),
        forces: vec![(0, format!("-{}*x - {}*x'", text(k), text(damping)))],
        start: vec![neat(x * draws.sign()), 0.0],
        ways: vec![(Of::Coordinate(0), (-0.9 * x, 0.9 * x))],
        until: neat(draws.between(2.0, 40.0) / omega),
        base: Some(x),
        ..Mechanism::default()
    }
}

fn shaken_pendulum(draws: &mut Draws) -> Mechanism {
    let pendulum = pendulum(draws);
    let lines = pendulum.lines.replace("position: \"[", "position: \"[base + ");
    Mechanism { kind: "shaken pendulum", lines, base: Some(0.3), ..pendulum }
}

/// A particle in the plane about a centre.
fn central_force(draws: &mut Draws) -> Mechanism {
    let (m, a, eccentricity) = (draws.scale(0.1, 10.0), length(draws), draws.between(0.0, 0.8));
    let omega = draws.scale(0.1, 10.0);
    // Kepler's third law.
    let strength = neat(m * omega * omega * a.powi(3));
    let far = neat(a * (1.0 + eccentricity));
    let speed = neat(a * omega * ((1.0 - eccentricity) / (1.0 + eccentricity)).sqrt());
    let force = strength / (a * a);
    Mechanism {
        kind: "central force",
        coordinates: vec![("x", a, a * omega, force), ("y", a, a * omega, force)],
        lines: format!(
            "bodies: {{b: {{mass: {}, position: \"[x, y]\"}}}}
springs: {{pull: {{between: [ground, b], energy: \"-{}/length\"}}}}",
            text(m),
            text(strength)
        ),
        start: vec![far, 0.0, 0.0, speed],
        ways: vec![(Of::Coordinate(0), (-0.5 * a, 0.9 * far))],
        until: neat(draws.between(0.5, 5.0) * TAU / omega),
        ..Mechanism::default()
    }
}
