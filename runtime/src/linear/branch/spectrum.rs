//! The numbers that decide on stability, such that they move smoothly with a parameter.

use nalgebra::{Complex, DMatrix};

use super::{BranchPoint, State};
use crate::linear::matrices::{Scaled, cholesky, null_space, symmetric_eigen};
use crate::linear::modes::matched;
use crate::linear::{LinearError, Linearised};
#[cfg(feature = "modal")]
use crate::linear::{matrices::Eigen, modes::without_zeros};
use crate::matrix::{equilibrated, is_symmetric};

/// Parts of an eigenvalue below this are what rounding makes of a double one.
const SPLIT: f64 = 1e-7;
/// Parts below this are rounding of eigenvalues that are not double, nor double with one shape.
const ROUNDING: f64 = 1e-12;
/// Real parts up to this many roundings of the largest eigenvalue, for each coordinate, are rounding.
const REAL_PART: f64 = 64.0 * f64::EPSILON;
/// κ nearer to 0 than this part of what the κ nearest to 0 is elsewhere on the branch is rounding.
const STIFFNESS: f64 = 16.0 * f64::EPSILON;
/// Eigenvectors that are nearer to depending on each other are those of a double eigenvalue: as in `modes/first_order.rs`.
#[cfg(feature = "modal")]
const WORST: f64 = 1e6;
/// What vanishes this near to a piece of the branch, in lengths of the piece, may do so in it.
const REACH: f64 = 0.25;

/// What is told from rounding.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::linear) enum Measure {
    /// What no rounding makes.
    Coarse,
    /// As much as can be: by it a change is located that the coarse measure has shown.
    Fine,
}

/// λ, or where no force depends on speed κ = −λ², the eigenvalues of M⁻¹K: these do not turn back where two meet.
#[derive(Clone, Debug)]
pub(in crate::linear) struct Spectrum {
    /// Sorted; those that are 0 by rank are left out.
    pub values: Vec<Complex<f64>>,
    squares: bool,
    /// Symmetric: eigenvalues are real, and may pass each other.
    symmetric: bool,
    /// λ of a system of first order.
    of_departures: bool,
    /// Real parts, or κ, up to this are rounding.
    floor: f64,
    /// Differences of two values up to this are what rounding makes of a double one.
    split: f64,
    /// All λ.
    pub eigenvalues: Vec<Complex<f64>>,
}

impl Spectrum {
    pub fn of(linear: &Linearised) -> Result<Spectrum, LinearError> {
        let stiffness = linear.k();
        let squares = linear.damping.is_zero();
        let mut free = 0;
        let (mut values, symmetric) = if squares {
            let failed = || LinearError::NoConvergence { what: "the singular value decomposition of K" };
            free = null_space(&Scaled::new(&linear.mass).stiffness(&stiffness)).ok_or_else(failed)?.ncols();
            let factor = cholesky(&linear.m()).map_err(|index| linear.singular(index))?;
            let mut half = stiffness;
            factor.solve_lower_triangular_mut(&mut half);
            let mut whole = half.transpose();
            factor.solve_lower_triangular_mut(&mut whole);
            let symmetric = linear.circulatory().is_zero();
            (of_matrix(whole.transpose(), symmetric)?, symmetric)
        } else {
            (linear.eigenvalues()?.into_iter().filter(|x| x.norm() > 0.0).collect(), false)
        };
        // Those that are 0 by rank stay what they are.
        values.sort_by(|a, b| a.norm().total_cmp(&b.norm()));
        values.drain(..free.min(values.len()));
        let norm = values.iter().fold(0.0_f64, |most, x| most.max(x.norm()));
        // What neither dissipates nor feeds has all eigenvalues on the axis, or in fours about it.
        let conserves = linear.dissipative().is_zero() && linear.circulatory().is_zero();
        let rounding = REAL_PART * linear.len() as f64 * norm;
        let eigenvalues: Vec<Complex<f64>> = match squares {
            true => {
                let zeros = std::iter::repeat_n(Complex::new(0.0, 0.0), 2 * free);
                zeros.chain(values.iter().flat_map(|kappa| both_roots(*kappa))).collect()
            }
            false if conserves => mirrored(linear.eigenvalues()?, rounding),
            false => linear.eigenvalues()?,
        };
        let floor = match (squares, conserves) {
            (true, _) => 0.0,
            (false, true) => SPLIT * norm,
            (false, false) => rounding,
        };
        if conserves && !squares && is_saddle(linear) {
            grow_certainly(&mut values, floor);
        }
        values
            .sort_by(|a, b| a.im.abs().total_cmp(&b.im.abs()).then(a.re.total_cmp(&b.re)).then(a.im.total_cmp(&b.im)));
        if symmetric {
            values.sort_by(|a, b| a.re.total_cmp(&b.re));
        }
        let of_departures = false;
        Ok(Spectrum { values, squares, symmetric, of_departures, floor, split: SPLIT * norm, eigenvalues })
    }

