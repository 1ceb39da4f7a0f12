//! Mechanisms of rigid bodies in the plane that touch planes and each other.

use std::fmt::Write;

use crate::random_runs::Draws;

/// A rigid body, its start and what pulls it.
#[derive(Clone, Debug)]
pub struct Body {
    /// kg.
    pub mass: f64,
    /// About its centre of mass, kg m².
    pub inertia: f64,
    /// x and y of its centre of mass, m, and its angle, rad.
    pub start: [f64; 3],
    /// Their rates.
    pub speed: [f64; 3],
}

/// A plane through a point; bodies are on the side of its normal.
#[derive(Clone, Copy, Debug)]
pub struct Plane {
    /// m.
    pub point: [f64; 2],
    /// Of length 1.
    pub normal: [f64; 2],
}

/// What touches.
#[derive(Clone, Debug)]
pub enum Touch {
    /// A point of a body, in its own axes, and a plane.
    Corner {
        /// The body.
        body: usize,
        /// m.
        place: [f64; 2],
        /// What it touches.
        plane: Plane,
    },
    /// A disc and a plane.
    Disc {
        /// The body.
        body: usize,
        /// m.
        radius: f64,
        /// What it touches.
        plane: Plane,
    },
    /// Two discs.
    Discs {
        /// The bodies.
        bodies: [usize; 2],
        /// m.
        radii: [f64; 2],
    },
    /// Two bodies, or one and the ground, pressed together as they slide along x; they never part.
    Pressed {
        /// The body, and the one on which it slides.
        body: usize,
        /// The ground, if there is none.
        from: Option<usize>,
        /// The largest force of friction, N.
        limit: f64,
    },
}

/// A contact with its coefficients.
#[derive(Clone, Debug)]
pub struct Contact {
    /// What touches.
    pub touch: Touch,
    /// Of friction; 0 where nothing rubs.
    pub friction: f64,
    /// Of restitution.
    pub restitution: f64,
}

/// What contacts that strike at once do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Law {
    /// All at once (Newton), as time stepping does.
    Together,
    /// One after the other.
    Sequential,
    /// All at once (Poisson).
    Poisson,
}

/// A mechanism that was drawn.
#[derive(Clone, Debug)]
pub struct Scene {
    /// One of [`KINDS`].
    pub kind: &'static str,
    /// Its bodies.
    pub bodies: Vec<Body>,
    /// Springs between the centres of two bodies along x and y, without rest length, N/m.
    pub springs: Vec<(usize, usize, f64)>,
    /// Its contacts.
    pub contacts: Vec<Contact>,
    /// m/s².
    pub gravity: [f64; 2],
    /// F sin(w t) along x on the first body, N and rad/s.
    pub drive: [f64; 2],
    /// What happens at impacts of several.
    pub law: Law,
    /// s.
    pub until: f64,
}

/// What is drawn.
pub const KINDS: [&str; 8] = [
    "box on a slope",
    "rod on a floor",
    "disc in a corner",
    "box in a corner",
    "two discs",
    "two boxes on a spring",
    "pressed blocks",
    "disc on a wedge of planes",
];

/// m/s².
const GRAVITY: f64 = 9.81;

