//! The object-safe face of a mechanism, on slices: everything downstream is written once over it.

use super::{Description, Energy, Scene, Singular};

/// A mechanism with its parameters, behind slices.
///
/// Everything downstream of generated code (integrators, events, charts, the command line) is written
/// over `S: System + ?Sized`: the program instantiates it once for `dyn System`, a Rust user's typed
/// call gets its own fast copy.  With n coordinates, `q`, `v` and `a` are generalized coordinates,
/// their rates and their accelerations, in SI units.
///
/// The equations of motion are F(t, q, v, a) = M(t, q) a + h(t, q, v) = 0.
///
/// Discontinuities are held by *modes*: one number per switch, set with [`System::set_modes`], stands
/// for the `sign` or `step` in the equations, which are smooth while the modes stay as they are.
/// Whoever integrates locates the zeros of [`System::switches`] and resets the modes there.
///
/// Accelerations come from Lagrange's equations unless [`System::set_derivation`] says that they come from a system of
/// momentum balances.
pub trait System {
    /// Names, shapes and structure.
    fn description(&self) -> &Description;

    /// Solves M a = −h, or the system of balances that is the derivation in force.
    ///
    /// # Errors
    /// [`Singular`] names the coordinate whose pivot vanishes, to rounding, or is not finite; or what is void or
    /// undetermined in the balances.
    fn accelerations(&self, t: f64, q: &[f64], v: &[f64], a: &mut [f64]) -> Result<(), Singular>;

    /// M's lower triangle, as values of `description().mass_pattern`.
    fn mass_matrix(&self, t: f64, q: &[f64], values: &mut [f64]);

    /// h, so that M a + h = 0; n numbers.
    fn bias(&self, t: f64, q: &[f64], v: &[f64], h: &mut [f64]);

    /// F = M a + h, n numbers, by one reverse pass where bodies are given.
    fn residual(&self, t: f64, q: &[f64], v: &[f64], a: &[f64], f: &mut [f64]);

    /// ∂F/∂q and ∂F/∂q' as values of `stiffness_pattern` and `damping_pattern`; ∂F/∂a is M.
    fn jacobians(&self, t: f64, q: &[f64], v: &[f64], a: &[f64], dq: &mut [f64], dv: &mut [f64]);

    /// ∂F/∂(u, u', u'') as values of `input_pattern`.
    fn input_jacobian(&self, t: f64, q: &[f64], v: &[f64], a: &[f64], du: &mut [f64]);

    /// ∂F/∂t, inputs held, of the rows of `time_pattern`; nothing where no equation depends on time by itself.
    fn time_jacobian(&self, t: f64, q: &[f64], v: &[f64], a: &[f64], dt: &mut [f64]) {
        let _ = (t, q, v, a, dt);
    }

    /// As [`System::time_jacobian`], with generic numbers in the place of functions of time that can be as small as
    /// none: 0 only where the parameters take time out of the equations, never because a pulse is far away.
    fn time_dependence(&self, t: f64, q: &[f64], v: &[f64], a: &[f64], dt: &mut [f64]) {
        self.time_jacobian(t, q, v, a, dt);
    }

    /// Σ |terms| of each component of F, n numbers: what a residual is judged by.
    ///
    /// Hand-written systems that do not know their terms have |F − F(q = 0)| + |F(q = 0)|.
    fn magnitudes(&self, t: f64, q: &[f64], v: &[f64], a: &[f64], sums: &mut [f64]) {
        let mut rest = vec![0.0; sums.len()];
        self.residual(t, q, v, a, sums);
        self.residual(t, &vec![0.0; q.len()], v, a, &mut rest);
        for (sum, rest) in sums.iter_mut().zip(rest) {
            *sum = if rest.is_finite() { (*sum - rest).abs() + rest.abs() } else { sum.abs() };
        }
    }

    /// Kinetic and potential energy, and what the energy balance needs.
    fn energy(&self, t: f64, q: &[f64], v: &[f64]) -> Energy;

    /// Pairs (value, sum of the absolute values of its terms) for each component of each invariant:
    /// twice `description().invariant_len()` numbers.
    fn invariants(&self, t: f64, q: &[f64], v: &[f64], pairs: &mut [f64]);

    /// Outputs, `description().output_len()` numbers.  `a` may be empty unless
    /// `description().outputs_use_accelerations`.
    fn outputs(&self, t: f64, q: &[f64], v: &[f64], a: &[f64], values: &mut [f64]);

    /// Pairs (value, condition) for each event; it counts only where its condition is > 0
    /// (1 where the file gives none).
    fn events(&self, t: f64, q: &[f64], v: &[f64], a: &[f64], pairs: &mut [f64]);

    /// Pairs (value, total time derivative) of the argument of each switch.
    fn switches(&self, t: f64, q: &[f64], v: &[f64], a: &[f64], pairs: &mut [f64]);

    /// The modes in force, one per switch.
    fn modes(&self) -> &[f64];

    /// Puts other modes in force.
    fn set_modes(&mut self, modes: &[f64]);

    /// Points and radii of `description().draw`, `description().drawing_len()` numbers.
    fn drawing(&self, t: f64, q: &[f64], v: &[f64], values: &mut [f64]);

    /// The free parameters' values, in the order of `description().parameters`.
    fn parameters(&self) -> Vec<f64>;

    /// Sets a free parameter; derived ones follow.
    fn set_parameter(&mut self, index: usize, value: f64);

    /// The inputs' values (u, u', u'' of each) at a time; three per input.
    fn inputs(&self, t: f64, values: &mut [f64]);

    /// Replaces an input's function of time by another that writes (u, u', u'').
    fn set_input(&mut self, index: usize, signal: Signal);

    /// What a scene sets: (index of a free parameter, value), evaluated with the present parameters.
    fn scene_parameters(&self, scene: usize) -> Vec<(usize, f64)>;

    /// A scene's start and settings, evaluated with the present parameters.
    fn scene(&self, scene: usize) -> Scene;

    /// The guess for an equilibrium that the file gives (0 where it gives none); n numbers.
    fn equilibrium_guess(&self) -> Vec<f64>;

    /// A (row by row) and b of the system of balances of this index, so that A·[q''; reactions] = b; nothing is
    /// written where there is none.  [`Balances`](super::Balances) evaluates, solves and judges it.
    fn balances(&self, system: usize, t: f64, q: &[f64], v: &[f64], matrix: &mut [f64], right: &mut [f64]) {
        let _ = (system, t, q, v, matrix, right);
    }

    /// The system of balances that gives the accelerations; `None`: Lagrange's equations.
    fn derivation(&self) -> Option<usize> {
        None
    }

    /// Takes the accelerations, and reactions that are outputs, from a system of balances from now on; `None` goes
    /// back to Lagrange's equations.  A system that is not there changes nothing.
    fn set_derivation(&mut self, system: Option<usize>) {
        let _ = system;
    }

    /// A copy on the heap, for running several at once.
    fn boxed_clone(&self) -> Box<dyn System>;

    /// How many coordinates there are.
    fn len(&self) -> usize {
        self.description().coordinates.len()
    }

    /// True for a mechanism without coordinates.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// An input as a function of time: (u, u', u'').
pub type Signal = std::sync::Arc<dyn Fn(f64) -> [f64; 3] + Send + Sync>;