    /// That of departures that obey z' = A z, without zeros: `nullities` are those of [`nullities`](crate::linear::modes::nullities), and
    /// so many more are known to be 0.
    ///
    /// # Errors
    /// [`LinearError::NoConvergence`].
    #[cfg(feature = "modal")]
    pub fn of_departures((matrix, more): (&DMatrix<f64>, usize), nullities: &[usize]) -> Result<Spectrum, LinearError> {
        let left = without_zeros(matrix, nullities)?;
        let failed = LinearError::NoConvergence { what: "the eigenvalue iteration" };
        let found = if left.is_empty() { None } else { Some(Eigen::of(&left).ok_or(failed)?) };
        let mut values = found.as_ref().map_or_else(Vec::new, |found| found.values.clone());
        values
            .sort_by(|a, b| a.im.abs().total_cmp(&b.im.abs()).then(a.re.total_cmp(&b.re)).then(a.im.total_cmp(&b.im)));
        let norm = values.iter().fold(0.0_f64, |most, x| most.max(x.norm()));
        // Bauer and Fike's bound on what rounding does to eigenvalues.
        let condition = found.map_or(1.0, |found| found.condition()).min(WORST);
        let floor = Scaled::threshold(left.nrows(), left.norm()) * condition;
        let zeros = std::iter::repeat_n(Complex::new(0.0, 0.0), nullities.iter().sum::<usize>() + more);
        let eigenvalues = zeros.chain(values.iter().copied()).collect();
        let (squares, symmetric, split) = (false, false, SPLIT * norm);
        Ok(Spectrum { values, squares, symmetric, of_departures: true, floor, split, eigenvalues })
    }

    /// The state of a branch that it belongs to.
    pub(super) fn point(self, State { q, value }: State, folds: usize, folded: bool) -> BranchPoint {
        BranchPoint { value, q, growing: self.growing(Measure::Coarse), eigenvalues: self.eigenvalues, folds, folded }
    }

    /// How many modes grow.
    pub fn growing(&self, measure: Measure) -> usize {
        self.values.iter().filter(|x| self.grows(x, measure) && x.im >= 0.0).count()
    }

    /// How many eigenvalues λ lie in the right half plane: two of a pair, and as many where the pair splits into real ones.
    pub fn unstable(&self, measure: Measure) -> usize {
        self.values.iter().filter(|x| self.grows(x, measure)).count()
    }

    /// By what number two states differ where a threshold lies between them: by eigenvalues in the right half plane.  Without
    /// forces of speed, flutter that goes over into divergence counts too, as a pair of κ that becomes two.
    pub fn counted(&self, measure: Measure) -> usize {
        if self.squares { self.growing(measure) } else { self.unstable(measure) }
    }

    /// Whether no value counts as rounding by a measure.
    pub fn is_exact(&self, measure: Measure) -> bool {
        match measure {
            Measure::Fine => self.squares || self.of_departures,
            Measure::Coarse => self.floor == 0.0,
        }
    }

    /// [`Spectrum::counted`] of what is more than twice what rounding makes.
    pub fn grown_clearly(&self, measure: Measure) -> usize {
        Spectrum { floor: 2.0 * self.floor, ..self.clone() }.counted(measure)
    }

    /// Whether the fine measure locates a change: with departures, where no eigenvalue keeps to the axis, so that signs of real
    /// parts are more than rounding.
    pub fn locates(&self) -> bool {
        let clear = !self.of_departures || self.values.iter().all(|x| x.re.abs() > self.floor);
        clear && self.counted(Measure::Fine) == self.counted(Measure::Coarse)
    }

    /// The distance from 0 of the κ that is nearest to it; 0 where these are not κ.
    pub fn softness(&self) -> f64 {
        let nearest = self.values.iter().fold(f64::INFINITY, |least, x| least.min(x.norm()));
        if self.squares && nearest.is_finite() { nearest } else { 0.0 }
    }

    /// The same, with κ that are rounding beside what the softest is elsewhere.
    pub fn beside(self, softest: f64) -> Spectrum {
        let floor = if self.squares { STIFFNESS * softest } else { self.floor };
        Spectrum { floor, ..self }
    }

    /// Whether a value lies, or what it stands for does, in the right half plane.
    fn grows(&self, x: &Complex<f64>, measure: Measure) -> bool {
        let (part, softest) = match measure {
            Measure::Coarse => (SPLIT, self.floor),
            Measure::Fine => (ROUNDING, 0.0),
        };
        match self.squares {
            // √−κ has a positive real part: κ < 0, or a pair off the axis.
            true => x.im.abs() > part * x.norm() || x.re < -softest,
            false if self.of_departures && measure == Measure::Fine => x.re > 0.0,
            // Between two that are δ apart rounding leaves real parts of ε/δ: no measure is finer than √ε.
            false => x.re > self.floor,
        }
    }

