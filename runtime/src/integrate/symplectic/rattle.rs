//! One step of RATTLE, the method of Störmer and Verlet on a mechanism with constraints.

use crate::mechanism::{At, Enforcement, KktSolver, Singular, System};

/// M q'½ = M q'₀ − h/2 f(q₀) + J(q₀)ᵀλ, q₁ = q₀ + h q'½ with c(t₁, q₁) = 0,
/// M q'₁ = M q'½ − h/2 f(q₁) + J(q₁)ᵀμ with c'(t₁, q₁, q'₁) = 0.
///
/// M: the constant mass matrix, n × n; f = h(t, q): forces with their signs reversed, n; c: the constraints, m; J = ∂c/∂q, m × n;
/// λ, μ: multipliers times half the step.  Order 2, symmetric, symplectic; places and speeds keep the constraints to rounding,
/// also those that move with time.  Its compositions have the orders that they have without constraints, since each part ends on
/// the constraints.
///
/// q₁ is found by Newton's iteration with J(q₁) M⁻¹ J(q₀)ᵀ from where the accelerations lead; a step is too long where there is no
/// such λ (on a circle: hω > 1).  Rows that depend on others are left out as everywhere (`mechanism/kkt/mod.rs`).
///
/// Source: Andersen, J. Comput. Phys. 52 (1983) 24; Hairer, Lubich, Wanner, Geometric Numerical Integration (2006), VII.1.4;
/// compositions: Reich, SIAM J. Numer. Anal. 33 (1996) 475.
#[derive(Default)]
pub(super) struct Rattle {
    /// M and J at the place that was reached last.
    form: KktSolver,
    /// Whether that place is where the next passage begins.
    pub stands: bool,
    /// (c, c', Σ |terms| of c) of all rows.
    triples: Vec<f64>,
    /// The largest Σ |terms| that each row has had at the ends of parts: where it vanishes its terms may too.
    scales: Vec<f64>,
    /// How far, at the most, each row's c would go in the present part without the constraints.
    way: Vec<f64>,
    delta: Vec<f64>,
    right: Vec<f64>,
    lambda: Vec<f64>,
    /// Evaluations of forces.
    pub evaluations: u64,
    /// Matrices of Newton's iteration.
    pub factorizations: u64,
}

/// A part of a step: a step of RATTLE by itself.
#[derive(Clone, Copy)]
pub(super) struct Part<'a> {
    /// Where it ends, s.
    pub t: f64,
    /// Its length, s; below 0 where it goes back.
    pub h: f64,
    /// [q; q'] from which the increments count.
    pub y: &'a [f64],
}

/// Less than the rounding of a constraint beside the sum of its terms.
const ROUNDING: f64 = 0.1 * f64::EPSILON;
/// An iteration that no longer converges has met a constraint to rounding where it misses no more than this part of its terms.
const MET: f64 = 1e-10;
/// A correction that leaves more than this of what is missed calls for a new matrix.
const SLOW: f64 = 0.1;
/// Newton's corrections at most: beside a double root each halves the error.
const ITERATIONS: usize = 40;

/// Whether constraints act by multipliers.
pub(super) fn is_constrained(system: &dyn System) -> bool {
    !system.active_rows().is_empty() && !matches!(system.enforcement(), Enforcement::Springs { .. })
}

impl Rattle {
    /// Stands at a state on the constraints, and finds its accelerations.
    pub fn begin(&mut self, system: &dyn System, at: At<'_>, a: &mut [f64]) -> Result<(), Singular> {
        self.make_room(system);
        self.take(system, at)?;
        self.stands = true;
        self.accelerate(system, at, a)
    }

    /// Takes M and J where a passage begins, unless they are known.
    pub fn stand(&mut self, system: &dyn System, at: At<'_>) -> Result<(), Singular> {
        if !std::mem::replace(&mut self.stands, false) {
            self.make_room(system);
            self.form.factor(system, at)?;
        }
        Ok(())
    }

    fn make_room(&mut self, system: &dyn System) {
        let rows = system.description().rows.len();
        self.triples.resize(3 * rows, 0.0);
        self.scales.resize(rows, 0.0);
        self.way.resize(rows, 0.0);
        self.lambda.resize(rows, 0.0);
        self.delta.resize(system.len(), 0.0);
    }

    /// Takes M, J and the forces at a state.
    fn take(&mut self, system: &dyn System, at: At<'_>) -> Result<(), Singular> {
        self.evaluations += 1;
        self.form.stand(system, at)
    }

