//! How large an error may be.

use crate::mechanism::dense::{ROUNDING, SECOND_ROUNDING, widest};
use crate::mechanism::{Coordinate, Description};

/// The tolerance as a norm: an error of component i counts in units of ε wᵢ, where w follows the motion itself.
///
/// Over a step of h,
///
/// w(qᵢ) = max(Rᵢ, |h q'ᵢ|, φᵢ/ε, h² νᵢ/ε),  w(q'ᵢ) = max(R'ᵢ, |h q''ᵢ|, φ'ᵢ/ε, h νᵢ/ε).
///
/// R is the range that the component has gone through since the start, or the way of the step itself if that is longer, so
/// that neither a shift of the origin nor a change of units changes a step; an angle's is at most 2π.  φ = 200 u max|q|, u = 2⁻⁵³, is the
/// rounding of q: no error below it counts, nor one below 200 u² max|q| of the coordinates with the same unit: what a mechanism in space that
/// stays in a plane has across it is rounding of rounding.  ν is the noise of the acceleration, what the rounding of all coordinates
/// and of the time makes of it; it is measured where errors do not fall as steps become shorter ([`Tolerance::noise`]), and counts
/// [`STAYS`] times where a coordinate has not left its rounding, or what its noise makes of it.  Where a
/// coordinate takes over the rounding of a larger one beside it, φ is raised then.  What sets off from rest like a high power of
/// time has errors of the size of its change in any step: those of its first step count as none ([`Tolerance::note_start_up_errors`]).
///
/// Of a coordinate that constraints hold only their rounding changes the rate: none of it counts that moves the place by less than φ until the end.
///
/// What has decayed far below its largest value has absolute accuracy only.  The hidden coordinate of a state of first order, its integral, has
/// no weight at all: 1/w = 0.
#[derive(Clone, Debug)]
pub(crate) struct Tolerance {
    /// ε.
    pub relative: f64,
    n: usize,
    low: Vec<f64>,
    high: Vec<f64>,
    /// What units are at least, of q and of q'.
    floors: Vec<f64>,
    /// The largest range that counts: 2π for angles.
    widest: Vec<f64>,
    /// φ raised to the rounding of other coordinates; 0 where it was not.
    raised: Vec<f64>,
    /// ν, 0 where nothing made it worth a measurement.
    noise: Vec<f64>,
    /// The longest step, s, that ν is known for: what it does in a longer one counts as what it does in that.
    noise_known: Vec<f64>,
    /// Errors over the step in which a component sets off from rest, where no shorter one has smaller ones beside its change.
    start_up_errors: Vec<f64>,
    /// What rounding of constraints that hardly differ leaves open, of q and of q'; 0 elsewhere.
    constraint_round_off: Vec<f64>,
    /// Whether there is neither noise nor round-off of constraints, as usual.
    is_clear: bool,
    /// The first coordinate of the same unit.
    group: Vec<usize>,
    /// Hidden coordinates of states of first order, whose errors count as none.
    hidden: Vec<bool>,
    /// Coordinates that constraints hold, with the time that is left, s; none: nothing is held.
    held: Option<(Vec<bool>, f64)>,
    /// The largest |q| and |q'| so far of those with the same unit, where the first of them stands.
    largest: Vec<f64>,
}

/// By what part of themselves coordinates and the time are moved to see what their rounding does: two to four units in the last place, so
/// that a rounding of what is computed from them does not swallow the change.
pub(crate) const PERTURBATION: f64 = 4.0 * f64::EPSILON;
/// The least unit of errors, SI: nothing is so small, and squares of what is many times smaller are still numbers.
pub(crate) const LEAST: f64 = 1e-100;
/// Errors are explained by up to so many times the measured noise.
const EXPLAINED: f64 = 8.0;
/// By so much the unit of what stays where it is, but for rounding, is larger: explained errors are a tenth of it then.  A controller lets a
/// step grow where the error of a method of order 8 is below 0.8⁸ = 0.17 of its unit, and noise, which is the same part of it in steps of any
/// length, would hold it.
const STAYS: f64 = 5.0;

/// For each coordinate the first that has its unit.
pub(super) fn alike(mechanism: &Description) -> Vec<usize> {
    let coordinates = &mechanism.coordinates;
    let first = |unit: &str| coordinates.iter().position(|other| other.unit == unit).unwrap_or(0);
    // What is hidden is like nothing else.
    let of = |(i, coordinate): (usize, &Coordinate)| match coordinate.state() {
        Some(_) => i,
        None => first(&coordinate.unit),
    };
    coordinates.iter().enumerate().map(of).collect()
}

