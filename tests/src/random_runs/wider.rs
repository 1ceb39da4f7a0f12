//! What is drawn beside the first ten thousand runs: starts at events and at rest, long horizons, features of two and three
//! variables, runs that are cut in two.

use super::draws::{Draws, neat, text};
use super::file::{Drawn, Place, Sheet};
use super::local::{Local, Of};
use super::mechanisms::{KINDS, Mechanism, coasting, on_a_base, oscillator};
use super::shapes::Shape;

/// Natural periods of the longest runs, about.
const HORIZON: f64 = 1e6;

/// Draws the model file of a run.
pub fn draw_wider(run: u64) -> Drawn {
    let mut draws = Draws::new(run);
    let far = draws.chance(0.15);
    let mut mechanism = match far {
        // What steps need not follow vibration by vibration.
        true => draws.pick(&[coasting as fn(&mut Draws) -> Mechanism, oscillator, on_a_base])(&mut draws),
        false => draws.pick(&KINDS)(&mut draws),
    };
    if far {
        mechanism.until = neat(mechanism.until * draws.scale(10.0, HORIZON / 10.0));
    }
    let rests = draws.chance(0.2) && rest(&mut mechanism);
    let mut sheet = Sheet::of(&mechanism);
    for _ in 0..*draws.pick(&[0, 1, 1, 2]) {
        if far {
            sheet.add_in_time(&mechanism, &mut draws);
        } else {
            sheet.add(&mechanism, &mut draws);
        }
    }
    if !far && draws.chance(0.5) {
        add_product(&mut sheet, &mechanism, &mut draws);
    }
    // What vibrates for long would meet it a million times.
    let watched = !far || mechanism.kind == "coasting particle";
    let event = match draws.chance(0.3) {
        _ if !watched => None,
        true => Some(watch_start(&mut sheet, &mechanism, &mut draws)),
        false => draws.chance(0.7).then(|| sheet.watch(&mechanism, &mut draws)),
    };
    let plain = sheet.text(&mechanism, &mechanism.start, &mut draws);
    let cut = draws.chance(0.5).then(|| draws.between(0.0, 1.0));
    let kind = match (far, rests) {
        (true, _) => "long run",
        (_, true) => "start at rest",
        _ => mechanism.kind,
    };
    Drawn { text: plain.clone(), plain, mechanism: kind, features: sheet.features, event, locals: sheet.locals, cut }
}

/// Lets a mechanism start at rest in its equilibrium; false if it has none at nought.
fn rest(mechanism: &mut Mechanism) -> bool {
    let rests = !matches!(mechanism.kind, "bouncing ball" | "central force" | "coasting particle");
    if rests {
        mechanism.start.fill(0.0);
    }
    rests
}

/// Adds a force that acts where two or three variables have their values at once.
fn add_product(sheet: &mut Sheet, mechanism: &Mechanism, draws: &mut Draws) {
    let time = (Of::Time, (0.0, mechanism.until));
    let coordinates = mechanism.ways.iter().filter(|(of, _)| matches!(of, Of::Coordinate(_)));
    let mut variables: Vec<(Of, (f64, f64))> = coordinates.copied().collect();
    if variables.len() < 2 || draws.chance(0.5) {
        variables.push(time);
    }
    let local: Vec<Shape> = Shape::ALL.into_iter().filter(|shape| shape.is_local() && *shape != Shape::Comb).collect();
    let mut factors = Vec::new();
    for (of, range) in variables {
        let shape = *draws.pick(&local);
        let (function, spots) = shape.write(&mechanism.name_of(of), range, draws.scale(1e-3, 0.3), draws);
        sheet.locals.extend(spots.into_iter().map(|spot| Local { of, spot }));
        sheet.features.push((Place::Product, shape));
        factors.push(format!("({function})"));
    }
    let i = *draws.pick(&(0..mechanism.coordinates.len()).collect::<Vec<_>>());
    let strength = draws.sign() * draws.between(0.1, 3.0) * mechanism.coordinates[i].3;
    sheet.forces.push((i, format!("{}*{}", text(strength), factors.join("*"))));
}

/// Adds an event whose function is zero at the start.
fn watch_start(sheet: &mut Sheet, mechanism: &Mechanism, draws: &mut Draws) -> &'static str {
    let n = mechanism.coordinates.len();
    let i = *draws.pick(&(0..n).collect::<Vec<_>>());
    let (of, value) = match draws.chance(0.7) {
        true => (Of::Coordinate(i), mechanism.start[i]),
        false => (Of::Rate(i), mechanism.start[n + i]),
    };
    let (_, motion, speed, _) = mechanism.coordinates[i];
    let size = if matches!(of, Of::Coordinate(_)) { motion } else { speed };
    sheet.watch_at(of, (value, size), &mechanism.name_of(of));
    "zero at the start"
}