/// The mechanism of a number.
pub fn draw(run: u64) -> Scene {
    let mut draws = Draws::new(run ^ 0x00c0_47ac_7500_0000);
    let kind = *draws.pick(&KINDS);
    let friction = *draws.pick(&[0.0, 0.1, 0.3, 0.5, 0.8]);
    let restitution = *draws.pick(&[0.0, 0.0, 0.3, 0.7]);
    let law = *draws.pick(&[Law::Together, Law::Together, Law::Sequential, Law::Poisson]);
    let drive = [*draws.pick(&[0.0, 0.0, 5.0, 15.0]), draws.between(1.0, 6.0)];
    let contact = |touch| Contact { touch, friction, restitution };
    let floor = Plane { point: [0.0; 2], normal: [0.0, 1.0] };
    let wall = Plane { point: [1.0, 0.0], normal: [-1.0, 0.0] };
    let mut scene = Scene {
        kind,
        bodies: Vec::new(),
        springs: Vec::new(),
        contacts: Vec::new(),
        gravity: [0.0, -GRAVITY],
        drive,
        law,
        until: 1.5,
    };
    let speeds = |draws: &mut Draws| [draws.between(-2.0, 2.0), draws.between(-1.0, 0.0), draws.between(-3.0, 3.0)];
    let cuboid = |draws: &mut Draws, start: [f64; 3]| {
        let (b, h) = (draws.between(0.05, 0.3), draws.between(0.05, 0.4));
        let body = Body { mass: 1.0, inertia: (b * b + h * h) / 3.0, start, speed: speeds(draws) };
        (body, [[-b, -h], [b, -h], [b, h]])
    };
    match kind {
        "box on a slope" => {
            let slope = draws.between(-0.5, 0.5);
            let start = [0.0, draws.between(0.5, 1.0), draws.between(-0.5, 0.5)];
            let (body, corners) = cuboid(&mut draws, start);
            scene.gravity = [GRAVITY * slope.sin(), -GRAVITY * slope.cos()];
            scene.bodies.push(body);
            let touch = |place| contact(Touch::Corner { body: 0, place, plane: floor });
            scene.contacts.extend(corners[..2].iter().copied().map(touch));
        }
        "rod on a floor" => {
            let half = draws.between(0.15, 1.0);
            let start = [0.0, 1.5, draws.between(-1.0, 1.0)];
            let speed = speeds(&mut draws);
            scene.bodies.push(Body { mass: 1.0, inertia: half * half / 3.0, start, speed });
            let touch = |x| contact(Touch::Corner { body: 0, place: [x, 0.0], plane: floor });
            scene.contacts.extend([-half, half].map(touch));
        }
        "disc in a corner" | "disc on a wedge of planes" => {
            let radius = draws.between(0.05, 0.5);
            let speed = speeds(&mut draws);
            let inertia = 0.5 * radius * radius;
            scene.bodies.push(Body { mass: 1.0, inertia, start: [0.0, 1.0, 0.0], speed });
            let planes = match kind {
                "disc in a corner" => vec![floor, wall],
                _ => {
                    let tilt = [draws.between(0.2, 1.2), draws.between(0.2, 1.2)];
                    let plane = |angle: f64| Plane { point: [0.0; 2], normal: [-angle.sin(), angle.cos()] };
                    scene.bodies[0].start = [0.0, 0.2 + radius / tilt[0].max(tilt[1]).cos(), 0.0];
                    vec![plane(tilt[0]), plane(-tilt[1])]
                }
            };
            let touch = |plane| contact(Touch::Disc { body: 0, radius, plane });
            scene.contacts.extend(planes.into_iter().map(touch));
        }
        "box in a corner" => {
            let start = [draws.between(-0.2, 0.4), draws.between(0.5, 1.0), draws.between(-0.5, 0.5)];
            let (body, corners) = cuboid(&mut draws, start);
            scene.bodies.push(body);
            let touch = |(place, plane)| contact(Touch::Corner { body: 0, place, plane });
            let pairs = [(corners[0], floor), (corners[1], floor), (corners[1], wall), (corners[2], wall)];
            scene.contacts.extend(pairs.map(touch));
        }
        "two discs" => {
            let radii = [draws.between(0.05, 0.2), draws.between(0.05, 0.2)];
            let masses = [1.0, draws.scale(0.3, 3.0)];
            let starts = [[0.0, radii[0], 0.0], [draws.between(-0.1, 0.1), 1.0, 0.0]];
            for i in 0..2 {
                let inertia = 0.5 * masses[i] * radii[i] * radii[i];
                let speed = [0.0, 0.0, draws.between(-3.0, 3.0)];
                scene.bodies.push(Body { mass: masses[i], inertia, start: starts[i], speed });
                scene.contacts.push(contact(Touch::Disc { body: i, radius: radii[i], plane: floor }));
            }
            scene.contacts.push(contact(Touch::Discs { bodies: [0, 1], radii }));
        }
        "two boxes on a spring" => {
            for i in 0..2 {
                let start = [draws.between(-0.5, 0.5), draws.between(0.5, 1.0), draws.between(-0.3, 0.3)];
                let (body, corners) = cuboid(&mut draws, start);
                scene.bodies.push(body);
                let touch = |place| contact(Touch::Corner { body: i, place, plane: floor });
                scene.contacts.extend(corners[..2].iter().copied().map(touch));
            }
            scene.springs.push((0, 1, draws.between(0.0, 20.0)));
        }
        _ => {
            scene.gravity = [0.0; 2];
            scene.until = 4.0;
            let count: usize = *draws.pick(&[1, 2, 3]);
            for i in 0..count {
                let speed = [draws.between(-2.0, 2.0), 0.0, 0.0];
                scene.bodies.push(Body { mass: draws.scale(0.3, 3.0), inertia: 1.0, start: [0.0; 3], speed });
                let from = if draws.chance(0.5) { i.checked_sub(1) } else { None };
                let touch = Touch::Pressed { body: i, from, limit: draws.between(0.0, 8.0) };
                scene.contacts.push(Contact { touch, friction: 0.0, restitution: 0.0 });
            }
            scene.springs.extend((1..count).map(|i| (i - 1, i, draws.between(0.0, 50.0))));
        }
    }
    scene
}

