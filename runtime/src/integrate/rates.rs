//! The mechanism as a first-order system.

use crate::mechanism::{At, Singular, System};

/// y = [q; q'; W] and its rates [q'; q''; P]; W, the work of what has no potential, only where there is any.
///
/// y is padded with zeros to a multiple of four numbers, so that sums over stages run in blocks of four.
#[derive(Clone, Debug)]
pub(crate) struct Rates {
    /// Number of generalized coordinates.
    pub n: usize,
    /// True when W is carried along.
    pub work: bool,
    /// Length of y with its padding.
    pub width: usize,
    /// How many times the accelerations were evaluated.
    pub evaluations: u64,
}

impl Rates {
    /// Rates of a system with n coordinates.
    pub fn new(n: usize, work: bool) -> Self {
        Rates { n, work, width: (2 * n + usize::from(work)).next_multiple_of(4), evaluations: 0 }
    }

    /// Writes the rates of y at time t into `rate`.
    pub fn evaluate<S: System + ?Sized>(
        &mut self,
        system: &S,
        t: f64,
        y: &[f64],
        rate: &mut [f64],
    ) -> Result<(), Singular> {
        self.evaluations += 1;
        let n = self.n;
        let (q, v) = (&y[..n], &y[n..2 * n]);
        rate[..n].copy_from_slice(v);
        system.accelerations(At::new(t, q, v), &mut rate[n..2 * n])?;
        if self.work {
            rate[2 * n] = system.energy(At::new(t, q, v)).power;
        }
        Ok(())
    }

    /// How many of y's numbers are controlled: all but the work.
    pub fn controlled(&self) -> usize {
        2 * self.n
    }
}
