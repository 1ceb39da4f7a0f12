//! What stands over the mechanism in a picture: arrows with their scale, and names of events.

use super::*;
use crate::show::arrows::Arrows;
use crate::show::solids::norm;

/// Width of an arrow, length and half width of its tip, px; a tip is at most half of its arrow.
const SHAFT: i32 = 2;
const TIP: (f64, f64) = (10.0, 4.0);
/// Shorter arrows are not drawn, px.
const SHORTEST: f64 = 1.0;
/// How far beyond its tip an arrow's name is, px.
const NAME: f64 = 9.0;
/// A letter of a name is no wider than this, px.
const LETTER_OF_NAME: f64 = 7.0;
/// How far the arrow that tells the scale is from the edges, px.
const MARGIN: f64 = 16.0;
/// The name of an event stays for so long, s of the picture.
const STAYS: f64 = 0.5;

impl Stage<'_> {
    /// All arrows, and the one that tells their scale.
    pub(super) fn draw_arrows<B: DrawingBackend>(&self, canvas: &Canvas<B>, numbers: &[f64]) -> Outcome<B> {
        let Some(arrows) = &self.animation.arrows else { return Ok(()) };
        for (place, name) in arrows.names.iter().enumerate() {
            let [from, to] = self.animation.arrow(place, numbers);
            let ends = [self.pixel(from), self.pixel(to)];
            self.draw_arrow(canvas, ends, norm(plus(to, -1.0, from)) > 0.999 * arrows.longest)?;
            if self.animation.names_arrows() {
                self.draw_name(canvas, ends, name)?;
            }
        }
        self.draw_scale(canvas, arrows)
    }

    /// An arrow, with two tips if it is cut.
    fn draw_arrow<B: DrawingBackend>(&self, canvas: &Canvas<B>, [from, to]: [(f64, f64); 2], cut: bool) -> Outcome<B> {
        let (dx, dy) = (to.0 - from.0, to.1 - from.1);
        let length = dx.hypot(dy);
        if !(length >= SHORTEST && length.is_finite()) {
            return Ok(());
        }
        let (dx, dy, tip) = (dx / length, dy / length, TIP.0.min(length / 2.0));
        let half = TIP.1 * tip / TIP.0;
        // Along the arrow from its end backwards, and across.
        let at = |back: f64, side: f64| fine((to.0 - back * dx - side * dy, to.1 - back * dy + side * dx));
        stroke(canvas, [fine(from), at(0.9 * tip, 0.0)], INK.stroke_width((SHAFT * FINE) as u32))?;
        for back in if cut { vec![0.0, tip] } else { vec![0.0] } {
            fill(canvas, [at(back, 0.0), at(back + tip, half), at(back + tip, -half)], INK.filled())?;
        }
        Ok(())
    }

    fn draw_name<B: DrawingBackend>(&self, canvas: &Canvas<B>, [from, to]: [(f64, f64); 2], name: &str) -> Outcome<B> {
        let (dx, dy) = (to.0 - from.0, to.1 - from.1);
        let length = dx.hypot(dy);
        if !(length >= SHORTEST && length.is_finite()) {
            return Ok(());
        }
        let anchor = match dx / length {
            along if along > 0.3 => HPos::Left,
            along if along < -0.3 => HPos::Right,
            _ => HPos::Center,
        };
        let (x, y) = (to.0 + NAME * dx / length, to.1 + NAME * dy / length);
        // Inside of the picture.
        let (right, width) = (f64::from(WIDTH), LETTER_OF_NAME * name.chars().count() as f64);
        let x = match anchor {
            HPos::Left => x.min(right - width),
            HPos::Right => x.max(width),
            HPos::Center => x.clamp((width / 2.0).min(right / 2.0), (right - width / 2.0).max(right / 2.0)),
        };
        write(canvas, name, (x.round() as i32, y.round() as i32), anchor, (11, INK))
    }

    /// The arrow that tells the scale, in the lower right corner.
    fn draw_scale<B: DrawingBackend>(&self, canvas: &Canvas<B>, arrows: &Arrows) -> Outcome<B> {
        let length = self.scale * arrows.length;
        if !(length >= SHORTEST && length.is_finite()) {
            return Ok(());
        }
        let (right, height) = (f64::from(WIDTH) - MARGIN, f64::from(self.height) - 1.5 * MARGIN);
        let left = right - length;
        self.draw_arrow(canvas, [(left, height), (right, height)], false)?;
        write(canvas, &arrows.text(), (right as i32, (height - MARGIN) as i32), HPos::Right, (12, INK))
    }

    /// The names of events that have just happened.
    pub(super) fn draw_events<B: DrawingBackend>(&self, canvas: &Canvas<B>, t: f64) -> Outcome<B> {
        let stays = STAYS * self.playback.speed;
        let now = self.animation.events.iter().filter(|event| event.x <= t && t < event.x + stays);
        let mut names: Vec<&str> = now.map(|event| event.name.as_str()).collect();
        if names.is_empty() {
            return Ok(());
        }
        names.dedup();
        write(canvas, &names.join(", "), (WIDTH / 2, BAND + 14), HPos::Center, (14, COLOURS[1]))
    }
}
