//! Where a function of a mechanism is evaluated.

/// A time and a state, with accelerations and multipliers where they are known.
///
/// With n coordinates and c constraints; slices may be empty where nothing reads them, as the rates are for M without states in masses.
#[derive(Clone, Copy, Debug, Default)]
#[non_exhaustive]
pub struct At<'a> {
    /// Time, s.
    pub t: f64,
    /// Generalized coordinates q, SI; n numbers.
    pub q: &'a [f64],
    /// Their rates q'; n numbers, or none.
    pub v: &'a [f64],
    /// Their accelerations q''; n numbers, or none.
    pub a: &'a [f64],
    /// Multipliers λ of the constraints; c numbers, or none.
    pub lambda: &'a [f64],
}

impl<'a> At<'a> {
    /// A state (q, q') at a time.
    #[inline(always)]
    pub fn new(t: f64, q: &'a [f64], v: &'a [f64]) -> Self {
        At { t, q, v, ..At::default() }
    }

    /// A configuration at a time, without rates.
    #[inline(always)]
    pub fn place(t: f64, q: &'a [f64]) -> Self {
        At { t, q, ..At::default() }
    }

    /// A state as integrators have it, the n coordinates before their n rates.
    ///
    /// This is the only place that knows in which order they lie; what follows the rates is left out.
    #[inline(always)]
    pub fn packed(t: f64, y: &'a [f64], n: usize) -> Self {
        let (q, rest) = y.split_at(n);
        At::new(t, q, &rest[..n])
    }

    /// With accelerations.
    #[inline(always)]
    pub fn accelerated(self, a: &'a [f64]) -> Self {
        At { a, ..self }
    }

    /// With multipliers.
    #[inline(always)]
    pub fn constrained(self, lambda: &'a [f64]) -> Self {
        At { lambda, ..self }
    }
}
