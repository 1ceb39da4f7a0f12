//! A drawn model file.

use super::draws::{Draws, neat, text};
use super::local::{Local, Of};
use super::mechanisms::{KINDS, Mechanism};
use super::shapes::{Shape, Sharpness};

/// A model file, what is in it, and where it happens.
#[derive(Clone, Debug)]
pub struct Drawn {
    /// The text.
    pub text: String,
    /// What the run is judged by: the same with its discontinuities and its start written plainly.
    pub plain: String,
    /// The mechanism.
    pub mechanism: &'static str,
    /// The features.
    pub features: Vec<(Place, Shape)>,
    /// The event, if there is one.
    pub event: Option<&'static str>,
    /// Where something happens.
    pub locals: Vec<Local>,
    /// Where the run is cut in two, to be one with the run in one piece: at that part of its events.
    pub cut: Option<f64>,
}

/// Where a feature stands in the equations.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Place {
    /// A force that depends on time.
    Time,
    /// An input that is a force.
    Input,
    /// An input whose rate is a force.
    InputRate,
    /// An input that moves a body.
    Base,
    /// A force that depends on a coordinate.
    Coordinate,
    /// A force that depends on a rate.
    Rate,
    /// A potential.
    Potential,
    /// A force that depends on two or three of them.
    Product,
}

/// Draws the model file of a run.
pub fn draw(run: u64) -> Drawn {
    let mut draws = Draws::new(run);
    let kind = draws.pick(&KINDS);
    let mechanism = kind(&mut draws);
    let mut sheet = Sheet::of(&mechanism);
    for _ in 0..*draws.pick(&[0, 1, 1, 1, 2, 2]) {
        sheet.add(&mechanism, &mut draws);
    }
    let event = draws.chance(0.6).then(|| sheet.watch(&mechanism, &mut draws));
    // Drawn apart, so that everything else stays what it was before these were.
    let mut aside = Draws::new(run ^ ASIDE);
    if aside.chance(0.2) {
        sheet.drag(&mechanism, &mut aside);
    }
    let plain = sheet.text(&mechanism, &mechanism.start, &mut draws);
    let mut text = plain.clone();
    if aside.chance(0.3) {
        text = with_jumping_arguments(&text);
    }
    if aside.chance(0.4) {
        let start = nudged(&mechanism, &mut aside);
        text = text.replace(&starting(&mechanism, &mechanism.start), &starting(&mechanism, &start));
    }
    Drawn { text, plain, mechanism: mechanism.kind, features: sheet.features, event, locals: sheet.locals, cut: None }
}

const ASIDE: u64 = 0x5eed_0000_0000_0000;

/// The same discontinuities with arguments that have poles in the place of zeros, or besides them.
fn with_jumping_arguments(text: &str) -> String {
    let mut out = text.replace("sign(sin(", "sign(tan(0.5*");
    for name in ["step(", "sign(abs("] {
        let mut from = 0;
        while let Some(at) = out[from..].find(name).map(|at| from + at + name.find('(').unwrap_or(0)) {
            let Some(end) = closing(&out[at..]).map(|end| at + end) else { break };
            let inner = out[at + 1..end].to_owned();
            out.replace_range(at + 1..end, &format!("1/({inner})"));
            from = at + 1;
        }
    }
    out
}

/// Where the first bracket closes.
fn closing(text: &str) -> Option<usize> {
    let mut depth = 0;
    text.char_indices().find_map(|(at, c)| {
        depth += i32::from(c == '(') - i32::from(c == ')');
        (c == ')' && depth == 0).then_some(at)
    })
}

/// A start in which what rests moves, by next to nothing.
fn nudged(mechanism: &Mechanism, draws: &mut Draws) -> Vec<f64> {
    let n = mechanism.coordinates.len();
    let nudge = |(k, value): (usize, &f64)| {
        let (_, motion, speed, _) = mechanism.coordinates[k % n];
        let size = if k < n { motion } else { speed };
        if *value == 0.0 { draws.sign() * draws.scale(1e-25, 1e-16) * size } else { *value }
    };
    mechanism.start.iter().enumerate().map(nudge).collect()
}

/// The start as it stands in the file.
fn starting(mechanism: &Mechanism, start: &[f64]) -> String {
    let names = mechanism.coordinates.iter().map(|(name, ..)| *name);
    let all = names.clone().map(str::to_owned).chain(names.map(|name| format!("{name}'")));
    let start: Vec<String> = all.zip(start).map(|(name, value)| format!("{name}: {}", text(*value))).collect();
    format!("start: {{{}}}", start.join(", "))
}