impl Scene {
    /// Its model file.
    pub fn text(&self) -> String {
        let mut text = String::from("name: Drawn\ncoordinates: {");
        let count = self.bodies.len();
        let list = |one: &dyn Fn(usize) -> String| (0..count).map(one).collect::<Vec<_>>().join(", ");
        let _ = writeln!(text, "{}}}", list(&|i| format!("x{i}: m, y{i}: m, th{i}: rad")));
        let parameters =
            |i: usize| format!("m{i}: {} kg, I{i}: {} kg*m^2", self.bodies[i].mass, self.bodies[i].inertia);
        let springs: String = self.springs.iter().map(|(a, b, k)| format!(", k{a}{b}: {k} N/m")).collect();
        let [gx, gy] = self.gravity;
        let [force, w] = self.drive;
        let _ = writeln!(
            text,
            "parameters: {{{}, gx: {gx} m/s^2, gy: {gy} m/s^2, F: {force} N, w: {w} rad/s, one: 1 m, L: 1 N{springs}}}",
            list(&parameters)
        );
        let body = |i: usize| format!("b{i}: {{mass: m{i}, inertia: I{i}, angle: th{i}, position: \"[x{i}, y{i}]\"}}");
        let _ = writeln!(text, "bodies: {{{}}}\ngravity: [gx, gy]", list(&body));
        let _ = writeln!(text, "forces: {{pull: {{on: b0, force: \"[F*sin(w*t), 0]\"}}}}");
        if !self.springs.is_empty() {
            let energy = |(a, b, _): &(usize, usize, f64)| format!("k{a}{b}/2*((x{a} - x{b})^2 + (y{a} - y{b})^2)");
            let _ =
                writeln!(text, "potential_energy: {}", self.springs.iter().map(energy).collect::<Vec<_>>().join(" + "));
        }
        let point = |(k, contact): (usize, &Contact)| match contact.touch {
            Touch::Corner { body, place: [x, y], .. } => {
                Some(format!("p{k}: \"b{body} + {x}*one*b{body}.x + {y}*one*b{body}.y\""))
            }
            _ => None,
        };
        let points: Vec<String> = self.contacts.iter().enumerate().filter_map(point).collect();
        if !points.is_empty() {
            let _ = writeln!(text, "points: {{{}}}", points.join(", "));
        }
        let (pressed, touching): (Vec<_>, Vec<_>) =
            (0..self.contacts.len()).partition(|k| matches!(self.contacts[*k].touch, Touch::Pressed { .. }));
        for (key, list) in [("friction", pressed), ("contacts", touching)] {
            if !list.is_empty() {
                let _ = writeln!(text, "{key}:");
                list.into_iter().for_each(|k| self.contact(k, &mut text));
            }
        }
        if self.contacts.iter().any(|contact| !matches!(contact.touch, Touch::Pressed { .. })) {
            let law = match self.law {
                Law::Together => "together",
                Law::Sequential => "sequential",
                Law::Poisson => "poisson",
            };
            let _ = writeln!(text, "impacts: {law}");
        }
        let _ = write!(text, "outputs: {{E: energy");
        for (k, contact) in self.contacts.iter().enumerate() {
            let _ = match contact.touch {
                Touch::Pressed { .. } => write!(text, ", T{k}: reaction(c{k})"),
                _ => write!(text, ", g{k}: \"{}\", N{k}: reaction(c{k})", self.gap(k)),
            };
            if contact.friction > 0.0 {
                let _ = write!(text, ", T{k}: reaction(c{k}.friction)");
            }
        }
        let start = |i: usize| {
            let Body { start: [x, y, th], speed: [u, v, w], .. } = self.bodies[i];
            format!("x{i}: {x}, y{i}: {y}, th{i}: {th}, x{i}': {u}, y{i}': {v}, th{i}': {w}")
        };
        let _ = writeln!(text, "}}\nscene: {{start: {{{}}}, until: {}, tolerance: 1e-9}}", list(&start), self.until);
        text
    }

