//! The object-safe face of a mechanism, on slices: everything downstream is written once over it.

use super::NO_CONTACTS;
use super::NO_SAMPLING;
use super::{
    At, Contacts, Description, Energy, Enforcement, Gimbal, Motion, MotionNumbers, Noise, RowHistory, SERIES_TERMS,
    Sampling, Scene, Series, Singular,
};
use crate::cause::NoSeries;

/// A mechanism with its parameters, behind slices.
///
/// Everything downstream of generated code (integrators, events, charts, the command line) is written
/// over `S: System + ?Sized`: the program instantiates it once for `dyn System`, a Rust user's typed
/// call gets its own fast copy.  Every function is told by [`At`] where it is evaluated; numbers are in SI units.
///
/// With n generalized coordinates q, rates v and accelerations a, the equations of motion are F(t, q, v, a) = M(t, q) a + h(t, q, v) = 0.
///
/// Discontinuities are held by *modes*: one number per switch, set with [`System::set_modes`], stands
/// for the `sign` or `step` in the equations, which are smooth while the modes stay as they are.
/// Whoever integrates locates the zeros of [`System::switches`] and resets the modes there.
///
/// Accelerations come from Lagrange's equations unless [`System::set_derivation`] says that they come from a system of
/// momentum balances.
pub trait System: Send + Sync {
    /// Names, shapes and structure.
    fn description(&self) -> &Description;

    /// Sequences of three angles that can lock.
    fn gimbals(&self) -> &[Gimbal] {
        &[]
    }

    /// What is held between events, what sets it, and when.
    fn sampling(&self) -> &Sampling {
        &NO_SAMPLING
    }

    /// Held noise.
    fn held_noise(&self) -> &[Noise] {
        &[]
    }

    /// Friction that may stick and contacts that may open.
    fn contacts(&self) -> &Contacts {
        &NO_CONTACTS
    }

    /// The held values, in the order of `sampling().memory`.
    fn memory(&self) -> &[f64] {
        &[]
    }

    /// Holds other values from now on.
    fn set_memory(&mut self, values: &[f64]) {
        let _ = values;
    }

    /// Values of all that events set, in the order of `sampling().sets`, at a state with its own accelerations and multipliers.
    fn assignments(&self, at: At<'_>, values: &mut [f64]) {
        let _ = (at, values);
    }

    /// What is held where a scene starts, with the present parameters.
    fn scene_memory(&self, scene: usize) -> Vec<f64> {
        let _ = scene;
        Vec::new()
    }

    /// The first tick and the period of each clock, s, with the present parameters.
    fn clocks(&self) -> Vec<[f64; 2]> {
        Vec::new()
    }

    /// Motions that the file asks for.  The scene of each, which `scene`, `scene_parameters` and [`Function::Scene`] tell, comes after those
    /// of `description().scenes`, in the same order.
    fn motions(&self) -> &[Motion] {
        &[]
    }

    /// The numbers of a motion, with the present parameters.
    fn motion_numbers(&self, motion: usize) -> MotionNumbers {
        let _ = motion;
        MotionNumbers::default()
    }

