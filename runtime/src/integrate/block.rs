//! Blocks of numbers, of a size that is known when compiled or only at run time.

/// A state [q; q'] or its rate: 2n numbers.
///
/// With an array the compiler knows every loop's length; a box takes any.  Methods are written once over both.
pub(crate) trait Block: Clone + Send {
    /// 2n zeros.
    fn zeros(n: usize) -> Self;
    /// All numbers.
    fn all(&self) -> &[f64];
    /// All numbers.
    fn all_mut(&mut self) -> &mut [f64];
}

impl<const N: usize> Block for [[f64; N]; 2] {
    #[inline(always)]
    fn zeros(_: usize) -> Self {
        [[0.0; N]; 2]
    }
    #[inline(always)]
    fn all(&self) -> &[f64] {
        self.as_flattened()
    }
    #[inline(always)]
    fn all_mut(&mut self) -> &mut [f64] {
        self.as_flattened_mut()
    }
}

impl Block for Box<[f64]> {
    fn zeros(n: usize) -> Self {
        vec![0.0; 2 * n].into()
    }
    fn all(&self) -> &[f64] {
        self
    }
    fn all_mut(&mut self) -> &mut [f64] {
        self
    }
}