    fn gap(&self, k: usize) -> String {
        let above = |[x, y]: [String; 2], &Plane { point: [px, py], normal: [nx, ny] }: &Plane| {
            format!("{nx}*({x} - {px}*one) + {ny}*({y} - {py}*one)")
        };
        match &self.contacts[k].touch {
            Touch::Corner { plane, .. } => above([format!("p{k}.x"), format!("p{k}.y")], plane),
            Touch::Disc { body, radius, plane } => {
                format!("{} - {radius}*one", above([format!("x{body}"), format!("y{body}")], plane))
            }
            Touch::Discs { bodies: [a, b], radii } => format!("norm(b{b} - b{a}) - {}*one", radii[0] + radii[1]),
            Touch::Pressed { .. } => String::new(),
        }
    }

    fn contact(&self, k: usize, text: &mut String) {
        let Contact { touch, friction, restitution } = &self.contacts[k];
        let place = match touch {
            Touch::Pressed { body, from, limit } => {
                let rate = from.map_or_else(String::new, |from| format!(" - x{from}'"));
                let on = from.map_or_else(String::new, |from| format!(", from: b{from}"));
                let _ = writeln!(
                    text,
                    "  c{k}: {{on: b{body}{on}, along: \"[1, 0]\", rate: \"x{body}'{rate}\", limit: {limit}*L}}"
                );
                return;
            }
            Touch::Corner { body, plane: Plane { normal: [nx, ny], .. }, .. } => {
                format!("on: b{body}, at: p{k}, normal: \"[{nx}, {ny}]\"")
            }
            Touch::Disc { body, radius, plane: Plane { normal: [nx, ny], .. } } => {
                format!("on: b{body}, at: \"b{body} - {radius}*one*[{nx}, {ny}]\", normal: \"[{nx}, {ny}]\"")
            }
            Touch::Discs { bodies: [a, b], radii: [r, s] } => {
                format!("on: b{b}, from: b{a}, at: \"b{a} + {}*(b{b} - b{a})\", normal: \"b{b} - b{a}\"", r / (r + s))
            }
        };
        let rubs = if *friction > 0.0 { format!(", friction: {friction}") } else { String::new() };
        let _ = writeln!(text, "  c{k}: {{gap: \"{}\", {place}{rubs}, restitution: {restitution}}}", self.gap(k));
    }
}
