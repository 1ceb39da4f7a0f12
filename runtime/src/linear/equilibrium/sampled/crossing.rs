//! Where eigenvalues of a map cross the unit circle while a factor grows, or falls.
//!
//! Between two factors each eigenvalue near the circle is followed from both ends by its slope.  Where both do not tell the same path, where it may
//! reach the circle between them, or meets another one so near to it that they may leave each other across it (a pair at −1 turns into two
//! numbers), it is looked between: so windows of instability are found whatever their width, if the map changes smoothly.

use std::cell::Cell;

use nalgebra::Complex;

use super::Eigenvalue;

/// The first steps of ln factor.
const STEP: f64 = 0.01;
/// Paths are straight, as far as ln z goes, where they turn by less from sample to sample.
const TURN: f64 = 0.25;
/// Two eigenvalues meet where they come nearer to each other than this part of the way that they move past each other.
const MEETS: f64 = 0.5;
/// Steps are halved so often: what happens within less of the factor is not seen.
const DEEPEST: u32 = 30;
/// Slopes of ln z are those of chords to so much further on: near the root of rounding, where a difference has most digits.
const CHORD: f64 = 1e-7;

/// The eigenvalues at a factor; `None` where there are none.
pub(super) type Spectrum<'a> = dyn Fn(f64) -> Option<Vec<Eigenvalue>> + 'a;

/// A walk from factor 1 outwards.
pub(super) struct Walk<'a> {
    spectrum: &'a Spectrum<'a>,
    /// How many more steps may be halved.
    left: Cell<usize>,
    /// ln factor beyond which steps are not halved any more.
    cut: Cell<Option<f64>>,
}

/// Where a walk came.
pub(super) struct Walked {
    /// The first factor at which something grows, or nothing any more.
    pub changed: Option<f64>,
    /// The last factor up to which nothing is missed.
    pub reached: f64,
}

struct Sample {
    /// ln factor.
    place: f64,
    values: Vec<Eigenvalue>,
    /// d ln z/d ln factor of each.
    slopes: Vec<Complex<f64>>,
}

/// Why a walk ends.
enum End {
    Changed(f64),
    Lost,
}

impl<'a> Walk<'a> {
    /// Of a spectrum, with so many halvings of steps.
    pub fn of(spectrum: &'a Spectrum<'a>, halvings: usize) -> Walk<'a> {
        Walk { spectrum, left: Cell::new(halvings), cut: Cell::new(None) }
    }

    /// Goes from 1 to a last factor.
    pub fn to(&self, last: f64) -> Walked {
        let end = last.ln();
        let reached = |otherwise: f64| self.cut.get().map_or(otherwise, f64::exp);
        let Some(mut here) = self.sample(0.0) else { return Walked { changed: None, reached: 1.0 } };
        while here.place != end {
            let next = here.place + STEP.copysign(end);
            let next = if next.abs() < end.abs() { next } else { end };
            let Some(there) = self.sample(next) else { break };
            match self.between(&here, &there, 0) {
                Ok(()) => here = there,
                Err(End::Changed(factor)) => return Walked { changed: Some(factor), reached: reached(factor) },
                Err(End::Lost) => break,
            }
        }
        Walked { changed: None, reached: reached(if here.place == end { last } else { here.place.exp() }) }
    }

    fn sample(&self, place: f64) -> Option<Sample> {
        let values = (self.spectrum)(place.exp())?;
        let beside = (self.spectrum)((place + CHORD).exp())?;
        let slope = |value: &Eigenvalue| {
            let near = |other: &&Eigenvalue| (other.z - value.z).norm();
            let next = beside.iter().min_by(|a, b| near(a).total_cmp(&near(b)))?;
            Some((next.z / value.z).ln() / CHORD)
        };
        let slopes = values.iter().map(|value| slope(value).unwrap_or(Complex::ZERO)).collect();
        Some(Sample { place, values, slopes })
    }

    /// Looks for the first change between two samples.
    fn between(&self, a: &Sample, b: &Sample, depth: u32) -> Result<(), End> {
        let unsure = depth < DEEPEST && !(a.leads_to(b) && b.leads_to(a));
        if unsure && self.left.get() == 0 && self.cut.get().is_none() {
            self.cut.set(Some(a.place));
        }
        if unsure && self.left.get() > 0 {
            self.left.set(self.left.get() - 1);
            let middle = self.sample(0.5 * (a.place + b.place)).ok_or(End::Lost)?;
            self.between(a, &middle, depth + 1)?;
            return self.between(&middle, b, depth + 1);
        }
        match grows(&a.values) == grows(&b.values) {
            true => Ok(()),
            false => Err(self.bisected(a, b).map_or(End::Lost, End::Changed)),
        }
    }

    /// The factor at which growth begins or ends, to rounding.  Of eigenvalues that stay on the circle at both ends as many are left out, those
    /// nearest to it; where one leaves it that stayed there, it has to leave it by more than its error.
    fn bisected(&self, a: &Sample, b: &Sample) -> Option<f64> {
        let began = grows(&a.values);
        let staying = |sample: &Sample| sample.values.iter().filter(|value| value.stays()).count();
        let left_out = staying(a).min(staying(b));
        let by_error = staying(if began { b } else { a }) > left_out;
        let grows = |factor: f64| {
            let mut values = (self.spectrum)(factor)?;
            values.sort_by(|x, y| x.growth().abs().total_cmp(&y.growth().abs()));
            let beyond = |value: &Eigenvalue| value.growth() > if by_error { value.error } else { 0.0 };
            Some(values[left_out.min(values.len())..].iter().any(beyond))
        };
        let (mut here, mut there) = (a.place.exp(), b.place.exp());
        loop {
            let middle = 0.5 * (here + there);
            if middle == here || middle == there {
                return Some(there);
            }
            if grows(middle)? == began { here = middle } else { there = middle }
        }
    }
}