impl Tolerance {
    /// For a motion from this state.
    pub fn new(relative: f64, mechanism: &Description, start: &[f64]) -> Self {
        let group = alike(mechanism);
        let n = group.len();
        let mut tolerance = Tolerance {
            relative,
            n,
            low: start.to_vec(),
            high: start.to_vec(),
            widest: widest(mechanism),
            raised: vec![0.0; n],
            noise: vec![0.0; n],
            noise_known: vec![0.0; n],
            floors: vec![0.0; start.len()],
            start_up_errors: vec![0.0; start.len()],
            constraint_round_off: vec![0.0; start.len()],
            is_clear: true,
            group,
            hidden: mechanism.coordinates.iter().map(|coordinate| coordinate.state().is_some()).collect(),
            held: None,
            largest: vec![0.0; start.len()],
        };
        for (k, y) in start.iter().enumerate() {
            tolerance.note_size(k, *y);
        }
        tolerance.floors = (0..start.len()).map(|k| tolerance.floor(k)).collect();
        tolerance
    }

    /// The least and the largest value of each component so far.
    pub fn seen(&self) -> [Vec<f64>; 2] {
        [self.low.clone(), self.high.clone()]
    }

    /// Counts no error below these, of [q; q'].
    pub fn at_least(mut self, floors: &[f64]) -> Self {
        self.start_up_errors.copy_from_slice(floors);
        self.floors = (0..floors.len()).map(|k| self.floor(k)).collect();
        self
    }

    /// The error of component k of [q; q'] that counts as 1, over a step of h that changes it by this much.
    #[inline(always)]
    pub fn unit(&self, k: usize, h: f64, change: f64) -> f64 {
        let usual = larger(self.floors[k], self.relative * change);
        if self.is_clear {
            return usual;
        }
        let i = if k < self.n { k } else { k - self.n };
        let h = self.noise_known[i].min(h.abs());
        let noise = h * if self.stays(i) { STAYS * self.noise[i] } else { self.noise[i] };
        let noise = if k < self.n { h * noise } else { noise };
        larger(usual, larger(noise, self.constraint_round_off[k]))
    }

    /// The errors of qᵢ and q'ᵢ that count as 1, over a step of h from `start` to `end` that begins with `rate`.
    pub fn units(&self, i: usize, h: f64, (start, end): (&[f64], &[f64]), rate: &[f64]) -> [f64; 2] {
        [i, self.n + i].map(|k| self.unit(k, h, (end[k] - start[k]).abs().max((h * rate[k]).abs())))
    }

    /// As [`Tolerance::units`], for changes of qᵢ and q'ᵢ over a step of h that are known as a whole: stiff accelerations
    /// at its start tell nothing of them.
    pub fn units_by_change(&self, i: usize, h: f64, [place, speed]: [f64; 2]) -> [f64; 2] {
        [self.unit(i, h, place.abs()), self.unit(self.n + i, h, speed.abs())]
    }

    /// The changes of qᵢ and q'ᵢ over a step, no less than this part of those of what has the same unit.
    ///
    /// What moves at first by a high power of the time alone, driven by what moves already, has errors of the size of its
    /// change in any step, however short.
    pub fn coupled_changes(&self, i: usize, change: impl Fn(usize) -> f64) -> [f64; 2] {
        /// Small beside 1, so that what moves by itself keeps its own unit, and far above rounding.
        const COUPLED: f64 = 1e-6;
        let mut most = [change(i), change(self.n + i)];
        for j in (0..self.n).filter(|j| self.group[*j] == self.group[i]) {
            most[0] = larger(most[0], COUPLED * change(j));
            most[1] = larger(most[1], COUPLED * change(self.n + j));
        }
        most
    }

    /// ω with which accelerations change by `changes` while places move by `way`: ω² = max |Δa|/|Δq|, Δq the largest of what has the same
    /// unit; ∞ where no place moves, and 0 where no acceleration changes.
    pub fn rate_of_change(&self, way: &[f64], changes: &[f64]) -> f64 {
        let squares = (0..self.n).map(|i| {
            let alike = (0..self.n).filter(|j| self.group[*j] == self.group[i]);
            let way = alike.map(|j| way[j].abs()).fold(0.0, f64::max);
            if changes[i] == 0.0 { 0.0 } else { changes[i].abs() / way }
        });
        squares.fold(0.0_f64, |most, square| if square > most || square.is_nan() { square } else { most }).sqrt()
    }

    /// Takes note of what rounding of the constraints makes of [q; q'] at the present state; `None`: nothing to speak of.
    pub fn note_constraint_round_off(&mut self, noise: Option<&[f64]>) {
        match noise {
            Some(noise) => self
                .constraint_round_off
                .iter_mut()
                .zip(noise)
                .for_each(|(constraint_round_off, noise)| *constraint_round_off = *noise),
            None => self.constraint_round_off.fill(0.0),
        }
        self.clear_up();
    }