    /// Whether, by parabolas through three states of which the second lies at a part of the way, a value may reach the border
    /// of stability, or two may meet, on the way from `from` to `to`: windows that are touched from one side are seen so.
    pub fn may_touch(three: [&Spectrum; 3], part: f64, (from, to): (f64, f64)) -> bool {
        let [a, m, b] = three;
        let alike = |other: &Spectrum| {
            (a.values.len(), a.squares, a.symmetric) == (other.values.len(), other.squares, other.symmetric)
        };
        if !alike(m) || !alike(b) {
            return false;
        }
        let middle = if a.symmetric { m.values.clone() } else { matched(&a.values, &m.values) };
        let last = if a.symmetric { b.values.clone() } else { matched(&middle, &b.values) };
        let path = |i: usize| [a.values[i], middle[i], last[i]];
        let floor = a.floor.max(m.floor).max(b.floor);
        let split = a.split.max(m.split).max(b.split).powi(2);
        let vanishes = |three: [Complex<f64>; 3], floor: f64| {
            three.iter().all(|x| x.norm() > floor) && root_near(three, part, (from, to))
        };
        (0..a.values.len()).any(|i| {
            let oscillates = |x: &Complex<f64>| x.im != 0.0;
            let border = path(i).map(|x| Complex::from(x.re));
            let kappa_pair = a.squares && path(i).iter().any(oscillates);
            let meets = |j: usize| {
                let [x, y] = [path(i), path(j)];
                vanishes([0, 1, 2].map(|k| (x[k] - y[k]).powi(2)), split)
            };
            !kappa_pair && vanishes(border, floor) || !a.symmetric && (0..i).any(meets)
        })
    }

    /// Im λ of the growing mode that is nearest to the border; 0 where it does not oscillate.
    pub fn border(&self, measure: Measure) -> Option<f64> {
        Some(self.near_border(measure).first()?.0)
    }

    /// The frequencies of so many growing modes that are nearest to the border, and how many have each: rising, those that are one but for rounding
    /// once.
    pub fn borders(&self, measure: Measure, count: usize) -> Vec<(f64, usize)> {
        let mut nearest: Vec<(f64, f64)> = self.near_border(measure).into_iter().take(count).collect();
        nearest.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut borders: Vec<(f64, usize)> = Vec::new();
        for (omega, size) in nearest {
            match borders.last_mut() {
                Some((last, times)) if omega - *last <= SPLIT * size => *times += 1,
                _ => borders.push((omega, 1)),
            }
        }
        borders
    }

    /// Im λ and |λ| of growing modes, the nearest to the border first; 0 where they do not oscillate.
    fn near_border(&self, measure: Measure) -> Vec<(f64, f64)> {
        let measure = if self.of_departures { measure } else { Measure::Fine };
        let lambda = |x: &Complex<f64>| if self.squares { both_roots(*x)[0] } else { *x };
        let growing = self.values.iter().filter(|x| self.grows(x, measure) && x.im >= 0.0);
        let mut growing: Vec<Complex<f64>> = growing.map(lambda).collect();
        growing.sort_by(|a, b| a.re.abs().total_cmp(&b.re.abs()));
        let omega = |x: &Complex<f64>| if x.im.abs() <= SPLIT * x.norm() { 0.0 } else { x.im.abs() };
        growing.iter().map(|x| (omega(x), x.norm())).collect()
    }

    /// True where nothing can have happened on the way to another spectrum: no value has moved by more than a part of
    /// its distance from the others and from the border of stability.
    pub fn is_near(&self, other: &Spectrum) -> bool {
        if self.values.len() != other.values.len() || self.squares != other.squares || self.symmetric != other.symmetric
        {
            return false;
        }
        if self.symmetric {
            let pairs = self.values.iter().zip(&other.values);
            return pairs.into_iter().all(|(a, b)| (a - b).norm() <= (0.5 * a.norm().max(b.norm())).max(self.floor));
        }
        self.all_near(other) && other.all_near(self)
    }

    fn all_near(&self, other: &Spectrum) -> bool {
        self.values.iter().enumerate().all(|(k, x)| {
            let apart = |y: &Complex<f64>| (y - x).norm();
            let moved = other.values.iter().map(apart).fold(f64::INFINITY, f64::min);
            let others = self.values.iter().enumerate().filter(|(j, _)| *j != k).map(|(_, y)| apart(y));
            // Double ones stay double, or part by more than rounding.
            let gap = others.filter(|gap| *gap > SPLIT * x.norm()).fold(f64::INFINITY, f64::min);
            let border = match self.squares {
                true => x.norm(),
                // What lies on the axis for want of damping has no distance from it.
                false if x.re.abs() <= self.floor.max(SPLIT * x.norm() * f64::from(u8::from(self.floor == 0.0))) => {
                    f64::INFINITY
                }
                false => x.re.abs(),
            };
            let across = match self.squares {
                true => moved,
                false => other
                    .values
                    .iter()
                    .min_by(|a, b| apart(a).total_cmp(&apart(b)))
                    .map_or(f64::INFINITY, |y| (y.re - x.re).abs()),
            };
            moved <= 0.3 * gap && across <= 0.5 * border
        })
    }
}

