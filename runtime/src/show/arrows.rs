//! Arrows over an animation: where they begin and end, and one scale for all of a motion.

use super::Animation;
use super::extent::Extent;
use super::solids::{Point, norm, plus};
use crate::numbers::{short, spaced};

/// What is usual of the largest arrow of a moment: no more than a fifth of the moments has a larger one.
const USUAL: f64 = 0.8;
/// Such an arrow is so long, of the distance of the farthest of the mechanism from the middle of the picture.
const LENGTH: f64 = 0.3;
/// Arrows that would be longer than this many usual ones are cut.
const LONGEST: f64 = 2.5;
/// So many arrows have their names beside them: more would cover each other.
#[cfg(feature = "png")]
const MOST_NAMED: usize = 8;

/// Arrows of an animation with their scale: see [`Animation::with_arrows`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Arrows {
    /// A name for each, which is written beside it; of more than eight none is.
    pub names: Vec<String>,
    /// What the arrow beside the mechanism stands for that tells the scale.
    pub value: f64,
    /// Its unit; empty for pure numbers.
    pub unit: String,
    /// Its length, m.
    pub length: f64,
    /// Arrows that would be longer than this, m, are cut to it and have two tips.
    pub longest: f64,
}

impl Arrows {
    /// `10 N`: what the arrow stands for that tells the scale.
    pub fn text(&self) -> String {
        format!("{}{}", short(self.value), spaced(&self.unit))
    }
}

impl Animation {
    /// The same animation with vectors as arrows over the mechanism: for each frame and each name the point at which the arrow begins, then
    /// the vector.  Vectors that are zero or not finite are not drawn.
    ///
    /// All have one scale, by which the largest vector of a moment is usually three tenths as long as the mechanism reaches from the middle of
    /// the picture; a few moments with a much larger one do not change it.
    ///
    /// ```
    /// use dalembert::mechanism::Shape;
    /// use dalembert::show::Animation;
    /// let rod = Animation::new("Rod", 2, vec![Shape::Line(2)]).with_frames([(0.0, vec![0.0, 0.0, 0.0, -1.0])]);
    /// let held = rod.with_arrows(["pin"], "N", &[vec![0.0, 0.0, 0.0, 12.0]]);
    /// assert_eq!(held.arrows.unwrap().text(), "10 N");
    /// ```
    pub fn with_arrows<N: Into<String>>(
        mut self,
        names: impl IntoIterator<Item = N>,
        unit: impl Into<String>,
        vectors: &[Vec<f64>],
    ) -> Animation {
        let d = self.dimension as usize;
        let names: Vec<String> = names.into_iter().map(Into::into).collect();
        let reach = Extent::of(&self).reach;
        let usual = usual_largest(vectors, d);
        let metres = if usual > 0.0 { LENGTH * reach / usual } else { 0.0 };
        let value = round_below(usual);
        let arrows =
            Arrows { value, unit: unit.into(), length: metres * value, longest: LONGEST * LENGTH * reach, names };
        let first = self.first_of_arrows();
        for ((_, numbers), vectors) in self.frames.iter_mut().zip(vectors) {
            numbers.resize(first, f64::NAN);
            for arrow in vectors.chunks_exact(2 * d).take(arrows.names.len()) {
                numbers.extend(ends(arrow, metres, arrows.longest));
            }
        }
        Animation { arrows: Some(arrows), ..self }
    }

    /// How far the mechanism is from the middle of the picture at most, m.
    #[cfg(feature = "cli")]
    pub(crate) fn reach(&self) -> f64 {
        Extent::of(self).reach
    }

    /// How many arrows it has.
    pub(super) fn arrow_count(&self) -> usize {
        self.arrows.as_ref().map_or(0, |arrows| arrows.names.len())
    }

    /// The place of their first number among those of a frame.
    pub(super) fn first_of_arrows(&self) -> usize {
        self.shapes.iter().map(|shape| shape.numbers(self.dimension as usize)).sum()
    }

    /// Where an arrow begins and ends; not finite where there is none.
    pub(super) fn arrow(&self, place: usize, numbers: &[f64]) -> [Point; 2] {
        let d = self.dimension as usize;
        let first = self.first_of_arrows() + 2 * d * place;
        let number = |k: usize| numbers.get(first + k).copied().unwrap_or(f64::NAN);
        [0, 1].map(|end| std::array::from_fn(|k| if k < d { number(end * d + k) } else { 0.0 }))
    }

    /// Whether names are written beside arrows.
    #[cfg(feature = "png")]
    pub(super) fn names_arrows(&self) -> bool {
        self.arrow_count() <= MOST_NAMED
    }
}

/// Where an arrow begins and ends, of a point and a vector.
fn ends(arrow: &[f64], metres: f64, longest: f64) -> Vec<f64> {
    let (at, vector) = arrow.split_at(arrow.len() / 2);
    let size = size(vector);
    if !(size > 0.0 && size.is_finite()) {
        return vec![f64::NAN; arrow.len()];
    }
    let scale = metres.min(longest / size);
    at.iter().copied().chain(at.iter().zip(vector).map(|(x, f)| x + scale * f)).collect()
}

fn size(vector: &[f64]) -> f64 {
    norm(plus([0.0; 3], 1.0, std::array::from_fn(|k| vector.get(k).copied().unwrap_or(0.0))))
}

