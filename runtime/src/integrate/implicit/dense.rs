//! Dense output of a collocation method.

use super::stages::{From, Newton, Stages};
use super::step::Collocation;
use super::tableau::{STAGES, Tableau, sum};
use crate::integrate::hermite::{BY_ENDS, BY_MIDDLE, nest, write_by_ends, write_by_middle};
use crate::integrate::{OneStep, StepFailure};
use crate::mechanism::System;

/// What a method knows between the ends of a step.
pub(super) struct Interpolation {
    of: Kind,
    pieces: Vec<f64>,
}

enum Kind {
    /// For stiff motions: the collocation polynomial, as what each stage adds to each piece.
    Collocated([[f64; STAGES + 1]; STAGES]),
    /// The polynomial through both ends.
    Ends,
    /// The polynomial through both ends and the middle, which a step of half the length gives.
    Middle(Box<Half>),
}

/// A step of half the length, beside the motion.
struct Half {
    newton: Newton,
    stages: Stages,
    y: Vec<f64>,
    rate: Vec<f64>,
}

impl Interpolation {
    pub fn new(tableau: &'static Tableau, n: usize) -> Self {
        let (of, count) = match tableau.stages() {
            _ if tableau.estimate.is_some() => (Kind::Collocated(stage_pieces(tableau)), STAGES + 1),
            STAGES => {
                let half = Half {
                    newton: Newton::new(tableau, n),
                    stages: Stages::new(STAGES, n),
                    y: vec![0.0; 2 * n],
                    rate: vec![0.0; 2 * n],
                };
                (Kind::Middle(Box::new(half)), BY_MIDDLE)
            }
            _ => (Kind::Ends, BY_ENDS),
        };
        Interpolation { of, pieces: vec![0.0; 2 * n * count] }
    }

    pub fn pieces(&self) -> &[f64] {
        &self.pieces
    }

    /// Of the step of half the length, where there is one.
    pub fn newton(&self) -> Option<&Newton> {
        match &self.of {
            Kind::Middle(half) => Some(&half.newton),
            _ => None,
        }
    }

    pub fn forget(&mut self) {
        if let Kind::Middle(half) = &mut self.of {
            half.newton.forget();
        }
    }
}

/// The pieces of the polynomials that are 1 at one node and 0 at the others and at 0.
fn stage_pieces(tableau: &Tableau) -> [[f64; STAGES + 1]; STAGES] {
    std::array::from_fn(|i| {
        let node = |j: usize| tableau.nodes[j].value();
        let mut monomials = [0.0; STAGES + 1];
        monomials[1] = 1.0 / node(i);
        for other in (0..STAGES).filter(|j| *j != i) {
            // Times (θ − cⱼ)/(cᵢ − cⱼ).
            for k in (0..=STAGES).rev() {
                let below = if k > 0 { monomials[k - 1] } else { 0.0 };
                monomials[k] = (below - node(other) * monomials[k]) / (node(i) - node(other));
            }
        }
        nest(monomials)
    })
}

impl Collocation {
    /// Radau's collocation polynomial; for the methods of Gauss, whose own is of lower order, one through states of the
    /// order of the method.
    pub(super) fn write_dense(&mut self, system: &dyn System, t: f64, h: f64) -> Result<(), StepFailure> {
        let width = 2 * self.ends.n;
        if let Kind::Middle(_) = &self.interpolation.of {
            self.go_half(system, t, h)?;
        }
        let mut pieces = std::mem::take(&mut self.interpolation.pieces);
        match &self.interpolation.of {
            Kind::Ends => write_by_ends(h, [self.start(), self.end()], &mut pieces),
            Kind::Middle(half) => write_by_middle(h, [self.start(), self.end()], (&half.y, &half.rate), &mut pieces),
            Kind::Collocated(weights) => {
                pieces.fill(0.0);
                for j in 0..width {
                    pieces[j] = self.ends.y[j];
                    let (of, j_of) =
                        if j < self.ends.n { (&self.stages.places, j) } else { (&self.stages.speeds, j - self.ends.n) };
                    for (i, line) in weights.iter().enumerate() {
                        for (k, weight) in line.iter().enumerate().skip(1) {
                            pieces[k * width + j] += weight * of[i * self.ends.n + j_of];
                        }
                    }
                }
                // The end may have been moved to the constraints.
                for j in 0..width {
                    pieces[width + j] = self.ends.end[j] - self.ends.y[j];
                }
            }
        }
        self.interpolation.pieces = pieces;
        Ok(())
    }

    fn go_half(&mut self, system: &dyn System, t: f64, h: f64) -> Result<(), StepFailure> {
        let n = self.ends.n;
        let Kind::Middle(half) = &mut self.interpolation.of else { return Ok(()) };
        let node = |j: usize| self.tableau.nodes[j].value();
        for i in 0..STAGES {
            let line = &mut half.stages.accelerations[i * n..][..n];
            line.fill(0.0);
            for j in 0..STAGES {
                let others = (0..STAGES).filter(|l| *l != j);
                let weight: f64 = others.map(|l| (0.5 * node(i) - node(l)) / (node(j) - node(l))).product();
                let known = &self.stages.accelerations[j * n..][..n];
                line.iter_mut().zip(known).for_each(|(k, known)| *k += weight * known);
            }
        }
        let from = From { t, h: 0.5 * h, y: &self.ends.y, carry: &self.ends.carry };
        half.newton.solve(system, from, &mut half.stages, None, &mut self.room)?;
        let Half { stages, y, rate, .. } = &mut **half;
        for j in 0..n {
            let k = |stage: usize| stages.accelerations[stage * n + j];
            let weights = (self.tableau.place_weights, self.tableau.speed_weights);
            let (h, v) = (0.5 * h, self.ends.y[n + j]);
            y[j] = self.ends.y[j] + (self.ends.carry[j] + h * (v + h * sum(weights.0, k)));
            y[n + j] = v + (self.ends.carry[n + j] + h * sum(weights.1, k));
        }
        self.ends.evaluations += 1;
        Ok(system.rate(t + 0.5 * h, y, rate)?)
    }
}