    /// Takes note of the coordinates that constraints hold from now on, for so many seconds.
    pub fn hold(&mut self, held: Option<Vec<bool>>, span: f64) {
        self.held = held.map(|held| (held, span));
        (0..self.floors.len()).for_each(|k| self.floors[k] = self.floor(k));
    }

    /// What rounding of constraints makes of a rate.
    fn held_rate(&self, k: usize) -> f64 {
        match &self.held {
            Some((held, span)) if k >= self.n && held[k - self.n] => ROUNDING * self.largest_alike(k - self.n) / span,
            _ => 0.0,
        }
    }

    /// Takes note of a state on the motion.
    pub fn observe(&mut self, y: &[f64]) {
        let mut grew = false;
        for (k, y) in y.iter().enumerate() {
            if *y < self.low[k] {
                self.low[k] = *y;
            } else if *y > self.high[k] {
                self.high[k] = *y;
            } else {
                continue;
            }
            grew |= self.note_size(k, *y);
            self.floors[k] = self.floor(k);
        }
        if grew {
            // What stands beside something that grew has the rounding of its rounding.
            (0..y.len()).for_each(|k| self.floors[k] = self.floor(k));
        }
    }

    /// Whether nothing with its unit was as large so far.
    fn note_size(&mut self, k: usize, y: f64) -> bool {
        let first = self.first_alike(k);
        let grows = y.abs() > self.largest[first];
        self.largest[first] = larger(self.largest[first], y.abs());
        grows
    }

    /// The first component of [q; q'] with the same unit.
    fn first_alike(&self, k: usize) -> usize {
        if k < self.n { self.group[k] } else { self.n + self.group[k - self.n] }
    }

    /// The part of a unit that does not depend on the step: ε times the range so far, or rounding.
    fn floor(&self, k: usize) -> f64 {
        if self.hidden.get(k) == Some(&true) {
            return f64::INFINITY;
        }
        let (low, high) = (self.low[k], self.high[k]);
        let (widest, raised) = if k < self.n { (self.widest[k], self.raised[k]) } else { (f64::INFINITY, 0.0) };
        let of_rounding = SECOND_ROUNDING * self.largest[self.first_alike(k)];
        let rounding = larger(larger(ROUNDING * larger(high.abs(), low.abs()), of_rounding), raised);
        let range = if high - low > widest { widest } else { high - low };
        // Where all of it is zero an error of zero must count as none.
        let rounding = larger(rounding, self.held_rate(k));
        larger(larger(self.relative * range, rounding), larger(self.start_up_errors[k], LEAST))
    }

    /// True if the errors of coordinate i, too large still after they fell from `before` to `after` when the step was cut
    /// from h₁ to h₂, fell so little that they might be noise.
    pub fn suspects(
        &self,
        i: usize,
        (before, after): ([f64; 2], [f64; 2]),
        (h1, h2): (f64, f64),
        (ends, rate): ((&[f64], &[f64]), &[f64]),
    ) -> bool {
        let units = self.units(i, h2, ends, rate);
        let falls = (h2 / h1).powf(2.5);
        (0..2).any(|k| after[k] > units[k] && after[k] > falls * before[k])
    }

    /// Whether rounding alone may be what moves coordinate i in a step of h: it has stayed where it is, or its speed is known better than what
    /// noise makes of it.
    pub fn may_be_noise(&self, i: usize, h: f64) -> bool {
        self.stays(i) || self.noise_known[i].min(h.abs()) * self.noise[i] > self.floors[self.n + i]
    }

    /// True if nothing has moved coordinate i until now, and a step of h with too large an error does.
    pub fn is_moved(&self, i: usize, errors: [f64; 2], h: f64, (ends, rate): ((&[f64], &[f64]), &[f64])) -> bool {
        let rests = |k: usize| self.low[k] == self.high[k];
        let units = self.units(i, h, ends, rate);
        rests(i) && rests(self.n + i) && (0..2).any(|k| errors[k] > units[k])
    }

    /// Whether the noise that is known, twice [`EXPLAINED`] times the measured one, explains these errors of coordinate i over a step of h.
    pub fn explains(&self, i: usize, h: f64, errors: [f64; 2]) -> bool {
        let h = self.noise_known[i].min(h.abs());
        let explained = 0.5 * h * self.noise[i];
        errors[1] <= explained && errors[0] <= (h * explained).max(self.raised[i])
    }

    /// Whether a speed and an acceleration move coordinate i in a step of h by more than rounding and this noise of its acceleration.
    pub fn moves(&self, i: usize, h: f64, [speed, acceleration]: [f64; 2], noise: f64) -> bool {
        let way = h.abs() * speed.abs() + h * h * acceleration.abs();
        way > ROUNDING * self.largest[self.group[i]] + EXPLAINED * h * h * noise
    }

