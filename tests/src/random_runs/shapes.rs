//! Functions of one variable that happen in a small part of it.

use super::draws::{Draws, neat, text};

/// Where a function of one variable happens, and how narrowly.
#[derive(Clone, Copy, Debug)]
pub struct Spot {
    /// A place, or one of many.
    pub place: f64,
    /// The distance from one place to the next; `None`: there is one.
    pub every: Option<f64>,
    /// How narrow it is there.
    pub width: f64,
}

impl Spot {
    /// The distance of a value from the nearest place, no less than the width there.
    pub fn distance(&self, value: f64) -> f64 {
        let apart = match self.every {
            None => (value - self.place).abs(),
            Some(period) => ((value - self.place + 0.5 * period).rem_euclid(period) - 0.5 * period).abs(),
        };
        apart.max(self.width)
    }
}

/// How sharp a shape is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Sharpness {
    /// It has derivatives of all orders.
    Smooth,
    /// Its derivative jumps.
    Kinked,
    /// It jumps.
    Jumping,
}

/// A kind of function that happens in a small part of its variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Shape {
    /// `exp(−z²)`.
    Gaussian,
    /// `1/(1 + z²)`.
    Lorentz,
    /// `1/(1 + z⁴)`.
    Quartic,
    /// `1 − tanh² z`, which is `1/cosh² z`.
    Sech,
    /// The difference of two tanh.
    Window,
    /// `tanh z`.
    Tanh,
    /// `1/(1 + exp(−z))`.
    Logistic,
    /// `atan z`.
    Arctangent,
    /// `√(z² + w²)`.
    SoftKink,
    /// `exp(−sin²/w²)`.
    Comb,
    /// `max(0, z)`.
    Ramp,
    /// `|z|`.
    Fold,
    /// `max(0, 1 − |z|)`.
    Tent,
    /// `exp(−|z|)`.
    Cusp,
    /// `max(0, sin − ½)`.
    Clipped,
    /// `max(0, |z| − w) sign z`.
    DeadZone,
    /// `step z`.
    Step,
    /// The difference of two steps.
    Pulse,
    /// `sign sin`.
    Wave,
    /// `sign(|z| − w)`.
    NestedSigns,
}

use Shape::*;

impl Shape {
    /// All of them.
    pub const ALL: [Shape; 20] = [
        Gaussian,
        Lorentz,
        Quartic,
        Sech,
        Window,
        Tanh,
        Logistic,
        Arctangent,
        SoftKink,
        Comb,
        Ramp,
        Fold,
        Tent,
        Cusp,
        Clipped,
        DeadZone,
        Step,
        Pulse,
        Wave,
        NestedSigns,
    ];

    /// How sharp it is.
    pub fn sharpness(self) -> Sharpness {
        match self {
            Step | Pulse | Wave | NestedSigns => Sharpness::Jumping,
            Ramp | Fold | Tent | Cusp | Clipped | DeadZone => Sharpness::Kinked,
            _ => Sharpness::Smooth,
        }
    }

    /// True where it is zero but for its small part.
    pub fn is_local(self) -> bool {
        matches!(self, Gaussian | Lorentz | Quartic | Sech | Window | Comb | Tent | Cusp | Pulse)
    }

    /// The function of a variable, of about 1 where it is largest, and where it happens.
    ///
    /// The variable runs over `range`, in which the place is drawn; the width is in parts of it.
    pub fn write(self, of: &str, range: (f64, f64), width: f64, draws: &mut Draws) -> (String, Vec<Spot>) {
        let span = range.1 - range.0;
        let place = draws.between(range.0 + 0.08 * span, range.1 - 0.08 * span);
        let w = neat(width * span);
        let turns = neat(draws.scale(3.0, 150.0) / span);
        let (c, width, n, all) = (text(place), text(w), text(turns), text(span));
        let z = format!("({of} - {c})/{width}");
        let away = neat(place + draws.between(2.0, 30.0) * w);
        let function = match self {
            Gaussian => format!("exp(-({z})^2)"),
            Lorentz => format!("1/(1 + ({z})^2)"),
            Quartic => format!("1/(1 + ({z})^4)"),
            Sech => format!("(1 - tanh({z})^2)"),
            Window => format!("(tanh({z}) - tanh(({of} - {})/{width}))/2", text(away)),
            Tanh => format!("tanh({z})"),
            Logistic => format!("1/(1 + exp(-{z}))"),
            Arctangent => format!("2/pi*atan({z})"),
            SoftKink => format!("sqrt(({of} - {c})^2 + {width}^2)/{all}"),
            Comb => format!("exp(-(sin({n}*{of})/{})^2)", text(10.0 * w / span)),
            Ramp => format!("max(0, {of} - {c})/{all}"),
            Fold => format!("abs({of} - {c})/{all}"),
            Tent => format!("max(0, 1 - abs({of} - {c})/{width})"),
            Cusp => format!("exp(-abs({of} - {c})/{width})"),
            Clipped => format!("max(0, sin({n}*{of}) - 0.5)"),
            DeadZone => format!("max(0, abs({of} - {c}) - {width})*sign({of} - {c})/{all}"),
            Step => format!("step({of} - {c})"),
            Pulse => format!("(step({of} - {c}) - step({of} - {}))", text(place + w)),
            Wave => format!("sign(sin({n}*{of}))"),
            NestedSigns => format!("sign(abs({of} - {c}) - {width})"),
        };
        let sharp = 1e-7 * span;
        let one = |place: f64, width: f64| Spot { place, every: None, width };
        let many = |place: f64, width: f64| Spot { place, every: Some(std::f64::consts::PI / turns), width };
        let spots = match self {
            Window => vec![one(place, w), one(away, w)],
            Comb => vec![many(0.0, 10.0 * w / span / turns)],
            Wave => vec![many(0.0, 0.1 / turns)],
            // At π/6 and 5π/6 of every other half turn.
            Clipped => vec![
                many(std::f64::consts::FRAC_PI_6 / turns, 0.1 / turns),
                many(-std::f64::consts::FRAC_PI_6 / turns, 0.1 / turns),
            ],
            Ramp | Fold | Step => vec![one(place, sharp)],
            Pulse => vec![one(place, sharp.min(w)), one(neat(place + w), sharp.min(w))],
            Tent | DeadZone | NestedSigns => {
                vec![one(place, sharp.min(w)), one(place - w, sharp.min(w)), one(place + w, sharp.min(w))]
            }
            _ => vec![one(place, w)],
        };
        (function, spots)
    }
}
