//! How rows that depend on each other share a force, but those of what sticks (`constrain/contacts/share.rs`).
//!
//! Of all multipliers that do the same to the rows those with the least Σ w_k λ_k² (Udwadia and Kalaba, Analytical Dynamics, 1992): w_k = S_kk for
//! constraints, which is invariant under a scaling of rows, and the mean of these for contacts, whose gaps are lengths.  So would springs share the force
//! that are alike at all contacts.  In which order rows stand makes no difference.
//!
//! With S = L Lᵀ these are λ = W⁻¹ L (Lᵀ W⁻¹ L)⁻¹ Lᵀ λ'.

use nalgebra::{DMatrix, DVector};

use super::KktSolver;
use crate::mechanism::System;

impl KktSolver {
    /// How rows share a force where they depend on each other everywhere, in the phase in force; `None` where none does that sticks nowhere.
    pub(super) fn shares<S: System + ?Sized>(&self, system: &S) -> Option<Shares> {
        let (m, rank) = (self.active.len(), self.rank);
        let usual = system.description().phases.get(system.phase()).map_or(0, |phase| phase.rank as usize);
        let along = |place: &usize| self.along[self.order[*place]];
        let left_out: Vec<usize> = (rank..m).filter(|place| !along(place)).collect();
        if rank < usual || left_out.is_empty() {
            return None;
        }
        let kept = (0..rank).take_while(|place| !along(place)).count();
        let places: Vec<usize> = (0..kept).chain(left_out).collect();
        let entry = |i: usize, j: usize| if places[i] >= j { self.schur[places[i] * m + j] } else { 0.0 };
        let factor = DMatrix::from_fn(places.len(), kept, entry);
        let norms: Vec<f64> = places.iter().map(|place| self.norms[self.order[*place]]).collect();
        let contacts: Vec<usize> =
            system.contacts().all.iter().filter_map(|contact| Some(contact.normal? as usize)).collect();
        let is_contact = |place: &usize| contacts.contains(&self.active[self.order[*place]]);
        let compliances = factor.row_iter().zip(&norms).map(|(row, norm)| row.norm_squared() * norm.powi(2));
        let compliances: Vec<f64> = compliances.collect();
        let of_contacts = places.iter().zip(&compliances).filter(|(place, _)| is_contact(place));
        let (count, sum) = of_contacts.fold((0, 0.0), |(count, sum), (_, compliance)| (count + 1, sum + compliance));
        let weight = |((place, own), norm): ((&usize, &f64), &f64)| {
            let weight = if is_contact(place) { sum / f64::from(count) } else { *own };
            weight / norm.powi(2)
        };
        let weights: Vec<f64> = places.iter().zip(&compliances).zip(&norms).map(weight).collect();
        Shares::of(places, factor, &weights)
    }

    /// Makes the multipliers of the active rows those of rows that share forces, where they depend on each other everywhere.
    pub fn spread<S: System + ?Sized>(&self, system: &S, lambda: &mut [f64]) {
        // Where friction is made of multipliers they share already.
        if !system.description().friction_pattern.is_empty() {
            return;
        }
        let Some(shares) = self.shares(system) else { return };
        let mut scaled: Vec<f64> = self.order.iter().map(|k| lambda[self.active[*k]] * self.norms[*k]).collect();
        shares.share(&mut scaled);
        for (x, &k) in scaled.iter().zip(&self.order) {
            lambda[self.active[k]] = if self.norms[k] > 0.0 { x / self.norms[k] } else { 0.0 };
        }
    }
}

/// The linear map from multipliers to the shared ones, all scaled as S is.
pub(super) struct Shares {
    /// The rows that share, by their places in the order of the pivots; those that are kept first.
    places: Vec<usize>,
    /// L, a line for each of them.
    factor: DMatrix<f64>,
    /// W⁻¹ L (Lᵀ W⁻¹ L)⁻¹.
    spread: DMatrix<f64>,
}

impl Shares {
    fn of(places: Vec<usize>, factor: DMatrix<f64>, weights: &[f64]) -> Option<Self> {
        let mut light = factor.clone();
        for (mut row, weight) in light.row_iter_mut().zip(weights) {
            row *= if *weight > 0.0 { 1.0 / weight } else { 0.0 };
        }
        let inverse = light.tr_mul(&factor).cholesky()?;
        let spread = inverse.solve(&light.transpose()).transpose();
        Some(Shares { places, factor, spread })
    }

    /// Shares these multipliers of all rows.
    pub(super) fn share(&self, all: &mut [f64]) {
        let own = DVector::from_iterator(self.places.len(), self.places.iter().map(|place| all[*place]));
        let shared = &self.spread * self.factor.tr_mul(&own);
        self.places.iter().zip(shared.iter()).for_each(|(place, x)| all[*place] = *x);
    }

    /// What multipliers of kept rows do where they are shared, from what those of all rows do by themselves.
    pub(super) fn of_kept(&self, all: &mut [f64]) {
        let own = DVector::from_iterator(self.places.len(), self.places.iter().map(|place| all[*place]));
        let kept = self.factor.ncols();
        let shared = self.factor.rows(0, kept) * self.spread.tr_mul(&own);
        all[..kept].copy_from_slice(shared.as_slice());
    }
}