/// Whether any eigenvalue is outside of the circle by more than its error.
pub(super) fn grows(values: &[Eigenvalue]) -> bool {
    values.iter().any(|value| value.growth() > value.error)
}

impl Sample {
    /// Whether the slopes here tell where eigenvalues near the circle are at another sample, and that none reaches it on the way unseen.
    fn leads_to(&self, other: &Sample) -> bool {
        let step = other.place - self.place;
        self.values.iter().zip(&self.slopes).all(|(value, slope)| {
            let turn = slope * step;
            // What is far inside or outside of the circle does not come there by its slope.
            if value.growth().abs() > 1.0 + 2.0 * turn.norm() || !value.growth().is_finite() {
                return true;
            }
            let expected = value.z * turn.exp();
            let far = |k: &usize| (other.values[*k].z - expected).norm();
            let Some(k) = (0..other.values.len()).min_by(|i, k| far(i).total_cmp(&far(k))) else { return false };
            if turn.norm() > TURN || far(&k) > TURN * expected.norm() {
                return false;
            }
            let (here, there) = (value.growth(), other.values[k].growth());
            let chord = (there - here) / step;
            // Twice what a parabola with these slopes would rise above its chord.
            let rise = ((slope.re - chord).abs() + (other.slopes[k].re - chord).abs()) * step.abs() / 4.0;
            let passes = here.signum() != there.signum();
            let clear = here.abs().min(there.abs());
            let stays = value.stays() || other.values[k].stays();
            (passes || stays || rise < clear) && (passes || !self.meets([value.z, expected], step, clear))
        })
    }

    /// Whether another eigenvalue comes so near to one on its way that they may not pass each other, where they would part by more than this.
    fn meets(&self, [from, to]: [Complex<f64>; 2], step: f64, clear: f64) -> bool {
        self.values.iter().zip(&self.slopes).filter(|(other, _)| other.z != from).any(|(other, slope)| {
            let (before, after) = (other.z - from, other.z * (slope * step).exp() - to);
            let way = after - before;
            let part = (-(before.conj() * way).re / way.norm_sqr()).clamp(0.0, 1.0);
            (before + way * part).norm() < MEETS * way.norm() && before.norm() + after.norm() >= clear
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn walk(radius: impl Fn(f64) -> f64, last: f64) -> Walked {
        let spectrum = |factor: f64| {
            let z = Complex::from_polar(radius(factor), 3.0 * factor);
            Some(vec![z, z.conj(), Complex::from(1.0)].into_iter().map(|z| Eigenvalue { z, error: 1e-14 }).collect())
        };
        Walk::of(&spectrum, 20_000).to(last)
    }

    /// |z| = 1 − ((f − 3)² − w²)/10: a window of half width w, beside an eigenvalue that stays at 1.
    #[test]
    fn windows_of_any_width_are_found() {
        for width in [1e-1, 1e-3, 1e-5, 1e-6] {
            let found = walk(|f| 1.0 - 0.1 * ((f - 3.0).powi(2) - width * width), 5.0).changed.unwrap();
            assert!((found - (3.0 - width)).abs() < 1e-9, "{width}: {found}");
            let down = walk(|f| 1.0 - 0.1 * ((f - 0.3).powi(2) - width * width), 0.1).changed.unwrap();
            assert!((down - (0.3 + width)).abs() < 1e-9, "{width}: {down}");
        }
    }

    /// A pair on a circle of radius 0.998 that turns as e^(3if), but where it passes −1 its two numbers part: z² + 2 b z + r² with
    /// b = −r cos 3f (1 + 3·10⁻⁶), whose discriminant is positive in a window of 0.0016.
    #[test]
    fn pairs_that_part_at_the_real_axis_are_seen() {
        let r = 1.0 - 1e-3;
        let spectrum = |factor: f64| {
            let b = r * (3.0 * factor).cos() * (1.0 + 3e-6);
            let root = Complex::from(b * b - r * r).sqrt();
            Some([b + root, b - root].into_iter().map(|z| Eigenvalue { z, error: 1e-14 }).collect())
        };
        let found = Walk::of(&spectrum, 20_000).to(10.0).changed.unwrap();
        // One of them is −1 where 2 b = −(1 + r²), that is −cos 3f = (1 + r²)/(2 r (1 + 3·10⁻⁶)), at the first odd half turn.
        let cosine = (1.0 + r * r) / (2.0 * r * (1.0 + 3e-6));
        let expected = (std::f64::consts::PI - cosine.acos()) / 3.0;
        assert!((found - expected).abs() < 1e-9, "{found} {expected}");
    }

    #[test]
    fn the_nearest_change_is_found_and_none_where_there_is_none() {
        let found = walk(|f| 1.0 + 0.1 * (20.0 * (f - 2.0)).sin() * (f - 4.0), 10.0).changed.unwrap();
        assert!((found - (2.0 - 6.0 * std::f64::consts::PI / 20.0)).abs() < 1e-12, "{found}");
        let none = walk(|f| 0.999_999 - 0.01 * (f - 2.0).powi(2), 10.0);
        assert!(none.changed.is_none() && none.reached == 10.0);
        // Where halvings come to an end it goes on without, and says so.
        let far = walk(|f| 0.999 + 1e-5 * (1e6 * f).sin(), 10.0);
        assert!(far.changed.is_none() && far.reached < 10.0, "{}", far.reached);
    }
}