/// What is added to a mechanism.
#[derive(Default)]
pub(super) struct Sheet {
    inputs: Vec<String>,
    base: Vec<String>,
    pub forces: Vec<(usize, String)>,
    potential: Vec<String>,
    event: Option<String>,
    pub features: Vec<(Place, Shape)>,
    pub locals: Vec<Local>,
}

impl Sheet {
    /// With nothing but what the mechanism brings.
    pub fn of(mechanism: &Mechanism) -> Self {
        Sheet { locals: mechanism.locals.clone(), forces: mechanism.forces.clone(), ..Sheet::default() }
    }

    /// Adds a feature anywhere.
    pub fn add(&mut self, mechanism: &Mechanism, draws: &mut Draws) {
        let place = match draws.pick(&[0, 1, 2, 3, 4, 5, 6]) {
            0 if mechanism.base.is_some() => Place::Base,
            0 | 1 => Place::Time,
            2 => Place::Input,
            3 if draws.chance(0.3) => Place::InputRate,
            4 => Place::Potential,
            5 if draws.chance(0.3) => Place::Rate,
            _ => Place::Coordinate,
        };
        let place = if place == Place::Rate && !has_rate(mechanism) { Place::Coordinate } else { place };
        self.add_at(place, mechanism, draws);
    }

    /// Adds a feature of time.
    pub fn add_in_time(&mut self, mechanism: &Mechanism, draws: &mut Draws) {
        let place = if mechanism.base.is_some() { Place::Base } else { *draws.pick(&[Place::Time, Place::Input]) };
        self.add_at(place, mechanism, draws);
    }

    fn add_at(&mut self, place: Place, mechanism: &Mechanism, draws: &mut Draws) {
        let shapes: Vec<Shape> = Shape::ALL.into_iter().filter(|shape| fits(place, *shape)).collect();
        let shape = *draws.pick(&shapes);
        let width = draws.scale(1e-6, 0.3);
        let (of, range) = match place {
            Place::Coordinate | Place::Potential => {
                let ways: Vec<_> = mechanism.ways.iter().filter(|(of, _)| matches!(of, Of::Coordinate(_))).collect();
                **draws.pick(&ways)
            }
            Place::Rate => *mechanism.ways.iter().find(|(of, _)| matches!(of, Of::Rate(_))).expect("a rate"),
            _ => (Of::Time, (0.0, mechanism.until)),
        };
        let name = mechanism.name_of(of);
        let (function, spots) = shape.write(&name, range, width, draws);
        self.locals.extend(spots.into_iter().map(|spot| Local { of, spot }));
        self.features.push((place, shape));
        let i = match of {
            Of::Coordinate(i) | Of::Rate(i) => i,
            Of::Time => *draws.pick(&(0..mechanism.coordinates.len()).collect::<Vec<_>>()),
        };
        let (_, motion, speed, force) = mechanism.coordinates[i];
        // What is narrow may be strong.
        let strength = draws.sign() * draws.between(0.1, 1.0);
        let stronger = if shape.is_local() { width.powf(-draws.between(0.0, 1.0)) } else { 1.0 };
        let weaker = width.powf(draws.between(0.0, 1.0));
        match place {
            Place::Time | Place::Coordinate | Place::Rate | Place::Product => {
                self.forces.push((i, format!("{}*({function})", text(strength * stronger * force))));
            }
            Place::Input => {
                let input = format!("u{}", self.inputs.len());
                self.forces.push((i, input.clone()));
                self.inputs.push(format!("{input}: \"{}*({function})\"", text(strength * stronger * force)));
            }
            Place::InputRate => {
                let input = format!("u{}", self.inputs.len());
                let damping = force / speed;
                self.forces.push((i, format!("{}*{input}'", text(damping))));
                self.inputs.push(format!("{input}: \"{}*({function})\"", text(strength * motion)));
            }
            Place::Base => {
                let motion = mechanism.base.unwrap_or(1.0);
                let smaller = if shape.sharpness() == Sharpness::Smooth || shape.is_local() { width } else { weaker };
                self.base.push(format!("{}*({function})", text(strength * motion * smaller)));
            }
            Place::Potential => {
                self.potential.push(format!("{}*({function})", text(0.7 * strength * force * motion)));
            }
        }
    }

    /// Adds a drag of the square of a rate.
    fn drag(&mut self, mechanism: &Mechanism, draws: &mut Draws) {
        let i = *draws.pick(&(0..mechanism.coordinates.len()).collect::<Vec<_>>());
        let (name, _, speed, force) = mechanism.coordinates[i];
        let factor = draws.scale(0.01, 0.5) * force / (speed * speed);
        self.forces.push((i, format!("-{}*{name}'*abs({name}')", text(factor))));
    }