    /// Goes through a part from `end` = y + `increment`, where the rate is `rate`, and changes all three to what they are at its
    /// end; false where it is too long.
    pub fn go(
        &mut self,
        system: &dyn System,
        part: Part<'_>,
        (increment, end): (&mut [f64], &mut [f64]),
        rate: &mut [f64],
    ) -> Result<bool, Singular> {
        let Part { t, h, y } = part;
        let n = y.len() / 2;
        let (at_places, at_speeds) = (0..n, n..2 * n);
        for k in at_speeds.clone() {
            increment[k] += 0.5 * h * rate[k];
            end[k] = y[k] + increment[k];
        }
        for k in at_places {
            increment[k] += h * end[n + k];
            end[k] = y[k] + increment[k];
        }
        if !self.close(system, part, increment, end) {
            return Ok(false);
        }
        self.take(system, At::packed(t, end, n))?;
        self.accelerate(system, At::packed(t, end, n), &mut rate[n..])?;
        for k in at_speeds {
            increment[k] += 0.5 * h * rate[k];
            end[k] = y[k] + increment[k];
        }
        self.align(system, part, increment, end);
        self.accelerate(system, At::packed(t, end, n), &mut rate[n..])?;
        rate[..n].copy_from_slice(&end[n..]);
        Ok(true)
    }

    /// Brings the places to the constraints by the forces of the constraints where the part began, and changes the speeds by as
    /// much over its length; false where that cannot be.
    fn close(
        &mut self,
        system: &dyn System,
        Part { t, h, y }: Part<'_>,
        increment: &mut [f64],
        end: &mut [f64],
    ) -> bool {
        let n = y.len() / 2;
        let (mut before, mut fresh) = (f64::INFINITY, false);
        // What the constraints keep where it is is as exact as the way on which it would go without them.
        self.form.held(&self.lambda, &mut self.way);
        self.way.iter_mut().for_each(|way| *way *= 0.5 * h * h);
        for _ in 0..ITERATIONS {
            let missed = self.missed(system, At::packed(t, end, n));
            let left = missed / before;
            let met = fresh && left > SLOW && missed <= MET;
            if met || missed == 0.0 {
                return true;
            }
            fresh = before.is_infinite() || left > SLOW;
            if !missed.is_finite() || (fresh && !self.aim(system, At::place(t, &end[..n]))) {
                break;
            }
            let (triples, delta) = (&self.triples, &mut self.delta);
            self.form.steer(|row| -triples[3 * row], delta);
            for k in 0..n {
                increment[k] += delta[k];
                increment[n + k] += delta[k] / h;
                end[k] = y[k] + increment[k];
                end[n + k] = y[n + k] + increment[n + k];
            }
            // What this correction leaves is known by what the one before left.
            if !before.is_infinite() && left * missed <= ROUNDING {
                return true;
            }
            before = missed;
        }
        false
    }

    fn aim(&mut self, system: &dyn System, place: At<'_>) -> bool {
        self.factorizations += 1;
        self.form.cross(system, place)
    }

    /// By what part of its terms the place misses the constraint that it misses most, of those whose rows are kept.
    fn missed(&mut self, system: &dyn System, at: At<'_>) -> f64 {
        system.constraints(at, &mut self.triples);
        self.form.kept().fold(0.0_f64, |most, row| {
            let (c, terms) = (self.triples[3 * row], self.triples[3 * row + 2]);
            let share = if c == 0.0 { 0.0 } else { c.abs() / terms.max(self.scales[row]).max(self.way[row]) };
            most.max(if share.is_nan() { f64::INFINITY } else { share })
        })
    }

    /// Brings the speeds to the constraints, in the metric of M.
    fn align(&mut self, system: &dyn System, Part { t, y, .. }: Part<'_>, increment: &mut [f64], end: &mut [f64]) {
        let n = y.len() / 2;
        system.constraints(At::packed(t, end, n), &mut self.triples);
        for (scale, triple) in self.scales.iter_mut().zip(self.triples.chunks_exact(3)) {
            *scale = scale.max(triple[2]);
        }
        self.right.clear();
        self.right.extend(self.form.active().iter().map(|row| -self.triples[3 * row + 1]));
        self.delta.fill(0.0);
        self.form.solve(&mut self.delta, &mut self.right);
        for k in 0..n {
            increment[n + k] += self.delta[k];
            end[n + k] = y[n + k] + increment[n + k];
        }
    }

    /// The accelerations at the place where M, J and h were taken last, by the derivation in force.
    fn accelerate(&mut self, system: &dyn System, at: At<'_>, a: &mut [f64]) -> Result<(), Singular> {
        if system.derivation().is_some() {
            self.evaluations += 1;
            return system.accelerations(at, a);
        }
        self.form.motion_here(system, at, 0.0, a, &mut self.lambda)
    }
}