/// The largest vector of a moment, as it is usually: of all moments at which there is any.
fn usual_largest(vectors: &[Vec<f64>], d: usize) -> f64 {
    let largest = |numbers: &Vec<f64>| {
        let sizes = numbers.chunks_exact(2 * d).map(|arrow| size(&arrow[d..]));
        sizes.filter(|size| size.is_finite()).fold(0.0, f64::max)
    };
    let mut all: Vec<f64> = vectors.iter().map(largest).filter(|size| *size > 0.0).collect();
    all.sort_unstable_by(f64::total_cmp);
    let last = all.len().saturating_sub(1);
    all.get((USUAL * last as f64).floor() as usize).copied().unwrap_or(0.0)
}

/// The largest of 1, 2, 5, 10 and so on that is not greater.
fn round_below(value: f64) -> f64 {
    if !(value > 0.0 && value.is_finite()) {
        return 0.0;
    }
    let decade = 10.0_f64.powf(value.log10().floor());
    let digit = [10.0, 5.0, 2.0].into_iter().find(|digit| digit * decade <= value * (1.0 + 1e-9)).unwrap_or(1.0);
    // By its decimal text, so that 0.2 is not 0.2 and a rounding.
    format!("{:e}", digit * decade).parse().map_or(value, |x: f64| short(x).parse().unwrap_or(x))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanism::Shape;

    fn rod(frames: usize) -> Animation {
        let numbers = || vec![0.0, 0.0, 0.0, -2.0];
        Animation::new("Rod", 2, vec![Shape::Line(2)]).with_frames((0..frames).map(|i| (i as f64, numbers())))
    }

    /// The vector of an arrow in a frame, by the scale.
    fn told(animation: &Animation, frame: usize) -> [f64; 2] {
        let [from, to] = animation.arrow(0, &animation.frames[frame].1);
        let Arrows { value, length, .. } = animation.arrows.as_ref().unwrap();
        [to[0] - from[0], to[1] - from[1]].map(|x| x / length * value)
    }

    #[test]
    fn arrows_have_the_length_and_direction_of_their_vectors() {
        let animation = rod(2).with_arrows(["pin"], "N", &[vec![0.0, -2.0, 3.0, -4.0], vec![0.0, -2.0, 0.0, 25.0]]);
        let arrows = animation.arrows.as_ref().unwrap();
        assert_eq!((arrows.value, arrows.text()), (5.0, "5 N".to_owned()));
        let [x, y] = told(&animation, 0);
        assert!((x - 3.0).abs() < 1e-12 && (y + 4.0).abs() < 1e-12, "{x} {y}");
        // The rod reaches 1 m from its middle: an arrow of 5 N is 0.3 m long.
        assert!((arrows.length - 0.3).abs() < 1e-12, "{}", arrows.length);
    }

    #[test]
    fn a_single_peak_leaves_the_scale_and_is_cut() {
        let vectors: Vec<Vec<f64>> = (0..100).map(|i| vec![0.0, 0.0, 0.0, if i == 50 { 1e6 } else { 10.0 }]).collect();
        let animation = rod(100).with_arrows(["floor"], "N", &vectors);
        assert_eq!(animation.arrows.as_ref().unwrap().text(), "10 N");
        assert!((told(&animation, 49)[1] - 10.0).abs() < 1e-12);
        let [from, to] = animation.arrow(0, &animation.frames[50].1);
        assert!((to[1] - from[1] - 0.75).abs() < 1e-12);
    }

    #[test]
    fn no_arrow_is_drawn_of_what_is_zero_or_not_known() {
        let animation =
            rod(3).with_arrows(["pin"], "N", &[vec![0.0; 4], vec![0.0, 0.0, f64::NAN, 1.0], vec![0.0, 0.0, 1.0, 0.0]]);
        for frame in [0, 1] {
            assert!(animation.arrow(0, &animation.frames[frame].1).iter().flatten().take(2).all(|x| x.is_nan()));
        }
        assert!((told(&animation, 2)[0] - 1.0).abs() < 1e-12);
        let none = rod(1).with_arrows(["pin"], "N", &[vec![0.0; 4]]);
        assert_eq!(none.arrows.unwrap().value, 0.0);
    }

    #[test]
    fn scales_are_round() {
        for (value, round) in [
            (1.0, 1.0),
            (1.9, 1.0),
            (4.9, 2.0),
            (9.81, 5.0),
            (10.0 - 1e-12, 10.0),
            (0.25, 0.2),
            (3e7, 2e7),
            (6e-9, 5e-9),
        ] {
            assert_eq!(round_below(value), round);
        }
    }

    #[test]
    fn what_is_up_turns_arrows_too() {
        let ball = Animation { up: [0.0, 1.0, 0.0], ..Animation::new("Ball", 3, vec![Shape::Sphere]) };
        let ball = ball.with_frames([(0.0, vec![1.0, 2.0, 3.0, 0.5])]);
        let ball = ball.with_arrows(["floor"], "N", &[vec![1.0, 2.0, 3.0, 0.0, 1.0, 0.0]]).upright().into_owned();
        let [from, to] = ball.arrow(0, &ball.frames[0].1);
        assert_eq!(from, ball.frames[0].1[..3]);
        assert!(to[2] > from[2] && to[..2] == from[..2]);
    }
}