    /// Whether coordinate i has stayed where it is until now, but for rounding: that of coordinates, or what the noise of its acceleration
    /// makes of it.  From rest a constant acceleration a gives it the speed v over the way s = v²/(2a).
    fn stays(&self, i: usize) -> bool {
        let range = |k: usize| self.high[k] - self.low[k];
        let (way, speed) = (range(i), range(self.n + i));
        way <= ROUNDING * self.largest[self.group[i]] || speed * speed <= 2.0 * self.noise[i] * way
    }

    /// Takes note of the noise of an acceleration: what it changes by when every coordinate moves by
    /// [`Tolerance::perturbation`].  Errors over a step of h that are no larger than it explains count as rounding from now on, in steps up to
    /// `known` seconds.
    pub fn noise(&mut self, i: usize, change: f64, (h, known): (f64, f64), errors: [f64; 2]) {
        let floor = ROUNDING * self.largest_alike(i);
        let explains = h.abs() * change;
        if errors[1] > EXPLAINED * explains || errors[0] > (EXPLAINED * h.abs() * explains).max(floor) {
            return;
        }
        let noise = 2.0 * EXPLAINED * change;
        let does = |noise: f64, known: f64| if known.is_finite() { known * noise } else { noise };
        if does(noise, known) > does(self.noise[i], self.noise_known[i]) {
            (self.noise[i], self.noise_known[i]) = (noise, known);
        }
        self.clear_up();
        // That of another one's place, or of its own.
        self.raised[i] = self.raised[i].max(floor);
        self.floors[i] = self.floor(i);
    }

    /// Takes note of errors over a step: those of components that have not moved yet count no more from now on.
    ///
    /// What grows like tᵖ is off by the same part of itself over any first step, however short; later steps, which move it by
    /// far more, are judged by its range.
    pub fn note_start_up_errors(&mut self, errors: &[f64]) {
        for (k, error) in errors.iter().enumerate() {
            if self.low[k] == self.high[k] {
                self.start_up_errors[k] = error.abs();
                self.floors[k] = self.floor(k);
            }
        }
    }

    /// What rounding drives is rounding, too: coordinates that have been at rest until now, and whose errors over a step of h are no
    /// larger than the noise of any acceleration explains, have that noise.
    pub fn spread_noise(&mut self, errors: &[f64], h: f64) {
        let noise = self.noise.iter().fold(0.0_f64, |most, noise| most.max(*noise));
        let known = self.noise_known.iter().fold(0.0_f64, |most, known| most.max(*known));
        let h = known.min(h.abs());
        let explained = 0.5 * h * noise;
        for i in 0..self.n {
            let rests = self.low[i] == self.high[i] && self.low[self.n + i] == self.high[self.n + i];
            if rests && errors[i].abs() <= h * explained && errors[self.n + i].abs() <= explained {
                (self.noise[i], self.noise_known[i]) = (noise, known);
            }
        }
        self.clear_up();
    }

    fn clear_up(&mut self) {
        self.is_clear = self.noise.iter().chain(&self.constraint_round_off).all(|part| *part == 0.0);
    }

    /// A change of coordinate i of a few roundings.
    pub fn perturbation(&self, i: usize) -> f64 {
        PERTURBATION * self.high[i].abs().max(self.low[i].abs())
    }

    /// Coordinates whose accuracy is limited by the rounding of larger ones instead of the tolerance, and to what, in SI;
    /// not those whose whole motion is no more than that.
    pub fn limited(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        let raised = self.raised.iter().copied().enumerate();
        let range = |i: usize| self.high[i] - self.low[i];
        let own = |i: usize| ROUNDING * larger(self.high[i].abs(), self.low[i].abs());
        raised.filter(move |(i, rounding)| {
            *rounding > own(*i).max(self.relative * range(*i)) && range(*i) > 4.0 * rounding && !self.stays(*i)
        })
    }

    /// How far each component has gone.
    pub fn swept(&self) -> Vec<f64> {
        self.low.iter().zip(&self.high).map(|(low, high)| high - low).collect()
    }

    /// The largest size of a coordinate with the same unit as this one; of angles at least one radian.
    fn largest_alike(&self, i: usize) -> f64 {
        let alike = (0..self.n).filter(|j| self.group[*j] == self.group[i]);
        let least = if self.widest[i].is_finite() { 1.0 } else { 0.0 };
        alike.map(|j| self.high[j].abs().max(self.low[j].abs())).fold(least, f64::max)
    }
}

/// The larger of two numbers, one instruction where `f64::max` takes five; a NaN counts as nothing if it comes second.
#[inline(always)]
pub(crate) fn larger(a: f64, b: f64) -> f64 {
    if b > a { b } else { a }
}