    /// Solves M a = −h, or the system of balances that is the derivation in force.
    ///
    /// # Errors
    /// [`Singular`] names the coordinate whose pivot vanishes, to rounding, or is not finite; or what is void or
    /// undetermined in the balances.
    fn accelerations(&self, at: At<'_>, a: &mut [f64]) -> Result<(), Singular>;

    /// The rate [q'; q''] of a state [q; q'] at a time, as methods of integration ask for it most often.
    ///
    /// # Errors
    /// As [`System::accelerations`].
    fn rate(&self, t: f64, y: &[f64], rate: &mut [f64]) -> Result<(), Singular> {
        let (speeds, accelerations) = rate.split_at_mut(y.len() / 2);
        speeds.copy_from_slice(&y[y.len() / 2..]);
        self.accelerations(At::packed(t, y, y.len() / 2), accelerations)
    }

    /// The accelerations of the coordinates of one of `description().parts`, computed of their own state alone; what else `a` holds
    /// means nothing.
    ///
    /// # Errors
    /// As [`System::accelerations`].
    fn part_accelerations(&self, part: usize, at: At<'_>, a: &mut [f64]) -> Result<(), Singular> {
        let _ = part;
        self.accelerations(at, a)
    }

    /// What the same part has of the energies.
    fn part_energy(&self, part: usize, at: At<'_>) -> Energy {
        let _ = part;
        self.energy(at)
    }

    /// The accelerations, and the multipliers λ of all rows of the constraints (0 for those that are not active):
    /// M a + h = (Jᵀ + B) λ and J a + γ = 0.
    ///
    /// # Errors
    /// As [`System::accelerations`].
    fn accelerations_and_multipliers(&self, at: At<'_>, a: &mut [f64], lambda: &mut [f64]) -> Result<(), Singular> {
        lambda.fill(0.0);
        self.accelerations(at, a)
    }

    /// The same where all rows act and the motion so far says that they are clearly independent here, by elimination over shared velocities
    /// without M and J; false where they are not, or no such elimination is known.
    fn eliminated(&self, at: At<'_>, a: &mut [f64], lambda: &mut [f64]) -> bool {
        let _ = (at, a, lambda);
        false
    }

    /// The rates of the accelerations and of all multipliers at a state with its own a and λ, by differentiating the
    /// system that they solve: M ȧ − (Jᵀ + B) λ̇ = −∂F/∂t − …, J ȧ = −…, with a and λ held on the right.  False where they are not
    /// known: no event asks for them, rows depend on each other, or something else than multipliers enforces them.
    fn motion_rates(&self, at: At<'_>, a: &mut [f64], lambda: &mut [f64]) -> bool {
        let _ = (at, a, lambda);
        false
    }

    /// Triples (c, c', Σ |terms| of c) for each row of the constraints, whether it is active or not.  Where a row contains
    /// speeds, c is its integral if that is known ([`super::Row::integral`]), and else c'.
    fn constraints(&self, at: At<'_>, triples: &mut [f64]) {
        let _ = (at, triples);
    }

    /// J = ∂c'/∂q' as values of `constraint_pattern`.
    fn constraint_matrix(&self, at: At<'_>, values: &mut [f64]) {
        let _ = (at, values);
    }

    /// γ of all rows: c'' = J a + γ, or c' = J a + γ for rows that contain speeds.
    fn constraint_bias(&self, at: At<'_>, gamma: &mut [f64]) {
        let _ = (at, gamma);
    }

    /// B as values of `friction_pattern`.
    fn friction(&self, at: At<'_>, values: &mut [f64]) {
        let _ = (at, values);
    }

    /// ∂(J a + γ)/∂q and ∂(J a + γ)/∂q' as values of their patterns.
    fn constraint_jacobians(&self, at: At<'_>, dq: &mut [f64], dv: &mut [f64]) {
        let _ = (at, dq, dv);
    }

    /// ∂c'/∂q as values of its pattern.
    fn constraint_rate_jacobian(&self, at: At<'_>, values: &mut [f64]) {
        let _ = (at, values);
    }

    /// ∂c'/∂(u, u') of all rows: a column for each of u and u' of every input.  False where none are known.
    fn constraint_rates_by_inputs(&self, at: At<'_>, columns: &mut [f64]) -> bool {
        let _ = (at, columns);
        false
    }

    /// Total time derivatives of F and of J a + γ, with a and λ held: n numbers, then one for each row.
    fn held_rates(&self, at: At<'_>, values: &mut [f64]) {
        let _ = (at, values);
    }

    /// The phase in force.
    fn phase(&self) -> usize {
        0
    }

    /// Puts another phase in force.
    fn set_phase(&mut self, phase: usize) {
        let _ = phase;
    }

    /// Rows of the constraints that act in the phase in force.
    fn active_rows(&self) -> &[u32] {
        self.description().phases.get(self.phase()).map_or(&[], |phase| &phase.rows)
    }

    /// What is known of the constraints from the motion so far; `None` for a mechanism without any.
    fn row_history(&self) -> Option<&RowHistory> {
        None
    }

    /// The same, to be noted.
    fn row_history_mut(&mut self) -> Option<&mut RowHistory> {
        None
    }

    /// How constraints are enforced.
    fn enforcement(&self) -> Enforcement {
        Enforcement::Multipliers
    }

    /// Enforces constraints in another way from now on, or with another gain of Baumgarte's, α in 1/s (0: none).
    fn enforce(&mut self, by: Enforcement, alpha: f64) {
        let _ = (by, alpha);
    }

    /// Baumgarte's gain α in force, 1/s; 0: none.
    fn baumgarte_gain(&self) -> f64 {
        0.0
    }

    /// Quantities that scenes' starts meet beside constraints: what they are at a state, and what they are to be.
    fn start_conditions(&self, at: At<'_>) -> Vec<(f64, f64)> {
        let _ = at;
        Vec::new()
    }

    /// Pairs (place of one of these, rate that it contains).
    fn start_condition_speeds(&self) -> Vec<(u32, u32)> {
        Vec::new()
    }

    /// The coefficients of restitution that `description().events` refer to.
    fn restitutions(&self) -> Vec<f64> {
        Vec::new()
    }

    /// Angular frequencies ω, rad/s and of either sign, of the dependence of the motion on time, with the present parameters: all of it is
    /// in sines, cosines and periodic tables of ω t + …; some ω may be 0.  Equations, constraints, the inputs that they contain,
    /// discontinuities and the events that do more than record count.  With all of them multiples of ω₀ everything repeats itself after
    /// 2π/ω₀, if not sooner.  Empty where nothing depends on time; `None` where it does in another way, an input was replaced, or it is not
    /// known.
    fn frequencies(&self) -> Option<Vec<f64>> {
        None
    }

    /// M's lower triangle, as values of `description().mass_pattern`; of the rates only states of first order are read, which masses may contain.
    fn mass_matrix(&self, at: At<'_>, values: &mut [f64]);

    /// M's diagonal, n numbers, 0 where there is no entry; where M is not written down the squares that it is made of, each by itself, which
    /// grow without bound where it does.
    /// `room` is reused between calls, which then allocate nothing.
    fn inertias(&self, at: At<'_>, room: &mut Vec<f64>, diagonal: &mut [f64]) {
        let pattern = &self.description().mass_pattern;
        room.resize(pattern.len(), 0.0);
        self.mass_matrix(at, room);
        put_diagonal(pattern, room, diagonal);
    }

    /// h, so that M a + h = 0; n numbers.
    fn bias(&self, at: At<'_>, h: &mut [f64]);

    /// F = M a + h, n numbers, by one reverse pass where bodies are given.
    fn residual(&self, at: At<'_>, f: &mut [f64]);

    /// ∂F/∂q and ∂F/∂q' as values of `stiffness_pattern` and `damping_pattern`; ∂F/∂a is M.
    fn jacobians(&self, at: At<'_>, dq: &mut [f64], dv: &mut [f64]);

    /// ∂F/∂(u, u', u'') as values of `input_pattern`.
    fn input_jacobian(&self, at: At<'_>, du: &mut [f64]) {
        let _ = (at, du);
    }

    /// ∂F/∂t, inputs held, of the rows of `time_pattern`; nothing where no equation depends on time by itself.
    fn time_jacobian(&self, at: At<'_>, dt: &mut [f64]) {
        let _ = (at, dt);
    }

    /// As [`System::time_jacobian`], with generic numbers in the place of functions of time that can be as small as
    /// none: 0 only where the parameters take time out of the equations, never because a pulse is far away.
    fn time_dependence(&self, at: At<'_>, dt: &mut [f64]) {
        self.time_jacobian(at, dt);
    }

    /// Σ |terms| of each component of F, n numbers: what a residual is judged by.
    ///
    /// Hand-written systems that do not know their terms have |F − F(q = 0)| + |F(q = 0)|.
    fn magnitudes(&self, at: At<'_>, sums: &mut [f64]) {
        let (mut rest, zero) = (vec![0.0; sums.len()], vec![0.0; at.q.len()]);
        self.residual(at, sums);
        self.residual(At { q: &zero, ..at }, &mut rest);
        for (sum, rest) in sums.iter_mut().zip(rest) {
            *sum = if rest.is_finite() { (*sum - rest).abs() + rest.abs() } else { sum.abs() };
        }
    }

    /// What rounding may have made of each component of h, n numbers: where forces cancel each other it is much beside them.
    ///
    /// Hand-written systems have half a unit in the last place of their [`System::magnitudes`].
    fn force_errors(&self, at: At<'_>, errors: &mut [f64]) {
        self.magnitudes(at.accelerated(&vec![0.0; errors.len()]), errors);
        errors.iter_mut().for_each(|error| *error *= 0.5 * f64::EPSILON);
    }

    /// Kinetic and potential energy, and what the energy balance needs.
    fn energy(&self, at: At<'_>) -> Energy;

    /// Pairs (value, sum of the absolute values of its terms) for each component of each invariant:
    /// twice `description().invariant_len()` numbers.
    fn invariants(&self, at: At<'_>, pairs: &mut [f64]) {
        let _ = (at, pairs);
    }

    /// Outputs, `description().output_len()` numbers.  Accelerations may be left out unless
    /// `description().outputs_use_accelerations`.
    fn outputs(&self, at: At<'_>, values: &mut [f64]) {
        let _ = (at, values);
    }

    /// ∂y/∂(q, q', q'', λ, u, u', u'', t) of all components of the outputs, at a state with its own accelerations and
    /// multipliers: a column of `description().output_len()` numbers for each coordinate, each rate, each acceleration,
    /// each row of the constraints, each of three for every input, and time.  NaN where an output has no derivative;
    /// false where none are known.
    fn output_slopes(&self, at: At<'_>, columns: &mut [f64]) -> bool {
        let _ = (at, columns);
        false
    }

    /// What rounding may have made of each component of the outputs at a state with its own accelerations and multipliers, which are
    /// taken for exact: where an output is a small difference of large terms it is much beside it.  0 where it is not known.
    fn output_errors(&self, at: At<'_>, errors: &mut [f64]) {
        let _ = at;
        errors.fill(0.0);
    }

    /// The slopes of a function's numbers when state, time and parameters change along a direction, by numbers that carry their
    /// derivative (Griewank, Walther, Evaluating Derivatives, 2008, 3.1), derived parameters and the file's inputs included.  Modes and
    /// the phase stay as they are.  NaN where there is no derivative; false where none are known.
    fn slopes(&self, function: Function, at: At<'_>, along: &Along<'_>, values: &mut [f64]) -> bool {
        let _ = (function, at, along, values);
        false
    }

    /// Pairs (value, condition) for each event; it counts only where its condition is > 0
    /// (1 where the file gives none).
    fn events(&self, at: At<'_>, pairs: &mut [f64]) {
        let _ = (at, pairs);
    }

    /// Total time derivative of each event's function, as far as `description().events` says that it is known.
    fn event_rates(&self, at: At<'_>, rates: &mut [f64]) {
        let _ = (at, rates);
    }

    /// Pairs (value, total time derivative) of `description().arguments`.
    fn arguments(&self, at: At<'_>, pairs: &mut [f64]) {
        let _ = (at, pairs);
    }

    /// The function that replaces an input's own; `None`: the file's is in force.
    fn signal(&self, index: usize) -> Option<&Signal> {
        let _ = index;
        None
    }

    /// Pairs (value, total time derivative) of the argument of each switch.
    fn switches(&self, at: At<'_>, pairs: &mut [f64]) {
        let _ = (at, pairs);
    }

    /// The modes in force, one per switch; NaN where it slides.
    fn modes(&self) -> &[f64] {
        &[]
    }

    /// Puts other modes in force.  NaN lets a switch slide: its argument stays zero, since both sides push back to it, and accelerations,
    /// multipliers and all that is made of them are those between the two sides that keep it so.
    fn set_modes(&mut self, modes: &[f64]) {
        let _ = modes;
    }

    /// The switches that slide.
    fn sliding(&self) -> &[usize] {
        &[]
    }

    /// Whether switches can slide.
    fn can_slide(&self) -> bool {
        false
    }

    /// Points and radii of `description().draw`, `description().drawing_len()` numbers.
    fn drawing(&self, at: At<'_>, values: &mut [f64]) {
        let _ = (at, values);
    }

    /// The free parameters' values, in the order of `description().parameters`.
    fn parameters(&self) -> Vec<f64> {
        Vec::new()
    }

    /// Sets a free parameter; derived ones follow.
    fn set_parameter(&mut self, index: usize, value: f64) {
        let _ = (index, value);
    }

    /// The inputs' values (u, u', u'' of each) at a time; three per input.
    fn inputs(&self, t: f64, values: &mut [f64]) {
        let _ = (t, values);
    }

    /// How power series of M, h, J and γ follow from that of the motion, for [`Method::Taylor`](super::Method::Taylor).
    ///
    /// # Errors
    /// Why there are none.
    #[doc(hidden)]
    fn series(&self) -> Result<&Series, NoSeries> {
        Err(NoSeries::Functions)
    }

    /// The numbers that [`System::series`] is made with, at the present parameters, modes and phase.
    #[doc(hidden)]
    fn series_constants(&self, values: &mut [f64]) {
        let _ = values;
    }

    /// The power series of the motion by statements written out, where there are some.
    #[doc(hidden)]
    fn expansion(&self, t: f64, unit: f64, state: &mut [[f64; SERIES_TERMS]]) -> bool {
        let _ = (t, unit, state);
        false
    }

    /// Replaces an input's function of time by another that writes (u, u', u'').
    fn set_input(&mut self, index: usize, signal: Signal) {
        let _ = (index, signal);
    }

    /// Holds an input at a value from now on, in place of its function of time.
    fn hold_input(&mut self, index: usize, value: f64) {
        self.set_input(index, std::sync::Arc::new(move |_| [value, 0.0, 0.0]));
    }

    /// What a scene sets: (index of a free parameter, value), evaluated with the present parameters.
    fn scene_parameters(&self, scene: usize) -> Vec<(usize, f64)> {
        let _ = scene;
        Vec::new()
    }

    /// A scene's start and settings, evaluated with the present parameters.
    fn scene(&self, scene: usize) -> Scene;

    /// The guess for an equilibrium where the file gives one; n numbers.
    fn equilibrium_guess(&self) -> Option<Vec<f64>> {
        None
    }

    /// A (row by row) and b of the system of balances of this index, so that A·[q''; reactions] = b; nothing is
    /// written where there is none.  [`Balances`](super::Balances) evaluates, solves and judges it.
    fn balances(&self, system: usize, at: At<'_>, matrix: &mut [f64], right: &mut [f64]) {
        let _ = (system, at, matrix, right);
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

    /// Lets h and F be wrong from now on, by so many times their [`System::force_errors`], up in one coordinate and down in the next, and M, γ
    /// and J M⁻¹ Jᵀ by so many half units in the last place: what such a run differs by tells what their rounding does. 0: as they are.
    fn disturb_forces(&mut self, times: f64) {
        let _ = times;
    }

    /// By how many times [`System::disturb_forces`] has forces wrong.
    fn disturbance(&self) -> f64 {
        0.0
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

/// A function of a mechanism whose slopes [`System::slopes`] tells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Function {
    /// F, n numbers.
    Residual,
    /// J a + γ of all rows of the constraints.
    RowAccelerations,
    /// Triples (c, c', Σ |terms| of c) of all rows.
    Constraints,
    /// Pairs (value, condition) of the events.
    Events,
    /// Pairs (argument, its rate) of the switches.
    Switches,
    /// Outputs.
    Outputs,
    /// T, V, the Jacobi integral, the power of what has no potential, and the sum of the absolute terms of T and V: 5 numbers.
    Energies,
    /// Pairs (value, sum of the absolute terms) of the invariants.
    Invariants,
    /// Values of all that events set.
    Assignments,
    /// What [`System::start_conditions`] are.
    StartConditions,
    /// The coefficients of restitution.
    Restitutions,
    /// A scene's end, tolerance and spacing of reports, then its start [q; q']: 3 + 2 n numbers, which depend on parameters only.
    Scene(usize),
}

/// What values of a pattern have on the diagonal.
pub(crate) fn put_diagonal(pattern: &[(u32, u32)], values: &[f64], diagonal: &mut [f64]) {
    diagonal.fill(0.0);
    for ((row, column), value) in pattern.iter().zip(values) {
        if row == column {
            diagonal[*row as usize] = *value;
        }
    }
}

/// A direction in which a state, time and a parameter change; slices may be empty where nothing changes.
#[derive(Clone, Copy, Debug, Default)]
pub struct Along<'a> {
    /// The slope of time.
    pub t: f64,
    /// Slopes of the generalized coordinates.
    pub q: &'a [f64],
    /// Slopes of their rates.
    pub v: &'a [f64],
    /// Slopes of their accelerations.
    pub a: &'a [f64],
    /// Slopes of the multipliers.
    pub lambda: &'a [f64],
    /// The free parameter that changes, with slope 1.
    pub parameter: Option<usize>,
    /// The held value that changes, with slope 1.
    pub memory: Option<usize>,
}

/// [`System::active_rows`] as places.
pub(crate) fn rows_in_force<S: System + ?Sized>(system: &S) -> impl Iterator<Item = usize> {
    system.active_rows().iter().map(|row| *row as usize)
}

/// What stands for an input's function of time in the file.
#[derive(Clone)]
pub(crate) enum Replaced {
    /// A function, of which nothing is known between the times at which it is asked.
    Signal(Signal),
    /// A value that is held.
    Held(f64),
}

impl Replaced {
    /// (u, u', u'') at a time.
    pub fn at(&self, t: f64) -> [f64; 3] {
        match self {
            Replaced::Signal(signal) => signal(t),
            Replaced::Held(value) => [*value, 0.0, 0.0],
        }
    }

    /// The function, if it is one.
    pub fn signal(&self) -> Option<&Signal> {
        match self {
            Replaced::Signal(signal) => Some(signal),
            Replaced::Held(_) => None,
        }
    }
}

/// An input as a function of time: (u, u', u'').
pub type Signal = std::sync::Arc<dyn Fn(f64) -> [f64; 3] + Send + Sync>;