    /// Adds an event, and tells which kind.
    pub fn watch(&mut self, mechanism: &Mechanism, draws: &mut Draws) -> &'static str {
        let (of, range) = *draws.pick(&mechanism.ways);
        let (name, span) = (mechanism.name_of(of), range.1 - range.0);
        let c = neat(draws.between(range.0 + 0.1 * span, range.1 - 0.1 * span));
        let mut spot = |place: f64, every: Option<f64>, width: f64| {
            self.locals.push(Local { of, spot: super::shapes::Spot { place, every, width } });
        };
        let (kind, when) = match draws.pick(&[0, 0, 1, 1, 2, 3, 4]) {
            0 => {
                spot(c, None, 1e-4 * span);
                ("x − c", format!("{name} - {}", text(c)))
            }
            1 => {
                let n = neat(draws.scale(3.0, 1000.0) / span);
                spot(0.0, Some(std::f64::consts::PI / n), 0.3 / n);
                ("sin(n x)", format!("sin({}*{name})", text(n)))
            }
            2 => {
                let apart = neat(span * draws.scale(1e-5, 0.1));
                let other = c + apart;
                spot(c, None, 0.1 * apart);
                spot(other, None, 0.1 * apart);
                ("two roots", format!("({name} - {})*({name} - {} - {})", text(c), text(c), text(apart)))
            }
            3 => {
                let width = neat(span * draws.scale(1e-6, 0.1));
                spot(c, None, 0.3 * width);
                ("a Gaussian less a half", format!("exp(-(({name} - {})/{})^2) - 0.5", text(c), text(width)))
            }
            _ => {
                let width = neat(span * draws.scale(1e-6, 0.1));
                spot(c, None, 0.1 * width);
                ("a tent less a half", format!("max(0, 1 - abs({name} - {})/{}) - 0.5", text(c), text(width)))
            }
        };
        self.event = Some(when);
        kind
    }

    /// Adds an event where a variable has a value, which is of this size elsewhere.
    pub fn watch_at(&mut self, of: Of, (value, size): (f64, f64), name: &str) {
        self.locals.push(Local { of, spot: super::shapes::Spot { place: value, every: None, width: 1e-4 * size } });
        self.event = Some(format!("{name} - {}", text(value)));
    }

    pub fn text(&self, mechanism: &Mechanism, start: &[f64], draws: &mut Draws) -> String {
        let names: Vec<&str> = mechanism.coordinates.iter().map(|(name, ..)| *name).collect();
        let mut lines = vec!["name: Drawn".to_owned()];
        lines.push(format!(
            "coordinates: {{{}}}",
            names.iter().map(|n| format!("{n}: 1")).collect::<Vec<_>>().join(", ")
        ));
        let mut inputs = self.inputs.clone();
        if mechanism.base.is_some() {
            let base = if self.base.is_empty() { "0".to_owned() } else { self.base.join(" + ") };
            inputs.push(format!("base: \"{base}\""));
        }
        if !inputs.is_empty() {
            lines.push(format!("inputs: {{{}}}", inputs.join(", ")));
        }
        lines.push(mechanism.lines.clone());
        if !self.potential.is_empty() {
            lines.push(format!("potential_energy: \"{}\"", self.potential.join(" + ")));
        }
        let force = |(i, name): (usize, &&str)| {
            let terms: Vec<&str> =
                self.forces.iter().filter(|(at, _)| *at == i).map(|(_, term)| term.as_str()).collect();
            (!terms.is_empty()).then(|| format!("{name}: \"{}\"", terms.join(" + ")))
        };
        let forces: Vec<String> = names.iter().enumerate().filter_map(force).collect();
        if !forces.is_empty() {
            lines.push(format!("generalized_forces: {{{}}}", forces.join(", ")));
        }
        if let Some(event) = &self.event {
            lines.push(format!("events: {{e: {{when: \"{event}\", then: record}}}}"));
        }
        lines.push(format!(
            "scene: {{{}, until: {}, tolerance: {}}}\n",
            starting(mechanism, start),
            text(mechanism.until),
            text(draws.scale(1e-10, 1e-4))
        ));
        lines.join("\n")
    }
}

fn has_rate(mechanism: &Mechanism) -> bool {
    mechanism.ways.iter().any(|(of, _)| matches!(of, Of::Rate(_)))
}

/// Whether a shape has a meaning at a place: what jumps moves no body and stores no energy.
fn fits(place: Place, shape: Shape) -> bool {
    match place {
        Place::Base | Place::Potential => shape.sharpness() != Sharpness::Jumping,
        // The acceleration decides on which side of a jump a rate goes on: there it may chatter.
        Place::Rate => shape.sharpness() == Sharpness::Smooth,
        _ => true,
    }
}