/// Whether det K < 0: then a real λ grows, whatever gyroscopic forces there are, and were it less than rounding makes of others.
fn is_saddle(linear: &Linearised) -> bool {
    let stiffness = linear.k();
    let is_regular = null_space(&Scaled::new(&linear.mass).stiffness(&stiffness)).is_some_and(|free| free.ncols() == 0);
    // By Sylvester's law the signs are those of the matrix of one size.
    let negative = || equilibrated(&stiffness).0.symmetric_eigenvalues().iter().filter(|x| **x < 0.0).count();
    is_regular && negative() % 2 == 1
}

/// Makes the real pair that grows for certain one that counts as growing, where rounding has left it too near to 0 or on the axis: of all that do
/// not grow clearly it is the one nearest to 0.
fn grow_certainly(values: &mut [Complex<f64>], floor: f64) {
    /// So many times what is rounding grows clearly.
    const CLEARLY: f64 = 4.0;
    let clear = values.iter().filter(|x| x.im == 0.0 && x.re > floor).count();
    let mut others: Vec<&mut Complex<f64>> = values.iter_mut().filter(|x| x.re.abs() <= floor).collect();
    others.sort_by(|a, b| a.norm().total_cmp(&b.norm()));
    if let (0, [first, second, ..]) = (clear % 2, others.as_mut_slice()) {
        (**first, **second) = (Complex::from(CLEARLY * floor), Complex::from(-CLEARLY * floor));
    }
}

/// Eigenvalues λ where nothing dissipates or feeds: with λ, −λ̄ is one too, so that what has no such partner lies on the axis.
fn mirrored(mut values: Vec<Complex<f64>>, rounding: f64) -> Vec<Complex<f64>> {
    let has_partner = |x: &Complex<f64>| values.iter().any(|y| (y + x.conj()).norm() <= 0.5 * x.re.abs());
    let on_axis = |x: &Complex<f64>| x.im != 0.0 && (x.re.abs() <= rounding.min(0.5 * x.im.abs()) || !has_partner(x));
    let on_axis: Vec<bool> = values.iter().map(on_axis).collect();
    values.iter_mut().zip(on_axis).filter(|(_, on_axis)| *on_axis).for_each(|(x, _)| x.re = 0.0);
    values
}

/// Whether the parabola that has these values at 0, at a part, and at 1 has a root near a piece of the way.
fn root_near([a, m, b]: [Complex<f64>; 3], part: f64, (from, to): (f64, f64)) -> bool {
    let [before, behind] = [(m - a) / part, (b - m) / (1.0 - part)];
    let square = behind - before;
    let half = (before - square * part) * 0.5;
    let root = (half * half - square * a).sqrt();
    let larger = if (half.conj() * root).re >= 0.0 { -half - root } else { -half + root };
    // Of two roots of square·u² + 2 half·u + a one is larger/square, the other a/larger.
    [larger / square, a / larger].iter().any(|u| {
        let aside = (from - u.re).max(u.re - to).max(0.0);
        aside.hypot(u.im) <= REACH * (to - from)
    })
}

/// The square roots of −κ, that with a positive real part (or on the upper axis) first.
fn both_roots(kappa: Complex<f64>) -> [Complex<f64>; 2] {
    let root = match (kappa.im == 0.0, kappa.re > 0.0) {
        (true, true) => Complex::new(0.0, kappa.re.sqrt()),
        (true, false) => Complex::new((-kappa.re).sqrt(), 0.0),
        (false, _) => (-kappa).sqrt(),
    };
    [root, -root]
}

fn of_matrix(matrix: DMatrix<f64>, symmetric: bool) -> Result<Vec<Complex<f64>>, LinearError> {
    let failed = LinearError::NoConvergence { what: "the eigenvalue iteration" };
    if symmetric || is_symmetric(&matrix) {
        let (values, _) = symmetric_eigen((&matrix + matrix.transpose()) * 0.5).ok_or(failed)?;
        return Ok(values.iter().map(|x| Complex::from(*x)).collect());
    }
    #[cfg(feature = "modal")]
    return crate::linear::matrices::Eigen::of(&matrix).map(|found| found.values).ok_or(failed);
    #[cfg(not(feature = "modal"))]
    Err(LinearError::NeedsFeature { feature: "modal" })
}
